//! The start of a draw's motion as other simulators take it up. The simulator's z points up; there y does.

use super::config::Config;
pub(crate) use super::inertia::{Placed, tensor};
use super::moving::Moving;
use super::plan::Plan;
use super::shapes::{Form, Made};
use super::standing::Standing;
use super::values::{Drawn, Numbers};
use crate::animation::{Collider, Physics, Rigid, Solid, Still, UPRIGHT, upright};
use crate::engines::{self, EARTH, turned};
use crate::scene::ConfigError;
use glam::{DQuat, DVec3};
use plaus_sim::WorldError;
use plaus_sim::rigid::Start;
use plaus_sim::shape::{Convex, ConvexHull, MassProperties, Shape};
use std::collections::BTreeMap;

impl Plan {
    /// The world of a draw at the start of its motion.
    pub(super) fn physics(&self, draw: &Drawn) -> Result<Physics, WorldError> {
        let numbers = self.works.numbers(Some(draw));
        let built = self.build(&numbers)?;
        let starts = self.starts(&numbers, &built.there, &built.shapes);
        let mut physics = Physics::default();
        for ((&index, made), start) in built.there.iter().zip(&built.shapes).zip(&starts) {
            let body = self.body(index, (made, start), &numbers, &mut physics.left_out)?;
            physics.bodies.push(body);
        }
        for part in self.parts.iter().filter(|part| part.there.of(&numbers)) {
            let colliders = still(part, &numbers, &mut physics.left_out)?;
            let (name, material) = (part.name.clone(), part.substance);
            physics.scenery.push(Still { name, colliders, material });
        }
        physics.laws = engines::laws(&self.laws(&numbers)?, self.substances.len() as u16, &mut physics.left_out);
        if self.bottom > f64::NEG_INFINITY {
            physics.left_out.push("that bodies are gone below a height".into());
        }
        let own = self.own_starts(&numbers, &built.there, &built.shapes);
        for bond in &self.joints {
            let joint = bond.told(&numbers, &built.there, [&own, &starts], &mut physics.left_out);
            physics.joints.extend(joint);
        }
        let mut groups: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (place, &index) in built.there.iter().enumerate() {
            self.bodies[index].no_contact.iter().for_each(|group| groups.entry(group).or_default().push(place));
        }
        physics.no_contact = groups.into_values().filter(|group| group.len() > 1).collect();
        Ok(physics)
    }

    fn body(
        &self,
        index: usize,
        (made, start): (&Made, &Start),
        numbers: &Numbers<'_>,
        left_out: &mut Vec<String>,
    ) -> Result<Rigid, WorldError> {
        let body = &self.bodies[index];
        let is_driven = body.way.is_some();
        // About its origin: its own axes and solids as the scenario gives them.
        let given = if is_driven { body.form.make(numbers)? } else { made.clone() };
        let origin = if is_driven { DVec3::ZERO } else { made.centre };
        let colliders = solids(&body.name, (&given, &body.form), numbers, (-origin, DQuat::IDENTITY), left_out);
        let appears = body.late.is_some().then(|| "that it appears later: it is there from the start".to_owned());
        let release = if body.late.is_some() { 0.0 } else { start.time };
        let told = body.acting.told(release).into_iter().chain(appears);
        left_out.extend(told.map(|what| format!("{}: {what}", body.name)));
        let density = self.substances[body.substance].density.of(numbers);
        let properties = made.mass_properties(density);
        Ok(Rigid {
            name: body.name.clone(),
            colliders,
            material: body.substance,
            is_driven,
            mass: properties.mass,
            moments: properties.inertia,
            axes: (UPRIGHT * made.axes).normalize(),
            at: upright(start.position),
            turn: turned(start.orientation * made.axes.conjugate()),
            velocity: upright(start.velocity),
            spin: upright(start.spin),
            gravity: body.acting.gravity(numbers) * self.gravity / EARTH,
        })
    }
}

