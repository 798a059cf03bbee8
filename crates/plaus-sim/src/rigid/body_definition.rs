//! Quantities derived from a body's shape and mass.

use super::motion::damping::Damping;
use super::motion::free_rotation::{Inertia, LEFT_OUT};
use super::motion::kinematic::KinematicPath;
use super::narrow_phase::foot::FOOT_POINTS;
use super::narrow_phase::seams::Seams;
use super::tolerances::{CONTACT_MARGIN, INERTIA_ROUNDING, LARGE_BOX, MAX_PIECES, SPAN_PER_GYRATION, TURN_ERROR};
use super::{BodySpec, RigidWorldDesc, StaticShape};
use crate::accuracy::Accuracy;
use crate::error::WorldError;
use crate::material::Material;
use crate::scenery::Aabb;
use crate::shape::piece::Piece;
use crate::shape::{ContactSphere, MassProperties, Ring, Shape};
use crate::special_case::SpecialCase;
use glam::{DMat3, DVec3};

/// A body with the quantities derived from its shape.
#[derive(Debug, Clone)]
pub(crate) struct BodyDef {
    pub(crate) mass: f64,
    pub(crate) inertia: Inertia,
    pub(crate) material: Material,
    /// The balls of the hull first, then those for uneven ground.
    pub(super) contact_spheres: Vec<ContactSphere>,
    pub(super) hull: usize,
    /// Distances from the centre of gravity of the contact spheres, and of the rings' circles.
    pub(super) arms: Vec<f64>,
    pub(super) ring_arms: Vec<f64>,
    pub(crate) bounding_radius: f64,
    pub(crate) size: f64,
    /// The length in m that says how fast it tips and slides in lasting contact: see [`span`].
    pub(crate) span: f64,
    /// Acceleration while nothing is touched, in m/s², and its size.
    pub(crate) gravity: DVec3,
    pub(crate) gravity_magnitude: f64,
    /// `√(g · size)`.
    pub(crate) speed: f64,
    /// Time in s within which many events make its contacts last: `accuracy.rattle · √(size/g)`.
    pub(crate) rattle: f64,
    /// Gap at which it touches, in m: the preset's gap over [`CONTACT_MARGIN`].
    pub(crate) gap: f64,
    pub(crate) anisotropy: f64,
    /// Terms of the series of its free rotation that searches for first contacts and steps of a crowd leave out. Where
    /// an event finds it, it is without them.
    pub(crate) turn_error: f64,
    pub(crate) is_ball: bool,
    /// Whether it can roll: a ball or a body of revolution.
    pub(crate) is_round: bool,
    pub(super) rings: Vec<Ring>,
    /// A ball about the axis that holds all rings: height of its centre, and its radius.
    pub(super) base: [f64; 2],
    pub(crate) skin: ShapeKind,
    /// Its convex pieces.
    pub(super) pieces: Vec<Piece>,
    /// Where they lie flush.
    pub(super) seams: Seams,
    /// A capsule along the body's z axis that holds it: heights of its ends, and its radius.
    pub(crate) capsule: [f64; 3],
    /// Whether its origin is not its centre of gravity: then it has to be driven.
    pub(super) is_off_centre: bool,
    /// Its path, if it is driven.
    pub(super) drive: Option<KinematicPath>,
    /// Damping and torque, if there is any.
    pub(super) damping: Option<Damping>,
}

/// How other bodies see a body.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ShapeKind {
    /// A ball, about its centre of gravity.
    Ball,
    /// A body of revolution: a row of balls and rings.
    Revolved,
    /// One or several convex pieces. Those that are polyhedra about the centre of gravity, cuboids among them, meet
    /// flat ground by their corners (`has_corners`).
    Convex { has_corners: bool },
}

/// Number of points of the first ring, a quarter turn apart, beginning with its lowest; other rings have only their
/// lowest point.
pub(crate) const RIM_POINTS: usize = 4;

/// The length of a compound whose free fall sets the length of steps, in m.
///
/// A body with radius of gyration k that tips over a point at distance r follows `√(g r/(k² + r²))`, which is at most
/// `√(g/2k)` for any r. So a board does not need steps as short as the thinnest of its pieces, which is its size.
fn span(size: f64, mass: f64, moments: DVec3) -> f64 {
    size.max(SPAN_PER_GYRATION * (moments.min_element() / mass).sqrt())
}

fn check(body: usize, b: &BodySpec) -> Result<(), WorldError> {
    let bad = |field, value, expected| Err(WorldError::BadBody { body, field, value, expected });
    let MassProperties { mass, inertia } = b.mass;
    for (field, value) in [
        ("mass", mass),
        ("inertia", inertia.x),
        ("inertia", inertia.y),
        ("inertia", inertia.z),
        ("reach", b.shape.reach()),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return bad(field, value, "a positive number");
        }
    }
    // Each moment is at most the sum of the two others: the integral of y² + z² is at most that of x² + z² plus x² +
    // y².
    let largest = inertia.max_element();
    if largest > (inertia.x + inertia.y + inertia.z - largest) * (1.0 + INERTIA_ROUNDING) {
        return bad("inertia", largest, "moments none of which exceeds the sum of the other two");
    }
    Ok(())
}

