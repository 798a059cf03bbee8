//! Starts of bodies that a run, or another program, left in a file.

use super::amount::{Measure, Place, Turning, Velocity};
use super::values::Value;
use crate::files::{Files, inside};
use crate::scenario::nearest;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DQuat;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

settings! {
    /// How some bodies start: as a run of Plaus or another program left them. Each takes the place of the start of the
    /// body with its name.
    pub struct StartFrom {
        /// The file, `.json` or `.toml`: its path from the scenario's folder, with `/` between folders. `plaus export
        /// --format state` writes it. A run stores what it says, and then no longer needs the file.
        file: Option<String>;
        /// Whether the file may lie outside the scenario's folder.
        anywhere: bool;
        /// The bodies themselves, in place of a file.
        #[schemars(length(max = 4096))]
        bodies: Vec<BodyState>;
    }
}

/// Where a body is, and how it moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyState {
    /// Its name; of an array, such as `peg_3`.
    pub name: String,
    /// Where its origin is, the point that a body's own `at_mm` places.
    #[schemars(extend("x-unit" = "mm"))]
    pub at_mm: [f64; 3],
    /// How it is turned: a quaternion x, y, z, w from its own axes to the world's.
    #[serde(default = "upright")]
    pub orientation: [f64; 4],
    /// Velocity of its centre of gravity.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s"))]
    pub velocity_m_s: [f64; 3],
    /// How fast it turns, about the world's x, y and z axes.
    #[serde(default)]
    #[schemars(extend("x-unit" = "degree/s"))]
    pub spin_deg_s: [f64; 3],
}

fn upright() -> [f64; 4] {
    DQuat::IDENTITY.to_array()
}

/// The key, from the scenario's root.
pub(super) const KEY: &str = "world.custom.start_from";

impl StartFrom {
    /// Stores what the file says.
    pub(super) fn load(&mut self, files: &dyn Files) -> Result<(), ConfigError> {
        let Some(file) = &self.file else { return Ok(()) };
        if !self.bodies.is_empty() {
            return Err(ConfigError::new(format!("{KEY}.file"), "give the bodies in one way: `file` or `bodies`"));
        }
        let read = || {
            inside(file, self.anywhere)?;
            let bytes = files.bytes(file, self.anywhere)?;
            bodies(file, std::str::from_utf8(&bytes).map_err(|_| "it is not text in UTF-8")?)
        };
        let found = read().map_err(|error| ConfigError::new(format!("{KEY}.file"), format!("{file}: {error}")))?;
        *self = Self { bodies: found, ..Self::default() };
        Ok(())
    }

    /// Refuses what cannot be, and bodies of which none is among `names`.
    pub(super) fn check(&self, names: &[&str]) -> Result<(), ConfigError> {
        let wrong = |key: String, message: String| Err(ConfigError::new(format!("{KEY}.{key}"), message));
        if let Some(file) = &self.file {
            return wrong("file".into(), format!("{file} has not been read: the scenario was read without its files"));
        }
        for (index, body) in self.bodies.iter().enumerate() {
            let key = |name: &str| format!("bodies[{index}].{name}");
            let ranges: [(&str, &[f64], f64, &str); 4] = [
                ("at_mm", &body.at_mm, Place::MOST, Place::UNIT),
                ("velocity_m_s", &body.velocity_m_s, Velocity::MOST, Velocity::UNIT),
                ("spin_deg_s", &body.spin_deg_s, Turning::MOST, Turning::UNIT),
                ("orientation", &body.orientation, Place::MOST, ""),
            ];
            for (name, numbers, most, unit) in ranges {
                if let Some(number) = numbers.iter().find(|number| number.is_nan() || number.abs() > most) {
                    let message = format!("{}: {number} must be from -{most} to {most} {unit}", body.name);
                    return wrong(key(name), message.trim_end().into());
                }
            }
            if body.quaternion().is_none() {
                return wrong(key("orientation"), format!("{}: a quaternion that is not 0", body.name));
            }
            if self.bodies[..index].iter().any(|other| other.name == body.name) {
                return wrong(key("name"), format!("{:?} is there twice", body.name));
            }
        }
        if self.bodies.iter().any(|body| names.contains(&body.name.as_str())) {
            return Ok(());
        }
        let Some(first) = self.bodies.first() else {
            return wrong("bodies".into(), "which bodies? Give `file`, or `bodies`".into());
        };
        let near = nearest(&first.name, names.iter().copied());
        let near = near.map(|near| format!("; did you mean {near:?}?")).unwrap_or_default();
        wrong("bodies".into(), format!("none of its bodies is in this world: there is no {:?}{near}", first.name))
    }

    /// The body with this name.
    pub(super) fn of(&self, name: &str) -> Option<&BodyState> {
        self.bodies.iter().find(|body| body.name == name)
    }

    /// Those of its bodies that are not in this world, in words.
    pub(super) fn note(&self, is_there: impl Fn(&str) -> bool) -> Option<String> {
        let others: Vec<&str> =
            self.bodies.iter().map(|body| body.name.as_str()).filter(|name| !is_there(name)).collect();
        let (shown, more) = (others.iter().take(SHOWN), if others.len() > SHOWN { " and others" } else { "" });
        let shown = shown.copied().collect::<Vec<_>>().join(", ");
        (!others.is_empty()).then(|| format!("`start_from` has bodies that this world has not: {shown}{more}"))
    }
}

/// How many names a note has at most.
const SHOWN: usize = 6;

impl BodyState {
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
