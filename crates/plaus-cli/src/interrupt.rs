//! Ctrl-C, and what schedulers send: the first asks for a checkpoint and an end, the second ends at once.

use crate::failure::Failure;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of an interrupted run.
pub(crate) const EXIT: u8 = 130;

static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on an interrupt is noted instead of ending the process.
pub(crate) fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(EXIT));
        }
    })
    .map_err(|error| Failure::Message(format!("cannot listen for interrupts: {error}")))
}

/// Whether an interrupt came.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}