impl BodyDef {
    pub(super) fn new(
        body: usize,
        b: &BodySpec,
        world: &RigidWorldDesc,
        spacing: f64,
        gravity_magnitude: f64,
    ) -> Result<Self, WorldError> {
        let MassProperties { mass, inertia } = b.mass;
        check(body, b)?;
        world.laws.require(b.material)?;
        let mut contact_spheres = b.shape.contact_spheres();
        let hull = contact_spheres.len();
        if spacing.is_finite() {
            contact_spheres.extend(b.shape.contact_spheres_between(spacing));
        }
        let (size, inertia) = (b.shape.size(), Inertia::new(inertia));
        let (speed, gap) = ((gravity_magnitude * size).sqrt(), world.accuracy.gap * size / CONTACT_MARGIN);
        // Without gravity the only time scale is that of the speeds, which are not known here.
        let rattle =
            if gravity_magnitude > 0.0 { world.accuracy.rattle * (size / gravity_magnitude).sqrt() } else { 0.0 };
        let (bounding_radius, anisotropy) = (b.shape.reach(), inertia.anisotropy());
        let (skin, rings) = match &b.shape {
            Shape::Ball(_) => (ShapeKind::Ball, Vec::new()),
            Shape::Revolution(r) => (ShapeKind::Revolved, r.rings().to_vec()),
            Shape::Cuboid(_) | Shape::Hull(_) => (ShapeKind::Convex { has_corners: true }, Vec::new()),
            Shape::Compound(_) => (ShapeKind::Convex { has_corners: false }, Vec::new()),
        };
        let (capsule, base) = (capsule(&b.shape, bounding_radius), ball_around(&rings));
        let arms = contact_spheres.iter().map(|f| f.centre.length()).collect();
        let ring_arms = rings.iter().map(|r| (r.circle * r.circle + r.height * r.height).sqrt()).collect();
        let is_ball = matches!(skin, ShapeKind::Ball);
        let is_round =
            is_ball || matches!(skin, ShapeKind::Revolved) || matches!(&b.shape, Shape::Compound(c) if c.is_round());
        let pieces = b.shape.pieces();
        if pieces.len() > MAX_PIECES {
            let expected = "at most 256";
            return Err(WorldError::BadBody { body, field: "convex pieces", value: pieces.len() as f64, expected });
        }
        Ok(Self {
            mass,
            inertia,
            material: b.material,
            contact_spheres,
            hull,
            arms,
            ring_arms,
            bounding_radius,
            size,
            span: if matches!(b.shape, Shape::Compound(_)) && !is_round {
                span(size, mass, inertia.moments)
            } else {
                size
            },
            gravity: world.gravity,
            gravity_magnitude,
            speed,
            rattle,
            gap,
            anisotropy,
            turn_error: if world.accuracy.takes_crowd_steps() { TURN_ERROR * world.accuracy.gap } else { LEFT_OUT },
            is_ball,
            is_round,
            rings,
            base,
            skin,
            seams: Seams::within(&pieces),
            pieces,
            capsule,
            is_off_centre: b.shape.is_off_centre(),
            drive: None,
            damping: None,
        })
    }

    /// Sets its scales of speed and time for pulls of this strength.
    pub(super) fn scale_by(&mut self, gravity_magnitude: f64, accuracy: &Accuracy) {
        self.speed = (gravity_magnitude * self.size).sqrt();
        self.rattle =
            if gravity_magnitude > 0.0 { accuracy.rattle * (self.size / gravity_magnitude).sqrt() } else { 0.0 };
    }

    /// Whether it is driven.
    #[inline]
    pub(crate) fn is_driven(&self) -> bool {
        self.drive.is_some()
    }

