//! Ropes as bodies and joints.

use super::config::{Body, Config};
use super::joints::Joint;
use crate::scene::ConfigError;
use serde_json::from_value;

/// Ropes as bodies and joints, after all others.
pub(super) struct Spelled {
    pub(super) config: Config,
    /// The rope of each body and of each joint, and how many others there are.
    of: [(usize, Vec<usize>); 2],
}

impl Spelled {
    pub(super) fn new(config: &Config) -> Result<Self, ConfigError> {
        let mut spelled = Self {
            of: [(config.bodies.len(), Vec::new()), (config.joints.len(), Vec::new())],
            config: Config { ropes: Vec::new(), ..config.clone() },
        };
        for (index, rope) in config.ropes.iter().enumerate() {
            let key = format!("world.custom.ropes[{index}]");
            let wrong = |error: serde_json::Error| ConfigError::new(key.clone(), error);
            let (body, joints) = rope.tables(&key)?;
            spelled.config.bodies.push(from_value::<Body>(body).map_err(wrong)?);
            spelled.of[0].1.push(index);
            for joint in joints {
                spelled.config.joints.push(from_value::<Joint>(joint).map_err(wrong)?);
                spelled.of[1].1.push(index);
            }
        }
        Ok(spelled)
    }

    /// An error, at the rope where it is about what a rope became.
    pub(super) fn blamed(&self, error: ConfigError) -> ConfigError {
        let rope = ["bodies", "joints"].iter().zip(&self.of).find_map(|(list, (others, ropes))| {
            let (index, _) =
                error.key.strip_prefix("world.custom.")?.strip_prefix(list)?.strip_prefix('[')?.split_once(']')?;
            ropes.get(index.parse::<usize>().ok()?.checked_sub(*others)?)
        });
        match rope {
            Some(rope) => ConfigError { key: format!("world.custom.ropes[{rope}]"), ..error },
            None => error,
        }
    }
}
