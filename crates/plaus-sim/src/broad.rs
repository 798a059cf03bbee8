//! The broad phase: which boxes meet a given box, without testing all of them.
//!
//! The boxes are in a binary tree whose leaves are sorted by place: halves of halves along the longest side. A box that
//! changes is updated up to the root; after as many changes as there are boxes, the tree is sorted again. So a query
//! costs about the logarithm of the number of boxes. Results come in ascending order, so nothing depends on the shape
//! of the tree.

use crate::scenery::Aabb;
use glam::DVec3;

/// Up to this many boxes, all are tested: scanning so few costs no more than a tree.
const FEW: usize = 24;

/// A tree over boxes that its owner keeps.
#[derive(Debug, Clone, Default)]
pub(crate) struct BoxTree {
    /// The box of each leaf.
    order: Vec<u32>,
    /// The leaf of each box.
    leaf: Vec<u32>,
    /// Root at 1, children of `k` at `2k` and `2k + 1`, leaves from `first` on.
    nodes: Vec<Aabb>,
    first: usize,
    changes: usize,
}

impl BoxTree {
    /// A tree over these boxes.
    pub(crate) fn new(boxes: &[Aabb]) -> Self {
        let mut tree = Self::default();
        tree.sort(boxes);
        tree
    }

    /// Forgets the tree: the boxes are new.
    pub(crate) fn reset(&mut self) {
        self.order.clear();
    }

    /// Updates the tree after a box has changed.
    pub(crate) fn change(&mut self, k: usize, to: &Aabb) {
        self.changes += 1;
        if self.order.is_empty() {
            return;
        }
        let mut at = self.first + self.leaf[k] as usize;
        self.nodes[at] = *to;
        while at > 1 {
            at /= 2;
            let both = self.nodes[2 * at].union(self.nodes[2 * at + 1]);
            if self.nodes[at] == both {
                break;
            }
            self.nodes[at] = both;
        }
    }

    /// Sets `found` to the boxes that have a point in common with `around`, in ascending order.
    pub(crate) fn meeting(&mut self, boxes: &[Aabb], around: &Aabb, found: &mut Vec<u32>) {
        found.clear();
        if boxes.len() <= FEW {
            found.extend((0..boxes.len() as u32).filter(|&k| boxes[k as usize].meets(around)));
            return;
        }
        if self.order.len() != boxes.len() || self.changes >= boxes.len() {
            self.sort(boxes);
        }
        self.find(around, found);
    }

    /// The same for a tree whose boxes do not change.
    pub(crate) fn find(&self, around: &Aabb, found: &mut Vec<u32>) {
        self.search(|node| node.meets(around), found);
    }

    /// The boxes that are no farther than `reach` from a point, likewise.
    pub(crate) fn within(&self, x: DVec3, reach: f64, found: &mut Vec<u32>) {
        let squared = reach * reach;
        self.search(|node| (x - x.clamp(node.min, node.max)).length_squared() <= squared, found);
    }

    fn search(&self, is_met: impl Fn(&Aabb) -> bool, found: &mut Vec<u32>) {
        found.clear();
        let mut open = [0_usize; 64];
        let mut count = usize::from(!self.order.is_empty());
        open[0] = 1;
        while count > 0 {
            count -= 1;
            let at = open[count];
            if !is_met(&self.nodes[at]) {
                continue;
            }
            if at >= self.first {
                found.push(self.order[at - self.first]);
            } else {
                (open[count], open[count + 1]) = (2 * at, 2 * at + 1);
                count += 2;
            }
        }
        found.sort_unstable();
    }

    fn sort(&mut self, boxes: &[Aabb]) {
        let n = boxes.len();
        self.changes = 0;
        self.order.clear();
        self.order.extend(0..n as u32);
        self.first = n.next_power_of_two();
        let middles: Vec<[f64; 3]> = boxes.iter().map(|b| (0.5 * (b.min + b.max)).to_array()).collect();
        halve(&mut self.order, self.first, &middles);
        self.leaf.resize(n, 0);
        for (leaf, &k) in self.order.iter().enumerate() {
            self.leaf[k as usize] = leaf as u32;
        }
        self.nodes.clear();
        self.nodes.resize(2 * self.first, Aabb::EMPTY);
        for (leaf, &k) in self.order.iter().enumerate() {
            self.nodes[self.first + leaf] = boxes[k as usize];
        }
        for at in (1..self.first).rev() {
            self.nodes[at] = self.nodes[2 * at].union(self.nodes[2 * at + 1]);
        }
    }
}

/// Sorts leaves so that the first half of `room` has the lower ones along the side of largest spread, and so on.
fn halve(order: &mut [u32], room: usize, middles: &[[f64; 3]]) {
    let half = room / 2;
    if order.len() <= half {
        return halve_in(order, half, middles);
    }
    if order.len() < 2 {
        return;
    }
    let spread = |axis: usize| {
        let ends = order.iter().map(|&k| middles[k as usize][axis]).filter(|x| x.is_finite());
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let axis = (1..3).fold(0, |best, k| if spread(k) > spread(best) { k } else { best });
    order.select_nth_unstable_by(half, |&a, &b| {
        middles[a as usize][axis].total_cmp(&middles[b as usize][axis]).then(a.cmp(&b))
    });
    let (low, high) = order.split_at_mut(half);
    halve(low, half, middles);
    halve(high, half, middles);
}

fn halve_in(order: &mut [u32], room: usize, middles: &[[f64; 3]]) {
    if room > 1 {
        halve(order, room, middles);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with a scan of all boxes, while boxes change.
    #[test]
    fn boxes_that_meet_are_found() {
        let mut seed = 7_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut place = || {
            let p = DVec3::new(next(), next(), next());
            Aabb { min: p, max: p + DVec3::new(next(), next(), next()) * 0.2 }
        };
        let mut met = 0;
        for n in [1, 3, FEW, FEW + 1, 64, 65, 300] {
            let mut boxes: Vec<Aabb> = (0..n).map(|_| place()).collect();
            let (mut tree, mut found) = (BoxTree::default(), Vec::new());
            for step in 0..3 * n {
                let (k, around) = (step * 7 % n, place());
                boxes[k] = place();
                tree.change(k, &boxes[k]);
                tree.meeting(&boxes, &around, &mut found);
                let scanned: Vec<u32> = (0..n as u32).filter(|&k| boxes[k as usize].meets(&around)).collect();
                assert_eq!(found, scanned, "{n} boxes, step {step}");
                let (x, reach) = (place().min, 0.1);
                BoxTree::new(&boxes).within(x, reach, &mut found);
                let is_near = |b: &Aabb| (x - x.clamp(b.min, b.max)).length() <= reach;
                let scanned: Vec<u32> = (0..n as u32).filter(|&k| is_near(&boxes[k as usize])).collect();
                assert_eq!(found, scanned, "{n} boxes around a point, step {step}");
                met += found.len();
            }
        }
        assert!(met > 1000, "{met}");
    }

    #[test]
    fn a_tree_of_nothing_finds_nothing() {
        let mut found = vec![1];
        BoxTree::new(&[]).find(&Aabb::EVERYWHERE, &mut found);
        assert!(found.is_empty());
    }
}
