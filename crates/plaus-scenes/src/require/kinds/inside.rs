//! Inside a region: at some time, always, or never.

use crate::require::aim::{Aim, End, Zone};
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{FAR, Reach};
use crate::require::timed::Timed;
use crate::require::ways::{Leg, Quadratic, extremes_of_smallest};
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How exactly the moment is found at which a body comes in, in s: for marks, not for decisions.
const BRIEF: f64 = 1e-6;

settings! {
    /// A body's middle is inside a region, a box or a ball, at some time of a window, always, or never.
    pub struct Inside {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// Range along x. Unset: anywhere.
        #[schemars(extend("x-unit" = "mm"))]
        x_mm: Option<[f64; 2]>;
        /// Range along y. Unset: anywhere.
        #[schemars(extend("x-unit" = "mm"))]
        y_mm: Option<[f64; 2]>;
        /// Range of height. Unset: anywhere.
        #[schemars(extend("x-unit" = "mm"))]
        z_mm: Option<[f64; 2]>;
        /// Centre of a ball, in place of a box.
        #[schemars(extend("x-unit" = "mm"))]
        centre_mm: Option<[f64; 3]>;
        /// Radius of the ball.
        radius_mm: f64 = 100.0, 1e-3..=1e6, "mm";
        /// Whether at some time, always, never, or at the end.
        how: How;
        /// How many millimetres outside cost one nat.
        scale_mm: f64 = 5.0, 1e-6..=1e6, "mm";
        /// The window of time.
        when: When;
    }
}

/// When a region holds a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum How {
    /// At some time of the window.
    Sometimes,
    /// Throughout the window.
    Always,
    /// At no time of the window.
    Never,
    /// At the end of the motion.
    #[default]
    AtEnd,
}

impl Inside {
    fn sides(&self) -> [(&'static str, Option<[f64; 2]>); 3] {
        [("x_mm", self.x_mm), ("y_mm", self.y_mm), ("z_mm", self.z_mm)]
    }

    /// Least and largest depth below the region's surface over a leg, in mm; negative outside.
    fn depths(&self, leg: &Leg) -> [f64; 2] {
        if let Some(centre) = self.centre_mm {
            let [near, far] = leg.distances(1e-3 * DVec3::from_array(centre));
            return [self.radius_mm - 1e3 * far, self.radius_mm - 1e3 * near];
        }
        let walls = self.sides().into_iter().enumerate().filter_map(|(axis, (_, side))| Some((axis, side?)));
        let depths: Vec<Quadratic> = walls
            .flat_map(|(axis, [low, high])| {
                let c = [leg.p[axis], leg.v[axis], 0.5 * leg.a[axis]].map(|c| 1e3 * c);
                [[c[0] - low, c[1], c[2]], [high - c[0], -c[1], -c[2]]]
            })
            .collect();
        extremes_of_smallest(&depths, leg.length)
    }

    /// When the body is inside for the first time.
    fn entered(&self, probe: &Probe<'_>) -> Option<f64> {
        let window = self.when.window();
        let [mut begin, _] = probe.seen(window)?;
        for leg in probe.legs(&self.body, window) {
            if self.depths(&leg)[1] >= 0.0 {
                // The first half of what remains in which it is inside at some time, until that is short.
                let (mut leg, mut at) = (leg, begin);
                while leg.length > BRIEF {
                    let [first, second] = leg.halves();
                    let is_first = self.depths(&first)[1] >= 0.0;
                    at += if is_first { 0.0 } else { first.length };
                    leg = if is_first { first } else { second };
                }
                return Some(at);
            }
            begin += leg.length;
        }
        None
    }

    /// How deep inside anything can be, in mm.
    fn deepest(&self) -> f64 {
        let half = self.sides().into_iter().filter_map(|(_, side)| side.map(|[low, high]| 0.5 * (high - low)));
        if self.centre_mm.is_some() { self.radius_mm } else { half.fold(f64::INFINITY, f64::min) }
    }
}

impl Ask for Inside {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        self.when.check(place)?;
        for (key, [low, high]) in self.sides().into_iter().filter_map(|(key, side)| Some((key, side?))) {
            if !(low < high && low.abs() <= 1e6 && high.abs() <= 1e6) {
                return Err(place
                    .at(key)
                    .wrong("a range in mm: the first number is the smaller one, and both are at most 1e6"));
            }
        }
        let boxed = self.sides().iter().any(|(_, side)| side.is_some());
        match (boxed, self.centre_mm) {
            (true, Some(_)) => {
                Err(place.wrong("choose a box or a ball: use either `centre_mm`, or `x_mm`, `y_mm` and `z_mm`"))
            }
            (false, None) => Err(place.wrong("which region? Give `x_mm`, `y_mm` or `z_mm`, or `centre_mm`")),
            (_, Some(centre)) if !centre.iter().all(|x| x.abs() <= 1e6) => {
                Err(place.at("centre_mm").wrong("beyond 1e6 mm"))
            }
            _ => Ok(()),
        }
    }

    /// A body that is not there is never inside.
    fn subject(&self) -> Option<&str> {
        (self.how != How::Never).then_some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_mm, "mm"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let nats = |depth: f64| (depth / self.scale_mm).clamp(-FAR, FAR);
        let window = self.when.window();
        let at_end = self.how == How::AtEnd;
        let whole = if at_end { probe.is_whole() } else { probe.sees_all(window) };
        let window = if at_end { probe.at_end() } else { window };
        if probe.is_whole() && probe.track(&self.body).is_none() {
            return if self.how == How::Never { Reach::certain(1.0) } else { Reach::NEVER };
        }
        let legs = if at_end && !whole { Vec::new() } else { probe.legs(&self.body, window) };
        let depths = legs.iter().map(|leg| self.depths(leg));
        let [least, most] =
            depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], d| [low.min(d[0]), high.max(d[1])]);
        let best = nats(self.deepest());
        match self.how {
            How::Sometimes | How::AtEnd => Reach::between(nats(most), if whole { nats(most) } else { best }),
            How::Always => Reach::between(if whole { nats(least) } else { -FAR }, nats(least).min(best)),
            How::Never => Reach::between(nats(most), if whole { nats(most) } else { best }).opposite(),
        }
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        if self.how != How::Sometimes {
            return Vec::new();
        }
        let what = format!("{} inside", probe.name(&self.body));
        vec![Timed { what, wanted: When::default().window(), found: self.entered(probe) }]
    }

    fn looks(&self) -> Looks {
        if self.how == How::AtEnd { Looks::default() } else { Looks::after(self.when.window()).or_impacts() }
    }

    fn aims(&self) -> Vec<Aim> {
        if self.how != How::AtEnd {
            return Vec::new();
        }
        let zone = match (self.centre_mm, [self.x_mm, self.y_mm]) {
            (Some([x, y, _]), _) => Zone::Disc { centre: [x, y], radius: self.radius_mm, scale: self.scale_mm },
            (None, [None, None]) => return Vec::new(),
            (None, sides) => Zone::Box { sides, scale: self.scale_mm },
        };
        vec![Aim { body: self.body.clone(), end: End::In(zone, false) }]
    }
}
