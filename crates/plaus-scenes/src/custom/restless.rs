//! What cannot work or is hardly meant, told before anything is sampled: bodies that roll on for ever, that begin
//! inside meshes, that are smaller than a grain of sand or faster than sound.

use super::Custom;
use super::ending::Overlap;
use super::plan::Plan;
use super::shapes::Round;
use super::standing::Standing;
use super::values::{Drawn, Value};
use glam::DVec3;
use plaus_dist::{Purpose, Seed, math};
use std::f64::consts::PI;

/// Cosine of the tilt up to which ground counts as level: a tenth of a degree.
const LEVEL: f64 = 1.0 - 1.5e-6;

/// How many draws of the prior are looked at for bodies inside meshes.
const DRAWS: u64 = 20;

/// Triangles of meshes that are looked at in all, at most: a second or so.
const MOST_FACES: usize = 10_000_000;

/// A grain of sand in m, and the speed of sound in air in m/s: who says less or more may have meant another unit.
const GRAIN: f64 = 5e-4;
const SOUND: f64 = 340.0;

impl Plan {
    /// The level ground, if any, on which nothing ever stops a body that rolls: by the places of bodies among all, and
    /// of ground among the scenery.
    fn rolls_on(&self, body: usize) -> Option<usize> {
        let moving = &self.bodies[body];
        if moving.form.round == Round::Not || moving.way.is_some() || moving.acting.is_slowed() || self.is_held(body) {
            return None;
        }
        let numbers = self.works.numbers(None);
        let is_level = |part: &Standing| {
            let (_, turn) = part.pose(&numbers);
            part.is_endless() && (turn * DVec3::Z).z >= LEVEL
        };
        self.parts.iter().position(|part| is_level(part) && !self.resists([moving.substance, part.substance]))
    }

    /// Whether resistance to rolling may act between two materials.
    fn resists(&self, both: [usize; 2]) -> bool {
        let none = Value::Fixed(0.0);
        let said = self.pairs.iter().find(|(two, _)| *two == both || *two == [both[1], both[0]]);
        match said.and_then(|(_, said)| said[2]) {
            Some(rolling) => rolling != none,
            None => both.iter().any(|&one| self.substances[one].contact[2] != none),
        }
    }

    /// The first body that begins inside a closed mesh without touching it, and the mesh, in a draw.
    fn enclosed(&self, draw: &Drawn, room: &mut usize) -> Option<Overlap> {
        let numbers = self.works.numbers(Some(draw));
        for (index, part) in self.parts.iter().enumerate().filter(|(_, part)| part.is_mesh() && part.there.of(&numbers))
        {
            let (at, turn) = part.pose(&numbers);
            let faces = part.faces(&numbers).ok()?;
            let bodies = self.there(draw).into_iter().filter(|&body| self.bodies[body].way.is_none());
            for body in bodies {
                *room = room.checked_sub(faces.len())?;
                let place =
                    self.bodies[body].made(&numbers).ok().map(|made| self.bodies[body].start(&numbers, &made))?;
                let place: DVec3 = turn.conjugate() * (place.position - at);
                let out = faces.iter().flatten().fold(DVec3::ZERO, |far, corner| far.max(corner.abs()));
                if place.abs().cmple(out).all() && winding(&faces, place) > 0.5 {
                    return Some(Overlap { body: body as u32, other: (self.bodies.len() + index) as u32, depth: 0.0 });
                }
            }
        }
        None
    }
}

/// How often triangles enclose a point: 1 inside a closed surface whose triangles look outwards, 0 outside of it (Van
/// Oosterom and Strackee, "The solid angle of a plane triangle" (1983)).
fn winding(faces: &[[DVec3; 3]], point: DVec3) -> f64 {
    let angle = |face: &[DVec3; 3]| {
        let [a, b, c] = face.map(|corner| corner - point);
        let [x, y, z] = [a, b, c].map(DVec3::length);
        2.0 * math::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    faces.iter().map(angle).sum::<f64>() / (4.0 * PI)
}

impl Custom {
    /// Bodies that nothing ever stops once they roll, each with what it rolls on.
    pub(super) fn rolling_on(&self) -> Vec<(String, String)> {
        let named = |body: usize| {
            let part = &self.plan.parts[self.plan.rolls_on(body)?];
            Some((self.plan.bodies[body].name.clone(), part.name.clone()))
        };
        (0..self.plan.bodies.len()).filter_map(named).collect()
    }

    /// A body whose size or speed is hardly meant, in a draw of the prior.
    pub(super) fn out_of_scale(&self) -> Option<String> {
        let draw = plaus_mcmc::Target::start(self, &mut Seed(0).chain(0).at(0, Purpose::START));
        let numbers = self.plan.works.numbers(Some(&draw));
        self.plan.there(&draw).into_iter().find_map(|index| {
            let body = &self.plan.bodies[index];
            let made = body.made(&numbers).ok()?;
            let (size, speed) = (2.0 * made.solid.reach(), body.start(&numbers, &made).velocity.length());
            let strange = if size < GRAIN {
                format!("is {:.2} mm large, smaller than a grain of sand", size * 1e3)
            } else if speed > SOUND {
                format!("starts at {speed:.0} m/s, faster than sound")
            } else {
                return None;
            };
            Some(format!("{:?} {strange}: the end of each key says its unit, such as `_mm` or `_m_s`", body.name))
        })
    }

    /// What begins inside a closed mesh, if anything does in some draws.
    pub(super) fn enclosed(&self) -> Option<String> {
        let (streams, mut room) = (Seed(0).chain(0), MOST_FACES);
        let draws = if self.vars.is_empty() { 1 } else { DRAWS };
        let found = (0..draws).find_map(|nth| {
            let draw = plaus_mcmc::Target::start(self, &mut streams.at(nth, Purpose::START));
            self.plan.enclosed(&draw, &mut room)
        })?;
        let [body, mesh] = [found.body, found.other].map(|index| self.name(index));
        Some(format!(
            "{body:?} begins inside the closed mesh {mesh:?}, which it does not touch: a mesh is a surface, so it may \
             stay in there or come out through a wall; if that is not meant, change `at_mm`"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::custom::bumpy::block;
    use crate::turns::by_angles;
    use glam::DQuat;

    /// A box of triangles encloses what is in it, however it is turned.
    #[test]
    fn a_closed_surface_encloses_what_is_inside() {
        let turn: DQuat = by_angles([20.0, -35.0, 70.0]);
        let (corners, faces) = block(DVec3::new(0.2, 0.3, 0.4), f64::INFINITY);
        let faces: Vec<[DVec3; 3]> = faces.into_iter().map(|face| face.map(|k| turn * corners[k as usize])).collect();
        for (place, inside) in [
            (DVec3::ZERO, 1.0),
            (DVec3::new(0.09, -0.14, 0.19), 1.0),
            (DVec3::new(0.11, 0.0, 0.0), 0.0),
            (DVec3::new(0.0, 0.0, -0.21), 0.0),
        ] {
            let found = winding(&faces, turn * place);
            assert!((found - inside).abs() < 1e-9, "{place}: {found}");
        }
    }
}
