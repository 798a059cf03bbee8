//! Classical multidimensional scaling (Torgerson 1952): points in the plane whose distances are as close to given ones
//! as a projection can.

use crate::features::squared;
use plaus_dist::math::square;

/// Steps of the power iteration; enough for a map that is only looked at.
const STEPS: usize = 300;

/// Two maps of the same solutions, in their order.
#[derive(Debug, Clone, Default)]
pub(crate) struct Maps {
    /// Solutions whose bodies end in similar places are near each other.
    pub outcomes: Vec<[f64; 2]>,
    /// Solutions whose bodies move in similar ways are near each other.
    pub paths: Vec<[f64; 2]>,
}

/// A map of the rows, in their unit.
#[must_use]
pub(crate) fn of(rows: &[Vec<f32>]) -> Vec<[f64; 2]> {
    let n = rows.len();
    let mut gram: Vec<f64> = (0..n * n).map(|k| -0.5 * squared(&rows[k / n], &rows[k % n])).collect();
    // Double centring: −½ times the squared distances become inner products about the centre.
    let means: Vec<f64> = gram.chunks(n.max(1)).map(|row| row.iter().sum::<f64>() / n as f64).collect();
    let mean = means.iter().sum::<f64>() / n.max(1) as f64;
    gram.iter_mut().enumerate().for_each(|(k, value)| *value += mean - means[k / n] - means[k % n]);
    let first = principal(&gram, n, &[]);
    let second = principal(&gram, n, &first);
    first.into_iter().zip(second).map(|(x, y)| [x, y]).collect()
}

/// The eigenvector of the largest eigenvalue orthogonal to `without`, as long as the eigenvalue's root.
fn principal(gram: &[f64], n: usize, without: &[f64]) -> Vec<f64> {
    // Any start with a component along it will do; this one is the same every time.
    let mut vector: Vec<f64> = (0..n).map(|k| ((k * 7919 + 13) % 101) as f64 / 101.0 - 0.5).collect();
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut value = 0.0;
    for _ in 0..STEPS {
        let share = without.iter().zip(&vector).map(|(a, b)| a * b).sum::<f64>() / square(length(without)).max(1e-300);
        vector.iter_mut().zip(without).for_each(|(v, w)| *v -= share * w);
        let size = length(&vector);
        if size < 1e-12 {
            return vec![0.0; n];
        }
        vector.iter_mut().for_each(|v| *v /= size);
        let next: Vec<f64> =
            gram.chunks(n).map(|row| row.iter().zip(&vector).map(|(a, b)| a * b).sum::<f64>()).collect();
        value = length(&next);
        if value < 1e-12 {
            return vec![0.0; n];
        }
        vector = next.iter().map(|v| v / value).collect();
    }
    vector.iter().map(|v| v * value.sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_plane_keep_their_distances() {
        let rows: Vec<Vec<f32>> =
            [[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [3.0, 1.0, 1.0], [0.0, 1.5, 1.0]].map(Vec::from).to_vec();
        let map = of(&rows);
        for a in 0..4 {
            for b in 0..4 {
                let [x, y] = [map[a][0] - map[b][0], map[a][1] - map[b][1]];
                assert!((x * x + y * y - squared(&rows[a], &rows[b])).abs() < 1e-6, "{a} {b}");
            }
        }
    }

    #[test]
    fn equal_solutions_are_all_in_the_middle() {
        assert_eq!(of(&vec![vec![2.0]; 3]), [[0.0; 2]; 3]);
        assert_eq!(of(&[vec![2.0]]), [[0.0; 2]]);
        assert!(of(&[]).is_empty());
    }
}
