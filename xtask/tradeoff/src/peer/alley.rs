//! A bowling alley in rapier.

use super::{Steps, half_space, vector};
use crate::world::Places;
use glam::{DQuat, DVec3};
use plaus_figures::Result;
use plaus_scenes::bowling::Alley;
use plaus_sim::Law;
use plaus_sim::rigid::{Start, StaticShape};
use plaus_sim::shape::{MassProperties, Profile, Revolution};
use rapier3d_f64::prelude as peer;
use std::f64::consts::PI;

/// Number of corners of a pin's cross sections.
const CORNERS: usize = 20;
/// Height in m below which a body counts as gone, as in our world.
const SINK: f64 = -5.0 * INCH;
const INCH: f64 = 0.0254;

/// The parts that never change: colliders.
pub(crate) struct AlleyParts {
    fixed: Vec<peer::ColliderBuilder>,
    ball: peer::ColliderBuilder,
    pin: peer::ColliderBuilder,
    laws: PairLaws,
}

/// Ball, pin and wood, as stored with each collider.
const BALL: u128 = 0;
const PIN: u128 = 1;
const WOOD: u128 = 2;

/// The coefficients of each pair of materials. rapier's rules for combining two bodies' own coefficients cannot give
/// all four.
#[derive(Clone, Copy)]
struct PairLaws {
    ball_lane: Law,
    ball_pin: Law,
    pin_pin: Law,
    pin_lane: Law,
}

impl peer::PhysicsHooks for PairLaws {
    fn modify_solver_contacts(&self, context: &mut peer::ContactModificationContext<'_>) {
        let of = |handle: peer::ColliderHandle| context.colliders[handle].user_data;
        let (a, b) = (of(context.collider1), of(context.collider2));
        let law = match (a.min(b), a.max(b)) {
            (BALL, PIN) => self.ball_pin,
            (BALL, _) => self.ball_lane,
            (PIN, PIN) => self.pin_pin,
            _ => self.pin_lane,
        };
        if let Some(contact) = context.rigid_mut() {
            (*contact.friction, *contact.restitution) = (law.friction, law.restitution);
        }
    }
}

impl AlleyParts {
    pub(crate) fn new(alley: &Alley) -> Result<Self> {
        let marked = |c: peer::ColliderBuilder, what: u128| {
            c.user_data(what).active_hooks(peer::ActiveHooks::MODIFY_SOLVER_CONTACTS)
        };
        let mut fixed = Vec::new();
        for part in alley.world()?.parts() {
            let collider = match part {
                StaticShape::Plane(plane) => half_space(plane.normal * plane.offset, plane.normal),
                StaticShape::Block { bounds, .. } => {
                    let half = 0.5 * (bounds.max - bounds.min);
                    peer::ColliderBuilder::cuboid(half.x, half.y, half.z)
                        .translation(vector(0.5 * (bounds.max + bounds.min)))
                }
                StaticShape::Table(_) | StaticShape::Solid(_) | StaticShape::Mesh(_) | StaticShape::Arc(_) => {
                    return Err("an alley has planes and boxes".into());
                }
            };
            fixed.push(marked(collider, WOOD));
        }
        let heavy = |c: peer::ColliderBuilder, MassProperties { mass, inertia }: MassProperties| {
            c.mass_properties(peer::MassProperties::new(peer::Vector::ZERO, mass, vector(inertia)))
        };
        let inertia = DVec3::splat(alley.ball_mass * alley.ball_gyration * alley.ball_gyration);
        let ball = peer::ColliderBuilder::ball(alley.ball_radius);
        let pin = alley.pin()?;
        let mass = pin.mass_properties(1.0).with_mass(alley.pin_mass);
        Ok(Self {
            fixed,
            ball: marked(heavy(ball, MassProperties { mass: alley.ball_mass, inertia }), BALL),
            pin: marked(heavy(compound(&pin)?, mass), PIN),
            laws: PairLaws {
                ball_lane: alley.ball_lane,
                ball_pin: alley.ball_pin,
                pin_pin: alley.pin_pin,
                pin_lane: alley.pin_lane,
            },
        })
    }
}

