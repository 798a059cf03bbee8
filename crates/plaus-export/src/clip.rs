//! What is exported: an animation, a part of its time, and facts about it.

use plaus_animation::{Animation, Physics};
use serde_json::{Map, Value, json};

/// The most poses, over all bodies, in one file.
pub const MOST_POSES: f64 = 1e7;

/// Frames per second by default: where keys may lie, besides those at every impact.
pub const FPS: f64 = 60.0;

/// What is exported.
#[derive(Debug, Clone, Copy)]
pub struct Clip<'a> {
    /// The motion.
    pub animation: &'a Animation,
    /// Facts about it.
    pub label: &'a Label,
    /// The part of its time.
    pub cut: Cut,
    /// How it is written.
    pub style: Style,
    /// The world that it starts in, if [`Style::engines`] asks for it.
    pub physics: Option<&'a Physics>,
    /// Called with the number of frames done and their total, by formats whose frames take long to make.
    pub progress: fn(u64, u64),
}

impl<'a> Clip<'a> {
    /// A part of an animation, in the default style.
    #[must_use]
    pub fn new(animation: &'a Animation, label: &'a Label, cut: Cut) -> Self {
        Self { animation, label, cut, style: Style::default(), physics: None, progress: |_, _| () }
    }

    /// The same clip in another style.
    #[must_use]
    pub fn styled(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// The same clip, for physics engines too; with the feature `physics`.
    #[cfg(feature = "physics")]
    #[must_use]
    pub fn with_physics(self, physics: Option<&'a Physics>) -> Self {
        Self { physics, ..self }
    }

    /// The same clip, with progress reported to `progress`.
    #[must_use]
    pub fn watched(self, progress: fn(u64, u64)) -> Self {
        Self { progress, ..self }
    }
}

/// How animations are written, if a format leaves a choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// How keys are joined.
    pub keys: Between,
    /// Time codes per second in USD: the frame rate of the scene, in programs without a clock of their own. Default 24,
    /// the rate of Blender's scenes.
    pub time_codes: f64,
    /// Which axis points up.
    pub up: Up,
    /// Units per metre: 100 for programs that use centimetres.
    pub scale: f64,
    /// Whether the clip's one body is the root node and carries the motion itself, for game engines in which an
    /// animation moves an actor. [`Style::up`] and [`Style::scale`] are then applied to the keys.
    pub root_motion: bool,
    /// What a GLB has for physics engines.
    pub engines: Engines,
    /// Pixels across and down, for pictures and videos; `None` means the format's default.
    pub size: Option<(u32, u32)>,
}

impl Default for Style {
    fn default() -> Self {
        let (keys, up, engines) = (Between::Linear, Up::Y, Engines::Nothing);
        Self { keys, time_codes: 24.0, up, scale: 1.0, root_motion: false, engines, size: None }
    }
}

/// How programs that read a file should join two keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Between {
    /// Straight lines, with keys as dense as the motion requires: right in every program, to the tolerances of
    /// [`crate::keys`].
    #[default]
    Linear,
    /// Cubic splines with exact tangents, if the format has them: exact in programs that evaluate them as glTF
    /// specifies. Blender does not.
    Exact,
}

/// What a file has for physics engines. Of each clip it then needs the world that it [starts in](Clip::physics).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Engines {
    /// Nothing.
    #[default]
    Nothing,
    /// The world at the start, besides the motion. Engines that follow the extension play the motion then, and let
    /// other bodies of theirs meet it.
    Beside,
    /// The world at the start, and no motion but that of bodies that follow keys, for engines to simulate.
    Alone,
}

/// The axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// As in glTF, Blender's importer, Godot and Unity.
    #[default]
    Y,
    /// As in Unreal, Blender's own axes and much of robotics.
    Z,
}

/// A name, and facts that travel with the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Label {
    /// Name of the animation.
    pub name: String,
    /// Facts: sample, seed, log p and the like.
    pub facts: Map<String, Value>,
}

impl Label {
    /// A name without any facts.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), facts: Map::new() }
    }

    /// With facts about the frames of a cut: their rate, the range of time, and the frame that a scene's frame range
    /// should end at, for programs that do not set it themselves.
    #[must_use]
    pub fn timed(mut self, cut: &Cut) -> Self {
        let last = (cut.length() * cut.fps).ceil();
        let facts = [("fps", json!(cut.fps)), ("time_range", json!([cut.from, cut.to])), ("last_frame", json!(last))];
        self.facts.extend(facts.map(|(name, value)| (name.to_owned(), value)));
        self
    }
}

/// A part of an animation's time and how often it is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    fps: f64,
    from: f64,
    to: f64,
}

impl Cut {
    /// `fps` frames per second from one time to another (in s), or over the whole animation. A range that ends after
    /// the animation ends with it.
    ///
    /// # Errors
    /// [`ExportError`] if that makes no frames, or more than [`MOST_POSES`] poses.
    pub fn new(fps: f64, range: Option<(f64, f64)>, animation: &Animation) -> Result<Self, ExportError> {
        let duration = animation.motion.duration;
        let (from, end) = range.unwrap_or((0.0, duration));
        let to = end.min(duration);
        if !(from >= 0.0 && (from < to || (range.is_none() && to == 0.0))) {
            return Err(ExportError::Range { from, to: end, duration });
        }
        let poses = (to - from) * fps * animation.motion.tracks.len().max(1) as f64;
        if !(fps > 0.0 && poses <= MOST_POSES) {
            return Err(ExportError::Fps(fps));
        }
        Ok(Self { fps, from, to })
    }

    /// Frames per second.
    #[must_use]
    pub fn fps(&self) -> f64 {
        self.fps
    }

    /// Where it begins, in s of the animation.
    #[must_use]
    pub fn from(&self) -> f64 {
        self.from
    }

    /// Where it ends, in s of the animation.
    #[must_use]
    pub fn to(&self) -> f64 {
        self.to
    }

    /// Its length in s.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.to - self.from
    }

    /// Whether it contains a time of the animation.
    #[must_use]
    pub fn holds(&self, time: f64) -> bool {
        (self.from..=self.to).contains(&time)
    }
}

/// Why something cannot be exported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// Too few or too many frames.
    #[error("the frames a second must be above 0 and make at most {MOST_POSES} poses")]
    Fps(f64),
    /// An empty range.
    #[error("the range of time must begin at 0 or later and end after it begins; the animation ends at {duration} s")]
    Range {
        /// Where it begins, s.
        from: f64,
        /// Where it ends, s.
        to: f64,
        /// Duration of the animation, s.
        duration: f64,
    },
    /// More bytes than the format can hold.
    #[error(
        "the file would be longer than 4 GiB, the most that it can hold: choose fewer frames a second, fewer \
         samples, or less of the time"
    )]
    TooLong,
    /// A value that the format cannot store.
    #[error("cannot be written as JSON: {0}")]
    Json(String),
    /// A format lacks something that it needs, or cannot show this much.
    #[error("{0}")]
    Impossible(String),
    /// An error of the disk.
    #[error("{0}")]
    Output(#[from] std::io::Error),
}
