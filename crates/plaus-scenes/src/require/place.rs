//! The place of a requirement in a scenario, for error messages.

use super::cast::{Cast, matches};
use crate::scenario::nearest;
use crate::scene::ConfigError;
use std::cell::RefCell;

/// A table of a scenario that contains a requirement.
#[derive(Debug, Clone)]
pub(super) struct Place<'a> {
    key: String,
    cast: &'a Cast,
    /// Which bodies were named so far.
    named: &'a RefCell<Vec<bool>>,
    /// Whether a body need not be named, because several are asked about in turn.
    counted: bool,
}

impl<'a> Place<'a> {
    /// The entry `index` of the list of requirements. `named` has a flag for each body of the cast; checks
    /// of names set those that they find.
    pub(super) fn of_entry(index: usize, cast: &'a Cast, named: &'a RefCell<Vec<bool>>) -> Self {
        Self { key: format!("require[{index}]"), cast, named, counted: false }
    }

    /// The place of one of its keys.
    pub(super) fn at(&self, key: &str) -> Self {
        Self { key: format!("{}.{key}", self.key), ..self.clone() }
    }

    /// The place of an entry, if it is a list.
    pub(super) fn entry(&self, index: usize) -> Self {
        Self { key: format!("{}[{index}]", self.key), ..self.clone() }
    }

    /// The same place, where bodies need not be named.
    pub(super) fn counted(&self) -> Self {
        Self { counted: true, ..self.clone() }
    }

    pub(super) fn cast(&self) -> &'a Cast {
        self.cast
    }

    /// An error at this place.
    pub(super) fn wrong(&self, message: &str) -> ConfigError {
        ConfigError::new(self.key.clone(), message)
    }

    /// Refuses a name, or pattern, that no body matches.
    pub(super) fn body(&self, key: &str, name: &str) -> Result<(), ConfigError> {
        let place = self.at(key);
        if name.is_empty() {
            let only = self.cast.only();
            only.map(|body| self.name(body, &self.cast.bodies));
            let one = self.counted || only.is_some();
            return if one { Ok(()) } else { Err(place.wrong(&format!("name a body: there are {}", self.bodies()))) };
        }
        if self.name(name, &self.cast.bodies) {
            return Ok(());
        }
        Err(place.wrong(&self.unknown(name, &self.cast.bodies)))
    }

    /// Refuses to ask how a body is turned where bodies have no orientation.
    pub(super) fn turned(&self) -> Result<(), ConfigError> {
        let none = "the balls of this world are simulated without an orientation";
        if self.cast.turns { Ok(()) } else { Err(self.wrong(none)) }
    }

    /// Refuses a name, or pattern, that no joint matches; empty means any joint.
    pub(super) fn joint(&self, key: &str, name: &str) -> Result<(), ConfigError> {
        let joints = &self.cast.joints;
        if joints.iter().any(|joint| name.is_empty() || matches(name, joint)) {
            return Ok(());
        }
        let none = "this world has no joints, so none can break";
        Err(self.at(key).wrong(&if joints.is_empty() { none.into() } else { self.unknown(name, joints) }))
    }

    /// The same for a name that must be one body.
    pub(super) fn one_body(&self, key: &str, name: &str) -> Result<(), ConfigError> {
        self.body(key, name)?;
        if name.contains('*') {
            Err(self.at(key).wrong("give the name of one body here, not a pattern"))
        } else {
            Ok(())
        }
    }

    /// Refuses a name that matches nothing that can be touched; empty means anything.
    pub(super) fn partner(&self, key: &str, name: &str) -> Result<(), ConfigError> {
        let all: Vec<String> = self.cast.bodies.iter().chain(&self.cast.fixed).cloned().collect();
        if name.is_empty() || self.name(name, &all) {
            return Ok(());
        }
        Err(self.at(key).wrong(&self.unknown(name, &all)))
    }

    /// Takes down which bodies a pattern matches; the bodies come first among `things`. Whether it matches any thing.
    fn name(&self, pattern: &str, things: &[String]) -> bool {
        let mut named = self.named.borrow_mut();
        things.iter().zip(named.iter_mut()).for_each(|(body, named)| *named |= matches(pattern, body));
        things.iter().any(|thing| matches(pattern, thing))
    }

    /// Refuses three numbers that are no direction.
    pub(super) fn direction(&self, key: &str, along: [f64; 3]) -> Result<(), ConfigError> {
        let wrong = || self.at(key).wrong("a direction: three numbers from -1e6 to 1e6, not all of them 0");
        let is_one = along.iter().all(|x| x.abs() <= 1e6) && along.iter().any(|x| x.abs() >= 1e-6);
        if is_one { Ok(()) } else { Err(wrong()) }
    }

    /// Refuses limits that exclude everything, or nothing.
    pub(super) fn limits(&self, at_least: Option<f64>, at_most: Option<f64>) -> Result<(), ConfigError> {
        match (at_least, at_most) {
            (None, None) => Err(self.wrong("it asks for nothing: give a lower limit, an upper limit, or both")),
            (Some(least), Some(most)) if least > most => {
                Err(self.wrong(&format!("at least {least} and at most {most}: no value is both")))
            }
            _ => Ok(()),
        }
    }

    fn unknown(&self, name: &str, all: &[String]) -> String {
        let near = nearest(name, all.iter().map(String::as_str));
        let near = near.map(|near| format!("did you mean \"{near}\"? ")).unwrap_or_default();
        format!("there is no {name:?}; {near}there are {}", listed(all))
    }

    fn bodies(&self) -> String {
        listed(&self.cast.bodies)
    }
}

/// Lists names in a sentence: the first few, if there are many.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 12;
    let more = names.len().saturating_sub(SHOWN);
    let shown = names.iter().take(SHOWN).cloned().collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}
