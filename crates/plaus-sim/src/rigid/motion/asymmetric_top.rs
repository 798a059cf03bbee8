//! Free rotation of a body with three different moments in closed form, at any time at the same cost.
//!
//! The angular momentum in body axes runs on Jacobi's elliptic functions (Landau and Lifshitz, *Mechanics*, § 37),
//! which are quotients of theta functions; the body turns about it by an angle that grows evenly, but for the argument
//! of a theta function of a complex number (Whittaker, *Analytical Dynamics*, § 69; van Zon and Schofield, J. Comput.
//! Phys. 225 (2007)). All are sums that converge in a few terms: four where the nome is a tenth, twelve where the
//! separatrix is as near as rounding, 19 at [`LEAST_COMPLEMENT`]. Products of differences of moments take the place of
//! differences of products, so nothing cancels where moments or the axis are nearly those of a simpler case.

use super::elliptic::{arithmetic_geometric_mean, carlson_rf};
use glam::{DMat3, DVec3};
use plaus_dist::math;
use std::f64::consts::{FRAC_PI_2, PI};

/// Terms of the sums at most.
const MOST_TERMS: usize = 24;

/// Least complement of the parameter, which is 0 on the separatrix: a body that turns about its middle axis but for
/// 1e-20 of its angular velocity.
const LEAST_COMPLEMENT: f64 = 1e-40;

/// A wobble of less than this share of the angular momentum is below rounding; squared.
const NO_WOBBLE: f64 = 1e-34;

/// Powers of the nome by which the theta functions weigh sines and cosines of `(2 n + 1) x` and `2 n x`.
#[derive(Debug, Clone, Copy, Default)]
struct Term {
    /// Of the two odd ones of a real number; with alternating sign for the sine.
    odd: f64,
    alternating: f64,
    /// Of the even one.
    even: f64,
    /// Of that of the complex number: its real and imaginary part.
    re: f64,
    im: f64,
}

/// Free rotation of a body with three different moments.
#[derive(Debug, Clone)]
pub(super) struct AsymmetricTop {
    /// From the axes in which the angular momentum is upright to those of the world.
    base: DMat3,
    /// Angular momentum over the moments, where the angular momentum is one unit.
    gains: DVec3,
    /// The axes: of the amplitude of the cosine, of the sine, and the one about which it goes round.
    axes: [usize; 3],
    amplitudes: [f64; 3],
    /// The axis whose turning about the angular momentum is followed.
    followed: usize,
    /// The argument of the theta functions at the start, and its rate in 1/s.
    start: f64,
    rate: f64,
    /// The even part of the turning about the angular momentum in rad/s, and the sign of the rest.
    precession: f64,
    sign: f64,
    terms: [Term; MOST_TERMS],
    count: usize,
}

impl AsymmetricTop {
    /// Free rotation from an orientation, with an angular velocity in body axes; `None` if that stays as it is.
    pub(super) fn new(moments: DVec3, r: &DMat3, w: DVec3) -> Option<Self> {
        let speed = w.length();
        // Not divided by the largest: moments that differ by rounding have to stay different.
        let (i, w) = (moments.to_array(), w / speed);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| i[a].total_cmp(&i[b]));
        let [low, mid, high] = order;
        // Squared angular momentum less twice the energy times a moment.
        let above = |k: usize| (0..3).map(|j| i[j] * (i[j] - i[k]) * w[j] * w[j]).sum::<f64>();
        let side = i[high] * (i[high] - i[mid]) * (w[high] * w[high]) - i[low] * (i[mid] - i[low]) * (w[low] * w[low]);
        let axes = if side >= 0.0 { [low, mid, high] } else { [high, mid, low] };
        let [a, b, c] = axes;
        let [ab, bc, ca] = [(i[a] - i[b]).abs(), (i[b] - i[c]).abs(), (i[c] - i[a]).abs()];
        let (wobble, round) = (above(c).abs(), above(a).abs());
        let squares = [wobble * i[a] / ca, wobble * i[b] / bc, round * i[c] / ca];
        let is_steady = squares[0] + squares[1] <= NO_WOBBLE * squares[2];
        if is_steady || !speed.is_finite() || squares.iter().any(|s| !s.is_finite()) {
            return None;
        }
        let parameter = (wobble * ab / (round * bc)).min(1.0);
        let complement = side.abs() * ca / (round * bc);
        if complement < LEAST_COMPLEMENT && w[a] * w[a] + w[c] * w[c] <= NO_WOBBLE {
            return None;
        }
        let complement = complement.clamp(LEAST_COMPLEMENT, 1.0);
        let quarter = FRAC_PI_2 / arithmetic_geometric_mean(1.0, complement.sqrt());
        let other_quarter = FRAC_PI_2 / arithmetic_geometric_mean(1.0, parameter.sqrt());
        let nome = math::exp(-PI * other_quarter / quarter);
        let root_of_nome = math::exp(-0.25 * PI * other_quarter / quarter);

