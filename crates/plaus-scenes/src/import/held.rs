//! What joints make of things: which stand still, which are uncertain together, and which are left out.

use super::ImportError;
use super::numbers::number;
use super::things::{Held, Role, Shape, Sway, Things};
use super::write::angles;
use std::collections::BTreeSet;

impl Things<'_> {
    /// Makes a piece of scenery a driven body that stands still, so that a joint to it keeps the two from touching.
    /// Only convex shapes can be one.
    pub(super) fn hold_still(&mut self, index: usize) -> bool {
        let thing = &mut self.all[index];
        let can = matches!(&thing.shape, Shape::Hull { .. } | Shape::Solid { volume: 1e-15.., .. });
        if can && thing.role == Role::Fixed {
            let at = thing.at.to_array().map(number).join(", ");
            let turn = angles(thing.turn).map(number).join(", ");
            (thing.role, thing.stands) = (Role::Driven, true);
            thing.lines.push(format!("keys = [{{ at_s = 0, at_mm = [{at}], turn_deg = [{turn}] }}]"));
        }
        can
    }

    /// Says what is uncertain about the places of what joints hold: nothing if they hold it to what stands still, and
    /// otherwise the same for all that they hold together.
    pub(super) fn sway_with_joints(&mut self) {
        // The first of all that each is held together with.
        let mut first: Vec<usize> = (0..self.all.len()).collect();
        for held in &self.joints {
            let Some(to) = held.to.filter(|&to| self.all[to].role == Role::Body) else { continue };
            let (low, high) = (first[held.body].min(first[to]), first[held.body].max(first[to]));
            first.iter_mut().filter(|first| **first == high).for_each(|first| *first = low);
        }
        let is_still = |held: &Held| held.to.is_none_or(|to| self.all[to].role != Role::Body);
        let still: BTreeSet<usize> =
            self.joints.iter().filter(|held| is_still(held)).map(|held| first[held.body]).collect();
        for index in 0..self.all.len() {
            let is_held = first.iter().filter(|&&other| other == first[index]).count() > 1;
            self.all[index].sway = match first[index] {
                one if still.contains(&one) => Sway::Nothing,
                one if is_held => Sway::With(format!("start_of_{}", self.all[one].name.replace('-', "_"))),
                _ => Sway::Own,
            };
        }
    }

    /// Leaves out one of two things that joints hold inside each other: scenery, or else, where the file may say that
    /// things pass through each other, a body with its joints.
    ///
    /// # Errors
    /// [`ImportError::Stuck`] if neither can be left out.
    pub(super) fn part(&mut self, body: usize, other: usize) -> Result<(), ImportError> {
        let [held, thing] = [body, other].map(|index| self.all[index].name.clone());
        let (gone, kept) = match self.all[other].role {
            Role::Fixed => (other, body),
            Role::Driven if self.all[other].stands => (other, body),
            _ if self.passes => (body, other),
            _ => return Err(ImportError::Stuck { body: held, other: thing }),
        };
        let [gone_name, kept_name] = [gone, kept].map(|index| self.all[index].name.clone());
        let what = format!("a joint holds it and {kept_name} inside each other, and here the two would touch");
        self.left_out.push(format!("{gone_name}: {what}"));
        let stands = self.all[gone].role != Role::Body;
        (self.all[gone].role, self.all[gone].stands) = (Role::Gone, stands);
        let is_its = |held: &Held| held.body == gone || held.to == Some(gone);
        if stands {
            self.joints.iter_mut().filter(|held| is_its(held)).for_each(|held| held.to = None);
        } else {
            let (lost, kept) = std::mem::take(&mut self.joints).into_iter().partition(is_its);
            self.joints = kept;
            let lost: Vec<Held> = lost;
            self.left_out.extend(lost.iter().map(|held| format!("{}: what it holds is left out", held.name)));
            self.sway_with_joints();
        }
        Ok(())
    }
}
