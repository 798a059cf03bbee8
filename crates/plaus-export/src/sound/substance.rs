//! Materials, as far as they can be heard, and how they ring.

use plaus_animation::{Form, Look, Material, Prop, Shape, Track};
use plaus_dist::math::square;
use std::f64::consts::{PI, TAU};

/// Stiffness, weight and damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Substance {
    /// Young's modulus, Pa.
    pub(super) young: f64,
    /// Poisson's ratio.
    pub(super) poisson: f64,
    /// Density, kg/m³.
    pub(super) density: f64,
    /// Loss factor: the share of a mode's energy that is lost in one radian.
    pub(super) loss: f64,
    /// Height of roughness, m: what makes rolling audible.
    pub(super) rough: f64,
}

const fn substance(young: f64, poisson: f64, density: f64, loss: f64, rough: f64) -> Substance {
    Substance { young, poisson, density, loss, rough }
}

// Young's moduli, Poisson's ratios and densities: Ashby, Materials Selection in Mechanical Design (2011), appendix A.
// Loss factors: Cremer, Heckl & Petersson, Structure-Borne Sound (2005), table 3.2; the upper ends, because things lie
// on something. Roughness: order of magnitude of a polished, a turned, a planed and a woven surface.
const GLASS: Substance = substance(70e9, 0.22, 2500.0, 0.003, 2e-7);
const ACRYLIC: Substance = substance(3.2e9, 0.37, 1190.0, 0.03, 1e-6);
const POLYESTER: Substance = substance(4.0e9, 0.36, 1250.0, 0.03, 1e-6);
const MAPLE: Substance = substance(12e9, 0.35, 700.0, 0.015, 4e-6);
const STEEL: Substance = substance(205e9, 0.29, 7800.0, 0.002, 5e-7);
const STONE: Substance = substance(50e9, 0.25, 2600.0, 0.01, 1e-5);
const RUBBER: Substance = substance(2e7, 0.49, 1100.0, 0.2, 5e-6);
const FELT: Substance = substance(5e7, 0.3, 600.0, 0.3, 5e-5);

/// One way of ringing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mode {
    /// Hz.
    pub(super) frequency: f64,
    pub(super) loss: f64,
    /// Mass that takes part, kg.
    pub(super) mass: f64,
    /// Surface that radiates, m².
    pub(super) area: f64,
}

/// A thing that is hit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sounding {
    pub(super) substance: Substance,
    /// Radius of curvature where it touches, m.
    pub(super) radius: f64,
    /// kg; infinite for scenery.
    pub(super) mass: f64,
    pub(super) modes: Vec<Mode>,
}

/// Free bars: frequencies over the first (Fletcher & Rossing, The Physics of Musical Instruments, 1998, section 2.14).
const BAR: [f64; 4] = [1.0, 2.757, 5.404, 8.933];
/// Free solid spheres: ω a over the speed of shear waves, spheroidal modes of degrees 2 to 5 (Lamb 1882).
const SPHERE: [f64; 4] = [2.65, 3.92, 5.07, 6.15];
/// Thickness of a table top or a floor that rings, m.
const PANEL: f64 = 0.02;
/// Number of a panel's modes. Each frequency is a fifth (a factor 1.5) above the one before, because those of a plate
/// grow denser evenly.
const PANEL_MODES: usize = 9;