        // Which way it goes round, by Euler's equations, which change sign where the axes are no right-handed system.
        let is_right_handed = (a + 1) % 3 == b;
        let is_against = (w[c] < 0.0) ^ (i[c] < i[b]) ^ !is_right_handed;
        let signs = [1.0, if is_against { -1.0 } else { 1.0 }, if w[c] < 0.0 { -1.0 } else { 1.0 }];
        let modulus = parameter.sqrt().sqrt();
        let narrow = complement.sqrt().sqrt();
        let sizes = squares.map(f64::sqrt);
        let amplitudes = [
            sizes[0] * 2.0 * root_of_nome * narrow / modulus,
            signs[1] * sizes[1] * 2.0 * root_of_nome / modulus,
            signs[2] * sizes[2] * narrow,
        ];
        let phase = {
            let [cos, sin] = [w[a] * i[a] / sizes[0], signs[1] * w[b] * i[b] / sizes[1]];
            let length = math::hypot(cos, sin);
            let [cos, sin] = [cos / length, sin / length];
            let first = sin * carlson_rf(cos * cos, cos * cos + complement * (sin * sin), 1.0);
            if cos >= 0.0 { first } else { (2.0 * quarter).copysign(sin) - first }
        };

        let (followed, tangent) =
            if sizes[0] < sizes[2] { (a, sizes[2] / sizes[0]) } else { (c, sizes[0] / (sizes[2] * parameter.sqrt())) };
        let height = {
            let square = 1.0 / (1.0 + tangent * tangent);
            let sin = tangent * square.sqrt();
            sin * carlson_rf(square, square + parameter * (sin * sin), 1.0)
        };
        let mut top = Self {
            base: DMat3::IDENTITY,
            gains: DVec3::ZERO,
            axes,
            amplitudes,
            followed,
            start: phase * FRAC_PI_2 / quarter,
            rate: speed * (round * bc / (i[a] * i[b] * i[c])).sqrt() * FRAC_PI_2 / quarter,
            precession: 0.0,
            sign: if followed == high { -1.0 } else { 1.0 },
            terms: [Term::default(); MOST_TERMS],
            count: 0,
        };
        let slope = top.sum_up(nome, height * FRAC_PI_2 / quarter, {
            math::exp(-PI * (2.0 * other_quarter - height) / (2.0 * quarter))
        });
        let momentum = (squares[0] + squares[2]).sqrt();
        // How fast the axis turns where the cosine is 0; there no terms cancel.
        let others = [squares[1], if followed == a { complement * squares[2] } else { 0.0 }];
        let there = (others[0] / i[b] + others[1] / i[c]) / (others[0] + others[1]);
        top.precession = speed * momentum * there + top.sign * top.rate * slope;
        top.gains = DVec3::from_array(i.map(|i| speed * momentum / i));
        top.base = *r * top.about(0.0).0.transpose();
        Some(top)
    }

    /// Finds the terms of the sums; `height` is the imaginary part of the complex argument, and `ratio` the nome over
    /// `exp(−height)`. Returns how fast the angle of the complex theta function falls where the real part is a right
    /// angle.
    fn sum_up(&mut self, nome: f64, height: f64, ratio: f64) -> f64 {
        let mut sums = [0.0; 2];
        let (mut odd, mut even, mut both, mut sign) = (1.0, 1.0, 1.0, 1.0);
        // Powers of the nome with an exponent of 2 n, and of the ratio with one of 2.
        let (square, squared_ratio) = (nome * nome, ratio * ratio);
        let (mut step, mut even_step, mut both_step) = (square, nome, squared_ratio);
        for n in 0..MOST_TERMS {
            let times = (2 * n + 1) as f64;
            let fades = -math::exp_m1(-2.0 * times * height);
            let [re, im] = [both * (2.0 - fades), both * fades];
            self.terms[n] = Term { odd, alternating: sign * odd, even, re: sign * re, im: sign * im };
            sums[0] += times * im;
            sums[1] += re;
            self.count = n + 1;
            if n > 0 && even.max(both) < 0.1 * f64::EPSILON {
                break;
            }
            (odd, step) = (odd * step, step * square);
            (even, even_step) = (even * even_step, even_step * square);
            (both, both_step) = (both * both_step, both_step * square);
            sign = -sign;
        }
        sums[0] / sums[1]
    }

    /// From body axes to those in which the angular momentum is upright and does not turn, after a time; and the
    /// direction of the angular momentum in body axes.
    fn about(&self, t: f64) -> (DMat3, DVec3) {
        let (sin, cos) = math::sin_cos(self.start + self.rate * t);
        let [twice_cos, twice_sin] = [cos * cos - sin * sin, 2.0 * sin * cos];
        let turned = |[c, s]: [f64; 2]| [c * twice_cos - s * twice_sin, s * twice_cos + c * twice_sin];
        let (mut at_odd, mut at_even) = ([cos, sin], [1.0, 0.0]);
        let (mut of_cos, mut of_sin, mut of_round) = (0.0, 0.0, -1.0);
        let [mut re, mut im] = [0.0; 2];
        for term in &self.terms[..self.count] {
            of_cos += term.odd * at_odd[0];
            of_sin += term.alternating * at_odd[1];
            of_round += 2.0 * term.even * at_even[0];
            re += term.re * at_odd[1];
            im += term.im * at_odd[0];
            (at_odd, at_even) = (turned(at_odd), turned(at_even));
        }
        let mut n = DVec3::ZERO;
        for (axis, (amplitude, part)) in self.axes.iter().zip(self.amplitudes.iter().zip([of_cos, of_sin, of_round])) {
            n[*axis] = amplitude * part;
        }
        let n = n.normalize();
        let (s, c) = math::sin_cos(self.precession * t);
        let (im, length) = (im * self.sign, math::hypot(re, im));
        let [cos, sin] = [(c * re - s * im) / length, (s * re + c * im) / length];
        // The axis that is followed is at this angle.
        let k = self.followed;
        let (p, q) = ((k + 1) % 3, (k + 2) % 3);
        let far = (n[p] * n[p] + n[q] * n[q]).sqrt();
        let (mut x, mut y) = (DVec3::ZERO, DVec3::ZERO);
        (x[k], x[p], x[q]) = (far, -n[p] * n[k] / far, -n[q] * n[k] / far);
        (y[p], y[q]) = (n[q] / far, -n[p] / far);
        let rows = DMat3::from_cols(x * cos - y * sin, x * sin + y * cos, n);
        (rows.transpose(), n)
    }

    /// Orientation, and angular velocity in body axes, after a time.
    pub(super) fn at(&self, t: f64) -> (DMat3, DVec3) {
        let (turned, n) = self.about(t);
        (self.base * turned, n * self.gains)
    }
}

