//! What can be asked of a die, and how well an animation meets it.

use super::Rotation;
use super::flight::Trip;
use crate::require::{self, FAR, FacesUp, Impact, Missed, Require, RestsAt, When};
use crate::settings::settings;
use crate::turns::turned;
use glam::{DQuat, DVec3};
use plaus_dist::math;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One demand. Its log density is 0 if it is met perfectly, and negative otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Constraint {
    /// Where a die comes to rest.
    RestAt(RestAt),
    /// Which face comes up.
    FaceUp(FaceUp),
    /// Where a die is at a given time, how it is turned, and how fast it is.
    PoseAt(PoseAt),
    /// A point that a die's middle passes near.
    Passes(Passes),
    /// When a die first touches the table.
    FirstImpact(FirstImpact),
}

settings! {
    /// A die comes to rest with its middle over a place: `−½ (distance/sigma)²`.
    #[derive(Copy)]
    pub struct RestAt {
        /// Which die, counted from 1.
        die: u32 = 1, 1..=24;
        /// Place along x.
        x_mm: f64 = 0.0, -1e5..=1e5, "mm";
        /// Place along y.
        y_mm: f64 = 0.0, -1e5..=1e5, "mm";
        /// Standard deviation along each axis: smaller is stricter.
        sigma_mm: f64 = 4.0, 0.001..=1e5, "mm";
        /// A die that rests closer than this meets the demand.
        within_mm: f64 = 10.0, 0.001..=1e5, "mm";
    }

    /// A die comes to rest with a given face up. Another face costs `−ln_lambda`; if `angle_sd_deg` is given, the angle
    /// adds `−½ (angle/angle_sd_deg)²`.
    #[derive(Copy)]
    pub struct FaceUp {
        /// Which die, counted from 1.
        die: u32 = 1, 1..=24;
        /// The face.
        face: u32 = 6, 1..=6;
        /// What another face costs.
        ln_lambda: f64 = 5.0, 0.0..=700.0, "nat";
        /// Standard deviation of the angle between the face's normal and the vertical; 0: the angle does not count.
        angle_sd_deg: f64 = 0.0, 0.0..=180.0, "degree";
        /// If a die's face is farther from level than this, the die leans on something, and no face is up.
        within_deg: f64 = 20.0, 0.1..=45.0, "degree";
    }

    /// A die's state at a given time: minus half the sum of squares of its distance, its angle and its difference in
    /// velocity, each divided by its spread.
    #[derive(Copy)]
    pub struct PoseAt {
        /// Which die, counted from 1.
        die: u32 = 1, 1..=24;
        /// When. A die that has come to rest stays where it is.
        time_s: f64 = 0.3, 0.0..=60.0, "s";
        /// Place of its middle along x.
        x_mm: f64 = 0.0, -1e5..=1e5, "mm";
        /// Place along y.
        y_mm: f64 = 0.0, -1e5..=1e5, "mm";
        /// Height.
        z_mm: f64 = 30.0, -1e5..=1e5, "mm";
        /// Standard deviation along each axis; 0: the place does not count.
        sigma_mm: f64 = 5.0, 0.0..=1e5, "mm";
        /// A die closer than this meets the demand.
        within_mm: f64 = 10.0, 0.001..=1e5, "mm";
        /// How its pips are turned, starting from face 1 up, face 2 along y and face 3 along x. This is a rotation
        /// vector, whose direction is the axis and whose length is the angle; here its component along x.
        turn_x_deg: f64 = 0.0, -360.0..=360.0, "degree";
        /// Its component along y.
        turn_y_deg: f64 = 0.0, -360.0..=360.0, "degree";
        /// Its component along z.
        turn_z_deg: f64 = 0.0, -360.0..=360.0, "degree";
        /// Standard deviation of the angle from that orientation; 0: the orientation does not count.
        angle_sd_deg: f64 = 0.0, 0.0..=180.0, "degree";
        /// A die turned less far from that orientation meets the demand.
        within_deg: f64 = 20.0, 0.1..=180.0, "degree";
        /// Velocity along x.
        vx: f64 = 0.0, -100.0..=100.0, "m/s";
        /// Velocity along y.
        vy: f64 = 0.0, -100.0..=100.0, "m/s";
        /// Velocity upwards.
        vz: f64 = 0.0, -100.0..=100.0, "m/s";
        /// Standard deviation of each component of the velocity; 0: it does not count.
        velocity_sd: f64 = 0.0, 0.0..=100.0, "m/s";
    }

    /// A die's middle passes near a point at any time: `−½ (least distance/sigma)²`.
    #[derive(Copy)]
    pub struct Passes {
        /// Which die, counted from 1.
        die: u32 = 1, 1..=24;
        /// The point along x.
        x_mm: f64 = -50.0, -1e5..=1e5, "mm";
        /// The point along y.
        y_mm: f64 = 0.0, -1e5..=1e5, "mm";
        /// The point's height.
        z_mm: f64 = 40.0, -1e5..=1e5, "mm";
        /// Standard deviation of the least distance.
        sigma_mm: f64 = 5.0, 0.001..=1e5, "mm";
        /// A die that comes closer than this meets the demand.
        within_mm: f64 = 10.0, 0.001..=1e5, "mm";
    }

    /// A die first touches the table at a given time: `−½ (difference/sigma)²`.
    #[derive(Copy)]
    pub struct FirstImpact {
        /// Which die, counted from 1.
        die: u32 = 1, 1..=24;
        /// When.
        time_s: f64 = 0.12, 0.0..=60.0, "s";
        /// Standard deviation.
        sigma_s: f64 = 0.01, 1e-6..=60.0, "s";
        /// A first touch within this time meets the demand.
        within_s: f64 = 0.02, 1e-6..=60.0, "s";
    }
}