    /// How far it reaches in a direction (a unit vector in the world) from its centre of gravity, with these axes.
    pub(super) fn extent(&self, r: &DMat3, d: DVec3) -> f64 {
        if matches!(self.skin, ShapeKind::Revolved) {
            let [low, high, radius] = self.capsule;
            let along = d.dot(r.z_axis);
            return (low * along).max(high * along) + radius;
        }
        let bounding_radius = |piece: &Piece| piece.placed(r, DVec3::ZERO).support(d) + piece.rounding;
        self.pieces.iter().map(bounding_radius).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether it is a body of revolution that meets a part by the balls and rings of its skin: a box that is so large
    /// beside its foot that none of its sides fits between points of the rim. By its pieces, a pin among the boxes of
    /// an alley takes five times as long.
    pub(super) fn meets_by_rings(&self, part: &StaticShape) -> bool {
        let is_large = |bounds: &Aabb| (bounds.max - bounds.min).min_element() >= LARGE_BOX * self.rings[0].circle;
        SpecialCase::RingsOnBoxes.is_on()
            && matches!((self.skin, part), (ShapeKind::Revolved, StaticShape::Block { bounds, .. }) if is_large(bounds))
    }

    /// Whether it meets flat ground by its pieces, not by its contact spheres.
    #[inline]
    pub(crate) fn is_compound(&self) -> bool {
        !SpecialCase::SpheresOnPlanes.is_on() || matches!(self.skin, ShapeKind::Convex { has_corners: false })
    }

    /// The balls on the axis of a body of revolution.
    pub(crate) fn row(&self) -> &[ContactSphere] {
        &self.contact_spheres[..self.hull]
    }

    /// The points that can touch a part and lie on rings; the contact spheres of the hull come before them.
    pub(crate) fn ring_points(&self) -> std::ops::Range<usize> {
        let count = if self.rings.is_empty() { 0 } else { RIM_POINTS + self.rings.len() - 1 };
        self.hull..self.hull + count
    }

    /// The points at which the foot meets the edges of a box that it meets by its rings, after those of the rings.
    pub(crate) fn foot_points(&self) -> std::ops::Range<usize> {
        let first = self.ring_points().end;
        first..if self.rings.is_empty() { first } else { first + FOOT_POINTS }
    }

    /// Whether a point that touches a part, other than a table, keeps its place in the body.
    pub(crate) fn is_fixed_point(&self, point: usize) -> bool {
        self.rings.is_empty() || point < self.hull
    }

    /// The ring that a point belongs to.
    pub(crate) fn ring_of(&self, point: usize) -> Option<&Ring> {
        let k = point.checked_sub(self.hull)?;
        self.rings.get((k + 1).saturating_sub(RIM_POINTS))
    }

    /// The points of a ring.
    pub(crate) fn points_of(&self, ring: usize) -> std::ops::Range<usize> {
        let first = self.hull + if ring == 0 { 0 } else { RIM_POINTS + ring - 1 };
        first..first + if ring == 0 { RIM_POINTS } else { 1 }
    }

    /// A point that can touch a part, as a ball in body axes; `up` and `up_rate` as for
    /// [`ring_point`](Self::ring_point).
    pub(crate) fn point(&self, point: usize, up: DVec3, up_rate: DVec3) -> ContactSphere {
        if self.ring_of(point).is_some() { self.ring_point(point, up, up_rate).0 } else { self.contact_spheres[point] }
    }

    /// A point of a ring as a ball in body axes, where `up` (in body axes) points away from the part, and the point's
    /// place: 0 lowest, 1 and 3 sideways, 2 highest. On a level ring, the point that sinks fastest counts as the
    /// lowest; `up_rate` is the rate of `up` in body axes.
    pub(crate) fn ring_point(&self, point: usize, up: DVec3, up_rate: DVec3) -> (ContactSphere, usize) {
        let k = point - self.hull;
        let (ring, quarter) = if k < RIM_POINTS { (&self.rings[0], k) } else { (&self.rings[k + 1 - RIM_POINTS], 0) };
        let is_level = up.x == 0.0 && up.y == 0.0;
        let flat = if is_level { DVec3::new(up_rate.x, up_rate.y, 0.0) } else { DVec3::new(up.x, up.y, 0.0) };
        let down = if flat == DVec3::ZERO { DVec3::X } else { -flat.normalize() };
        let along = match quarter {
            0 => down,
            1 => DVec3::new(-down.y, down.x, 0.0),
            2 => -down,
            _ => DVec3::new(down.y, -down.x, 0.0),
        };
        (
            ContactSphere { centre: along * ring.circle + DVec3::new(0.0, 0.0, ring.height), radius: ring.radius },
            quarter,
        )
    }
}

/// A ball about the axis that holds these rings: height of its centre, and its radius.
fn ball_around(rings: &[Ring]) -> [f64; 2] {
    let (low, high) =
        rings.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), r| (l.min(r.height), h.max(r.height)));
    let middle = if rings.is_empty() { 0.0 } else { 0.5 * (low + high) };
    let bounding_radius =
        |r: &Ring| ((r.height - middle) * (r.height - middle) + r.circle * r.circle).sqrt() + r.radius;
    [middle, rings.iter().map(bounding_radius).fold(0.0, f64::max)]
}

fn capsule(shape: &Shape, bounding_radius: f64) -> [f64; 3] {
    let Shape::Revolution(body) = shape else { return [0.0, 0.0, bounding_radius] };
    let widest =
        body.row().iter().map(|f| f.radius).chain(body.rings().iter().map(|r| r.circle + r.radius)).fold(0.0, f64::max);
    // Ends chosen so that the balls there hold the cap and the foot.
    let top = body.row().iter().map(|f| f.centre.z + f.radius - widest).fold(f64::NEG_INFINITY, f64::max);
    let low = body.rings().iter().map(|r| {
        let outer = r.circle + r.radius;
        r.height - r.radius + (widest * widest - outer * outer).max(0.0).sqrt()
    });
    let low = low.chain(body.row().iter().map(|f| f.centre.z - f.radius + widest)).fold(f64::INFINITY, f64::min);
    [low.min(top), top.max(low), widest]
}
