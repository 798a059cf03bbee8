//! One marble on one plane or triangle, in closed form (`crate::roll`).

use super::Marbles;
use super::body::{Ending, Marble, Phase};
use crate::roll::{End, Going, Kind, PARALLEL, Slope};
use crate::roots::fall_of_quadratic;
use crate::scenery::Surface;

/// Gives the marble a closed form if there is one; false if it needs steps. Its only contact must be `surface`.
pub(crate) fn begin(world: &Marbles, index: usize, body: &mut Marble, surface: Surface) -> bool {
    let normal = match surface {
        Surface::Plane(k) => world.scenery.planes()[k as usize].normal,
        Surface::Face(k) => world.scenery.mesh().faces[k as usize].normal,
        _ => return false,
    };
    let (spec, law) = (&world.specs[index], world.surface_law(index, surface));
    let Some(slope) = Slope::new(normal, world.gravity, law, [spec.gyration, spec.radius], PARALLEL) else {
        return false;
    };
    body.path.v -= normal * body.path.v.dot(normal);
    let Some(going) = slope.going(body.path.v, &mut body.spin) else { return false };
    apply(&slope, body, &going);
    if let Surface::Face(k) = surface {
        leave_face(world, k, body, spec.radius);
    }
    body.expiry > body.path.t
}

fn apply(slope: &Slope, body: &mut Marble, going: &Going) {
    let phase = match going.kind {
        Kind::Slides => Phase::Slide,
        Kind::Rolls => Phase::Roll,
        Kind::Spins => Phase::Spin,
        Kind::Rests => Phase::Rest,
    };
    body.begin(phase, going.acceleration);
    body.spin_rate = going.spin_rate;
    body.normal = slope.normal;
    body.drill = slope.drill();
    body.expiry = (body.path.t + going.lasts).min(f64::MAX);
    body.ending = match going.end {
        End::Plain => Ending::Plain,
        End::Rolls => Ending::Rolls,
        End::Stops => Ending::Stops,
    };
    if phase == Phase::Rest {
        (body.path.v, body.spin) = (glam::DVec3::ZERO, glam::DVec3::ZERO);
    }
}

/// Ends the motion where the contact point reaches a side of its triangle.
fn leave_face(world: &Marbles, k: u32, body: &mut Marble, radius: f64) {
    if matches!(body.phase, Phase::Rest | Phase::Spin) {
        return;
    }
    let face = &world.scenery.mesh().faces[k as usize];
    let projection = body.path.x - face.normal * radius;
    for (side, (inward, offset)) in face.sides.iter().enumerate() {
        let c = [inward.dot(projection) - offset, inward.dot(body.path.v), 0.5 * inward.dot(body.path.a)];
        if let Some(dt) = fall_of_quadratic(c, body.expiry - body.path.t) {
            body.expiry = body.path.t + dt;
            body.ending = Ending::Leaves(side as u8);
        }
    }
}
