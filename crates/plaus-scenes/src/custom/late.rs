//! Bodies that appear when something has happened.

use super::amount::{Amount, Moment};
use super::values::{Collector, Owner, Value};
use crate::scenario::nearest;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// What makes a body appear. Until then it is not drawn, and nothing can touch it.
    pub struct Appears {
        /// The name of a body: once that has come to rest.
        when_rests: String;
        /// Names of a body and of another one, or of a piece of scenery: once the two have hit each other. With one
        /// name: once that body has hit anything.
        #[schemars(length(max = 2))]
        when_touches: Vec<String>;
        /// So long after that. Without `when_rests` and `when_touches`: so long after the start.
        #[schemars(extend("x-unit" = "s"))]
        after_s: Amount<Moment>;
    }
}

/// What a body waits for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cue {
    Start,
    /// This body rests.
    Rest(usize),
    /// This body has hit something: a body of this place among all, or a piece of scenery, counted on.
    Hit(usize, Option<usize>),
}

/// When a body appears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Late {
    pub(super) cue: Cue,
    pub(super) after: Value,
}

impl Late {
    /// What the keys say of a body that has this place; `bodies` and `fixed` are the names of all.
    pub(super) fn new(
        (owner, index): (&Owner<'_>, usize),
        (said, after): (&Appears, Value),
        (bodies, fixed): (&[String], &[&str]),
    ) -> Result<Self, ConfigError> {
        let wrong = |key: &str, message: String| owner.wrong(&format!("appears.{key}"), message);
        let find = |key: &str, name: &String, others: &[&str]| {
            let all = || bodies.iter().map(String::as_str).chain(others.iter().copied());
            let near = || nearest(name, all()).map(|near| format!("; did you mean {near:?}?")).unwrap_or_default();
            match all().position(|known| known == name) {
                Some(found) if found == index => Err(wrong(key, format!("{name:?} cannot wait for itself"))),
                Some(found) => Ok(found),
                None => Err(wrong(key, format!("there is no {name:?}{}", near()))),
            }
        };
        let cue = match (said.when_rests.is_empty(), said.when_touches.as_slice()) {
            (true, []) => Cue::Start,
            (false, []) => Cue::Rest(find("when_rests", &said.when_rests, &[])?),
            (true, [body]) => Cue::Hit(find("when_touches[0]", body, &[])?, None),
            (true, [body, other]) => {
                Cue::Hit(find("when_touches[0]", body, &[])?, Some(find("when_touches[1]", other, fixed)?))
            }
            (true, _) => return Err(wrong("when_touches", "at most two names".into())),
            (false, _) => {
                return Err(wrong("when_rests", "it waits for one thing: `when_rests` or `when_touches`".into()));
            }
        };
        Ok(Self { cue, after })
    }

    /// How long it waits, as a value.
    pub(super) fn wait(
        collector: &mut Collector,
        owner: &Owner<'_>,
        said: &Appears,
        release: Value,
    ) -> Result<Value, ConfigError> {
        if release != Value::Fixed(0.0) {
            let message = "`appears` says when: leave this out, or say it as `appears.after_s`";
            return Err(owner.wrong("release_s", message));
        }
        collector.number(owner, "appears.after_s", "appears", &said.after_s)
    }

    /// The other things on which it depends whether and when it appears.
    pub(super) fn waits_for(&self) -> impl Iterator<Item = usize> {
        let (one, other) = match self.cue {
            Cue::Start => (None, None),
            Cue::Rest(body) => (Some(body), None),
            Cue::Hit(body, other) => (Some(body), other),
        };
        one.into_iter().chain(other)
    }
}
