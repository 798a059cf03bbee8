//! Curves, cut to the range of a plot.

/// The parts of a curve with y in [`low`, `high`]; each ends where the curve leaves the range.
pub fn inside(points: &[(f64, f64)], low: f64, high: f64) -> Vec<Vec<(f64, f64)>> {
    let mut parts: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some((from, to)) = cut(pair[0], pair[1], low, high) else {
            open = false;
            continue;
        };
        if !open {
            parts.push(vec![from]);
        }
        if let Some(part) = parts.last_mut() {
            part.push(to);
        }
        open = to == pair[1];
    }
    parts
}

/// The part of a segment with y in [`low`, `high`].
fn cut(a: (f64, f64), b: (f64, f64), low: f64, high: f64) -> Option<((f64, f64), (f64, f64))> {
    if a.1.max(b.1) < low || a.1.min(b.1) > high {
        return None;
    }
    let at = |y: f64| (a.0 + (b.0 - a.0) * (y - a.1) / (b.1 - a.1), y);
    let ends = |p: (f64, f64)| {
        if p.1 < low {
            at(low)
        } else if p.1 > high {
            at(high)
        } else {
            p
        }
    };
    Some((ends(a), ends(b)))
}

/// Steps: each value holds for one iteration, the first for iteration `first`.
pub fn numbered(values: &[f64]) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(index, &value)| (index as f64, value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_cut_where_it_leaves() {
        let parts = inside(&[(0.0, -1.0), (1.0, 1.0), (2.0, 0.5), (3.0, 4.5), (4.0, 5.0)], 0.0, 2.5);
        assert_eq!(parts, [[(0.5, 0.0), (1.0, 1.0), (2.0, 0.5), (2.5, 2.5)]]);
        assert_eq!(inside(&[(0.0, 3.0), (1.0, 3.0)], 0.0, 2.5), Vec::<Vec<_>>::new());
    }
}
