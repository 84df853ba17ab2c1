//! Texts from files in messages.

/// A text for a message, shortened where it is long, and in one line.
pub(crate) fn cut(text: &str) -> String {
    /// Most characters of a line that a message shows; chosen to keep it in one line.
    const LONGEST_SHOWN: usize = 60;
    let mut shown: String = text.chars().take(LONGEST_SHOWN).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST_SHOWN).is_some() {
        shown.push_str("...");
    }
    shown
}
