//! How animations differ: numbers whose Euclidean distance says how far apart the bodies are, in metres.

use plaus_scenes::animation::{Animation, Track};
use std::collections::{BTreeMap, BTreeSet};

/// Moments at which paths are compared: at equal shares of each animation's duration.
const MOMENTS: usize = 32;

/// Where the bodies of one animation are.
#[derive(Debug, Clone)]
pub(crate) struct Paths {
    /// For each body: three coordinates for each moment.
    paths: BTreeMap<String, Vec<f32>>,
    /// For each body: position at the end, and orientation if it has one.
    outcomes: BTreeMap<String, Vec<f32>>,
}

impl Paths {
    /// Samples an animation.
    #[must_use]
    pub(crate) fn of(animation: &Animation) -> Self {
        let moments: Vec<f64> =
            (0..MOMENTS).map(|k| animation.motion.duration * (k + 1) as f64 / MOMENTS as f64).collect();
        let path = |track: &Track| -> Vec<f32> {
            moments.iter().flat_map(|&time| track.position(time).as_vec3().to_array()).collect()
        };
        let outcome = |track: &Track| -> Vec<f32> {
            let mut place = track.position(animation.motion.duration).as_vec3().to_array().to_vec();
            // Turning a body moves points on its surface.
            let turned = glam::DMat3::from_quat(track.orientation(animation.motion.duration)) * track.shape.reach();
            place.extend(turned.to_cols_array().map(|x| x as f32));
            place
        };
        let each = |feature: &dyn Fn(&Track) -> Vec<f32>| -> BTreeMap<String, Vec<f32>> {
            animation.motion.tracks.iter().map(|track| (track.name.clone(), feature(track))).collect()
        };
        Self { paths: each(&path), outcomes: each(&outcome) }
    }
}

/// One row of numbers for each animation.
#[derive(Debug, Clone, Default)]
pub(crate) struct Features {
    /// Where bodies go.
    pub paths: Vec<Vec<f32>>,
    /// Where they end.
    pub outcomes: Vec<Vec<f32>>,
}

impl Features {
    /// Rows of equal length. If an animation lacks a body, the body's mean place in the others is used.
    #[must_use]
    pub(crate) fn of(animations: Vec<Paths>) -> Self {
        let (paths, outcomes) = animations.into_iter().map(|one| (one.paths, one.outcomes)).unzip();
        Self { paths: rows(paths), outcomes: rows(outcomes) }
    }
}

fn rows(animations: Vec<BTreeMap<String, Vec<f32>>>) -> Vec<Vec<f32>> {
    let names: BTreeSet<String> = animations.iter().flat_map(|bodies| bodies.keys().cloned()).collect();
    let mut rows = vec![Vec::new(); animations.len()];
    for name in &names {
        let there: Vec<&Vec<f32>> = animations.iter().filter_map(|bodies| bodies.get(name)).collect();
        let width = there.first().map_or(0, |values| values.len());
        let mean: Vec<f32> = (0..width)
            .map(|k| there.iter().map(|values| f64::from(values[k])).sum::<f64>() / there.len() as f64)
            .map(|mean| mean as f32)
            .collect();
        for (row, bodies) in rows.iter_mut().zip(&animations) {
            row.extend(bodies.get(name).unwrap_or(&mean));
        }
    }
    // Root mean squares over bodies and moments: in metres, whatever the number of bodies and moments.
    let scale = rows.first().map_or(1.0, |row: &Vec<f32>| (3.0 / row.len().max(3) as f32).sqrt());
    rows.iter_mut().flatten().for_each(|value| *value *= scale);
    rows
}

/// Squared distance of two rows.
#[must_use]
pub(crate) fn squared(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a - b) * f64::from(a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use plaus_scenes::animation::{Look, Piece, Shape};

    fn animation(names: &[&str], x: f64) -> Animation {
        let piece = Piece::resting(0.0, DVec3::new(x, 0.0, 0.0));
        let track = |name: &&str| Track::new(*name, Shape::ball(0.1), Look::nth(0), vec![piece]);
        Animation::new(1.0, names.iter().map(track).collect(), vec![])
    }

    #[test]
    fn distances_are_root_mean_squares_in_metres() {
        let both = [animation(&["a", "b"], 0.0), animation(&["a", "b"], 0.5)];
        let features = Features::of(both.iter().map(Paths::of).collect());
        assert!((squared(&features.paths[0], &features.paths[1]).sqrt() - 0.5).abs() < 1e-6);
        assert!(squared(&features.outcomes[0], &features.outcomes[1]) > 0.0);
    }

    #[test]
    fn a_body_that_is_not_everywhere_makes_no_difference_by_itself() {
        let some = [animation(&["a", "b"], 0.0), animation(&["a"], 0.0)];
        let features = Features::of(some.iter().map(Paths::of).collect());
        assert_eq!(features.paths[0], features.paths[1]);
    }
}
