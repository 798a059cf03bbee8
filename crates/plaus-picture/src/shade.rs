//! The light that comes back along a ray: from a sun with a soft edge, from a bright sky that crevices receive less of,
//! and from highlights on glossy things.

use crate::bvh::{Hit, Ray};
use crate::drawing::Moment;
use crate::noise::Noise;
use glam::DVec3;
use plaus_animation::{Colour, Look, Material};
use plaus_dist::math;
use std::sync::LazyLock;

pub(crate) struct Shader<'a> {
    pub(crate) moment: Moment<'a>,
    /// Height of the table on which everything stands.
    pub(crate) ground: f64,
}

/// Towards the sun.
pub(crate) const SUN: DVec3 = DVec3::new(-0.32, 1.0, 0.36);
/// Radius of the sun's disc at distance 1: how soft shadows are.
pub(crate) const SOFT: f64 = 0.07;
const SUNLIGHT: f64 = 0.72;
const SKYLIGHT: f64 = 0.5;
/// Things nearer than this to a surface keep light of the sky away from it, in metres.
pub(crate) const CREVICE: f64 = 0.03;
/// How far off the surface that it left a ray continues, in metres.
const OFF: f64 = 1e-6;
/// Largest number of translucent things that a ray passes through.
const DEEP: usize = 12;
const TABLE: Look = Look::new([236, 233, 228], Material::Matte);

/// The light for each of the 256 values of a channel; a screen's curve is close enough to a power.
static LIGHT: LazyLock<[f64; 256]> = LazyLock::new(|| std::array::from_fn(|value| light_of(value as f64)));
/// The least light for which a channel has the value 1, 2 and so on.
static STEPS: LazyLock<[f64; 255]> = LazyLock::new(|| std::array::from_fn(|value| light_of(value as f64 + 0.5)));

fn light_of(value: f64) -> f64 {
    math::powf(value / 255.0, 2.2)
}

/// sRGB to linear light.
fn linear(Colour(rgb): Colour) -> DVec3 {
    DVec3::from_array(rgb.map(|value| LIGHT[usize::from(value)]))
}

/// Linear light as a pixel.
pub(crate) fn to_pixel(light: DVec3) -> [u8; 3] {
    light.to_array().map(|light| STEPS.partition_point(|step| *step <= light) as u8)
}

fn sky(along: DVec3) -> DVec3 {
    DVec3::new(0.93, 0.95, 0.98).lerp(DVec3::new(0.62, 0.74, 0.92), along.y.clamp(0.0, 1.0))
}

impl Shader<'_> {
    /// Light that comes back along a ray, and how far away the last surface is that it reached; infinite for the sky.
    pub(crate) fn light(&self, from: DVec3, along: DVec3, noise: &Noise) -> (DVec3, f64) {
        let (mut seen, mut left, mut least) = (DVec3::ZERO, 1.0, OFF);
        for _ in 0..DEEP {
            let hit = self.moment.first(&Ray { from, along, least, most: f64::INFINITY, solid_only: false });
            let table = (self.ground - from.y) / along.y;
            let on_table = table > least && hit.as_ref().is_none_or(|hit| table < hit.t);
            if on_table {
                return (seen + left * self.surface(from + table * along, DVec3::Y, along, TABLE, noise), table);
            }
            let Some(Hit { t, normal, look }) = hit else { break };
            let normal = if normal.dot(along) > 0.0 { -normal } else { normal };
            let at = from + t * along;
            match look.clear() {
                None => return (seen + left * self.surface(at, normal, along, look, noise), t),
                Some(share) => {
                    // The more obliquely a thing is looked at, the less is seen through it.
                    let glance = 1.0 - along.dot(normal).abs();
                    let share = share * (1.0 - 0.35 * glance * glance * glance);
                    seen += left * (1.0 - share) * linear(look.colour);
                    left *= share;
                    least = t + OFF;
                }
            }
        }
        (seen + left * DVec3::new(0.9, 0.92, 0.95), f64::INFINITY)
    }

    fn surface(&self, at: DVec3, normal: DVec3, along: DVec3, look: Look, noise: &Noise) -> DVec3 {
        let sun = SUN.normalize();
        let [a, b] = noise.pair(1);
        let (sin, cos) = math::sin_cos(std::f64::consts::TAU * a);
        let side = sun.any_orthonormal_vector();
        let towards = (sun + SOFT * b.sqrt() * (cos * side + sin * sun.cross(side))).normalize();
        let facing = normal.dot(towards).max(0.0);
        let lit = facing > 0.0 && self.in_the_way(at, towards, f64::INFINITY).is_none();
        let open = self.open(at, normal, noise);
        let sunlight = if lit { SUNLIGHT * facing } else { 0.0 };
        let colour = linear(look.colour);
        let mut light = colour * (sunlight * DVec3::new(1.0, 0.97, 0.92) + SKYLIGHT * open * sky(normal));
        let (gloss, sharp) = match look.material {
            Material::Glossy => (0.5, 90),
            Material::Metal => (0.8, 60),
            Material::Wood => (0.08, 20),
            _ => (0.0, 1),
        };
        if gloss > 0.0 {
            let mirrored = along - 2.0 * along.dot(normal) * normal;
            let shine = if lit { math::powi(mirrored.dot(sun).max(0.0), sharp) } else { 0.0 };
            // Schlick 1994, refractive index 1.5.
            let edge = 0.04 + 0.96 * math::powi(1.0 - normal.dot(-along).clamp(0.0, 1.0), 5);
            let above = mirrored.y.max(0.0).sqrt() * open;
            light += DVec3::splat(gloss * shine) + gloss * edge * above * sky(mirrored);
        }
        light
    }

    /// The solid thing that is in the way from a point on a surface.
    fn in_the_way(&self, from: DVec3, along: DVec3, most: f64) -> Option<Hit> {
        self.moment.first(&Ray { from, along, least: OFF, most, solid_only: true })
    }

    /// How open the sky is, at most 1, from one ray: steep directions are more likely, and the nearer the thing that
    /// the ray hits, the smaller the result.
    fn open(&self, at: DVec3, normal: DVec3, noise: &Noise) -> f64 {
        let [a, b] = noise.pair(2);
        let (sin, cos) = math::sin_cos(std::f64::consts::TAU * a);
        let side = normal.any_orthonormal_vector();
        let out = b.sqrt();
        let towards = (normal * (1.0 - b).sqrt() + out * (cos * side + sin * normal.cross(side))).normalize();
        match self.in_the_way(at, towards, CREVICE) {
            Some(hit) => 0.15 + 0.85 * hit.t / CREVICE,
            None => 1.0,
        }
    }
}
