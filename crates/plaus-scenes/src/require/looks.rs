//! When it is worth looking at a motion that is known in part.

use super::when::Window;

/// When the beginning of a motion may show that a requirement can no longer be met.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Looks {
    /// At these times, in s.
    pub(super) times: Vec<f64>,
    /// At any impact.
    pub(super) impacts: bool,
    /// Whether it takes notice of lasting contacts.
    pub(super) contacts: bool,
    /// Whether it takes notice of the scenery.
    pub(super) scenery: bool,
}

impl Looks {
    /// At the end of a window.
    pub(super) fn after(window: Window) -> Self {
        Self::at(Some(window.to).filter(|to| to.is_finite()))
    }

    /// At a time.
    pub(super) fn at(time: Option<f64>) -> Self {
        Self { times: time.into_iter().collect(), ..Self::default() }
    }

    /// The same, and at any impact.
    pub(super) fn or_impacts(self) -> Self {
        Self { impacts: true, ..self }
    }

    /// The same, of a requirement that takes notice of lasting contacts.
    pub(super) fn and_contacts(self) -> Self {
        Self { contacts: true, ..self }
    }

    /// The same, of a requirement that takes notice of the scenery.
    pub(super) fn and_scenery(self) -> Self {
        Self { scenery: true, ..self }
    }

    /// Whenever one of several does.
    pub(super) fn of_all(all: impl IntoIterator<Item = Self>) -> Self {
        let mut looks = Self::default();
        for one in all {
            looks.times.extend(one.times);
            looks.impacts |= one.impacts;
            looks.contacts |= one.contacts;
            looks.scenery |= one.scenery;
        }
        looks.times.sort_by(f64::total_cmp);
        looks.times.dedup();
        looks
    }
}
