//! Windows of time.

use super::missed::Nat;
use super::place::Place;
use super::score::Band;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// When: a time with a tolerance, a window, or a frame. Without any of them: at any time.
    #[derive(Copy)]
    pub struct When {
        /// About this time; `within_ms` says how near.
        #[schemars(extend("x-example" = 0.2))]
        at_s: Option<f64>, 0.0..=3600.0, "s";
        /// How far from `at_s` it may be.
        within_ms: f64 = 10.0, 1e-6..=1e6, "ms";
        /// Not before.
        #[schemars(extend("x-example" = 0.5))]
        from_s: Option<f64>, 0.0..=3600.0, "s";
        /// Not after.
        #[schemars(extend("x-example" = 2.5))]
        to_s: Option<f64>, 0.0..=3600.0, "s";
        /// In this frame, counted from 0: within half a frame of its time.
        frame: Option<u32>, 0..=1_000_000;
        /// Frames per second, for `frame`.
        fps: f64 = 24.0, 1.0..=1000.0, "1/s";
        /// How many milliseconds outside the window cost one nat. Unset: half of the tolerance, or 50 ms for a window
        /// with an open end.
        #[schemars(extend("x-example" = 5.0))]
        scale_ms: Option<f64>, 1e-6..=1e6, "ms";
    }
}

/// From one time to another, in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Beginning; −∞ if there is none.
    pub from: f64,
    /// End; ∞ if there is none.
    pub to: f64,
}

impl When {
    /// The window.
    #[must_use]
    pub fn window(&self) -> Window {
        let about = |at: f64, within: f64| Window { from: at - within, to: at + within };
        match (self.at_s, self.frame) {
            (Some(at), _) => about(at, 1e-3 * self.within_ms),
            (_, Some(frame)) => about(f64::from(frame) / self.fps, 0.5 / self.fps),
            _ => Window { from: self.from_s.unwrap_or(f64::NEG_INFINITY), to: self.to_s.unwrap_or(f64::INFINITY) },
        }
    }

    /// Whether it says anything.
    pub(super) fn is_set(&self) -> bool {
        *self != Self::default()
    }

    /// One moment if there is one, otherwise the window.
    pub(super) fn moments(&self) -> Window {
        match self.at_s.is_some() || self.frame.is_some() {
            true => self.instant().map_or_else(|| self.window(), |at| Window { from: at, to: at }),
            false => self.window(),
        }
    }

    /// The window, and how far outside it costs one nat.
    #[must_use]
    pub fn band(&self) -> Band {
        let Window { from, to } = self.window();
        let half = 0.5 * (to - from);
        let usual = if half.is_finite() && half > 0.0 { 0.5 * half } else { 0.05 };
        Band { from, to, scale: self.scale_ms.map_or(usual, |scale| 1e-3 * scale) }
    }

    /// What a nat of the band's margin measures.
    pub(super) fn nat(&self) -> Nat {
        Nat::of(1e3 * self.band().scale, "ms")
    }

    /// The one time that is meant, for a condition at a time; `None`: at the end.
    #[must_use]
    pub fn instant(&self) -> Option<f64> {
        self.at_s.or_else(|| self.frame.map(|frame| f64::from(frame) / self.fps)).or(self.from_s)
    }

    /// Refuses an invalid window.
    pub(super) fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        let place = place.at("when");
        let ways = [self.at_s.is_some(), self.frame.is_some(), self.from_s.is_some() || self.to_s.is_some()];
        if ways.iter().filter(|way| **way).count() > 1 {
            return Err(place.wrong("give the time in one way: `at_s`, `frame`, or `from_s` and `to_s`"));
        }
        let Window { from, to } = self.window();
        if from > to {
            return Err(place.wrong(&format!("an empty window: it ends at {to} s, before it begins at {from} s")));
        }
        if from > place.cast().longest {
            let longest = place.cast().longest;
            return Err(place.wrong(&format!("it begins at {from} s, but every motion ends by {longest} s")));
        }
        Ok(())
    }
}
