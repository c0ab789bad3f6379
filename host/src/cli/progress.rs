//! The progress bar, and Ctrl-C.

use indicatif::{ProgressBar, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Between two updates of the progress bar.
const REDRAW: Duration = Duration::from_millis(50);

/// A progress bar on standard error that also notices Ctrl-C.
pub(super) struct Progress {
    bar: ProgressBar,
    drawn: Instant,
    interrupted: Arc<AtomicBool>,
}

impl Progress {
    pub(super) fn new() -> Self {
        let interrupted = watch_for_interrupts();
        Self {
            bar: bar(),
            drawn: Instant::now(),
            interrupted,
        }
    }

    /// Shows which fraction is done and says whether to go on.
    pub(super) fn tell(&mut self, done: f64) -> ControlFlow<()> {
        if self.drawn.elapsed() >= REDRAW {
            self.drawn = Instant::now();
            self.bar.set_position((done * 1000.0) as u64);
        }
        if self.interrupted.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    pub(super) fn finish(self) {
        self.bar.finish_and_clear();
    }
}

/// A bar of a thousand parts. Hidden by the crate if standard error is no terminal.
pub(super) fn bar() -> ProgressBar {
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent} %, {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// Set by the first Ctrl-C, so that the run ends and temporary folders go; the second one ends the process,
/// should an FMU not return.
pub(super) fn watch_for_interrupts() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    // Without a handler Ctrl-C works as usual.
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    interrupted
}
