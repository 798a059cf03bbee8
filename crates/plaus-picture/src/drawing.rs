//! An animation as balls and triangles: those of each body in its own frame, made once; and where the bodies are at a
//! given time.

use crate::bvh::{Bvh, Hit, Ray, Target};
use glam::{DMat3, DVec3};
use plaus_animation::{Animation, Form, Look, Shape};
use plaus_export::mesh::{self, Part};

/// Everything that is to be drawn of an animation.
pub(crate) struct Drawing<'a> {
    animation: &'a Animation,
    scenery: Bvh<Thing>,
    /// One for each track, in the body's frame.
    bodies: Vec<Bvh<Thing>>,
}

/// A drawing at one time.
pub(crate) struct Moment<'a> {
    scenery: &'a Bvh<Thing>,
    bodies: Bvh<Placed<'a>>,
    /// One for each track.
    pub(crate) poses: Vec<Pose>,
}

/// Where a body is: its place, its axes, and the box around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub(crate) at: DVec3,
    pub(crate) turned: DMat3,
    pub(crate) bounds: [DVec3; 2],
}

/// A body where it is.
struct Placed<'a> {
    body: &'a Bvh<Thing>,
    at: DVec3,
    /// From the body's axes to the world's, and back.
    turned: DMat3,
    back: DMat3,
}

/// Something a ray can hit.
#[derive(Debug, Clone, Copy)]
struct Thing {
    solid: Solid,
    look: Look,
    /// Whether it is seen only from the side that its normal points to, and casts no shadow: a plane, which has no end
    /// and nothing behind it.
    one_sided: bool,
}

#[derive(Debug, Clone, Copy)]
enum Solid {
    /// About the origin.
    Ball { radius: f64 },
    /// A corner, the two edges from it, and normals at the corners.
    Triangle { corner: DVec3, edges: [DVec3; 2], normals: [DVec3; 3] },
}

impl<'a> Drawing<'a> {
    pub(crate) fn new(animation: &'a Animation) -> Self {
        let scenery = animation.scenery.iter().flat_map(|prop| {
            let one_sided = matches!(prop.form, Form::Plane { .. });
            triangles(&mesh::of_form(&prop.form, prop.look)).into_iter().map(move |thing| Thing { one_sided, ..thing })
        });
        let bodies = animation.motion.tracks.iter().map(|track| Bvh::new(body(&track.shape, track.look)));
        Self { animation, scenery: Bvh::new(scenery.collect()), bodies: bodies.collect() }
    }

    /// Lowest and highest coordinates of the scenery.
    pub(crate) fn scenery_bounds(&self) -> Option<[DVec3; 2]> {
        self.scenery.bounds()
    }

    /// Whether solid scenery is in front of something around `at` that reaches so far.
    pub(crate) fn hides(&self, eye: DVec3, at: DVec3, reach: f64) -> bool {
        let (along, far) = ((at - eye).normalize(), (at - eye).length());
        let ray = Ray { from: eye, along, least: 0.0, most: far - reach, solid_only: true };
        self.scenery.first(&ray).is_some()
    }

    pub(crate) fn at(&self, time: f64) -> Moment<'_> {
        let there = self.animation.motion.tracks.iter().zip(&self.bodies).filter(|(track, _)| track.is_there(time));
        let placed = there.map(|(track, body)| {
            let turned = DMat3::from_quat(track.orientation(time));
            Placed { body, at: track.position(time), turned, back: turned.transpose() }
        });
        let placed: Vec<Placed<'_>> = placed.collect();
        let pose = |one: &Placed<'_>| Pose { at: one.at, turned: one.turned, bounds: one.bounds() };
        Moment { scenery: &self.scenery, poses: placed.iter().map(pose).collect(), bodies: Bvh::new(placed) }
    }
}

impl Moment<'_> {
    pub(crate) fn first(&self, ray: &Ray) -> Option<Hit> {
        let still = self.scenery.first(ray);
        let most = still.map_or(ray.most, |hit| hit.t);
        self.bodies.first(&Ray { most, ..*ray }).or(still)
    }

    /// The lowest height of anything.
    pub(crate) fn lowest(&self) -> f64 {
        let low = |bounds: Option<[DVec3; 2]>| bounds.map_or(f64::INFINITY, |[low, _]| low.y);
        low(self.scenery.bounds()).min(low(self.bodies.bounds()))
    }
}

