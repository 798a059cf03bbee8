//! Thirty shards, each of three boxes, that fall onto a floor.

use super::coin::anyhow;
use crate::peer::cast::{cuboid, floor};
use crate::peer::{Cast, Pose};
use crate::staged::Setting;
use crate::world::{Outcome, Reading};
use glam::{DQuat, DVec3};
use plaus_dist::{Stream, open_unit};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Start};
use plaus_sim::shape::{Compound, Convex, Cuboid, Member, Shape};
use plaus_sim::{Law, Material};
use rapier3d_f64::prelude as peer;

const COUNT: usize = 30;
/// Height from which the lowest fall, in m.
const DROP: f64 = 1.0;
/// Distances from the middle in which a body can end, in m.
const RING: f64 = 0.05;
const RINGS: usize = 12;

/// A heap of them, or one alone.
pub(crate) struct Shards {
    count: usize,
}

impl Shards {
    pub(crate) const HEAP: Self = Self { count: COUNT };
    pub(crate) const ALONE: Self = Self { count: 1 };
}

/// A bent piece of a wall: three flat boxes, each turned a little from the one before.
fn members() -> Result<Vec<Member>> {
    let edges = DVec3::new(0.022, 0.03, 0.005);
    let box_at = |side: f64| -> Result<Member> {
        let turn = DQuat::from_rotation_y(-0.5 * side);
        let at = DVec3::new(0.019 * side, 0.0, 0.005 * side.abs());
        Ok(Member { turn, ..Member::new(Convex::Cuboid(Cuboid::new(edges, 0.0)?), at) })
    };
    [-1.0, 0.0, 1.0].into_iter().map(box_at).collect()
}

/// The same boxes in rapier, in the axes of our body.
fn theirs(shard: &Compound) -> Result<peer::ColliderBuilder> {
    let back = shard.turn().conjugate();
    let mut shapes = Vec::new();
    for member in shard.members() {
        let Convex::Cuboid(c) = &member.solid else { return Err("a shard is made of boxes".into()) };
        let (at, q) = (back * (member.at - shard.centre()), back * member.turn);
        let pose =
            peer::Pose::from_parts(peer::Vector::new(at.x, at.y, at.z), peer::Rotation::from_xyzw(q.x, q.y, q.z, q.w));
        shapes.push((pose, cuboid(2.0 * c.half()).build().shared_shape().clone()));
    }
    Ok(peer::ColliderBuilder::compound(shapes))
}

impl Setting for Shards {
    fn name(&self) -> &'static str {
        if self.count == 1 { "shard" } else { "shards" }
    }

    fn title(&self) -> &'static str {
        if self.count == 1 { "A shard alone" } else { "Thirty shards" }
    }

    fn about(&self) -> String {
        let who = if self.count == 1 { "One body" } else { "Thirty bodies" };
        format!(
            "{who} of three boxes each, about 60 mm long, from 1 m and higher, turned anyhow; friction 0.4, \
             restitution 0.3. Read: how far each ends from the middle, in rings of 50 mm; how many end on others."
        )
    }

    fn cast(&self) -> Result<Cast> {
        let shard = Compound::new(&members()?)?;
        let collider = theirs(&shard)?;
        let spec = BodySpec::solid(Shape::from(shard), 2400.0, Material(0));
        Ok(Cast {
            bodies: vec![(spec, collider); self.count],
            parts: vec![floor(0.0)?],
            law: Law::new(0.4, 0.3),
            joints: Vec::new(),
            size: 0.0025,
        })
    }

    fn starts(&self, stream: &mut Stream) -> Vec<Start> {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let mut three = |most: f64| DVec3::new(between(-most, most), between(-most, most), between(-most, most));
        let start = |k: usize| {
            // Three by two in a layer, farther apart than they are long.
            let (i, j, layer) = (k % 3, k / 3 % 2, k / 6);
            let place = DVec3::new(i as f64 - 1.0, j as f64 - 0.5, layer as f64) * 0.09 + DVec3::Z * DROP;
            let orientation = anyhow(three(3.0));
            Start { position: place + three(0.005), orientation, spin: three(6.0), ..Start::at_rest(place) }
        };
        (0..self.count).map(start).collect()
    }

    fn readings(&self) -> Vec<Reading> {
        let above = Reading { name: "on others", categories: self.count + 1 };
        vec![Reading { name: "ring of a body", categories: RINGS }, above]
    }

    fn read(&self, ends: &[Pose]) -> Outcome {
        let ring = |x: DVec3| ((x.truncate().length() / RING) as usize).min(RINGS - 1) as u16;
        // Flat on the floor, its middle is 4 to 7 mm high.
        let above = ends.iter().filter(|(x, _)| x.z > 0.01).count();
        vec![ends.iter().map(|(x, _)| ring(*x)).collect(), vec![above as u16]]
    }

    fn tolerance(&self) -> f64 {
        0.002
    }

    fn duration(&self) -> f64 {
        6.0
    }

    fn patience(&self) -> f64 {
        3.0
    }
}
