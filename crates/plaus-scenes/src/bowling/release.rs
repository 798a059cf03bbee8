//! The laws of a delivery: which quantities of the ball are uncertain, and how.

use super::alley::Alley;
use crate::scene::ConfigError;
use crate::settings::settings;
use plaus_dist::{Gaussian, ParamError, TruncatedGaussian, WrappedUniform};
use plaus_mcmc::Law;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// A set of laws of the delivery.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Delivery {
    /// The paper's appendix A.1: a solid ball of 176 to 220 mm, released anywhere across the lane, with no spin except
    /// a little about the vertical, on a lane with the same friction everywhere. Its largest ball is larger than the
    /// rules allow.
    #[default]
    Paper,
    /// Balls within the rules, with the speed and spin that good players give them, on a lane oiled over its first 12
    /// m.
    Regulation,
}

settings! {
    /// Changes to the laws of the chosen delivery. Unset keys keep that delivery's values. A standard deviation of 0,
    /// or an interval of one value, makes a quantity certain.
    #[derive(Copy)]
    pub struct Release {
        /// Least radius of the ball.
        radius_min_mm: Option<f64>, 10.0..=1000.0, "mm";
        /// Largest radius of the ball. Regulation: 107.95 to 109.16.
        #[schemars(extend("x-example" = 110.0))]
        radius_max_mm: Option<f64>, 10.0..=1000.0, "mm";
        /// Least density of the ball.
        density_min: Option<f64>, 10.0..=25000.0, "kg/m³";
        /// Largest density of the ball. Regulation: 1331, so that the largest ball has no more than 7.26 kg.
        #[schemars(extend("x-example" = 1440.0))]
        density_max: Option<f64>, 10.0..=25000.0, "kg/m³";
        /// Least radius of gyration, relative to the ball's radius; a solid ball has 0.6325.
        gyration_min: Option<f64>, 0.1..=1.0;
        /// Largest radius of gyration, relative to the ball's radius.
        #[schemars(extend("x-example" = 0.7))]
        gyration_max: Option<f64>, 0.1..=1.0;
        /// How far the ball's centre may be from the middle of the lane when it is released.
        across_m: Option<f64>, 0.0..=0.6, "m";
        /// Mean height of the ball's centre above the lane, relative to its largest radius. The ball never starts
        /// inside the lane.
        height_mean: Option<f64>, 0.0..=20.0;
        /// Standard deviation of that height, relative to the largest radius.
        height_sd: Option<f64>, 0.0..=20.0;
        /// Mean speed along the lane.
        speed_mean: Option<f64>, 0.1..=100.0, "m/s";
        /// Standard deviation of the speed along the lane.
        speed_sd: Option<f64>, 0.0..=100.0, "m/s";
        /// Mean speed across the lane, to the bowler's right.
        drift_mean: Option<f64>, -100.0..=100.0, "m/s";
        /// Standard deviation of the speed across the lane.
        drift_sd: Option<f64>, 0.0..=100.0, "m/s";
        /// Mean angular velocity of forward roll, about the axis across the lane. A ball that rolls has its speed over
        /// its radius.
        roll_mean: Option<f64>, -1000.0..=1000.0, "rad/s";
        /// Standard deviation of the forward roll.
        roll_sd: Option<f64>, 0.0..=1000.0, "rad/s";
        /// Mean angular velocity about the axis along the lane. It makes the ball hook, to the bowler's right if
        /// positive.
        hook_mean: Option<f64>, -1000.0..=1000.0, "rad/s";
        /// Standard deviation of the hook.
        hook_sd: Option<f64>, 0.0..=1000.0, "rad/s";
        /// Mean angular velocity about the vertical, anticlockwise from above.
        twist_mean: Option<f64>, -1000.0..=1000.0, "rad/s";
        /// Standard deviation of the angular velocity about the vertical.
        twist_sd: Option<f64>, 0.0..=1000.0, "rad/s";
    }
}

/// A quantity of the ball; its value's index in [`super::Shot::ball`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Radius in m.
    Radius,
    /// Density in kg/m³.
    Density,
    /// Radius of gyration over radius.
    Gyration,
    /// Place of the centre across the lane in m.
    Across,
    /// Height of the centre above the lane in m.
    Height,
    /// Speed along the lane in m/s.
    Speed,
    /// Speed across the lane in m/s.
    Drift,
    /// Angular velocity of forward roll, about −x, in rad/s.
    Roll,
    /// Angular velocity about +y in rad/s.
    Hook,
    /// Angular velocity about the vertical in rad/s.
    Twist,
}

impl Quantity {
    /// All of them, in the order of their indices.
    pub const ALL: [Self; 10] = [
        Self::Radius,
        Self::Density,
        Self::Gyration,
        Self::Across,
        Self::Height,
        Self::Speed,
        Self::Drift,
        Self::Roll,
        Self::Hook,
        Self::Twist,
    ];

    /// Its name in tables, and its unit.
    #[must_use]
    pub fn name(self) -> (&'static str, &'static str) {
        const NAMES: [&str; 10] =
            ["radius", "density", "gyration", "across", "height", "speed", "drift", "roll", "hook", "twist"];
        let unit = match self {
            Self::Radius | Self::Across | Self::Height => "m",
            Self::Density => "kg/m³",
            Self::Gyration => "",
            Self::Speed | Self::Drift => "m/s",
            Self::Roll | Self::Hook | Self::Twist => "rad/s",
        };
        (NAMES[self as usize], unit)
    }

