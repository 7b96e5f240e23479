//! A progress bar for work that takes over a second, when a person is watching.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Counts work done; shows a bar only after a second, on a terminal, unless asked to be quiet.
pub(crate) struct Progress {
    total: u64,
    done: std::sync::atomic::AtomicU64,
    start: Instant,
    visible: bool,
    bar: OnceLock<ProgressBar>,
    what: &'static str,
}

impl Progress {
    pub(crate) fn new(what: &'static str, total: usize, quiet: bool) -> Self {
        Self {
            total: total as u64,
            done: std::sync::atomic::AtomicU64::new(0),
            start: Instant::now(),
            visible: !quiet && std::io::stderr().is_terminal(),
            bar: OnceLock::new(),
            what,
        }
    }

    pub(crate) fn add(&self, count: usize) {
        let done = self
            .done
            .fetch_add(count as u64, std::sync::atomic::Ordering::Relaxed)
            + count as u64;
        if !self.visible || self.start.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_init(|| {
            let bar = ProgressBar::with_draw_target(Some(self.total), ProgressDrawTarget::stderr());
            if let Ok(style) =
                ProgressStyle::with_template("{msg} {wide_bar} {percent}% ({eta} left)")
            {
                bar.set_style(style);
            }
            bar.set_message(self.what);
            bar
        });
        bar.set_position(done);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}
