//! The ground under everything, and what small things lie on it.

use super::numbers::{number, shortest};
use super::recognised::ROUNDED;
use super::things::{Piece, Role, Shape, Thing, Things};
use super::write::DROP;
use glam::{DQuat, DVec3};

/// Scenery is a level sheet if it is thinner than this share of its extent.
const THIN: f64 = 1e-6;
/// An object is small if it is less than this share of everything together.
const SMALL: f64 = 0.25;

impl Things<'_> {
    /// The corners of a shape's meshes, in mm, seen from where its thing is.
    fn places(&self, shape: &Shape) -> Vec<DVec3> {
        match shape {
            Shape::File { object } | Shape::Hull { object } => self.triangles(object.as_deref()).corners,
            Shape::Pieces(pieces) => {
                let of = |Piece { shape, at, turn, .. }: &Piece| {
                    let (at, turn): (DVec3, DQuat) = (*at * 1e3, *turn);
                    self.places(shape).into_iter().map(move |place| at + turn * place).collect::<Vec<_>>()
                };
                pieces.iter().flat_map(of).collect()
            }
            Shape::Solid { .. } => Vec::new(),
        }
    }

    /// The ends of a thing, in mm; none if it has no mesh.
    fn ends_of(&self, thing: &Thing) -> Option<[DVec3; 2]> {
        let places = self.places(&thing.shape).into_iter().map(|place| thing.at + thing.turn * place);
        places.fold(None, |ends, place| {
            let [low, high] = ends.unwrap_or([place; 2]);
            Some([low.min(place), high.max(place)])
        })
    }

    /// Adds a floor under everything where something moves and no plane is there: what leaves the scenery would fall
    /// for ever.
    pub(super) fn add_floor(&mut self) {
        let is_plane = |shape: &Shape| matches!(shape, Shape::Solid { said, .. } if said.starts_with("plane"));
        let stays = || self.all.iter().filter(|thing| thing.role == Role::Fixed);
        if self.bodies().next().is_none() || stays().any(|thing| is_plane(&thing.shape)) {
            return;
        }
        let low = |[low, _]: &[DVec3; 2]| low.z;
        let all = self.all.iter().filter(|thing| thing.role != Role::Gone).filter_map(|thing| self.ends_of(thing));
        let lowest = all.map(|ends| low(&ends)).fold(f64::INFINITY, f64::min);
        if !lowest.is_finite() {
            return;
        }
        // A sheet at the same height would touch everything a second time.
        let is_sheet = |[low, high]: [DVec3; 2]| {
            let size = (high - low).max_element();
            high.z - low.z <= THIN * size && low.z - lowest <= THIN * size
        };
        let has_sheet = stays().filter_map(|thing| self.ends_of(thing)).any(is_sheet);
        let height = if has_sheet { lowest - DROP } else { lowest };
        let height = shortest(height, ROUNDED * (self.ends[1] - self.ends[0]).max_element());
        self.notes.push(format!(
            "a floor is added under everything, at a height of {} mm: what leaves the scenery would fall for ever",
            number(height)
        ));
        self.floor = Some(height);
    }

    /// If nothing moves or follows keyframes: the names of objects, and whether each is small.
    pub(super) fn still(&self) -> Vec<(String, bool)> {
        if self.all.len() < 2 || self.all.iter().any(|thing| thing.role != Role::Fixed) {
            return Vec::new();
        }
        let whole = (self.ends[1] - self.ends[0]).max_element();
        let is_small =
            |thing: &Thing| self.ends_of(thing).is_some_and(|[low, high]| (high - low).max_element() < SMALL * whole);
        self.all.iter().map(|thing| (thing.name.clone(), is_small(thing))).collect()
    }
}