    /// What it becomes when left and right are exchanged.
    #[must_use]
    pub fn mirrored(self, value: f64) -> f64 {
        match self {
            Self::Across | Self::Drift | Self::Hook | Self::Twist => -value,
            _ => value,
        }
    }
}

/// The laws of all quantities that a configuration asks for.
///
/// # Errors
/// [`ConfigError`] if an interval ends before it begins, or a ball is too large for its place.
pub(super) fn laws(delivery: Delivery, release: &Release) -> Result<[Law; 10], ConfigError> {
    let base = preset(delivery);
    let bad = |key: &str, message: String| ConfigError::new(format!("world.bowling.release.{key}"), message);
    let wrong = |key: &'static str| move |error: ParamError| bad(key, error.to_string());
    let of = |key: fn(&Release) -> Option<f64>| key(release).or(key(&base)).unwrap_or(0.0);
    // Turns −0 into 0.
    let interval = |key: &'static str, low: f64, high: f64| match (low + 0.0).total_cmp(&(high + 0.0)) {
        Ordering::Less => WrappedUniform::new(low, high).map(Law::Uniform).map_err(wrong(key)),
        Ordering::Equal => Ok(Law::Fixed(low)),
        Ordering::Greater => Err(bad(key, format!("the interval ends at {high}, before it begins at {low}"))),
    };
    let gaussian = |key: &'static str, mean: f64, sd: f64| {
        if sd > 0.0 { Gaussian::new(mean, sd).map(Law::Gaussian).map_err(wrong(key)) } else { Ok(Law::Fixed(mean)) }
    };
    let (least, largest) = (of(|keys| keys.radius_min_mm) / 1000.0, of(|keys| keys.radius_max_mm) / 1000.0);
    if 2.0 * largest > Alley::WIDTH {
        let most = 500.0 * Alley::WIDTH;
        return Err(bad("radius_max_mm", format!("a ball of this radius is wider than the lane: at most {most:.1}")));
    }
    let (mean, sd) = (largest * of(|keys| keys.height_mean), largest * of(|keys| keys.height_sd));
    let height = if sd > 0.0 {
        // The interval is longest, and its mass least, for the largest ball.
        TruncatedGaussian::new(mean, sd, largest, f64::INFINITY).map_err(wrong("height_mean"))?;
        Law::Above(mean, sd, Quantity::Radius as usize)
    } else if mean >= largest {
        Law::Fixed(mean)
    } else {
        let message = "if it is certain, it must be at least 1, or the largest ball starts inside the lane";
        return Err(bad("height_mean", message.into()));
    };
    let across = of(|keys| keys.across_m);
    Ok([
        interval("radius_max_mm", least, largest)?,
        interval("density_max", of(|keys| keys.density_min), of(|keys| keys.density_max))?,
        interval("gyration_max", of(|keys| keys.gyration_min), of(|keys| keys.gyration_max))?,
        interval("across_m", -across, across)?,
        height,
        gaussian("speed_sd", of(|keys| keys.speed_mean), of(|keys| keys.speed_sd))?,
        gaussian("drift_sd", of(|keys| keys.drift_mean), of(|keys| keys.drift_sd))?,
        gaussian("roll_sd", of(|keys| keys.roll_mean), of(|keys| keys.roll_sd))?,
        gaussian("hook_sd", of(|keys| keys.hook_mean), of(|keys| keys.hook_sd))?,
        gaussian("twist_sd", of(|keys| keys.twist_mean), of(|keys| keys.twist_sd))?,
    ])
}

/// The keys of a delivery.
fn preset(delivery: Delivery) -> Release {
    let paper = Release {
        radius_min_mm: Some(88.0),
        radius_max_mm: Some(110.0),
        density_min: Some(1152.0),
        density_max: Some(1440.0),
        // A solid ball: √(2/5).
        gyration_min: Some(0.632_455_532_033_675_9),
        gyration_max: Some(0.632_455_532_033_675_9),
        across_m: Some(Alley::WIDTH / 2.0),
        height_mean: Some(1.1),
        height_sd: Some(0.1),
        speed_mean: Some(7.0),
        speed_sd: Some(1.0),
        drift_sd: Some(0.1),
        twist_sd: Some(0.2),
        ..Release::default()
    };
    match delivery {
        Delivery::Paper => paper,
        Delivery::Regulation => Release {
            radius_min_mm: Some(107.95),
            radius_max_mm: Some(109.16),
            // 5.4 kg (12 lb) for the smallest, 7.26 kg (16 lb) for the largest.
            density_min: Some(1025.0),
            density_max: Some(1331.0),
            // 2.46 to 2.80 inches.
            gyration_min: Some(0.576),
            gyration_max: Some(0.655),
            across_m: Some(0.42),
            speed_mean: Some(8.0),
            speed_sd: Some(0.5),
            drift_sd: Some(0.3),
            roll_mean: Some(25.0),
            roll_sd: Some(10.0),
            hook_sd: Some(20.0),
            twist_sd: Some(8.0),
            ..paper
        },
    }
}
