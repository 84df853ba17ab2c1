//! A progress bar on a terminal; with the feature `progress`.

use std::io::IsTerminal;
use std::sync::OnceLock;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::progress::Progress;

/// A progress bar on standard error with counts and the time left; silent when standard error is not a terminal.
#[derive(Debug)]
pub struct Bar {
    /// What is counted.
    what: &'static str,
    bar: OnceLock<ProgressBar>,
}

impl Default for Bar {
    fn default() -> Self {
        Self::of("evaluations")
    }
}

impl Bar {
    /// A bar for things that are called so, in the plural.
    #[must_use]
    pub const fn of(what: &'static str) -> Self {
        Self { what, bar: OnceLock::new() }
    }
}

impl Progress for Bar {
    fn begin(&self, total: u64, done: u64) {
        let target =
            if std::io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let template = format!("{{bar:30}} {{human_pos}} of {{human_len}} {} in {{elapsed}}, {{eta}} left", self.what);
        let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = self.bar.get_or_init(|| ProgressBar::with_draw_target(None, target).with_style(style));
        // What takes long at its first step must not look as if nothing had begun.
        bar.enable_steady_tick(std::time::Duration::from_millis(500));
        bar.set_length(total);
        bar.set_position(done);
        // The estimate of the time left must not include the evaluations of an earlier run.
        bar.reset_eta();
    }

    fn advance(&self, evaluations: u64) {
        if let Some(bar) = self.bar.get() {
            bar.inc(evaluations);
        }
    }

    fn end(&self) {
        if let Some(bar) = self.bar.get() {
            bar.abandon();
        }
    }
}
