//! A progress bar on a terminal; with the feature `progress`.

use std::io::IsTerminal;
use std::sync::OnceLock;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::progress::Progress;

/// A progress bar on standard error with counts and the time left; silent when standard error is not a terminal.
#[derive(Debug, Default)]
pub struct Bar {
    bar: OnceLock<ProgressBar>,
}

impl Progress for Bar {
    fn begin(&self, total: u64, done: u64) {
        let target =
            if std::io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let template = "{bar:30} {human_pos} of {human_len} evaluations, {eta} left";
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = self.bar.get_or_init(|| ProgressBar::with_draw_target(None, target).with_style(style));
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
