//! Times that requirements ask for, beside those that solutions found: a picture.

use crate::svg::{Frame, PANEL, Svg};
use plaus_run::{Error, RunOf, solutions};
use plaus_scenes::Scene;
use plaus_scenes::require::Probe;

/// Solutions that are looked at: each is simulated again.
const MOST: usize = 64;

/// What one requirement asked for, over all solutions looked at.
#[derive(Default)]
struct Asked {
    key: String,
    /// Middle and half width of each window, in s.
    wanted: Vec<[f64; 2]>,
    /// Middle of the window, and the time found, in s.
    found: Vec<[f64; 2]>,
}

/// The picture, and how many solutions are in it; `None` where nothing asks for a time, or there are no solutions.
///
/// # Errors
/// [`Error`] where the run cannot be read, or a solution not be simulated.
pub(crate) fn plot<S: Scene>(run: &RunOf<'_, S>) -> Result<Option<String>, Error> {
    let (scene, demands) = (run.scene(), run.scene().demands());
    let cast = scene.cast();
    let mut asked: Vec<Asked> = demands.iter().map(|(key, _)| Asked { key: key.clone(), ..Asked::default() }).collect();
    for solution in solutions::distinct(run)?.iter().take(MOST) {
        let draw = run.sample(solution.sample)?.state.draw;
        let motion = scene.motion(&draw).map_err(|error| Error::Sampling(error.to_string()))?;
        let probe = Probe::whole(&motion, &cast);
        for (asked, (_, require)) in asked.iter_mut().zip(&demands) {
            for timed in require.times(&probe) {
                let (from, to) = (timed.wanted.from, timed.wanted.to);
                let middle = 0.5 * (from + to);
                if !middle.is_finite() {
                    continue; // a window with an open end has no time that is meant
                }
                if asked.wanted.iter().all(|known| known[0] != middle) {
                    asked.wanted.push([middle, 0.5 * (to - from)]);
                }
                asked.found.extend(timed.found.map(|found| [middle, found]));
            }
        }
        if asked.iter().all(|one| one.wanted.is_empty()) {
            return Ok(None);
        }
    }
    asked.retain(|one| !one.wanted.is_empty());
    Ok((!asked.is_empty()).then(|| picture(&asked)))
}

/// Left: times found over times asked for. Right: how far off, with the windows.
fn picture(asked: &[Asked]) -> String {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let room = 0.05 * (high - low);
        [low - room, high + room]
    };
    let off = |[wanted, found]: [f64; 2]| 1e3 * (found - wanted);
    let windows = || asked.iter().flat_map(|one| &one.wanted);
    let times =
        range(&mut windows().map(|window| window[0]).chain(asked.iter().flat_map(|one| &one.found).map(|at| at[1])));
    let edges = windows().flat_map(|window| [-1e3 * window[1], 1e3 * window[1]]);
    let misses = range(&mut edges.chain(asked.iter().flat_map(|one| &one.found).map(|at| off(*at))));
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