/// How well an animation meets a constraint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// Log density in nats, at most 0.
    pub log: f64,
    /// Whether it is met.
    pub met: bool,
}

impl Constraint {
    /// Face 6 at the middle of the table.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self::RestAt(RestAt::default()), Self::FaceUp(FaceUp::default())]
    }

    /// Its name in scenario files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::RestAt(_) => "rest_at",
            Self::FaceUp(_) => "face_up",
            Self::PoseAt(_) => "pose_at",
            Self::Passes(_) => "passes",
            Self::FirstImpact(_) => "first_impact",
        }
    }

    /// The same demand in the vocabulary that all scenes share; `None` if that has no words for it.
    #[must_use]
    pub fn as_requirement(&self) -> Option<Require> {
        let body = format!("die_{}", self.die());
        Some(match *self {
            Self::RestAt(RestAt { x_mm, y_mm, within_mm, .. }) => {
                Require::RestsAt(RestsAt { body, x_mm, y_mm, within_mm, ..RestsAt::default() })
            }
            Self::FaceUp(FaceUp { face, within_deg, .. }) => {
                Require::FacesUp(FacesUp { body, face: Some(face), within_deg, ..FacesUp::default() })
            }
            Self::Passes(Passes { x_mm, y_mm, z_mm, within_mm, .. }) => {
                Require::Passes(require::Passes { body, x_mm, y_mm, z_mm, within_mm, ..require::Passes::default() })
            }
            Self::FirstImpact(FirstImpact { time_s, within_s, .. }) => {
                let when = When { at_s: Some(time_s), within_ms: 1e3 * within_s, ..When::default() };
                Require::Impact(Impact { body, when, ..Impact::default() })
            }
            Self::PoseAt(_) => return None,
        })
    }

    /// Which die it is about, counted from 1.
    #[must_use]
    pub fn die(&self) -> u32 {
        match self {
            Self::RestAt(RestAt { die, .. })
            | Self::FaceUp(FaceUp { die, .. })
            | Self::PoseAt(PoseAt { die, .. })
            | Self::Passes(Passes { die, .. })
            | Self::FirstImpact(FirstImpact { die, .. }) => *die,
        }
    }

    /// How well a die's trip, moved by `offset`, meets it. `slot` is the index of its answer in the trip's `frames` or
    /// `nearest`.
    pub(super) fn mark(&self, trip: &Trip, pips: &Rotation, slot: usize, offset: DVec3) -> Mark {
        match self {
            Self::RestAt(at) => {
                let off = ((trip.position + offset) * 1e3 - DVec3::new(at.x_mm, at.y_mm, 0.0)).truncate().length();
                Mark { log: gauss(off, at.sigma_mm), met: off < at.within_mm }
            }
            Self::FaceUp(up) => up.mark(trip.orientation, pips),
            Self::PoseAt(pose) => pose.mark(trip, pips, slot, offset),
            Self::Passes(point) => {
                let off = 1e3 * trip.nearest.get(slot).copied().unwrap_or(f64::INFINITY);
                Mark { log: gauss(off, point.sigma_mm), met: off < point.within_mm }
            }
            Self::FirstImpact(at) => match trip.impacts.first() {
                Some(first) => {
                    let off = (first[0] - at.time_s).abs();
                    Mark { log: gauss(off, at.sigma_s), met: off < at.within_s }
                }
                None => Mark { log: f64::NEG_INFINITY, met: false },
            },
        }
    }

    /// By how much it is missed, given the log density; `None` if no single unit says so.
    pub(super) fn missed(&self, log: f64) -> Option<Missed> {
        let off = |sigma: f64| sigma * (-2.0 * log).sqrt();
        match self {
            _ if log <= -FAR => Some(Missed::Never),
            Self::RestAt(at) => Some(Missed::By(off(at.sigma_mm) - at.within_mm, "mm")),
            Self::Passes(at) => Some(Missed::By(off(at.sigma_mm) - at.within_mm, "mm")),
            Self::FirstImpact(at) => Some(Missed::By(1e3 * (off(at.sigma_s) - at.within_s), "ms")),
            Self::FaceUp(_) => Some(Missed::Never),
            Self::PoseAt(_) => None,
        }
    }

    /// What a trip that misses it lacks, in words, if [`Constraint::missed`] does not say it.
    pub(super) fn lacks(&self, trip: &Trip, pips: &Rotation, slot: usize, offset: DVec3) -> String {
        match self {
            Self::FaceUp(up) => match pips.uppermost(trip.orientation).0 {
                face if u32::from(face) == up.face => format!("face {face} leans"),
                face => format!("face {face} is up"),
            },
            Self::PoseAt(pose) => pose.errors(trip, pips, slot, offset).map_or(String::new(), |[off, angle, slip]| {
                let each = [
                    (pose.sigma_mm > 0.0, format!("{off:.1} mm off")),
                    (pose.angle_sd_deg > 0.0, format!("turned {angle:.1} degrees too far")),
                    (pose.velocity_sd > 0.0, format!("{slip:.2} m/s too fast or too slow")),
                ];
                let said: Vec<String> = each.into_iter().filter(|(counts, _)| *counts).map(|(_, said)| said).collect();
                said.join(", ")
            }),
            _ => String::new(),
        }
    }
}

