//! Collision filters of `KHR_physics_rigid_bodies`: which things of a file pass through each other. In a scenario
//! bodies can, as wholes; scenery that nothing touches is left out, and the rest is told.

use super::physics::BODIES;
use super::things::{Role, Things};
use plaus_asset::glb::Glb;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Most names in one message.
const SHOWN: usize = 4;

/// The systems that a collider is in, and those that it collides with, or does not.
#[derive(Debug, Default)]
struct Filter {
    is_in: BTreeSet<String>,
    with: Option<BTreeSet<String>>,
    not_with: Option<BTreeSet<String>>,
}

impl Filter {
    /// Whether this one lets what is in these systems touch it.
    fn lets(&self, systems: &BTreeSet<String>) -> bool {
        let is_listed = |list: &BTreeSet<String>| systems.is_subset(list);
        self.with.as_ref().is_none_or(is_listed)
            && (systems.is_empty() || !self.not_with.as_ref().is_some_and(is_listed))
    }
}

/// Of each thing, the filters of its colliders, as the file numbers them.
pub(super) type Colliders = BTreeMap<usize, Vec<Option<usize>>>;

/// The filters of a file.
#[derive(Debug)]
pub(super) struct Filters(Vec<Filter>);

impl Filters {
    pub(super) fn read(file: &Glb) -> Self {
        let names = |value: &Value| -> Option<BTreeSet<String>> {
            Some(value.as_array()?.iter().filter_map(|name| Some(name.as_str()?.to_owned())).collect())
        };
        let filter = |value: &Value| Filter {
            is_in: names(&value["collisionSystems"]).unwrap_or_default(),
            with: names(&value["collideWithSystems"]),
            not_with: names(&value["notCollideWithSystems"]),
        };
        Self(file.extension(BODIES)["collisionFilters"].as_array().into_iter().flatten().map(filter).collect())
    }

    fn touch(&self, a: Option<usize>, b: Option<usize>) -> bool {
        let none = Filter::default();
        let [a, b] = [a, b].map(|index| index.and_then(|index| self.0.get(index)).unwrap_or(&none));
        a.lets(&b.is_in) && b.lets(&a.is_in)
    }

    /// Leaves out scenery that nothing which moves can touch, and tells which other things pass through each other in
    /// the file.
    pub(super) fn apply(&self, things: &mut Things<'_>, colliders: &Colliders) {
        if self.0.is_empty() {
            return;
        }
        let moves = |things: &Things<'_>, index: usize| matches!(things.all[index].role, Role::Body | Role::Driven);
        let indices: Vec<usize> = colliders.keys().copied().collect();
        let is_held = |things: &Things<'_>, a: usize, b: usize| {
            things
                .joints
                .iter()
                .any(|held| held.to.is_some_and(|to| [(held.body, to), (to, held.body)].contains(&(a, b))))
        };
        // All of its pairs of colliders, and how many of them touch.
        let pairs = |a: usize, b: usize| {
            let all = colliders[&a].iter().flat_map(|one| colliders[&b].iter().map(move |other| (*one, *other)));
            let touching = all.clone().filter(|&(one, other)| self.touch(one, other)).count();
            (all.count(), touching)
        };
        let others = |a: usize| indices.iter().copied().filter(move |&b| b != a);
        for &fixed in &indices {
            if things.all[fixed].role != Role::Fixed {
                continue;
            }
            let movers: Vec<usize> = others(fixed).filter(|&other| moves(things, other)).collect();
            if !movers.is_empty() && movers.iter().all(|&other| pairs(fixed, other).1 == 0) {
                things.notes.push(format!("{}: left out, as its filter lets nothing touch it", things.all[fixed].name));
                (things.all[fixed].role, things.all[fixed].stands) = (Role::Gone, true);
            }
        }
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let kept: Vec<usize> = indices.iter().copied().filter(|&index| things.all[index].role != Role::Gone).collect();
        for (nth, &a) in kept.iter().enumerate() {
            let (mut through, mut partly) = (Vec::new(), Vec::new());
            for &b in &kept[nth + 1..] {
                let (all, touching) = pairs(a, b);
                if (!moves(things, a) && !moves(things, b)) || touching == all || is_held(things, a, b) {
                    continue;
                }
                match touching {
                    0 if [a, b].into_iter().all(|index| moves(things, index) || things.hold_still(index)) => {
                        let pass = |one: usize, other: usize| one == other || pairs(one, other).1 == 0;
                        let fits = |group: &&mut Vec<usize>| group.iter().all(|&one| pass(one, a) && pass(one, b));
                        match groups.iter_mut().find(fits) {
                            Some(group) => group.extend([a, b]),
                            None => groups.push(vec![a, b]),
                        }
                    }
                    0 => through.push(b),
                    _ => partly.push(b),
                }
            }
            for (others, what) in [(through, "passes through"), (partly, "touches with some of its parts only")] {
                if others.is_empty() {
                    continue;
                }
                let names: Vec<&str> = others.iter().take(SHOWN).map(|&b| things.all[b].name.as_str()).collect();
                let more = others.len().saturating_sub(SHOWN);
                let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                let text = format!(
                    "{}: its filter, by which it {what} {}{more}: here all touch",
                    things.all[a].name,
                    names.join(", ")
                );
                things.left_out.push(text);
            }
        }
        for &index in &kept {
            let is_in = groups.iter().zip(1..).filter(|(group, _)| group.contains(&index));
            things.all[index].no_contact = is_in.map(|(_, nth)| format!("filter_{nth}")).collect();
        }
    }
}