#[cfg(test)]
mod tests {
    use super::super::inertia::Inertia;
    use super::super::series::{LEFT_OUT, series};
    use super::*;
    use glam::DQuat;
    use plaus_dist::{Purpose, Seed, open_unit};

    /// Free rotation in many short steps of the series.
    fn walked(inertia: &Inertia, turn: DQuat, w: DVec3, t: f64) -> (DMat3, DVec3) {
        let (mut turn, mut w) = (turn, w);
        let i = inertia.moments;
        let fastest = ((i * w).dot(w) / i.min_element()).sqrt();
        let count = (4.0 * fastest * t / 0.29).ceil().max(1.0);
        for _ in 0..count as usize {
            (turn, w) = series(inertia, turn, w, t / count, LEFT_OUT).unwrap();
        }
        (DMat3::from_quat(turn), w)
    }

    fn apart(a: &(DMat3, DVec3), b: &(DMat3, DVec3)) -> f64 {
        assert!(a.0.is_finite() && a.1.is_finite());
        let turned = (0..3).map(|k| (a.0.col(k) - b.0.col(k)).length()).fold(0.0, f64::max);
        turned.max((a.1 - b.1).length() / b.1.length())
    }

    /// Bodies of all kinds of moments, nearly equal ones and flat or thin ones among them, that turn in all ways,
    /// nearly about an axis and near the separatrix among them: the closed form is where the series comes to in short
    /// steps.
    /// Two starts that differ by rounding go apart by as much as errors of the two may: where the body does not tumble
    /// like them, by 1e-15 for each radian and step; near the separatrix, by a factor that grows with each turn over,
    /// which the walk of a start that is off by 1e-13 tells.
    #[test]
    fn the_closed_form_is_where_short_steps_come_to() {
        let mut stream = Seed(20).chain(0).at(0, Purpose::START);
        let mut draw = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
        let (mut worst, mut tops) = (0.0_f64, 0);
        for case in 0..3000 {
            let mut moments = DVec3::new(1.0, draw(1.0, 2.0), draw(1.0, 2.0));
            match case % 5 {
                1 => moments.y = 1.0 + math::exp(draw(-32.0, -5.0)),
                2 => moments.z = moments.y * (1.0 + math::exp(draw(-32.0, -5.0))),
                3 => moments.z = moments.x + moments.y * draw(0.9, 0.9999),
                _ => {}
            }
            let mut w = DVec3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), draw(-1.0, 1.0));
            let axis = case / 5 % 3;
            match case / 15 % 4 {
                // Nearly about an axis; the middle one is near the separatrix.
                1 => w[axis] /= math::exp(draw(-30.0, -2.0)),
                2 => w[axis] *= math::exp(draw(-30.0, -2.0)),
                _ => {}
            }
            let by = case % 3;
            let around = |v: DVec3| [v, DVec3::new(v.y, v.z, v.x), DVec3::new(v.z, v.x, v.y)][by];
            let (inertia, w) = (Inertia::new(around(moments)), around(w).normalize() * draw(0.1, 30.0));
            let turn = DQuat::from_xyzw(draw(-1.0, 1.0), draw(-1.0, 1.0), draw(-1.0, 1.0), 0.3).normalize();
            let t = draw(0.1, 40.0) / w.length();
            let Some(top) = AsymmetricTop::new(inertia.moments, &DMat3::from_quat(turn), w) else { continue };
            tops += 1;
            let right = walked(&inertia, turn, w, t);
            let near = walked(&inertia, turn, w * (1.0 + 1e-13) + DVec3::splat(1e-13 * w.length()), t);
            let allowed = 0.1 * apart(&near, &right) + 1e-15 * (40.0 + 600.0);
            let off = apart(&top.at(t), &right).max(apart(&top.at(0.0), &(DMat3::from_quat(turn), w)));
            worst = worst.max(off / allowed);
            assert!(off <= allowed, "{case}: {} {w} {t}: {off:e} of {allowed:e}", inertia.moments);
        }
        assert!(tops > 2900 && worst > 0.01, "{tops} {worst}");
    }

    /// Any time gives finite numbers that keep energy and momentum, for moments that differ by rounding too.
    #[test]
    fn however_fast_a_body_turns_energy_and_momentum_are_kept() {
        for moments in [DVec3::new(1.0, 1.5, 2.2), DVec3::new(1.0, 1.0 + 2.0 * f64::EPSILON, 1.0 + f64::EPSILON) * 1e-7]
        {
            let inertia = Inertia::new(moments);
            for (speed, t) in [(1e-100, 1.0), (1e6, 10.0), (1e9, 1e3), (1e100, 1e3)] {
                let turn = DQuat::from_xyzw(0.3, 0.1, -0.7, 0.2).normalize();
                let w = DVec3::new(0.1, 0.7, -0.7) * speed;
                let top = AsymmetricTop::new(moments, &DMat3::from_quat(turn), w).unwrap();
                let (r, v) = top.at(t);
                let momentum = turn * (moments * w);
                assert!((r * (moments * v) - momentum).length() < 1e-14 * momentum.length(), "{speed}");
                // The energy of a speed of one unit.
                let energy = |w: DVec3| w.dot(inertia.moments * w);
                assert!((energy(v / speed) / energy(w / speed) - 1.0).abs() < 1e-14, "{speed}");
            }
        }
    }
}
