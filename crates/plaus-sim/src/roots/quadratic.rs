//! Quadratics `c0 + c1 t + c2 t²`: a sphere and a plane, or two spheres in free flight.

/// Real roots in ascending order, by the formula that does not cancel. A double root is given twice; a constant has
/// none.
#[inline]
#[must_use]
pub fn roots_of_quadratic([c0, c1, c2]: [f64; 3]) -> Option<[f64; 2]> {
    if c2 == 0.0 {
        return if c1 == 0.0 { None } else { Some([-c0 / c1; 2]) };
    }
    let half = -0.5 * c1;
    let discriminant = half * half - c2 * c0;
    if discriminant < 0.0 {
        return None;
    }
    let q = half + discriminant.sqrt().copysign(half);
    // q is 0 only if c1 and the discriminant are: a double root at 0.
    let (first, second) = (q / c2, if q == 0.0 { 0.0 } else { c0 / q });
    Some(if first <= second { [first, second] } else { [second, first] })
}

/// First time in `[0, until]` at which the quadratic is not positive and falls (see the module).
#[inline]
#[must_use]
pub fn fall_of_quadratic(c: [f64; 3], until: f64) -> Option<f64> {
    let [c0, c1, c2] = c;
    let falling_now = c1 < 0.0 || (c1 == 0.0 && c2 < 0.0);
    let time = if c0 <= 0.0 {
        if falling_now {
            0.0
        } else if c2 < 0.0 {
            // Overlapping and separating: it cannot come back before its turning point.
            let turn = -0.5 * c1 / c2;
            if c0 + 0.5 * c1 * turn <= 0.0 { turn } else { roots_of_quadratic(c)?[1] }
        } else {
            return None;
        }
    } else if c2 > 0.0 {
        // A valley: the first root is the fall, and it lies ahead only if the value falls now.
        if c1 >= 0.0 {
            return None;
        }
        roots_of_quadratic(c)?[0]
    } else if c0 + (c1 + c2 * until) * until > 0.0 {
        // A hill or a line that is above zero at both ends is above zero between them.
        return None;
    } else {
        // A hill or a falling line, above zero now: the later root.
        if c2 == 0.0 && c1 >= 0.0 {
            return None;
        }
        roots_of_quadratic(c)?[1]
    };
    (time <= until).then_some(time)
}

/// Earliest time at which a gap `f` with rate `rate` and acceleration at least `-m` can close.
#[inline]
pub(crate) fn earliest(f: f64, rate: f64, m: f64) -> f64 {
    if f > 0.0 {
        let root = (rate * rate + 2.0 * m * f).sqrt();
        if rate < 0.0 {
            2.0 * f / (root - rate)
        } else if m > 0.0 {
            (rate + root) / m
        } else {
            f64::INFINITY
        }
    } else if rate <= 0.0 {
        0.0
    } else if m > 0.0 {
        // Overlapping but opening: not before the rate has changed sign.
        let discriminant = rate * rate + 2.0 * m * f;
        (rate + discriminant.max(0.0).sqrt()) / m
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_do_not_cancel() {
        let [small, large] = roots_of_quadratic([1.0, -1e8, 1.0]).unwrap();
        assert!((small - 1e-8).abs() < 1e-23);
        assert!((large - 1e8).abs() < 1e-7);
        assert_eq!(roots_of_quadratic([0.0, 0.0, 3.0]), Some([0.0, 0.0]));
        assert_eq!(roots_of_quadratic([1.0, 0.0, 1.0]), None);
    }

    #[test]
    fn every_case_of_the_rule() {
        // (coefficients, expected)
        let cases = [
            ([1.0, -1.0, 0.0], Some(1.0)),    // a line that falls
            ([1.0, 1.0, 0.0], None),          // a line that rises
            ([0.0, -1.0, 0.0], Some(0.0)),    // touching and approaching
            ([0.0, 1.0, 0.0], None),          // touching and leaving
            ([-1e-18, 1.0, -1.0], Some(1.0)), // overlapping by rounding, thrown up, comes back
            ([-0.5, 1.0, -1.0], Some(0.5)),   // overlapping all the way: from the turning point on
            ([1.0, 0.0, -1.0], Some(1.0)),    // a drop from rest
            ([1.0, -2.0, 1.0], Some(1.0)),    // exact grazing
            ([1.0, -2.0, 1.5], None),         // a miss
            ([0.0, 0.0, 0.0], None),          // resting
        ];
        for (c, expected) in cases {
            let found = fall_of_quadratic(c, 10.0);
            match (found, expected) {
                (Some(t), Some(e)) => assert!((t - e).abs() < 1e-12, "{c:?}: {t} for {e}"),
                _ => assert_eq!(found, expected, "{c:?}"),
            }
        }
        assert_eq!(fall_of_quadratic([1.0, -1.0, 0.0], 0.5), None);
    }
}
