//! Hinges as a scenario has them.

use super::numbers::number;
use glam::DVec3;

/// Most degrees from one limit of a hinge to the other, and from the start.
const WIDEST: [f64; 2] = [340.0, 180.0];

/// A hinge about an axis, with limits in radians from the start and a torque of friction in N m.
pub(super) fn hinge(axis: DVec3, limits: Option<[f64; 2]>, friction: f64, left_out: &mut Vec<String>) -> String {
    let axis = axis.to_array().map(number).join(", ");
    let friction = if friction > 0.0 { format!(", friction_n_m = {}", number(friction)) } else { String::new() };
    let mut said = String::new();
    if let Some(range) = limits {
        let [low, high] = range.map(f64::to_degrees);
        let [wide, far] = WIDEST;
        if low < -far || high > far || high - low > wide {
            left_out.push(format!(
                "the limits of its hinge, {} and {} degrees: it turns freely",
                number(low),
                number(high)
            ));
        } else if low > 0.0 || high < 0.0 {
            left_out.push(format!(
                "the limits of its hinge, {} and {} degrees: it starts beyond them, so that they begin there",
                number(low),
                number(high)
            ));
            said = format!(", limits_deg = [{}, {}]", number(low.min(0.0)), number(high.max(0.0)));
        } else if low == high {
            return "{ weld = {} }".into();
        } else {
            said = format!(", limits_deg = [{}, {}]", number(low), number(high));
        }
    }
    format!("{{ hinge = {{ axis = [{axis}]{said}{friction} }} }}")
}
