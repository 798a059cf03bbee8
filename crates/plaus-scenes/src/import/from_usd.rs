//! What a GLB that was made of USD says beyond what a GLB can: gravity, densities of colliders, colours, and what was
//! not read.

use super::numbers::number;
use super::things::{Piece, Things};
use super::write::place;
use glam::DVec3;
use plaus_asset::glb::{FROM_USD, Glb, Node};
use serde_json::Value;

/// In kg/m³: of what weighs what nothing says.
const WATER: f64 = 1000.0;

/// What a collider weighs: in kg, or in kg/m³; and whether its mesh is to be cut into convex pieces.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Weight {
    mass: Option<f64>,
    density: Option<f64>,
    pub(super) cuts: bool,
}

impl Weight {
    pub(super) fn of(node: &Node) -> Self {
        let ours = &node.extensions[FROM_USD];
        let cuts = ours["pieces"].as_bool().unwrap_or(false);
        Self { mass: ours["mass"].as_f64(), density: ours["density"].as_f64(), cuts }
    }
}

/// The colour of a node of which no mesh gives one.
pub(super) fn colour(node: &Node) -> Option<[u8; 3]> {
    let list = node.extensions[FROM_USD]["colour"].as_array().filter(|list| list.len() == 3)?;
    let channel = |k: usize| u8::try_from(list[k].as_u64()?).ok();
    Some([channel(0)?, channel(1)?, channel(2)?])
}

/// The mass of pieces together, if it is not that of water, and how their densities compare.
pub(super) fn weigh(things: &Things<'_>, pieces: &mut [Piece], weights: &[Weight]) -> Option<f64> {
    if weights.iter().all(|weight| weight.mass.is_none() && weight.density.is_none()) {
        return None;
    }
    let volume = |piece: &Piece, weight: &Weight| match weight.cuts {
        true => things.enclosed(&piece.shape).abs(),
        false => things.volume(&piece.shape).unwrap_or(0.0),
    };
    let weighed: Vec<(f64, f64)> = pieces
        .iter()
        .zip(weights)
        .map(|(piece, weight)| {
            let volume = volume(piece, weight);
            let of_mass = weight.mass.filter(|_| volume > 0.0).map(|mass| mass / volume);
            (of_mass.or(weight.density).unwrap_or(WATER), volume)
        })
        .collect();
    let densest = weighed.iter().map(|(density, _)| *density).fold(0.0, f64::max);
    for (piece, (density, _)) in pieces.iter_mut().zip(&weighed) {
        piece.density = (density / densest).clamp(1e-6, 1.0);
    }
    Some(weighed.iter().map(|(density, volume)| density * volume).sum::<f64>()).filter(|mass| *mass > 0.0)
}

/// Takes over gravity, and tells what was not read.
pub(super) fn told(file: &Glb, things: &mut Things<'_>) {
    let ours = file.extension(FROM_USD);
    let list = |key: &str| -> Vec<String> {
        ours[key].as_array().into_iter().flatten().filter_map(|what| what.as_str().map(String::from)).collect()
    };
    things.left_out.extend(list("left_out"));
    things.harmless.extend(list("harmless"));
    let numbers: Option<Vec<f64>> =
        ours["gravity"].as_array().map(|all| all.iter().filter_map(Value::as_f64).collect());
    if let Some(Ok(gravity)) = numbers.map(<[f64; 3]>::try_from) {
        things.gravity(place(DVec3::from_array(gravity)));
    }
}

impl Things<'_> {
    /// Takes over gravity in m/s², as far as it points down.
    pub(super) fn gravity(&mut self, gravity: DVec3) {
        let level = DVec3::new(gravity.x, gravity.y, gravity.z.max(0.0));
        if level != DVec3::ZERO {
            let said = gravity.to_array().map(number).join(" ");
            self.left_out.push(format!("gravity {said}: only the part that points down is used"));
        }
        self.world.push(format!("gravity = {}", number((-gravity.z).clamp(0.0, 1000.0))));
    }
}
