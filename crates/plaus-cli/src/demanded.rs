//! A plot of the times that requirements ask for, against the times in the solutions found.

use crate::svg::{Frame, PANEL, Svg};
use plaus_run::replay::replay_each;
use plaus_run::{Error, RunReader, SampleId, solutions};
use plaus_scenes::require::Timed;

/// Largest number of solutions in the plot: each is simulated again.
const MOST: usize = 64;

/// What one requirement asked for, over all solutions in the plot.
#[derive(Default)]
struct Asked {
    key: String,
    /// Middle and half width of each window, in s.
    wanted: Vec<[f64; 2]>,
    /// Middle of the window, and the time found, in s.
    found: Vec<[f64; 2]>,
}

/// The plot; `None` if nothing asks for a time, or there are no solutions.
///
/// # Errors
/// [`Error`] if the run cannot be read, or a solution not be simulated.
pub(crate) fn plot(run: &RunReader<'_>) -> Result<Option<String>, Error> {
    let samples: Vec<SampleId> = solutions::distinct(run)?.iter().take(MOST).map(|one| one.sample).collect();
    let times = |some| replay_each(run, some, |replay| run.scene().times(&replay.animation));
    let (first, others) = samples.split_at(samples.len().min(1));
    let mut found = times(first)?;
    if found.iter().flatten().any(|(_, timed)| middle(timed).is_some()) {
        found.extend(times(others)?);
    }
    let mut asked: Vec<Asked> = Vec::new();
    for (key, timed) in found.into_iter().flatten() {
        let Some(middle) = middle(&timed) else { continue };
        let known = asked.iter().position(|one| one.key == key);
        let index = known.unwrap_or_else(|| {
            asked.push(Asked { key, ..Asked::default() });
            asked.len() - 1
        });
        let one = &mut asked[index];
        if one.wanted.iter().all(|known| known[0] != middle) {
            one.wanted.push([middle, 0.5 * (timed.wanted.to - timed.wanted.from)]);
        }
        one.found.extend(timed.found.map(|found| [middle, found]));
    }
    Ok((!asked.is_empty()).then(|| picture(&asked)))
}

/// The time asked for: the middle of the window. A window with an open end has none.
fn middle(timed: &Timed) -> Option<f64> {
    Some(0.5 * (timed.wanted.from + timed.wanted.to)).filter(|middle| middle.is_finite())
}

/// Left: times found against times asked for. Right: the difference, with the windows.
fn picture(asked: &[Asked]) -> String {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let room = 0.05 * (high - low);
        [low - room, high + room]
    };
    let off = |[wanted, found]: [f64; 2]| 1e3 * (found - wanted);
    let windows = || asked.iter().flat_map(|one| &one.wanted);
    let found = || asked.iter().flat_map(|one| &one.found);
    let times = range(&mut windows().map(|window| window[0]).chain(found().map(|at| at[1])));
    let edges = windows().flat_map(|window| [-1e3 * window[1], 1e3 * window[1]]);
    let misses = range(&mut edges.chain(found().map(|at| off(*at))));
    let legend = 26.0 * asked.len() as f64;
    let mut svg = Svg::new(2 * PANEL[0] as usize, (PANEL[1] + legend) as usize);
    let both = Frame::new(0, times, times);
    svg.axes(&both, "found (s)", "asked for (s)");
    svg.segment(&both, [times[0]; 2], [times[1]; 2]);
    let apart = Frame::new(1, times, misses);
    svg.axes(&apart, "found − asked for (ms), windows as bars", "asked for (s)");
    svg.level(&apart, 0.0);
    for (number, one) in asked.iter().enumerate() {
        for [middle, half] in &one.wanted {
            svg.band(&apart, number, *middle, [-1e3 * half, 1e3 * half]);
        }
        for at in &one.found {
            svg.dot(&both, number, *at);
            svg.dot(&apart, number, [at[0], off(*at)]);
        }
        svg.legend(number, PANEL[1] + 26.0 * number as f64, &one.key);
    }
    svg.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_time_that_all_found_is_drawn_too() {
        let asked = Asked { key: "a<b".into(), wanted: vec![[0.5, 0.0]], found: vec![[0.5, 0.5]; 3] };
        let svg = picture(&[asked, Asked { wanted: vec![[0.5, 0.01]], ..Asked::default() }]);
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 6 + 2, "dots of both panels, and of the legend");
    }
}
