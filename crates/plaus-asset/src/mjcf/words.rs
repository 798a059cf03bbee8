//! Attributes of an element with the defaults of its class, and what they say.

use crate::AssetError;
use crate::xml::{Attributes, Element, Words};
use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math::{atan2, sin_cos};
use std::collections::BTreeMap;

/// The class of elements that name none.
const MAIN: &str = "main";
/// Ways to say how something is turned: at most one is said.
const TURNS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];
/// Lists of which the first numbers may be said, and the rest left to the class.
const LISTS: [&str; 2] = ["size", "friction"];

/// Classes with their attributes for each kind of element.
#[derive(Debug, Default)]
pub(super) struct Classes(BTreeMap<String, BTreeMap<String, Attributes>>);

impl Classes {
    pub(super) fn read(root: &Element) -> Result<Self, AssetError> {
        let mut classes = Self::default();
        classes.0.insert(MAIN.into(), BTreeMap::new());
        for section in root.all("default") {
            classes.add(section, section.get("class").unwrap_or(MAIN), MAIN)?;
        }
        Ok(classes)
    }

    fn add(&mut self, said: &Element, name: &str, above: &str) -> Result<(), AssetError> {
        let mut class = self.0.get(if self.0.contains_key(name) { name } else { above }).cloned().unwrap_or_default();
        for child in said.children.iter().filter(|child| child.tag != "default") {
            let known = class.entry(child.tag.clone()).or_default();
            *known = over(&child.attributes, known);
        }
        self.0.insert(name.to_owned(), class);
        for child in said.all("default") {
            let Some(inner) = child.get("class") else { return Err(child.place.wrong("a class needs a name")) };
            self.add(child, inner, name)?;
        }
        Ok(())
    }

    /// What an element says; without a class of its own, in the class `ambient`.
    pub(super) fn words<'a>(&self, of: &'a Element, ambient: Option<&str>) -> Result<Words<'a>, AssetError> {
        let class = of.get("class").or(ambient).unwrap_or(MAIN);
        let Some(class) = self.0.get(class) else { return Err(of.place.wrong(format!("there is no class {class:?}"))) };
        let said = class.get(&of.tag).map_or_else(|| of.attributes.clone(), |known| over(&of.attributes, known));
        Ok(Words { of, said })
    }
}

/// Attributes over those of a class.
fn over(own: &Attributes, class: &Attributes) -> Attributes {
    let mut all = class.clone();
    if TURNS.iter().any(|turn| own.contains_key(*turn)) {
        all.retain(|name, _| !TURNS.contains(&name.as_str()));
    }
    for (name, value) in own {
        let mut value = value.clone();
        if let Some(known) = class.get(name).filter(|_| LISTS.contains(&name.as_str())) {
            let rest = known.split_whitespace().skip(value.split_whitespace().count());
            value = value.split_whitespace().chain(rest).collect::<Vec<_>>().join(" ");
        }
        all.insert(name.clone(), value);
    }
    all
}

/// How angles are said.
#[derive(Debug, Clone)]
pub(super) struct Angles {
    /// Radians of the unit.
    pub(super) unit: f64,
    /// The axes of the three angles of `euler`; capitals stay where they are, others turn along.
    pub(super) sequence: [char; 3],
}

impl Words<'_> {
    /// Where it is, and how it is turned, within what it belongs to.
    pub(super) fn pose(&self, angles: &Angles) -> Result<(DVec3, DQuat), AssetError> {
        Ok((self.vector("pos")?.unwrap_or(DVec3::ZERO), self.turn(angles)?))
    }

    fn turn(&self, angles: &Angles) -> Result<DQuat, AssetError> {
        let said: Vec<&str> = TURNS.into_iter().filter(|turn| self.said.contains_key(*turn)).collect();
        let [name] = said[..] else {
            let Some(second) = said.get(1) else { return Ok(DQuat::IDENTITY) };
            return Err(self.wrong(second, format!("{} says already how it is turned", said[0])));
        };
        let count = match name {
            "quat" | "axisangle" => 4,
            "xyaxes" => 6,
            _ => 3,
        };
        let n = self.numbers(name, count..=count)?.unwrap_or_default();
        let unit = |from: usize| DVec3::from_slice(&n[from..]).try_normalize();
        let turn = match name {
            "quat" => {
                let quat = DQuat::from_xyzw(n[1], n[2], n[3], n[0]);
                (quat.length() > 1e-12).then(|| quat.normalize())
            }
            "axisangle" => unit(0).map(|axis| about(axis, n[3] * angles.unit)),
            "zaxis" => unit(0).map(upwards),
            "xyaxes" => unit(0).and_then(|x| {
                let y = DVec3::from_slice(&n[3..]).reject_from_normalized(x).try_normalize()?;
                Some(DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize())
            }),
            _ => Some(angles.euler(&n)),
        };
        turn.ok_or_else(|| self.wrong(name, "it has no direction"))
    }
}

impl Angles {
    pub(super) fn euler(&self, angles: &[f64]) -> DQuat {
        let mut turn = DQuat::IDENTITY;
        for (letter, angle) in self.sequence.iter().zip(angles) {
            let axis = match letter.to_ascii_lowercase() {
                'x' => DVec3::X,
                'y' => DVec3::Y,
                _ => DVec3::Z,
            };
            let by = about(axis, angle * self.unit);
            turn = if letter.is_ascii_uppercase() { by * turn } else { turn * by };
        }
        turn.normalize()
    }
}

/// The rotation about a unit vector by an angle in radians.
pub(crate) fn about(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = sin_cos(0.5 * angle);
    let axis = axis * sin;
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cos)
}

/// The shortest rotation that turns z to a unit vector.
pub(super) fn upwards(to: DVec3) -> DQuat {
    let across = DVec3::Z.cross(to);
    let sin = across.length();
    let axis = if sin > 0.0 { across / sin } else { DVec3::X };
    about(axis, atan2(sin, to.z))
}
