//! Which variables bear upon what becomes of things: their own, and those of all that they met.

use super::joints::Bond;

/// The variables of each thing, and what holds things together. Things are bodies, then pieces of scenery.
#[derive(Debug, Clone, Default)]
pub(super) struct Bearing {
    /// For each thing, the variables that its numbers follow from.
    pub(super) of: Vec<Vec<usize>>,
    /// Pairs of bodies that a joint holds together.
    pub(super) held: Vec<[usize; 2]>,
    /// How many things can be pushed. They come first; nothing pushes others by way of scenery or driven bodies.
    pub(super) free: usize,
}

impl Bearing {
    /// Adds a joint and its variables.
    pub(super) fn joined(&mut self, bond: &Bond, vars: Vec<usize>) {
        self.held.extend(bond.pair());
        let held = (0..self.free).find(|&body| bond.holds_body(body));
        held.into_iter().for_each(|body| self.of[body].extend(&vars));
    }

    /// Adds variables on which all things depend.
    pub(super) fn on_all(&mut self, vars: &[usize]) {
        self.of.iter_mut().for_each(|of| of.extend(vars));
    }

    /// Adds the variables of what each thing is made of.
    pub(super) fn made_of(&mut self, substances: impl Iterator<Item = usize>, vars: &[Vec<usize>]) {
        self.of.iter_mut().zip(substances).for_each(|(of, substance)| of.extend(&vars[substance]));
    }

    /// Whether each of `count` variables belongs to one of these bodies, or to a thing that they met, directly or
    /// through other bodies that can be pushed.
    pub(super) fn upon(&self, bodies: &[bool], met: &[[u32; 2]], count: usize) -> Vec<bool> {
        let met = || met.iter().map(|pair| pair.map(|thing| thing as usize)).chain(self.held.iter().copied());
        let mut reached = bodies.to_vec();
        reached.resize(self.of.len(), false);
        let mut is_more = true;
        while is_more {
            is_more = false;
            for (a, b) in met().flat_map(|[a, b]| [(a, b), (b, a)]) {
                if a < self.free && reached[a] && !reached[b] {
                    (reached[b], is_more) = (true, true);
                }
            }
        }
        let mut bears = vec![false; count];
        let of = self.of.iter().zip(&reached).filter(|(_, is_reached)| **is_reached);
        of.flat_map(|(vars, _)| vars).for_each(|&var| bears[var] = true);
        bears
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two balls that hit each other on a floor, a third one on the same floor, and a fourth one on a rope to the
    /// first.
    #[test]
    fn what_pushes_bears_and_the_floor_passes_nothing_on() {
        let of = vec![vec![0], vec![1], vec![2], vec![3], vec![4, 5]];
        let bearing = Bearing { of, held: vec![[0, 3]], free: 4 };
        let met = [[0, 4], [0, 1], [2, 4]];
        let upon = |thing: usize, met: &[[u32; 2]]| {
            let bodies: Vec<bool> = (0..4).map(|k| k == thing).collect();
            (0..6).filter(|&var| bearing.upon(&bodies, met, 6)[var]).collect::<Vec<_>>()
        };
        assert_eq!(upon(1, &met), [0, 1, 3, 4, 5]);
        assert_eq!(upon(2, &met), [2, 4, 5]);
        assert_eq!(upon(1, &[]), [1]);
    }
}
