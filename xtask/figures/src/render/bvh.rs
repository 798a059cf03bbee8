//! Which thing a ray hits first: a tree of boxes.

use super::prims::Thing;
use glam::DVec3;

/// Things in a leaf at most.
const LEAF: usize = 4;

#[derive(Debug)]
pub(super) struct Bvh {
    things: Vec<Thing>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Things `from..to` of a leaf; else the second child, the first being the next node.
    from: u32,
    to: u32,
    second: u32,
}

/// What a ray hit.
pub(super) struct Hit<'a> {
    pub(super) t: f64,
    pub(super) normal: DVec3,
    pub(super) thing: &'a Thing,
}

impl Bvh {
    pub(super) fn new(mut things: Vec<Thing>) -> Self {
        let mut nodes = Vec::new();
        let count = things.len();
        if count > 0 {
            build(&mut things, 0, count, &mut nodes);
        }
        Self { things, nodes }
    }

    /// The first thing along a ray between two distances of those that `counts`.
    pub(super) fn first(
        &self,
        from: DVec3,
        along: DVec3,
        least: f64,
        most: f64,
        counts: impl Fn(&Thing) -> bool,
    ) -> Option<Hit<'_>> {
        let inverse = along.recip();
        let mut nearest: Option<Hit<'_>> = None;
        let mut far = most;
        let mut open = vec![0_usize];
        while let Some(index) = open.pop() {
            let Some(node) = self.nodes.get(index) else { continue };
            if !node.meets(from, inverse, least, far) {
                continue;
            }
            if node.from == node.to {
                open.push(node.second as usize);
                open.push(index + 1);
                continue;
            }
            for thing in &self.things[node.from as usize..node.to as usize] {
                if let Some((t, normal)) = thing.solid.hit(from, along, least).filter(|(t, _)| *t < far)
                    && counts(thing)
                {
                    far = t;
                    nearest = Some(Hit { t, normal, thing });
                }
            }
        }
        nearest
    }
}

impl Node {
    fn meets(&self, from: DVec3, inverse: DVec3, least: f64, most: f64) -> bool {
        let (a, b) = ((self.low - from) * inverse, (self.high - from) * inverse);
        let (near, far) = (a.min(b), a.max(b));
        near.max_element().max(least) <= far.min_element().min(most)
    }
}

fn build(things: &mut [Thing], from: usize, to: usize, nodes: &mut Vec<Node>) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for thing in &things[from..to] {
        let [least, most] = thing.solid.bounds();
        (low, high) = (low.min(least), high.max(most));
    }
    let here = nodes.len();
    nodes.push(Node { low, high, from: from as u32, to: to as u32, second: 0 });
    if to - from <= LEAF {
        return;
    }
    let size = high - low;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let middle = |thing: &Thing| {
        let [least, most] = thing.solid.bounds();
        least[axis] + most[axis]
    };
    let half = (to - from) / 2;
    things[from..to].select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
    (nodes[here].from, nodes[here].to) = (0, 0);
    build(things, from, from + half, nodes);
    nodes[here].second = nodes.len() as u32;
    build(things, from + half, to, nodes);
}
