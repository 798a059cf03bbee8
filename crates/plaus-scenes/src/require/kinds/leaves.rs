//! Which pins are left.

use crate::require::claim::Claim;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::{Presence, Probe};
use crate::require::score::{Mark, Reach};
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;
use plaus_animation::{Shape, Track};
use plaus_dist::math;

/// A pin whose foot sinks farther than this, in m, has fallen, however it stands: gutters are at least 0.05 deep.
const SUNK: f64 = 0.01;

/// All pins, by their names in animations.
const PINS: &str = "pin_*";

settings! {
    /// These pins stand at the end, and all others have fallen. A pin that has fallen counts as down even if it rises
    /// again.
    pub struct Leaves {
        /// Numbers of the pins that stand: bodies `pin_1`, `pin_2` and so on. Empty: none does.
        #[schemars(length(min = 0, max = 64), inner(range(min = 0, max = 9999)))]
        pins: Vec<u32>;
        /// A pin that leans farther than this has fallen.
        within_deg: f64 = 60.0, 0.1..=180.0, "degree";
        /// A pin that stands farther than this from where it was does not count as left.
        moved_far_mm: f64 = 25.8, 0.0..=1e6, "mm";
        /// What each pin that should fall costs if it stands, and each that should stand if it has moved far; one that
        /// should stand and falls costs twice as much.
        nats_each: f64 = 2.5, 1e-3..=1000.0, "nat";
    }
}

/// Height of the lowest point of an upright body over its middle, in m; 0 if its shape does not tell.
fn foot(shape: &Shape) -> f64 {
    match shape {
        Shape::Revolution { profile, .. } => profile.iter().map(|[_, height]| *height).fold(0.0, f64::min),
        _ => 0.0,
    }
}

impl Leaves {
    /// Whether a body has fallen at the beginning of a piece of its motion before `known`, in s.
    fn has_fallen(&self, track: &Track, known: f64) -> bool {
        let Some(first) = track.pieces.first() else { return true };
        let (foot, least) = (foot(&track.shape), math::cos(self.within_deg.to_radians()));
        let mut before = track.pieces.iter().take_while(|piece| piece.start < known);
        before.any(|piece| {
            let up = (piece.turn.orientation * DVec3::Z).y;
            let sunk = first.position.y + foot - (piece.position.y + foot * up);
            up < least || sunk > SUNK
        })
    }

    /// The fewest and the most faults of a pin that may come of what is known.
    fn faults(&self, probe: &Probe<'_>, body: &str) -> [u32; 2] {
        let should = self.pins.iter().any(|pin| format!("pin_{pin}") == body);
        let down = u32::from(should) * 2;
        match (probe.presence(body), probe.track(body)) {
            (Presence::Absent, _) => [down; 2],
            (_, Some(track)) if self.has_fallen(track, probe.known()) => [down; 2],
            (_, Some(track)) if probe.is_whole() && should => {
                let way = track.position(probe.end()) - track.position(0.0);
                [u32::from(1e3 * (way - DVec3::Y * way.y).length() > self.moved_far_mm); 2]
            }
            (_, Some(_)) if probe.is_whole() => [1; 2],
            _ => [0, down.max(1)],
        }
    }
}

impl Ask for Leaves {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        if place.cast().matching(PINS).next().is_none() {
            return Err(place.wrong("there are no pins here: bodies with the names pin_1, pin_2 and so on"));
        }
        place.turned()?;
        place.body("pins", PINS)?;
        for (index, pin) in self.pins.iter().enumerate() {
            place.one_body("pins", &format!("pin_{pin}"))?;
            if self.pins[..index].contains(pin) {
                return Err(place.at("pins").wrong(&format!("pin {pin} is named twice")));
            }
        }
        Ok(())
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(1.0 / self.nats_each, "pins").beyond(0.5 * self.nats_each))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = probe.turned();
        let each: Vec<[u32; 2]> = probe.cast().matching(PINS).map(|body| self.faults(&probe, body)).collect();
        let mark = |end: usize| {
            let wrong = each.iter().filter(|faults| faults[end] > 0).count() as u32;
            Mark::of_faults(wrong, each.iter().map(|faults| faults[end]).sum(), self.nats_each)
        };
        Reach { least: mark(1), most: mark(0) }
    }

    fn looks(&self) -> Looks {
        if self.pins.is_empty() { Looks::default() } else { Looks::default().or_impacts() }
    }

    /// What becomes of the pins that it names.
    fn claims(&self) -> Vec<Claim> {
        vec![Claim::Left(self.pins.clone())]
    }
}
