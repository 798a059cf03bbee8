//! Any world of turning bodies in rapier: bodies, scenery and joints one by one.

use super::{Steps, half_space, vector};
use glam::{DMat3, DQuat, DVec3};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Frame, Joint, JointKind, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::{Law, Material};
use rapier3d_f64::prelude as peer;

/// A world said to both simulators.
pub(crate) struct Cast {
    /// Bodies, and rapier's collider for each, in the axes of ours.
    pub(crate) bodies: Vec<(BodySpec, peer::ColliderBuilder)>,
    /// Scenery, and rapier's.
    pub(crate) parts: Vec<(StaticShape, peer::ColliderBuilder)>,
    /// Holds wherever two things touch.
    pub(crate) law: Law,
    pub(crate) joints: Vec<Joint>,
    /// About the size of the bodies, in m.
    pub(crate) size: f64,
}

/// A place, and the rotation from a body's axes to the world's.
pub(crate) type Pose = (DVec3, DQuat);

pub(crate) struct CastPeer {
    steps: Steps,
    handles: Vec<peer::RigidBodyHandle>,
}

impl CastPeer {
    pub(crate) fn new(cast: &Cast, starts: &[Start], rate: f64) -> Self {
        let mut steps = Steps::new(rate, cast.size);
        let world = &mut steps.world;
        let dress = |c: peer::ColliderBuilder| c.friction(cast.law.friction).restitution(cast.law.restitution);
        for (_, collider) in &cast.parts {
            world.colliders.insert(dress(collider.clone()));
        }
        let mut handles = Vec::new();
        for ((spec, collider), start) in cast.bodies.iter().zip(starts) {
            let (mass, inertia) = (spec.mass.mass, vector(spec.mass.inertia));
            let pose = peer::Pose::from_parts(vector(start.position), rotation(start.orientation));
            let body = peer::RigidBodyBuilder::dynamic()
                .pose(pose)
                .linvel(vector(start.velocity))
                .angvel(vector(start.spin))
                .additional_mass_properties(peer::MassProperties::new(peer::Vector::ZERO, mass, inertia))
                .ccd_enabled(true);
            let handle = world.bodies.insert(body);
            let collider = dress(collider.clone()).density(0.0);
            world.colliders.insert_with_parent(collider, handle, &mut world.bodies);
            handles.push(handle);
        }
        let ground = world.bodies.insert(peer::RigidBodyBuilder::fixed());
        for joint in &cast.joints {
            let other = joint.other.map_or(ground, |k| handles[k]);
            world.insert_impulse_joint(other, handles[joint.body], bond(joint));
        }
        Self { steps, handles }
    }

    /// Steps to `time`, or until everything rests.
    pub(crate) fn run_to(&mut self, time: f64) {
        while self.steps.done < self.steps.until(time) && !self.steps.is_at_rest() {
            self.steps.step(&());
        }
    }

    pub(crate) fn pose(&self, body: usize) -> Pose {
        let q = self.steps.world.bodies[self.handles[body]].rotation();
        (self.steps.place(self.handles[body]), DQuat::from_xyzw(q.x, q.y, q.z, q.w))
    }

    /// Energy of all bodies in J.
    pub(crate) fn energy(&self, cast: &Cast) -> f64 {
        let of = |(k, (spec, _)): (usize, &(BodySpec, peer::ColliderBuilder))| {
            let body = &self.steps.world.bodies[self.handles[k]];
            let turn = DMat3::from_quat(self.pose(k).1);
            let spin = body.angvel();
            let spin = turn.transpose() * DVec3::new(spin.x, spin.y, spin.z);
            let speed = body.linvel().length_squared();
            0.5 * (spec.mass.mass * speed + spin.dot(spec.mass.inertia * spin))
                + spec.mass.mass * super::GRAVITY * self.pose(k).0.z
        };
        cast.bodies.iter().enumerate().map(of).sum()
    }
}

/// A cylinder about the z axis.
pub(crate) fn cylinder(radius: f64, height: f64) -> peer::ColliderBuilder {
    let upright = peer::AngVector::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0);
    peer::ColliderBuilder::cylinder(0.5 * height, radius).rotation(upright)
}

pub(crate) fn cuboid(edges: DVec3) -> peer::ColliderBuilder {
    peer::ColliderBuilder::cuboid(0.5 * edges.x, 0.5 * edges.y, 0.5 * edges.z)
}

/// A convex hull of corners.
pub(crate) fn hull(corners: &[DVec3]) -> Option<peer::SharedShape> {
    peer::SharedShape::convex_hull(&corners.iter().map(|&c| vector(c)).collect::<Vec<_>>())
}

/// A fixed mesh whose inner edges are not felt.
pub(crate) fn mesh(corners: &[DVec3], triangles: &[[u32; 3]]) -> Result<peer::ColliderBuilder> {
    let flags = peer::TriMeshFlags::FIX_INTERNAL_EDGES | peer::TriMeshFlags::ORIENTED;
    let corners = corners.iter().map(|&c| vector(c)).collect();
    Ok(peer::ColliderBuilder::trimesh_with_flags(corners, triangles.to_vec(), flags)?)
}

/// A level floor.
pub(crate) fn floor(height: f64) -> Result<(StaticShape, peer::ColliderBuilder)> {
    let at = DVec3::Z * height;
    Ok((StaticShape::Plane(Plane::new(at, DVec3::Z, Material(0))?), half_space(at, DVec3::Z)))
}

fn rotation(q: DQuat) -> peer::Rotation {
    peer::Rotation::from_xyzw(q.x, q.y, q.z, q.w)
}

/// A joint in rapier's terms, which knows none that breaks; of a string, nothing is kept. Its hinge turns about the
/// frame's x axis, along which its slider moves.
fn bond(joint: &Joint) -> peer::GenericJoint {
    let axes = match joint.kind {
        JointKind::Ball => peer::JointAxesMask::LOCKED_SPHERICAL_AXES,
        JointKind::Hinge(_) => peer::JointAxesMask::LOCKED_REVOLUTE_AXES,
        JointKind::Slider(_) => peer::JointAxesMask::LOCKED_PRISMATIC_AXES,
        JointKind::Weld => peer::JointAxesMask::LOCKED_FIXED_AXES,
        JointKind::String(_) => peer::JointAxesMask::empty(),
    };
    let along = DQuat::from_rotation_arc(DVec3::X, DVec3::Z);
    let frame = |f: &Frame| peer::Pose::from_parts(vector(f.at), rotation(f.turn * along));
    let [own, other] = &joint.frames;
    peer::GenericJointBuilder::new(axes)
        .local_frame1(frame(other))
        .local_frame2(frame(own))
        .contacts_enabled(false)
        .build()
}
