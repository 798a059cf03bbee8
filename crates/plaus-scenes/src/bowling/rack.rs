//! Which pins are set up, and which of them should be left.

use super::config::Config;
use crate::scene::ConfigError;

/// The pins of a scenario.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rack {
    /// Numbers of the pins that are set up, in ascending order.
    pins: Vec<usize>,
    /// Whether each of them should stand at the end.
    leave: Vec<bool>,
    /// The index in `pins` of each one's mirror image, if the task is symmetric.
    mirrored: Option<Vec<usize>>,
}

impl Rack {
    /// The pins of a configuration.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] if there is no such pin, one is named twice, or one that is not set up should be left.
    pub(super) fn new(config: &Config) -> Result<Self, ConfigError> {
        let pins = numbers("pins", &config.pins)?;
        if pins.is_empty() {
            return Err(ConfigError::new("world.bowling.pins", "no pin is set up: at least one must be"));
        }
        let left = numbers("leave", &config.leave)?;
        if let Some(absent) = left.iter().find(|pin| !pins.contains(pin)) {
            let message = format!("pin {absent} cannot be left standing: it is not among the pins {pins:?}");
            return Err(ConfigError::new("world.bowling.leave", message));
        }
        let leave: Vec<bool> = pins.iter().map(|pin| left.contains(pin)).collect();
        let mut mirrored = Vec::new();
        for (k, pin) in pins.iter().enumerate() {
            let image = pins.iter().position(|other| *other == mirror_image(*pin));
            mirrored.extend(image.filter(|&image| leave[image] == leave[k]));
        }
        let mirrored = (mirrored.len() == pins.len()).then_some(mirrored);
        Ok(Self { pins, leave, mirrored })
    }

    /// Numbers of the pins that are set up, in ascending order.
    #[must_use]
    pub fn pins(&self) -> &[usize] {
        &self.pins
    }

    /// Whether each of them should stand at the end.
    #[must_use]
    pub fn leave(&self) -> &[bool] {
        &self.leave
    }

    /// The index in [`Rack::pins`] of each one's mirror image; `None` if the task is not symmetric.
    #[must_use]
    pub fn mirrored(&self) -> Option<&[usize]> {
        self.mirrored.as_deref()
    }
}

/// The pin that is the mirror image of a pin, in a mirror along the middle of the lane.
fn mirror_image(pin: usize) -> usize {
    // The numbers of a pin and of its mirror image have the same sum as the first and the last number of their row.
    match pin {
        1 => 1,
        2..=3 => 5 - pin,
        4..=6 => 10 - pin,
        _ => 17 - pin,
    }
}

fn numbers(key: &str, given: &[u32]) -> Result<Vec<usize>, ConfigError> {
    let wrong = |message: String| Err(ConfigError::new(format!("world.bowling.{key}"), message));
    let mut pins: Vec<usize> = Vec::new();
    for &pin in given {
        if !(1..=10).contains(&pin) {
            return wrong(format!("there is no pin {pin}: pins are numbered 1 to 10"));
        }
        if pins.contains(&(pin as usize)) {
            return wrong(format!("pin {pin} is named twice"));
        }
        pins.push(pin as usize);
    }
    pins.sort_unstable();
    Ok(pins)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rack(pins: &[u32], leave: &[u32]) -> Result<Rack, String> {
        let config = Config { pins: pins.to_vec(), leave: leave.to_vec(), ..Config::default() };
        Rack::new(&config).map_err(|error| error.to_string())
    }

    #[test]
    fn mirrors_exchange_left_and_right() {
        let all: Vec<u32> = (1..=10).collect();
        assert_eq!(rack(&all, &[]).unwrap().mirrored(), Some([0, 2, 1, 5, 4, 3, 9, 8, 7, 6].as_slice()));
        assert_eq!(rack(&all, &[6, 7]).unwrap().mirrored(), None);
        assert_eq!(rack(&[7, 10], &[]).unwrap().mirrored(), Some([1, 0].as_slice()));
        assert_eq!(rack(&[6, 7], &[]).unwrap().mirrored(), None);
        assert!(rack(&all, &[7, 10]).unwrap().mirrored().is_some());
    }

    #[test]
    fn pins_that_are_not_there_are_named() {
        assert!(rack(&[1, 11], &[]).unwrap_err().contains("no pin 11"));
        assert!(rack(&[1, 0], &[]).unwrap_err().contains("no pin 0"));
        assert!(rack(&[6, 7], &[10]).unwrap_err().contains("pin 10 cannot be left"));
        assert!(rack(&[6, 6], &[]).unwrap_err().contains("pin 6 is named twice"));
        assert!(rack(&[], &[]).unwrap_err().contains("at least one"));
    }
}
