//! A progress bar on a terminal, lines in a log; as everything that takes long has them.

use std::io::{IsTerminal, Write};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use montecarlo::Progress;
use squeal::RunProgress;

use crate::log_lines::LogLines;
use crate::terminal::note;

/// Name of the things that a bar counts while a study is prepared, in the plural.
pub(crate) const PREPARED: &str = "steps of preparation";
/// Name of the things that a bar counts while a study is sampled, in the plural.
pub(crate) const EVALUATED: &str = "evaluations";
/// Name of the things that a bar counts while reasons are looked for, in the plural.
pub(crate) const REASONS: &str = "scenes asked why";
/// Time between two looks whether a line is due; chosen.
const LOOK: Duration = Duration::from_millis(500);

/// Progress on standard error: a bar with counts and the time left where that is a terminal, elsewhere a line whenever nothing was
/// said for ten seconds.
#[derive(Debug)]
pub struct Bar {
    /// Name of the things that are counted, in the plural.
    what: &'static str,
    bar: OnceLock<ProgressBar>,
    log: Mutex<Option<Log>>,
}

/// The lines of a log; what looks after them ends with it.
#[derive(Debug)]
struct Log {
    lines: Arc<Mutex<LogLines>>,
    _until_dropped: Sender<()>,
}

impl Default for Bar {
    fn default() -> Self {
        Self::of(EVALUATED)
    }
}

impl Bar {
    /// A bar for things that are called so, in the plural.
    #[must_use]
    pub const fn of(what: &'static str) -> Self {
        Self { what, bar: OnceLock::new(), log: Mutex::new(None) }
    }

    fn set_log(&self, log: Option<Log>) {
        *self.log.lock().unwrap_or_else(PoisonError::into_inner) = log;
    }
}

impl Log {
    /// Lines on standard error until it is dropped, also where one step takes long. Nobody has to read them.
    fn begin(lines: LogLines) -> Self {
        let (sender, receiver) = channel();
        let lines = Arc::new(Mutex::new(lines));
        let (of_thread, start) = (Arc::clone(&lines), Instant::now());
        std::thread::spawn(move || {
            while receiver.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                let line = of_thread.lock().unwrap_or_else(PoisonError::into_inner).tick(start.elapsed());
                if let Some(line) = line {
                    let _ = writeln!(std::io::stderr(), "{line}");
                }
            }
        });
        Self { lines, _until_dropped: sender }
    }
}

/// Receiver of the progress of a command, stage by stage; `what` names the things that a stage counts, in the plural.
pub trait Stages: Sync {
    /// Receiver of the progress of one stage.
    fn stage<'s>(&'s self, what: &'static str) -> Box<dyn Progress + 's>;
}

/// Bars, one for each stage.
#[derive(Debug, Clone, Copy)]
pub struct Bars;

impl Stages for Bars {
    fn stage<'s>(&'s self, what: &'static str) -> Box<dyn Progress + 's> {
        Box::new(Bar::of(what))
    }
}

/// The bars of a run, stage by stage.
#[derive(Debug)]
pub struct RunBars {
    preparation: Bar,
    evaluation: Bar,
    reasons: Bar,
}

impl Default for RunBars {
    fn default() -> Self {
        Self { preparation: Bar::of(PREPARED), evaluation: Bar::of(EVALUATED), reasons: Bar::of(REASONS) }
    }
}

impl RunBars {
    /// Bars as a run asks for them: for its preparation, its evaluations and its reasons.
    #[must_use]
    pub fn progress(&self) -> RunProgress<'_> {
        RunProgress { preparation: &self.preparation, evaluation: &self.evaluation, reasons: &self.reasons }
    }
}

impl Progress for Bar {
    fn begin(&self, total: u64, done: u64) {
        if !std::io::stderr().is_terminal() {
            let lines = LogLines { what: self.what, total, before: done, done, told: Duration::ZERO };
            return self.set_log(Some(Log::begin(lines)));
        }
        let template = format!("{{bar:30}} {{human_pos}} of {{human_len}} {} in {{elapsed}}, {{eta}} left", self.what);
        let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let target = ProgressDrawTarget::stderr();
        let bar = self.bar.get_or_init(|| ProgressBar::with_draw_target(None, target).with_style(style));
        // What takes long at its first step must not look as if nothing had begun.
        bar.enable_steady_tick(LOOK);
        bar.set_length(total);
        bar.set_position(done);
        // The estimate of the time left must not include the evaluations of an earlier run.
        bar.reset_eta();
    }

    fn advance(&self, evaluations: u64) {
        if let Some(bar) = self.bar.get() {
            bar.inc(evaluations);
        }
        if let Some(log) = &*self.log.lock().unwrap_or_else(PoisonError::into_inner) {
            log.lines.lock().unwrap_or_else(PoisonError::into_inner).done += evaluations;
        }
    }

    fn tell(&self, news: &str) {
        match self.bar.get() {
            Some(bar) => bar.suspend(|| note(news)),
            None => note(news),
        }
    }

    fn end(&self) {
        if let Some(bar) = self.bar.get() {
            bar.abandon();
        }
        self.set_log(None);
    }
}