/// A pin as convex pieces about its centre of gravity: belly, five slices of the neck, where the profile is concave,
/// and head.
fn compound(pin: &Revolution) -> Result<peer::ColliderBuilder> {
    let profile = Profile::pin();
    // Height above the foot, and radius: the foot's rim, then the skin's balls as far as they reach, and chords of the
    // profile elsewhere.
    let radius = |z: f64| {
        let ball = |f: &plaus_sim::shape::ContactSphere| {
            let up = z - pin.balance() - f.centre.z;
            (f.radius * f.radius - up * up).max(0.0).sqrt()
        };
        let chord = profile
            .points
            .windows(2)
            .find(|p| (p[0][0]..=p[1][0]).contains(&z))
            .map_or(0.0, |p| p[0][1] + (p[1][1] - p[0][1]) * (z - p[0][0]) / (p[1][0] - p[0][0]));
        pin.row().iter().map(ball).fold(0.0, f64::max).max(if z < 4.0 * INCH { chord } else { 0.0 })
    };
    let rims = [[0.0, profile.foot], [profile.rim, profile.foot + profile.rim]];
    let between = |low: f64, high: f64, pieces: usize| -> Vec<[f64; 2]> {
        (0..=pieces)
            .map(|k| low + (high - low) * k as f64 / pieces as f64)
            .map(|inches| [inches * INCH, radius(inches * INCH)])
            .collect()
    };
    let belly: Vec<[f64; 2]> = rims.into_iter().chain(between(0.75, 7.25, 10)).collect();
    let neck = between(7.25, 11.5, 5);
    let head = between(11.5, 14.95, 6);
    let hull = |rings: &[[f64; 2]]| {
        let point = |&[z, r]: &[f64; 2], k: usize| {
            let (s, c) = plaus_dist::math::sin_cos(2.0 * PI * k as f64 / CORNERS as f64);
            peer::Vector::new(r * c, r * s, z - pin.balance())
        };
        let points: Vec<_> = rings.iter().flat_map(|ring| (0..CORNERS).map(move |k| point(ring, k))).collect();
        peer::SharedShape::convex_hull(&points).ok_or("a slice of a pin has no hull")
    };
    let mut shapes = vec![(peer::Pose::IDENTITY, hull(&belly)?), (peer::Pose::IDENTITY, hull(&head)?)];
    for slice in neck.windows(2) {
        shapes.push((peer::Pose::IDENTITY, hull(slice)?));
    }
    Ok(peer::ColliderBuilder::compound(shapes))
}

pub(crate) struct AlleyPeer {
    steps: Steps,
    laws: PairLaws,
    handles: Vec<peer::RigidBodyHandle>,
}

impl AlleyPeer {
    pub(crate) fn new(parts: &AlleyParts, starts: &[Start], rate: f64) -> Self {
        let mut steps = Steps::new(rate, INCH);
        let world = &mut steps.world;
        for collider in &parts.fixed {
            world.colliders.insert(collider.clone());
        }
        let mut handles = Vec::new();
        for (k, start) in starts.iter().enumerate() {
            let q = start.orientation;
            let pose = peer::Pose::from_parts(vector(start.position), peer::Rotation::from_xyzw(q.x, q.y, q.z, q.w));
            let body = peer::RigidBodyBuilder::dynamic()
                .pose(pose)
                .linvel(vector(start.velocity))
                .angvel(vector(start.spin))
                .ccd_enabled(true);
            let handle = world.bodies.insert(body);
            let collider = if k == 0 { &parts.ball } else { &parts.pin };
            world.colliders.insert_with_parent(collider.clone(), handle, &mut world.bodies);
            handles.push(handle);
        }
        Self { steps, laws: parts.laws, handles }
    }

    /// Steps to `time`, or until everything rests. Bodies that fall into the pit are removed.
    pub(crate) fn run_to(&mut self, time: f64) {
        while self.steps.done < self.steps.until(time) && !self.steps.is_at_rest() {
            self.steps.step(&self.laws);
            for &handle in &self.handles {
                let gone = self.steps.world.bodies.get(handle).is_some_and(|body| body.translation().z < SINK);
                if gone {
                    self.steps.world.remove_body(handle);
                }
            }
        }
    }

    /// Where all bodies are.
    pub(crate) fn places(&self) -> Places {
        self.handles.iter().map(|&handle| self.pose(handle).map(|(x, _)| x)).collect()
    }

    /// Where a pin (1–10) is, and the rotation from its axes to the world's, unless it is gone.
    pub(crate) fn pin(&self, pin: usize) -> Option<(DVec3, DQuat)> {
        self.pose(self.handles[pin])
    }

    fn pose(&self, handle: peer::RigidBodyHandle) -> Option<(DVec3, DQuat)> {
        let q = self.steps.world.bodies.get(handle)?.rotation();
        Some((self.steps.place(handle), DQuat::from_xyzw(q.x, q.y, q.z, q.w)))
    }
}