/// The solids of what stands still.
fn still(part: &Standing, numbers: &Numbers<'_>, left_out: &mut Vec<String>) -> Result<Vec<Collider>, WorldError> {
    let (at, turn) = part.pose(numbers);
    if let Some(form) = part.form() {
        return Ok(solids(&part.name, (&form.make(numbers)?, form), numbers, (at, turn), left_out));
    }
    if part.is_plane() {
        return Ok(vec![Collider { solid: Solid::Plane, at: upright(at), turn: turned(turn) }]);
    }
    if part.is_arc() {
        left_out.push(format!("{}: that it is round: the flat faces that are drawn of it", part.name));
    }
    if part.is_random() && part.is_endless() {
        let name = &part.name;
        left_out
            .push(format!("{name}: that it has no end, and friction and restitution of its own: what is drawn of it"));
    }
    Ok(vec![engines::drawn()])
}

/// The convex solids of something whose origin is at a place, and that is turned.
fn solids(
    name: &str,
    (made, form): (&Made, &Form),
    numbers: &Numbers<'_>,
    (at, turn): (DVec3, DQuat),
    left_out: &mut Vec<String>,
) -> Vec<Collider> {
    let place = |p: DVec3| upright(at + turn * p);
    if let Shape::Revolution(_) = made.solid {
        left_out.push(format!("{name}: its hollows: the convex hull of its outline"));
        let (corners, faces) = made.drawn.surface();
        let corners = corners.into_iter().map(|corner| upright(corner + made.centre)).collect();
        return vec![Collider { solid: Solid::Hull(corners, faces), at: place(DVec3::ZERO), turn: turned(turn) }];
    }
    let collider = |member: plaus_sim::shape::Member| {
        let mut own = member.turn;
        let solid = match &member.solid {
            Convex::Ball(radius) => Solid::Ball(*radius),
            Convex::Cuboid(cuboid) => Solid::Box(upright(2.0 * cuboid.half()).abs()),
            Convex::Frustum(frustum) => {
                let [[low, wide], [high, narrow]] = frustum.discs();
                match frustum.rounding() {
                    0.0 => Solid::Cylinder([wide, narrow], high - low),
                    rounding => Solid::Capsule(rounding, high - low),
                }
            }
            Convex::Hull(hull) => {
                let (corners, faces) = grown(hull);
                let corners = corners.into_iter().map(|corner| upright(own * corner)).collect();
                own = DQuat::IDENTITY;
                Solid::Hull(corners, faces)
            }
        };
        Collider { solid, at: place(member.at), turn: turned(turn * own) }
    };
    if form.is_rounded(numbers) {
        left_out.push(format!("{name}: the rounding of its edges"));
    }
    made.members().into_iter().map(collider).collect()
}

/// Corners of each face of a hull in m, moved out with the face if the hull is rounded, and triangles.
fn grown(hull: &ConvexHull) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut corners, mut triangles) = (Vec::new(), Vec::new());
    for (index, face) in hull.faces().enumerate() {
        let (out, first) = (hull.normal(index).unwrap_or_default() * hull.rounding(), corners.len() as u32);
        corners.extend(face.iter().map(|&corner| hull.corners()[usize::from(corner)] + out));
        triangles.extend((2..face.len() as u32).map(|k| [first, first + k - 1, first + k]));
    }
    (corners, triangles)
}

/// Where the mass of each body is, of values in the middle of their laws.
///
/// # Errors
/// [`ConfigError`] if the configuration makes no world.
pub(crate) fn placed(config: &Config) -> Result<Vec<Placed>, ConfigError> {
    let plan = Plan::new(config)?.0;
    let numbers = plan.works.numbers(None);
    let placed = |body: &Moving| {
        let made = body.made(&numbers).map_err(|error| ConfigError::new(body.key.clone(), error))?;
        let MassProperties { mass, inertia } =
            made.mass_properties(plan.substances[body.substance].density.of(&numbers));
        Ok(Placed { mass, centre: made.centre, tensor: tensor(inertia, made.axes) })
    };
    plan.free().iter().map(placed).collect()
}
