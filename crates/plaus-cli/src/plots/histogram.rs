//! How one number is spread over the solutions of a run, as text and as SVG.

use crate::svg::{Frame, PANEL, Svg};
use crate::table::{grouped, percent, short};
use plaus_scenes::Scalar;
use serde_json::{Value, json};

/// Fewest and most bins of numbers that are not whole.
const LEAST: u32 = 5;
const MOST: u32 = 24;
/// Most bins of whole numbers: beyond that, several share one.
const MOST_WHOLE: f64 = 60.0;
/// Most bins of a width that is asked for.
const MOST_ASKED: u32 = 1000;
/// Most bars that have their number below and their share above them in a picture.
const MOST_LABELLED: usize = 12;
/// Columns of the longest bar on a terminal.
const WIDE: f64 = 40.0;

/// A histogram of a number.
pub(crate) struct Histogram {
    title: String,
    /// Left edge of the first bin, and the width of each.
    from: f64,
    width: f64,
    /// Draws in each bin.
    bins: Vec<u64>,
    /// Whether a bin holds one whole number.
    whole: bool,
    /// Draws for which the number is undefined.
    undefined: u64,
    /// Whether draws are independent, so that shares have a standard error.
    independent: bool,
}

/// Bins that are asked for: their width, and one of their edges.
pub(crate) type Bins = [f64; 2];

impl Histogram {
    /// The spread of a scalar, of which each value was recorded so many times, in the bins that are asked for, or in as
    /// many as the number of values suggests.
    ///
    /// # Errors
    /// What to do, if the bins that are asked for are too many.
    pub(crate) fn of(
        scalar: &Scalar,
        bins: Option<Bins>,
        independent: bool,
        values: impl Iterator<Item = (u64, f64)> + Clone,
    ) -> Result<Self, String> {
        let finite = || values.clone().filter(|(_, value)| value.is_finite());
        let (count, low, high) = finite()
            .fold((0_u32, f64::INFINITY, f64::NEG_INFINITY), |(count, low, high), (_, value)| {
                (count.saturating_add(1), value.min(low), value.max(high))
            });
        let whole = scalar.whole && high - low < MOST_WHOLE;
        let by_width = bins.map(|[width, edge]| {
            let [first, last] = [low, high].map(|end| ((end - edge) / width).floor());
            (edge + width * first, width, last - first + 1.0)
        });
        if let Some((.., bins)) = by_width.filter(|(.., bins)| count > 0 && !whole && *bins > f64::from(MOST_ASKED)) {
            let name = &scalar.name;
            let (ends, least) = ([low, high].map(short), rounded_up((high - low) / f64::from(MOST_ASKED - 1)));
            let [low, high] = ends;
            return Err(format!(
                "--bin: {name} goes from {low} to {high}, which is {bins:.0} bins; there may be {MOST_ASKED}, so take a \
                 width of {least} or more"
            ));
        }
        let (from, width, bins) = match whole {
            _ if count == 0 => (0.0, 1.0, 0),
            false if let Some((from, width, bins)) = by_width => (from, width, bins as usize),
            true => (low - 0.5, 1.0, (high - low) as usize + 1),
            false if high > low => {
                // As many bins as Sturges has for a bell curve.
                let bins = (u32::ilog2(count) + 2).clamp(LEAST, MOST);
                (low, (high - low) / f64::from(bins), bins as usize)
            }
            false => (low - 0.5, 1.0, 1),
        };
        let title = scalar.name.clone();
        let mut histogram = Self { title, from, width, bins: vec![0; bins], whole, undefined: 0, independent };
        if !scalar.unit.is_empty() {
            histogram.title += &format!(" ({})", scalar.unit);
        }
        for (draws, value) in values {
            match value.is_finite() {
                true => histogram.bins[(((value - from) / width) as usize).min(bins.saturating_sub(1))] += draws,
                false => histogram.undefined += draws,
            }
        }
        Ok(histogram)
    }

    fn draws(&self) -> u64 {
        self.bins.iter().sum::<u64>() + self.undefined
    }

    /// The edge before a bin.
    fn edge(&self, bin: usize) -> f64 {
        self.from + self.width * bin as f64
    }

    /// The whole number of a bin.
    fn number(&self, bin: usize) -> String {
        format!("{:.0}", self.edge(bin) + 0.5)
    }

    /// One bar a bin, with its share, and the share's standard error if draws are independent.
    pub(crate) fn in_words(&self) -> String {
        let label = |bin: usize| match self.whole {
            true => self.number(bin),
            false => format!("{} to {}", short(self.edge(bin)), short(self.edge(bin + 1))),
        };
        let labels: Vec<String> = (0..self.bins.len()).map(label).collect();
        let widest = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
        let (most, all) = (self.bins.iter().max().copied().unwrap_or(0).max(1) as f64, self.draws().max(1) as f64);
        let mut text = format!("{}\n", self.title);
        for (label, &draws) in labels.iter().zip(&self.bins) {
            let bar = bar(WIDE * draws as f64 / most);
            let share = draws as f64 / all;
            let error = match self.independent {
                true => format!(" ± {}", percent((share * (1.0 - share) / all).sqrt())),
                false => String::new(),
            };
            text += &format!("  {label:>widest$}  {bar} {} {}{error}\n", grouped(draws), percent(share));
        }
        if self.undefined > 0 {
            text += &format!("  no value in {} of {} draws\n", grouped(self.undefined), grouped(self.draws()));
        }
        text
    }