/// The parts of a body in its own frame: balls remain balls, everything else becomes triangles.
fn body(shape: &Shape, look: Look) -> Vec<Thing> {
    let parts = mesh::of_shape(shape, look);
    match shape {
        Shape::Sphere { radius, .. } => {
            let ball = Thing { solid: Solid::Ball { radius: *radius }, look, one_sided: false };
            std::iter::once(ball).chain(parts[1..].iter().flat_map(triangles)).collect()
        }
        _ => parts.iter().flat_map(triangles).collect(),
    }
}

fn triangles(part: &Part) -> Vec<Thing> {
    let at = |list: &[[f32; 3]], id: u32| DVec3::from_array(list[id as usize].map(f64::from));
    let triangle = |ids: &[u32; 3]| {
        let [a, b, c] = ids.map(|id| at(&part.mesh.positions, id));
        let normals = ids.map(|id| at(&part.mesh.normals, id));
        Thing {
            solid: Solid::Triangle { corner: a, edges: [b - a, c - a], normals },
            look: part.look,
            one_sided: false,
        }
    };
    part.mesh.triangles.iter().map(triangle).collect()
}

impl Target for Placed<'_> {
    fn bounds(&self) -> [DVec3; 2] {
        let [low, high] = self.body.bounds().unwrap_or_default();
        let (middle, half) = (self.at + self.turned * (0.5 * (low + high)), 0.5 * (high - low));
        let reach =
            self.turned.x_axis.abs() * half.x + self.turned.y_axis.abs() * half.y + self.turned.z_axis.abs() * half.z;
        [middle - reach, middle + reach]
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let own = Ray { from: self.back * (ray.from - self.at), along: self.back * ray.along, ..*ray };
        self.body.first(&own).map(|hit| Hit { normal: self.turned * hit.normal, ..hit })
    }
}

impl Target for Thing {
    fn bounds(&self) -> [DVec3; 2] {
        match self.solid {
            Solid::Ball { radius } => [DVec3::splat(-radius), DVec3::splat(radius)],
            Solid::Triangle { corner, edges, .. } => {
                let all = [corner, corner + edges[0], corner + edges[1]];
                [all[0].min(all[1]).min(all[2]), all[0].max(all[1]).max(all[2])]
            }
        }
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        if ray.solid_only && (self.one_sided || self.look.clear().is_some()) {
            return None;
        }
        let (t, normal) = self.solid.hit(ray).filter(|(_, normal)| !self.one_sided || normal.dot(ray.along) < 0.0)?;
        Some(Hit { t, normal, look: self.look })
    }
}

impl Solid {
    /// How far along the ray it is hit, and the normal there.
    fn hit(&self, ray: &Ray) -> Option<(f64, DVec3)> {
        let within = |t: f64| t > ray.least && t < ray.most;
        match *self {
            Self::Ball { radius } => {
                let middle = -ray.from.dot(ray.along);
                let off = ray.from + middle * ray.along;
                let inside = radius * radius - off.length_squared();
                if inside < 0.0 {
                    return None;
                }
                let half = inside.sqrt();
                let t = if middle - half > ray.least { middle - half } else { middle + half };
                within(t).then(|| (t, (ray.from + t * ray.along) / radius))
            }
            Self::Triangle { corner, edges: [a, b], normals } => {
                // Möller & Trumbore 1997.
                let p = ray.along.cross(b);
                let det = a.dot(p);
                if det == 0.0 {
                    return None;
                }
                let to = ray.from - corner;
                let u = to.dot(p) / det;
                if !(0.0..=1.0).contains(&u) {
                    return None;
                }
                let q = to.cross(a);
                let v = ray.along.dot(q) / det;
                let t = b.dot(q) / det;
                let hit = v >= 0.0 && u + v <= 1.0 && within(t);
                hit.then(|| (t, (normals[0] * (1.0 - u - v) + normals[1] * u + normals[2] * v).normalize()))
            }
        }
    }
}
