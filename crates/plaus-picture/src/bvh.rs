//! Finds the thing that a ray hits first: a tree of boxes.

use glam::DVec3;
use plaus_animation::Look;

/// Most things in a leaf.
const LEAF: usize = 4;
/// A depth that no tree reaches, because each level halves the contents.
const DEEPEST: usize = 64;

/// A half-line, with limits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) from: DVec3,
    /// Of length 1.
    pub(crate) along: DVec3,
    /// Nothing nearer than this is hit.
    pub(crate) least: f64,
    /// Nothing farther than this is hit.
    pub(crate) most: f64,
    /// Whether it passes through translucent things.
    pub(crate) solid_only: bool,
}

/// What a ray hit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    pub(crate) t: f64,
    pub(crate) normal: DVec3,
    pub(crate) look: Look,
}

/// Something that can be hit.
pub(crate) trait Target {
    /// Lowest and highest coordinates.
    fn bounds(&self) -> [DVec3; 2];

    /// Where a ray first hits it.
    fn hit(&self, ray: &Ray) -> Option<Hit>;
}

#[derive(Debug)]
pub(crate) struct Bvh<T> {
    things: Vec<T>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Things `from..to` of a leaf; otherwise the second child, while the first is the next node.
    from: u32,
    to: u32,
    second: u32,
    /// The axis along which the second child lies beyond the first.
    axis: usize,
}

impl<T: Target> Bvh<T> {
    pub(crate) fn new(mut things: Vec<T>) -> Self {
        let mut nodes = Vec::new();
        let count = things.len();
        if count > 0 {
            build(&mut things, 0, count, &mut nodes);
        }
        Self { things, nodes }
    }

    /// Lowest and highest coordinates of all; `None` if there is nothing.
    pub(crate) fn bounds(&self) -> Option<[DVec3; 2]> {
        self.nodes.first().map(|root| [root.low, root.high])
    }

    /// The first thing along a ray.
    pub(crate) fn first(&self, ray: &Ray) -> Option<Hit> {
        let inverse = ray.along.recip();
        let mut ray = *ray;
        let mut nearest = None;
        let (mut open, mut count) = ([0_u32; DEEPEST], usize::from(!self.nodes.is_empty()));
        while count > 0 {
            count -= 1;
            let index = open[count];
            let node = &self.nodes[index as usize];
            if !node.meets(&ray, inverse) {
                continue;
            }
            if node.from == node.to {
                // The nearer one first, because its contents may hide the other.
                let (near, far) = (index + 1, node.second);
                let turned = ray.along[node.axis] < 0.0;
                (open[count], open[count + 1]) = if turned { (near, far) } else { (far, near) };
                count += 2;
                continue;
            }
            for thing in &self.things[node.from as usize..node.to as usize] {
                if let Some(hit) = thing.hit(&ray) {
                    ray.most = hit.t;
                    nearest = Some(hit);
                }
            }
        }
        nearest
    }
}

impl Node {
    fn meets(&self, ray: &Ray, inverse: DVec3) -> bool {
        let (a, b) = ((self.low - ray.from) * inverse, (self.high - ray.from) * inverse);
        let (near, far) = (a.min(b), a.max(b));
        near.max_element().max(ray.least) <= far.min_element().min(ray.most)
    }
}

fn build<T: Target>(things: &mut [T], from: usize, to: usize, nodes: &mut Vec<Node>) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for thing in &things[from..to] {
        let [least, most] = thing.bounds();
        (low, high) = (low.min(least), high.max(most));
    }
    let here = nodes.len();
    nodes.push(Node { low, high, from: from as u32, to: to as u32, second: 0, axis: 0 });
    if to - from <= LEAF {
        return;
    }
    let Split { axis, first } = split(&mut things[from..to]);
    (nodes[here].from, nodes[here].to, nodes[here].axis) = (0, 0, axis);
    build(things, from, from + first, nodes);
    nodes[here].second = nodes.len() as u32;
    build(things, from + first, to, nodes);
}

/// How things are divided between two children: how many go to the first.
struct Split {
    axis: usize,
    first: usize,
}

/// Sorts things along an axis and cuts where rays will probably have the least work: where the surfaces of the two
/// boxes, times the number of things in them, have the smallest sum (MacDonald & Booth 1990). For few things the middle
/// is as good.
fn split<T: Target>(things: &mut [T]) -> Split {
    /// Places tried for a cut.
    const CUTS: usize = 12;
    let middle = |thing: &T| thing.bounds().into_iter().sum::<DVec3>();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for thing in things.iter() {
        (low, high) = (low.min(middle(thing)), high.max(middle(thing)));
    }
    let axis = (high - low).max_position();
    things.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let surface = |things: &[T]| {
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let grow = |[low, high]: [DVec3; 2], [a, b]: [DVec3; 2]| [low.min(a), high.max(b)];
        let [low, high] = things.iter().map(T::bounds).fold(none, grow);
        let size = high - low;
        size.x * size.y + size.y * size.z + size.z * size.x
    };
    let cost = |first: usize| {
        let (a, b) = things.split_at(first);
        surface(a) * a.len() as f64 + surface(b) * b.len() as f64
    };
    let cuts = (1..CUTS).map(|cut| (things.len() * cut / CUTS).clamp(1, things.len() - 1));
    // A tree must stay shallow, so things that lie in one place are halved.
    let cuts = cuts.filter(|first| first.min(&(things.len() - first)) * 4 >= things.len());
    let first = cuts.min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(things.len() / 2);
    Split { axis, first }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball at a place.
    struct Ball(DVec3, f64);

    impl Target for Ball {
        fn bounds(&self) -> [DVec3; 2] {
            [self.0 - DVec3::splat(self.1), self.0 + DVec3::splat(self.1)]
        }

        fn hit(&self, ray: &Ray) -> Option<Hit> {
            let middle = (self.0 - ray.from).dot(ray.along);
            let off = ray.from + middle * ray.along - self.0;
            let half = (self.1 * self.1 - off.length_squared()).sqrt();
            let t = middle - half;
            (t > ray.least && t < ray.most).then_some(Hit { t, normal: off, look: Look::STONE })
        }
    }

    /// Points that fill a cube evenly.
    fn point(k: u32) -> DVec3 {
        let share = |step: f64| (f64::from(k) * step).fract();
        DVec3::new(share(0.819_172_513_396_164_4), share(0.671_043_606_703_789_2), share(0.549_700_477_901_970_3))
    }

    #[test]
    fn the_tree_finds_what_looking_at_all_things_finds() {
        let balls = || (0..300).map(|k| Ball(point(k), 0.02 + 0.03 * point(7 * k).x));
        let (tree, all) = (Bvh::new(balls().collect()), balls().collect::<Vec<_>>());
        let mut hits = 0;
        for k in 0..2000 {
            let (from, to) = (3.0 * point(k + 1000) - DVec3::ONE, point(k + 5000));
            let ray = Ray { from, along: (to - from).normalize(), least: 1e-9, most: 5.0, solid_only: false };
            let expected = all.iter().filter_map(|ball| ball.hit(&ray)).map(|hit| hit.t).min_by(f64::total_cmp);
            assert_eq!(tree.first(&ray).map(|hit| hit.t), expected);
            hits += u32::from(expected.is_some());
        }
        assert!((500..2000).contains(&hits), "{hits} of 2,000 rays hit something");
        assert!(Bvh::<Ball>::new(Vec::new()).bounds().is_none());
    }
}