impl FaceUp {
    pub(super) fn mark(&self, orientation: DQuat, pips: &Rotation) -> Mark {
        let cosine = pips.cosine(self.face as u8, orientation);
        let angle = math::acos(cosine.clamp(-1.0, 1.0)).to_degrees();
        let met = angle < self.within_deg;
        Mark { log: if met { 0.0 } else { -self.ln_lambda } + gauss(angle, self.angle_sd_deg), met }
    }
}

impl PoseAt {
    /// How far a die is from the place, in mm, from the orientation, in degrees, and from the velocity, in m/s. `None`
    /// if it was not there at that time.
    fn errors(&self, trip: &Trip, pips: &Rotation, slot: usize, offset: DVec3) -> Option<[f64; 3]> {
        let frame = trip.frames.get(slot)?;
        let off = ((frame.position + offset) * 1e3).distance(DVec3::new(self.x_mm, self.y_mm, self.z_mm));
        let vector = DVec3::new(self.turn_x_deg, self.turn_y_deg, self.turn_z_deg) * (std::f64::consts::PI / 180.0);
        // q and −q are one orientation.
        let cosine = pips.pips(frame.orientation).dot(turned(vector)).abs().min(1.0);
        let slip = frame.velocity.distance(DVec3::new(self.vx, self.vy, self.vz));
        Some([off, 2.0 * math::acos(cosine).to_degrees(), slip])
    }

    fn mark(&self, trip: &Trip, pips: &Rotation, slot: usize, offset: DVec3) -> Mark {
        let Some([off, angle, slip]) = self.errors(trip, pips, slot, offset) else {
            return Mark { log: f64::NEG_INFINITY, met: false };
        };
        let near = self.sigma_mm == 0.0 || off < self.within_mm;
        let like = self.angle_sd_deg == 0.0 || angle < self.within_deg;
        // A velocity within two standard deviations is as asked for.
        let quick = self.velocity_sd == 0.0 || slip < 2.0 * self.velocity_sd;
        let log = gauss(off, self.sigma_mm) + gauss(angle, self.angle_sd_deg) + gauss(slip, self.velocity_sd);
        Mark { log, met: near && like && quick }
    }
}

/// `−½ (x/sd)²`; 0 if `sd` is 0.
fn gauss(x: f64, sd: f64) -> f64 {
    if sd == 0.0 { 0.0 } else { -0.5 * math::square(x / sd) }
}
