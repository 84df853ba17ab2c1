//! Lines of progress for a log: one wherever nothing was said for long.

use std::time::Duration;

/// Longest silence; chosen: after that a program looks as if it hung.
pub(crate) const LONGEST_SILENCE: Duration = Duration::from_secs(10);

/// Progress of a work, and when it was last said. Instants are times since its beginning.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LogLines {
    /// Name of the things that are counted, in the plural.
    pub what: &'static str,
    pub total: u64,
    /// Number of them that an earlier run did.
    pub before: u64,
    pub done: u64,
    pub told: Duration,
}

impl LogLines {
    /// The line for this instant, where the last one is long ago.
    pub fn tick(&mut self, now: Duration) -> Option<String> {
        if now < self.told + LONGEST_SILENCE {
            return None;
        }
        self.told = now;
        let Self { what, total, before, done, .. } = *self;
        let seconds = now.as_secs();
        let own = done.saturating_sub(before);
        let left = match total.saturating_sub(done) {
            left if own > 0 => format!(", roughly {:.0} s left", now.as_secs_f64() * left as f64 / own as f64),
            _ => String::new(),
        };
        Some(format!("{what}: {done} of {total} in {seconds} s{left}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_ends_ten_seconds_of_silence() {
        let at = Duration::from_secs;
        let mut lines = LogLines { what: "bases", total: 12, before: 2, done: 2, told: at(0) };
        assert_eq!((lines.tick(at(1)), lines.tick(at(9))), (None, None));
        assert_eq!(lines.tick(at(10)).unwrap(), "bases: 2 of 12 in 10 s");
        lines.done = 4;
        assert_eq!(lines.tick(at(19)), None);
        assert_eq!(lines.tick(at(21)).unwrap(), "bases: 4 of 12 in 21 s, roughly 84 s left");
        assert_eq!(lines.tick(at(30)), None);
        lines.done = 12;
        assert_eq!(lines.tick(at(31)).unwrap(), "bases: 12 of 12 in 31 s, roughly 0 s left");
    }
}