/// A body. Its shape and look determine its material.
pub(super) fn of_body(track: &Track) -> Sounding {
    let material = track.look.material;
    let (substance, radius, mass, modes) = match &*track.shape {
        Shape::Sphere { radius, .. } => {
            let made = match material {
                Material::Metal => STEEL,
                Material::Wood => MAPLE,
                _ if *radius < 0.04 => GLASS,
                _ => POLYESTER,
            };
            let mass = made.density * 4.0 / 3.0 * PI * radius * square(*radius);
            let shear = (made.young / (2.0 * (1.0 + made.poisson) * made.density)).sqrt();
            let mode = |number: f64| Mode {
                frequency: number * shear / (TAU * radius),
                loss: made.loss,
                mass: 0.25 * mass,
                area: 2.0 * PI * square(*radius),
            };
            (made, *radius, mass, SPHERE.map(mode).to_vec())
        }
        Shape::Disc { radius, thickness } => {
            let mass = RUBBER.density * PI * square(*radius) * thickness;
            (RUBBER, *radius, mass, Vec::new())
        }
        Shape::Cuboid { half, .. } => {
            let made = if material == Material::Wood { MAPLE } else { ACRYLIC };
            let mass = made.density * 8.0 * half.x * half.y * half.z;
            // The lowest mode of a cube: a standing shear wave across it.
            let shear = (made.young / (2.0 * (1.0 + made.poisson) * made.density)).sqrt();
            let side = 2.0 * half.max_element();
            let mode = Mode { frequency: shear / (2.0 * side), loss: made.loss, mass: 0.5 * mass, area: square(side) };
            // Corners and edges are rounded by about an eighth of the side.
            (made, 0.125 * side, mass, vec![mode])
        }
        Shape::Solid { vertices, triangles } => {
            let made = if material == Material::Wood { MAPLE } else { ACRYLIC };
            let corner = |k: &u32| vertices.get(*k as usize).copied().unwrap_or_default();
            let six = |[a, b, c]: &[u32; 3]| corner(a).dot(corner(b).cross(corner(c)));
            let volume = (triangles.iter().map(six).sum::<f64>() / 6.0).max(1e-12);
            // Like a cube of the same volume.
            let shear = (made.young / (2.0 * (1.0 + made.poisson) * made.density)).sqrt();
            let side = plaus_dist::math::cbrt(volume);
            let mass = made.density * volume;
            let mode = Mode { frequency: shear / (2.0 * side), loss: made.loss, mass: 0.5 * mass, area: square(side) };
            (made, 0.125 * side, mass, vec![mode])
        }
        Shape::Revolution { profile, .. } => {
            let (low, high) = profile.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[1]), b.max(p[1])));
            let (length, mut volume, mut widest) = ((high - low).max(1e-3), 0.0, 0.0_f64);
            for pair in profile.windows(2) {
                let [[r, h], [s, i]] = [pair[0], pair[1]];
                volume += PI / 3.0 * (i - h) * (r * r + r * s + s * s);
                widest = widest.max(r).max(s);
            }
            let mass = MAPLE.density * volume;
            // Like a bar of the same length and volume.
            let mean = (volume / (PI * length)).sqrt();
            let first = 22.37 / (TAU * square(length)) * (MAPLE.young / MAPLE.density).sqrt() * 0.5 * mean;
            let mode = |ratio: f64| Mode {
                frequency: first * ratio,
                loss: MAPLE.loss,
                mass: 0.25 * mass,
                area: length * 2.0 * mean,
            };
            (MAPLE, widest, mass, BAR.map(mode).to_vec())
        }
    };
    Sounding { substance, radius, mass, modes }
}

/// A part of the scenery: it rings as a panel, heavily damped by what it lies on.
pub(super) fn of_prop(prop: &Prop) -> Sounding {
    let substance = match prop.look.material {
        Material::Wood => MAPLE,
        Material::Felt => FELT,
        Material::Glass => GLASS,
        Material::Metal => STEEL,
        Material::Glossy => ACRYLIC,
        Material::Matte | Material::Mark => STONE,
    };
    let size = match &prop.form {
        Form::Block { half, .. } => half.max_element(),
        Form::Plane { half, .. } => *half,
        Form::Mesh { .. } | Form::Heightfield { .. } => 0.2,
    };
    let side = (2.0 * size).clamp(0.1, 1.0);
    // A supported square plate with that side, at most a metre, because parts farther away do not ring with it.
    let stiff = (substance.young / (12.0 * (1.0 - square(substance.poisson)) * substance.density)).sqrt() * PANEL;
    let first = PI * stiff / square(side);
    let mass = 0.25 * substance.density * PANEL * square(side);
    let loss = substance.loss.max(0.03);
    let mode = |number: usize| Mode {
        frequency: first * (0..number).fold(1.0, |so_far, _| so_far * 1.5),
        loss,
        mass,
        area: 0.25 * square(side),
    };
    let modes = (0..PANEL_MODES).map(mode).collect();
    Sounding { substance, radius: f64::INFINITY, mass: f64::INFINITY, modes }
}

/// An unknown thing, with a look that nothing has.
pub(super) fn unknown() -> Sounding {
    of_prop(&Prop::block("", Look::STONE, glam::DVec3::ZERO, glam::DVec3::ONE))
}
