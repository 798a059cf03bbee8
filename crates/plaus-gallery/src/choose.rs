//! Choosing solutions that differ.
//!
//! Farthest-first traversal (Gonzalez 1985): the next solution is always the one farthest from all chosen so far. So
//! any solution that is left out is at most twice as far from a chosen one as it would be in the best choice of that
//! many.

use crate::features::squared;
use rayon::prelude::*;

/// Chooses up to `count` rows, beginning with `first`; in the order of choice. Rows equal to a chosen one come last, in
/// their own order.
#[must_use]
pub fn farthest_first(rows: &[Vec<f32>], first: usize, count: usize) -> Vec<usize> {
    let mut chosen = Vec::new();
    let mut distances = vec![f64::INFINITY; rows.len()];
    let mut next = first;
    while chosen.len() < count.min(rows.len()) {
        chosen.push(next);
        distances.par_iter_mut().enumerate().for_each(|(index, distance)| {
            *distance = distance.min(squared(&rows[index], &rows[next]));
        });
        distances[next] = -1.0;
        let farthest = distances.iter().enumerate().reduce(|a, b| if b.1 > a.1 { b } else { a });
        let Some((index, _)) = farthest else { break };
        next = index;
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_the_farthest_from_those_before() {
        let rows: Vec<Vec<f32>> = [0.0, 1.0, 9.0, 10.0, 4.0].map(|x| vec![x]).to_vec();
        assert_eq!(farthest_first(&rows, 0, 3), [0, 3, 4]);
        assert_eq!(farthest_first(&rows, 0, 9).len(), 5);
        let mut all = farthest_first(&vec![vec![1.0]; 4], 2, 4);
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2, 3]);
    }
}
