//! A progress bar for people at a terminal, and Ctrl-C.

use super::args::TalkArgs;
use crate::driver::{Progress, Watcher};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Steps of the bar.
const STEPS: u64 = 1000;

/// Shows progress on stderr when it is a terminal; stops the job on Ctrl-C. A second Ctrl-C ends the process.
pub(super) struct Bar {
    bar: ProgressBar,
}

impl Bar {
    pub(super) fn new(talk: &TalkArgs) -> Self {
        let handler = || {
            if INTERRUPTED.swap(true, Ordering::SeqCst) {
                std::process::exit(i32::from(super::error::INTERRUPTED));
            }
        };
        // A handler that is there already does the same.
        let _ = ctrlc::set_handler(handler);
        if talk.quiet || !std::io::stderr().is_terminal() {
            return Self { bar: ProgressBar::hidden() };
        }
        let bar = ProgressBar::new(STEPS);
        let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {elapsed} / {eta} left  {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self { bar }
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Watcher for Bar {
    fn progress(&self, p: &Progress) {
        if self.bar.is_hidden() {
            return;
        }
        if let Some(fraction) = p.fraction {
            self.bar.set_position((fraction * STEPS as f64) as u64);
        }
        let error = p.rel_error.map_or_else(String::new, |e| format!(", rel_error {:.2} %", 100.0 * e));
        let rate = p.samples as f64 / p.seconds.max(1e-9);
        self.bar.set_message(format!("{} samples, {rate:.1}/s{error}", p.samples));
    }

    fn cancelled(&self) -> bool {
        INTERRUPTED.load(Ordering::SeqCst)
    }
}
