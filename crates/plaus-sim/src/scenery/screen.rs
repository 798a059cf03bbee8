//! A box in few bytes, to quickly rule out most things that are far away.

use super::Aabb;

/// A box rounded outward to `f32`: lower and negated upper corner, so that one kind of comparison serves for both.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Screen([f32; 8]);

/// What [`Screen`]s are compared with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Probe([f32; 8]);

impl Screen {
    pub(crate) fn new(b: &Aabb) -> Self {
        let (low, high) = (b.min.to_array().map(not_above), (-b.max).to_array().map(not_above));
        Self([low[0], low[1], low[2], high[0], high[1], high[2], 0.0, 0.0])
    }

    /// False where the boxes have no point in common; true may be wrong by rounding.
    #[inline(always)]
    pub(crate) fn may_meet(&self, probe: &Probe) -> bool {
        self.0.iter().zip(&probe.0).fold(true, |all, (a, b)| all & (a <= b))
    }
}

impl Probe {
    #[inline]
    pub(crate) fn new(b: &Aabb) -> Self {
        let (low, high) = ((-b.min).to_array().map(not_below), b.max.to_array().map(not_below));
        Self([high[0], high[1], high[2], low[0], low[1], low[2], 0.0, 0.0])
    }
}

/// The most that two roundings to `f32` can lose, over the number, is less than this.
const OUTWARD: f32 = 2.0 * f32::EPSILON;

/// A little less than `x`; never infinite above, so that points beyond all `f32` stay in.
#[inline(always)]
fn not_above(x: f64) -> f32 {
    let near = x as f32;
    let near = if near < f32::MAX { near } else { f32::MAX };
    near - (near.abs() * OUTWARD + f32::MIN_POSITIVE)
}

#[inline(always)]
fn not_below(x: f64) -> f32 {
    -not_above(-x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    fn any_box() -> impl Strategy<Value = Aabb> {
        let corner =
            || prop::array::uniform3(prop_oneof![-1.0..1.0_f64, Just(1e-50), Just(-1e-50), Just(1e60), Just(0.1)]);
        (corner(), corner()).prop_map(|(a, b)| Aabb::around([DVec3::from(a), DVec3::from(b)]))
    }

    proptest! {
        /// Boxes that meet are never ruled out.
        #[test]
        fn boxes_that_meet_pass(a in any_box(), b in any_box()) {
            prop_assert!(!a.meets(&b) || Screen::new(&a).may_meet(&Probe::new(&b)));
        }

        /// Boxes that are apart by more than an f32 can lose are ruled out.
        #[test]
        fn boxes_that_are_apart_do_not(
            a in prop::array::uniform3(-1.0..1.0_f64),
            axis in 0..3_usize,
            gap in 1e-6..1.0_f64,
        ) {
            let a = Aabb::around([DVec3::from(a), DVec3::from(a) + 0.1]);
            let mut b = a;
            b.min[axis] = a.max[axis] + gap;
            b.max[axis] = b.min[axis] + 0.1;
            prop_assert!(!Screen::new(&a).may_meet(&Probe::new(&b)) && !Screen::new(&b).may_meet(&Probe::new(&a)));
        }
    }

    #[test]
    fn nothing_meets_the_empty_box_and_all_meet_the_endless_one() {
        let unit = Probe::new(&Aabb { min: DVec3::ZERO, max: DVec3::ONE });
        assert!(!Screen::new(&Aabb::EMPTY).may_meet(&unit) && Screen::new(&Aabb::EVERYWHERE).may_meet(&unit));
    }
}
