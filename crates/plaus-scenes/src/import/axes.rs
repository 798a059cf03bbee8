//! Hinges and sliders as a scenario has them.

use super::numbers::number;
use glam::DVec3;

/// Most degrees from one limit of a hinge to the other, and from the start.
const WIDEST: [f64; 2] = [340.0, 180.0];
/// Farthest limit of a slider, in mm.
const FARTHEST: f64 = 1e6;

/// What acts along the axis of a hinge, in rad and N m, or of a slider, in m and N. Places are counted from the start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Along {
    pub(super) slides: bool,
    pub(super) limits: Option<[f64; 2]>,
    pub(super) friction: f64,
    /// Stiffness, rest, and damping.
    pub(super) spring: [f64; 3],
    /// A speed, and the greatest force.
    pub(super) motor: Option<[f64; 2]>,
}

impl Along {
    /// The joint about or along an axis; adds what it cannot have to `left_out`.
    pub(super) fn joint(&self, axis: DVec3, left_out: &mut Vec<String>) -> String {
        let (kind, unit, scale) =
            if self.slides { ("slider", "mm", 1e3) } else { ("hinge", "degrees", 1_f64.to_degrees()) };
        let axis = axis.to_array().map(number).join(", ");
        let mut said = String::new();
        if let Some([low, high]) = self.limits.map(|limits| limits.map(|limit| limit * scale)) {
            let [least, most] = [low, high].map(|limit| limit.clamp(-FARTHEST, FARTHEST));
            let of = format!("the limits of its {kind}, {} and {} {unit}", number(low), number(high));
            let [wide, far] = WIDEST;
            if !self.slides && (low < -far || high > far || high - low > wide) {
                left_out.push(format!("{of}: it turns freely"));
            } else if low == high {
                return "{ weld = {} }".into();
            } else {
                if low > 0.0 || high < 0.0 {
                    left_out.push(format!("{of}: it starts beyond them, so that they begin there"));
                }
                let limits = [least.min(0.0), most.max(0.0)].map(number).join(", ");
                said += &format!(", limits_{} = [{limits}]", if self.slides { "mm" } else { "deg" });
            }
        }
        if self.friction > 0.0 {
            said += &format!(", friction_{} = {}", if self.slides { "n" } else { "n_m" }, number(self.friction));
        }
        let [stiffness, rest, damping] = self.spring;
        let rest = rest * scale;
        if stiffness > 0.0 && !self.slides && rest.abs() > WIDEST[1] {
            left_out.push(format!("the spring of its hinge, which is at rest at {} degrees", number(rest)));
        } else if stiffness > 0.0 || damping > 0.0 {
            let [a, b, c] = if self.slides {
                ["stiffness_n_per_m", "rest_mm", "damping_n_s_per_m"]
            } else {
                ["stiffness_n_m_per_rad", "rest_deg", "damping_n_m_s_per_rad"]
            };
            let all = [(a, stiffness), (b, if stiffness > 0.0 { rest } else { 0.0 }), (c, damping)];
            let all =
                all.into_iter().filter(|part| part.1 != 0.0).map(|(key, value)| format!("{key} = {}", number(value)));
            said += &format!(", spring = {{ {} }}", all.collect::<Vec<_>>().join(", "));
        }
        if let Some([speed, most]) = self.motor {
            let (most, speed) = (number(most), number(if self.slides { speed } else { speed.to_degrees() }));
            said += &if self.slides {
                format!(", motor = {{ most_n = {most}, speed_m_s = {speed} }}")
            } else {
                format!(", motor = {{ most_n_m = {most}, speed_deg_s = {speed} }}")
            };
        }
        format!("{{ {kind} = {{ axis = [{axis}]{said} }} }}")
    }
}
