//! The bodies and scenery of a scene, and what names refer to.

use crate::spelling::picture::Grid;
use glam::DVec3;
use plaus_animation::View;
use std::collections::BTreeMap;

/// Where the faces 1 to 6 of a die lie.
pub(super) const FACES: [DVec3; 6] = [DVec3::Z, DVec3::Y, DVec3::X, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];

/// The bodies and scenery of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Cast {
    /// Names of bodies, as in animations.
    pub bodies: Vec<String>,
    /// Those of them that some draws do not have: a motion without their tracks is one of these draws.
    pub optional: Vec<String>,
    /// Names of the scenery that can be touched.
    pub fixed: Vec<String>,
    /// Names of joints, which may break.
    pub joints: Vec<String>,
    /// The latest end of a simulation, in s.
    pub longest: f64,
    /// Whether bodies have an orientation. Balls of some scenes have none.
    pub turns: bool,
    /// Whether the bodies are dice, whose faces have pips.
    pub faces: bool,
    /// Of bodies whose faces are marked, the directions along their own axes that point up where each number, from 1,
    /// is read.
    pub marks: BTreeMap<String, Vec<DVec3>>,
    /// The bins in which balls can spell words, if there are any.
    pub bins: Option<Grid>,
    /// From where the world is looked at, if that is the same in every motion.
    pub view: Option<View>,
    /// Bodies that nothing ever stops once they roll, each with the level ground on which that is so.
    pub restless: Vec<(String, String)>,
}

/// Nothing at all, for as long as one likes; bodies would turn.
impl Default for Cast {
    fn default() -> Self {
        Self {
            bodies: Vec::new(),
            optional: Vec::new(),
            fixed: Vec::new(),
            joints: Vec::new(),
            longest: f64::INFINITY,
            turns: true,
            faces: false,
            marks: BTreeMap::new(),
            bins: None,
            view: None,
            restless: Vec::new(),
        }
    }
}

impl Cast {
    /// The only body there is.
    pub(super) fn only(&self) -> Option<&str> {
        match self.bodies.as_slice() {
            [one] => Some(one),
            _ => None,
        }
    }

    /// A body's name, or that of the only one if it is empty.
    pub(super) fn only_or(&self, name: String) -> String {
        if name.is_empty() { self.only().unwrap_or_default().to_owned() } else { name }
    }

    /// The bodies that match a pattern.
    pub(super) fn matching<'a>(&'a self, pattern: &'a str) -> impl Iterator<Item = &'a str> {
        self.bodies.iter().map(String::as_str).filter(move |name| matches(pattern, name))
    }
}

/// Whether `name` matches `pattern`, in which each `*` stands for any characters.
pub(super) fn matches(pattern: &str, name: &str) -> bool {
    let Some((head, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(name) = name.strip_prefix(head) else { return false };
    (0..=name.len()).filter(|&cut| name.is_char_boundary(cut)).any(|cut| matches(rest, &name[cut..]))
}
