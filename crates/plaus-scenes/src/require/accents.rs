//! How strong impacts are beside each other.

use super::score::{FAR, Mark};
use crate::settings::settings;
use plaus_dist::math;

settings! {
    /// Impulses of impacts on beats are in proportion to the strengths of these.
    pub struct Accents {
        /// The impulse at the strongest beat. Unset: any.
        #[schemars(extend("x-example" = 0.02))]
        loudest_n_s: Option<f64>, 1e-9..=1e6, "N·s";
        /// By which part an impulse may be off: 0.25 allows all from 1/1.25 of it to 1.25 times it.
        within: f64 = 0.25, 1e-3..=100.0;
        /// By which part farther off costs one nat.
        scale: f64 = 0.1, 1e-6..=1e3;
        /// Impulses are in proportion to this power of strengths: at 2, twice the strength is four times the impulse.
        power: f64 = 1.0, 0.01..=10.0;
    }
}

/// An impact, by its impulse in N s, and the strength that it should have.
pub(super) type Hit = [f64; 2];

impl Accents {
    /// The mark of impacts that are exactly as strong as they should be.
    pub(super) fn best(&self) -> Mark {
        Mark::of(math::ln_1p(self.within) / math::ln_1p(self.scale))
    }

    /// The mark of impacts, beside the strength of the strongest beat. Each that is off costs what it lacks, where the
    /// impulse at the strongest beat is the best for all; the margin is that of the worst, where it is best for that.
    /// More impacts never make the mark better.
    pub(super) fn mark(&self, hits: &[Hit], strongest: f64) -> Mark {
        let [within, scale] = [self.within, self.scale].map(math::ln_1p);
        let off = |[impulse, strength]: &Hit| {
            math::ln(impulse.max(f64::MIN_POSITIVE)) - self.power * math::ln(strength / strongest)
        };
        let offs: Vec<f64> = hits.iter().map(off).collect();
        let [least, most] = offs.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
        if offs.is_empty() {
            return self.best();
        }
        let (middle, worst) = match self.loudest_n_s.map(math::ln) {
            Some(said) => (said, (most - said).max(said - least)),
            None => (cheapest(&offs, within), 0.5 * (most - least)),
        };
        let margin = ((within - worst) / scale).clamp(-FAR, FAR);
        let lacking = |off: &f64| ((off - middle).abs() - within).max(0.0) / scale;
        let cost = offs.iter().map(lacking).sum::<f64>().min(FAR);
        Mark { margin, log: if margin >= 0.0 { 0.0 } else { -cost } }
    }
}

/// Where all that numbers lie farther away than `within` has the least sum: that sum is convex, and its slope grows by
/// 1 at each end of each number's range, from minus their count on.
fn cheapest(numbers: &[f64], within: f64) -> f64 {
    let mut ends: Vec<f64> = numbers.iter().flat_map(|number| [number - within, number + within]).collect();
    ends.sort_by(f64::total_cmp);
    ends[numbers.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::{Purpose, Seed};
    use rand::RngExt;

    /// No impulse at the strongest beat costs less than the one that is chosen, among many.
    #[test]
    fn the_scale_is_the_cheapest() {
        let mut stream = Seed(4).chain(0).at(0, Purpose::START);
        for _ in 0..200 {
            let accents = Accents { within: stream.random_range(0.01..0.5), ..Accents::default() };
            let mut hit = || [stream.random_range(0.1..9.0), stream.random_range(1.0..127.0)];
            let hits: Vec<Hit> = (0..7).map(|_| hit()).collect();
            let free = accents.mark(&hits, 127.0);
            let fixed = (0..4000).map(|k| {
                let loudest_n_s = Some(math::exp(-3.0 + 0.002 * f64::from(k)));
                Accents { loudest_n_s, ..accents.clone() }.mark(&hits, 127.0)
            });
            let best =
                fixed.fold([f64::NEG_INFINITY; 2], |[margin, log], mark| [margin.max(mark.margin), log.max(mark.log)]);
            // A step is 0.002, and a nat 0.095, for each of seven; sums are off by rounding.
            let off = [free.margin - best[0], free.log - best[1]];
            assert!(off[0] > -1e-9 && off[0] < 0.02 && off[1] > -1e-9 && off[1] < 0.15, "{free:?} {best:?}");
            let fewer = accents.mark(&hits[..5], 127.0);
            assert!(fewer.margin >= free.margin && fewer.log >= free.log - 1e-9);
        }
        let accents = Accents { within: 0.1, scale: 0.1, power: 2.0, ..Accents::default() };
        let mark = accents.mark(&[[0.04, 2.0], [0.01, 1.0]], 2.0);
        assert!((mark.margin - 1.0).abs() < 1e-12 && mark.log == 0.0, "{mark:?}");
    }
}
