//! Starts of bodies that a run, or another program, left in a file.

use super::amount::{Measure, Place, Turning, Velocity};
use super::values::Value;
use crate::files::{Files, inside};
use crate::scenario::nearest;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DQuat;
use serde::{Deserialize, Serialize};
use serde_json::json;

settings! {
    /// How some bodies start: as a run of Plaus or another program left them. Each takes the place of the start of the
    /// body with its name.
    pub struct StartFrom {
        /// The file, `.json` or `.toml`: its path from the scenario's folder, with `/` between folders. `plaus export
        /// --format state` writes it. A run stores what it says, and then no longer needs the file.
        file: String;
        /// Whether the file may lie outside the scenario's folder.
        anywhere: bool;
        /// The text of such a JSON file, in place of a file.
        json: String;
    }
}

/// Where a body is, and how it moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyState {
    /// Its name; of an array, such as `peg_3`.
    pub name: String,
    /// Where its origin is, the point that a body's own `at_mm` places.
    pub at_mm: [f64; 3],
    /// How it is turned: a quaternion x, y, z, w from its own axes to the world's.
    #[serde(default = "upright")]
    pub orientation: [f64; 4],
    /// Velocity of its centre of gravity.
    #[serde(default)]
    pub velocity_m_s: [f64; 3],
    /// How fast it turns, about the world's x, y and z axes.
    #[serde(default)]
    pub spin_deg_s: [f64; 3],
}

fn upright() -> [f64; 4] {
    DQuat::IDENTITY.to_array()
}

/// The key, from the scenario's root.
const KEY: &str = "world.custom.start_from";

fn wrong(key: &str, message: impl ToString) -> ConfigError {
    ConfigError::new(format!("{KEY}.{key}"), message)
}

impl StartFrom {
    /// These bodies.
    #[must_use]
    pub fn of(bodies: &[BodyState]) -> Self {
        // Numbers and strings can all be written, so this cannot fail.
        let json = serde_json::to_value(bodies).map(|bodies| json!({ "bodies": bodies }).to_string());
        Self { json: json.unwrap_or_default(), ..Self::default() }
    }

    /// Whether it says nothing.
    pub(super) fn is_unset(&self) -> bool {
        *self == Self::default()
    }

    /// Stores what the file says.
    pub(super) fn load(&mut self, files: &dyn Files) -> Result<(), ConfigError> {
        let file = self.file.as_str();
        if file.is_empty() {
            return Ok(());
        }
        if !self.json.is_empty() {
            return Err(wrong("file", "give the bodies in one way: `file` or `json`"));
        }
        let read = || {
            inside(file, self.anywhere)?;
            let bytes = files.bytes(file, self.anywhere)?;
            bodies(file, std::str::from_utf8(&bytes).map_err(|_| "it is not text in UTF-8")?)
        };
        *self = Self::of(&read().map_err(|error: String| wrong("file", format!("{file}: {error}")))?);
        Ok(())
    }

    /// The bodies, of which some must be among `names`.
    pub(super) fn states(&self, names: &[&str]) -> Result<Vec<BodyState>, ConfigError> {
        if !self.file.is_empty() {
            let message = format!("{} has not been read: the scenario was read without its files", self.file);
            return Err(wrong("file", message));
        }
        if self.json.is_empty() {
            return Ok(Vec::new());
        }
        let all = bodies("", &self.json).map_err(|message| wrong("json", message))?;
        for (index, body) in all.iter().enumerate() {
            body.check().map_err(|message| wrong("json", format!("{}: {message}", body.name)))?;
            if all[..index].iter().any(|other| other.name == body.name) {
                return Err(wrong("json", format!("{:?} is there twice", body.name)));
            }
        }
        if all.iter().any(|body| names.contains(&body.name.as_str())) {
            return Ok(all);
        }
        let Some(first) = all.first() else { return Err(wrong("json", "which bodies? Its list `bodies` is empty")) };
        let near = nearest(&first.name, names.iter().copied());
        let near = near.map(|near| format!("; did you mean {near:?}?")).unwrap_or_default();
        Err(wrong("json", format!("none of its bodies is in this world: there is no {:?}{near}", first.name)))
    }

    /// Those of its bodies that are not in this world, in words.
    pub(super) fn note(&self, is_there: impl Fn(&str) -> bool) -> Option<String> {
        let all = if self.json.is_empty() { Vec::new() } else { bodies("", &self.json).unwrap_or_default() };
        let others: Vec<String> = all.into_iter().map(|body| body.name).filter(|name| !is_there(name)).collect();
        let shown = others.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
        let more = if others.len() > SHOWN { " and others" } else { "" };
        (!others.is_empty()).then(|| format!("`start_from` has bodies that this world has not: {shown}{more}"))
    }
}

/// How many names a note has at most.
const SHOWN: usize = 6;

impl BodyState {
    /// What is wrong with its numbers.
    fn check(&self) -> Result<(), String> {
        let ranges: [(&str, &[f64], f64, &str); 4] = [
            ("at_mm", &self.at_mm, Place::MOST, Place::UNIT),
            ("velocity_m_s", &self.velocity_m_s, Velocity::MOST, Velocity::UNIT),
            ("spin_deg_s", &self.spin_deg_s, Turning::MOST, Turning::UNIT),
            ("orientation", &self.orientation, Place::MOST, "in each part"),
        ];
        for (name, numbers, most, unit) in ranges {
            if let Some(number) = numbers.iter().find(|number| number.is_nan() || number.abs() > most) {
                return Err(format!("{name}: {number} must be from -{most} to {most} {unit}"));
            }
        }
        self.quaternion().map(drop).ok_or_else(|| "orientation: a quaternion that is not 0".into())
    }

    /// Its orientation; `None` if the quaternion is 0.
    pub(super) fn quaternion(&self) -> Option<DQuat> {
        let turn = DQuat::from_array(self.orientation);
        // Scaled first, so that no square is lost.
        let most = turn.to_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        (most > 0.0).then(|| (turn / most).normalize())
    }

    pub(super) fn values(numbers: [f64; 3]) -> [Value; 3] {
        numbers.map(Value::Fixed)
    }
}

/// The bodies in a file, an object or table with a list `bodies`; the rest of it is not needed.
fn bodies(file: &str, text: &str) -> Result<Vec<BodyState>, String> {
    let is_toml = file.rsplit_once('.').is_some_and(|(_, end)| end.eq_ignore_ascii_case("toml"));
    let text = text.trim_start_matches('\u{feff}');
    let mut whole: serde_json::Value = if is_toml {
        toml::from_str(text).map_err(|error| error.to_string())?
    } else {
        serde_json::from_str(text).map_err(|error| error.to_string())?
    };
    let list = match whole.get_mut("bodies").map(serde_json::Value::take) {
        Some(serde_json::Value::Array(list)) => list,
        _ => return Err("it has no list `bodies`: `plaus export --format state` writes such a file".into()),
    };
    let read = |(index, value)| serde_json::from_value(value).map_err(|error| format!("bodies[{index}]: {error}"));
    list.into_iter().enumerate().map(read).collect()
}