    /// Its bins, with their edges and draws.
    pub(crate) fn to_json(&self) -> Value {
        let bin = |(bin, draws): (usize, &u64)| match self.whole {
            true => json!({ "value": self.edge(bin) + 0.5, "draws": draws }),
            false => json!({ "from": self.edge(bin), "to": self.edge(bin + 1), "draws": draws }),
        };
        let bins: Vec<Value> = self.bins.iter().enumerate().map(bin).collect();
        json!({ "number": self.title, "bins": bins, "undefined": self.undefined })
    }

    /// One panel.
    pub(crate) fn draw(&self, svg: &mut Svg, number: u32) {
        let all = self.draws().max(1) as f64;
        let most = self.bins.iter().max().copied().unwrap_or(0) as f64 / all;
        let frame = Frame::new(number, [self.from, self.edge(self.bins.len())], [0.0, most]);
        let labelled = self.whole && self.bins.len() <= MOST_LABELLED;
        match labelled {
            true => drop(svg.plain_axes(&frame, "share", &self.title)),
            false => svg.axes(&frame, "share", &self.title),
        }
        for (bin, &draws) in self.bins.iter().enumerate() {
            let (from, share) = (self.edge(bin), draws as f64 / all);
            svg.column(&frame, [from, self.edge(bin + 1)], share);
            if labelled {
                svg.label(&frame, [from + 0.5, share], &self.number(bin), &percent(share));
            }
        }
    }
}

/// A number of two digits that is no smaller: rounding takes off at most a twentieth.
fn rounded_up(least: f64) -> String {
    format!("{:.1e}", 1.06 * least).parse::<f64>().map_or_else(|_| least.to_string(), |number| number.to_string())
}

/// Histograms beside each other.
pub(crate) fn picture(histograms: &[Histogram]) -> String {
    let mut svg = Svg::new(histograms.len().max(1) * PANEL[0] as usize, PANEL[1] as usize);
    (0..).zip(histograms).for_each(|(number, histogram)| histogram.draw(&mut svg, number));
    svg.finish()
}

/// A bar of so many columns, to an eighth of one.
fn bar(columns: f64) -> String {
    const PARTS: [&str; 8] = ["", "▏", "▎", "▍", "▌", "▋", "▊", "▉"];
    let eighths = (8.0 * columns).round() as usize;
    format!("{}{}", "█".repeat(eighths / 8), PARTS[eighths % 8])
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_scenes::Role;

    fn scalar(whole: bool) -> Scalar {
        Scalar { name: "x".into(), unit: "m", role: Role::Outcome, base: "x".into(), member: None, whole }
    }

    #[test]
    fn every_draw_is_in_one_bin() {
        let values: Vec<(u64, f64)> = (0..100).map(|k| (1 + k % 3, 0.37 * k as f64)).collect();
        let histogram = Histogram::of(&scalar(false), None, false, values.iter().copied()).unwrap();
        assert_eq!(histogram.bins.iter().sum::<u64>(), values.iter().map(|(draws, _)| draws).sum::<u64>());
        assert!(histogram.bins.iter().all(|&draws| draws > 0));
        let twice = Histogram::of(&scalar(true), None, false, [(2, 3.0), (1, 6.0), (4, f64::NAN)].into_iter()).unwrap();
        assert_eq!((twice.bins.as_slice(), twice.undefined), (&[2, 0, 0, 1][..], 4));
        assert!(twice.in_words().contains("no value in 4 of 7 draws"), "{}", twice.in_words());
    }

    #[test]
    fn bins_that_are_asked_for_have_the_edge_that_is_asked_for() {
        let of = |bins| Histogram::of(&scalar(false), Some(bins), true, [(1, -21.0), (3, 9.9), (2, 10.1)].into_iter());
        let (middle, edge) = (of([20.0, 10.0]).unwrap(), of([20.0, 0.0]).unwrap());
        let error = of([0.01, 0.0]).map(|_| ()).unwrap_err();
        assert!(error.contains("from -21") && error.contains("is 3111 bins; there may be 1000"), "{error}");
        // What is advised is accepted.
        for (range, asked) in [(31.1, 0.01), (0.1234, 1e-5), (9.99e6, 1.0), (99.9, 1e-3)] {
            let of = |width: f64| {
                let values = [(1, 0.0), (1, range)].into_iter();
                Histogram::of(&scalar(false), Some([width, 0.0]), true, values)
            };
            let error = of(asked).map(|_| ()).unwrap_err();
            let advised = error.split("width of ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
            assert!(of(advised.parse().unwrap()).is_ok(), "{error}");
        }
        assert!(Histogram::of(&scalar(true), Some([0.01, 0.0]), true, [(1, 0.0), (1, 20.0)].into_iter()).is_ok());
        assert_eq!((middle.from, middle.bins.as_slice()), (-30.0, &[1, 3, 2][..]));
        assert_eq!((edge.from, edge.bins.as_slice()), (-40.0, &[1, 0, 5][..]));
        // The standard error of 3 of 6 is the root of 0.5 · 0.5 / 6.
        assert!(middle.in_words().contains("3 50.0% ± 20.4%"), "{}", middle.in_words());
    }

    #[test]
    fn whole_numbers_stand_below_their_bars() {
        let histogram = Histogram::of(&scalar(true), None, false, [(3, 1.0), (1, 2.0)].into_iter()).unwrap();
        let svg = picture(&[histogram]);
        assert!(svg.contains(">1</text>") && svg.contains(">75.0%</text>") && !svg.contains("0.5000"), "{svg}");
    }

    #[test]
    fn one_value_and_none_are_drawn_too() {
        for values in [vec![(3, 0.25)], vec![(1, f64::NAN)], vec![]] {
            let svg = picture(&[Histogram::of(&scalar(false), None, false, values.into_iter()).unwrap()]);
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{svg}");
        }
    }
}
