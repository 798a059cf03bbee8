//! Work in a thread of its own, while Python waits without its lock, looks at how far it is, and can stop it.

use crate::clock::now;
use crate::errors::{RunError, of_run};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use std::{panic, thread};

/// How often it is looked whether there is a reason to stop.
const TICK: Duration = Duration::from_millis(50);

/// Work that can be looked at, and stopped.
pub(crate) trait Watched {
    /// Asks for an end soon, with what is there.
    fn stop(&self);

    /// Says how far it is; `false` where there is nothing to say yet.
    fn tell(&self, state: &Bound<'_, PyDict>) -> PyResult<bool>;
}

/// What came of work.
pub(crate) struct Over<T> {
    pub(crate) made: T,
    /// Why it was stopped, if it was.
    pub(crate) why: Option<&'static str>,
    pub(crate) seconds: f64,
}

/// Why work ends before it is done.
#[derive(Default)]
struct Stop {
    why: Option<&'static str>,
    raised: Option<PyErr>,
}

impl Stop {
    fn because(&mut self, why: &'static str, work: &dyn Watched) {
        self.why.get_or_insert(why);
        work.stop();
    }
}

/// Waits for work, looking now and then whether it is to stop.
pub(crate) struct Wait<'py> {
    pub(crate) py: Python<'py>,
    /// Seconds after which it stops.
    pub(crate) max_time: Option<f64>,
    /// A function of how far it is; what is false stops it.
    pub(crate) poll: Option<Bound<'py, PyAny>>,
    /// Seconds between two of its calls.
    pub(crate) interval: f64,
}

impl Wait<'_> {
    /// Does `job`, which `work` shows and stops.
    pub(crate) fn over<T: Send + 'static>(
        &self,
        work: &dyn Watched,
        job: impl FnOnce() -> Result<T, plaus_run::Error> + Send + 'static,
    ) -> PyResult<Over<T>> {
        let (tell, done) = sync_channel(1);
        let guarded = move || {
            let made = panic::catch_unwind(panic::AssertUnwindSafe(job)).ok();
            // Nobody listens any more where a second Ctrl-C came.
            let _ = tell.send(made);
        };
        let spawned = thread::Builder::new().name("plaus".to_owned()).spawn(guarded);
        spawned.map_err(|error| RunError::new_err(format!("cannot start a thread: {error}")))?;
        let done = Mutex::new(done);
        let (mut stop, begun, mut shown) = (Stop::default(), now(), f64::NEG_INFINITY);
        let made = loop {
            let wait = || done.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK);
            match self.py.detach(wait) {
                Ok(Some(Ok(made))) => break made,
                Ok(Some(Err(error))) => return Err(stop.raised.unwrap_or_else(|| of_run(self.py, &error))),
                Ok(None) | Err(RecvTimeoutError::Disconnected) => {
                    let message = "plaus panicked: a bug of plaus; its message is on the standard error";
                    return Err(RunError::new_err(message));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Err(error) = self.py.check_signals() {
                // The first asks for an end soon; the second does not wait for it.
                if stop.why == Some("interrupted") || !error.is_instance_of::<PyKeyboardInterrupt>(self.py) {
                    work.stop();
                    return Err(error);
                }
                stop.because("interrupted", work);
            }
            if self.max_time.is_some_and(|most| now() - begun >= most) {
                stop.because("out_of_time", work);
            }
            if stop.why.is_none() && now() - shown >= self.interval {
                shown = now();
                self.show(now() - begun, work, &mut stop);
            }
        };
        match stop.raised {
            Some(error) => Err(error),
            None => Ok(Over { made, why: stop.why, seconds: now() - begun }),
        }
    }

    fn show(&self, seconds: f64, work: &dyn Watched, stop: &mut Stop) {
        let Some(poll) = &self.poll else { return };
        let ask = || -> PyResult<bool> {
            let state = PyDict::new(self.py);
            state.set_item("seconds", seconds)?;
            if !work.tell(&state)? {
                return Ok(true);
            }
            let answer = poll.call1((state,))?;
            Ok(answer.is_none() || answer.is_truthy()?)
        };
        match ask() {
            Ok(true) => {}
            Ok(false) => stop.because("callback", work),
            Err(error) => {
                stop.because("callback", work);
                stop.raised = Some(error);
            }
        }
    }
}
