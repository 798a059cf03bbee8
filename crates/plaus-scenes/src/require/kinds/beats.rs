//! Events on the beats of a rhythm.

use crate::files::{Files, inside};
use crate::require::accents::{Accents, Hit};
use crate::require::event::{Event, What};
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{FAR, Mark, Reach};
use crate::require::timed::{Timed, known, words};
use crate::require::when::Window;
use crate::scene::ConfigError;
use crate::settings::settings;
use plaus_animation::Impact;
use plaus_asset::onsets::{Strengths, Stroke, Which, onsets, strokes};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

settings! {
    /// Impacts come on beats: at regular times, or at those of a list.
    pub struct Beats {
        /// Name of a body, or a pattern such as `ball_*`. May be left out if there is only one.
        body: String;
        /// What it hits: a body, a part of the scenery, or a pattern; empty: anything.
        with: String;
        /// Which impact of each body, counted from 1; −1 is the last.
        nth: i32 = 1, -10_000..=10_000;
        /// Only count impacts at which the two meet at this speed or faster.
        faster_than: f64 = 0.0, 0.0..=1000.0, "m/s";
        /// What must coincide with what.
        each: Each = Each::Body;
        /// Time between beats: 0.5 means 120 beats a minute. Unset: the beats are in `times_s`.
        #[schemars(extend("x-example" = 0.5))]
        every_s: Option<f64>, 1e-3..=3600.0, "s";
        /// Time of the first regular beat.
        offset_s: f64 = 0.0, 0.0..=3600.0, "s";
        /// The times of the beats, in place of regular ones.
        #[schemars(length(max = 10_000), extend("x-unit" = "s"))]
        times_s: Vec<f64>;
        /// A file with the times of the beats, in place of `times_s`, and with their strengths, if `strength` asks for
        /// these. A run stores them, and then no longer needs the file.
        times_from: Option<Onsets>;
        /// How strong impacts must be: as strong as the beats that they are nearest to, which have the velocities of
        /// notes, or `strengths`. Unset: any.
        strength: Option<Accents>;
        /// The strengths of the beats in `times_s`, in any unit.
        #[schemars(length(max = 10_000))]
        strengths: Vec<f64>;
        /// How far from a beat an impact may be.
        within_ms: f64 = 20.0, 1e-3..=1e6, "ms";
        /// How many milliseconds beyond that cost one nat.
        scale_ms: f64 = 10.0, 1e-6..=1e6, "ms";
    }
}

/// Times in a file: of a table, or of notes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Onsets {
    /// The file, `.csv`, `.mid` or `.midi`: its path from the scenario's folder, with `/` between folders.
    pub file: String,
    /// For a table: the column with this name in its first row, in seconds. Unset: the first column.
    #[serde(default)]
    pub column: Option<String>,
    /// For a table: the column of strengths, if `strength` asks for these. Unset: the one after that of the times.
    #[serde(default)]
    pub strengths: Option<String>,
    /// For MIDI: only notes of this key; 36 is a bass drum, 60 is middle C. Unset: all.
    #[serde(default)]
    #[schemars(range(min = 0, max = 127))]
    pub note: Option<u8>,
    /// For MIDI: only notes of this channel; 10 is the drums. Unset: all.
    #[serde(default)]
    #[schemars(range(min = 1, max = 16))]
    pub channel: Option<u8>,
    /// Whether the file may lie outside the scenario's folder.
    #[serde(default)]
    pub anywhere: bool,
}

/// Most beats of a list.
const MOST_BEATS: usize = 10_000;

impl Onsets {
    /// The times in the file, and the strengths if they are asked for.
    fn read(&self, key: &str, files: &dyn Files, is_strong: bool) -> Result<[Vec<f64>; 2], ConfigError> {
        let wrong = |message: String| ConfigError::new(format!("{key}.file"), format!("{}: {message}", self.file));
        inside(&self.file, self.anywhere).map_err(wrong)?;
        let bytes = files.bytes(&self.file, self.anywhere).map_err(wrong)?;
        let which = Which { column: self.column.as_deref(), note: self.note, channel: self.channel };
        let [times, strengths] = if is_strong {
            let column = self.strengths.as_deref().map_or(Strengths::Usual, Strengths::Column);
            let all = strokes(&self.file, &bytes, &which, column).map_err(|error| wrong(error.to_string()))?;
            let of = |one: fn(&Stroke) -> f64| all.iter().map(one).collect();
            [of(|stroke| stroke.time), of(|stroke| stroke.strength)]
        } else {
            [onsets(&self.file, &bytes, &which).map_err(|error| wrong(error.to_string()))?, Vec::new()]
        };
        if times.len() > MOST_BEATS {
            return Err(wrong(format!("it has {} beats; the most allowed is {MOST_BEATS}", times.len())));
        }
        Ok([times, strengths])
    }
}

/// What must coincide with what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Each {
    /// The `nth` impact of every body falls on a beat.
    #[default]
    Body,
    /// Every impact that counts falls on a beat; without impacts, nothing is required.
    Impact,
    /// An impact falls on every beat of `times_s`.
    Beat,
}

impl Beats {
    fn event(&self, body: &str) -> Event {
        let with = self.with.clone();
        Event {
            body: body.into(),
            what: What::Impact,
            with,
            nth: self.nth,
            faster_than: self.faster_than,
            ..Event::default()
        }
    }

    /// The number of the regular beat nearest to a time, from 0.
    fn number(&self, time: f64, every: f64) -> f64 {
        ((time - self.offset_s) / every).round().max(0.0)
    }

    /// How far a time is from the nearest beat, in s.
    fn off(&self, time: f64) -> f64 {
        match self.every_s {
            Some(every) => (time - self.offset_s - self.number(time, every) * every).abs(),
            None => self.times_s.iter().map(|beat| (time - beat).abs()).fold(f64::INFINITY, f64::min),
        }
    }

    /// The beat nearest to a time, in s; the first if there is no time.
    fn nearest(&self, time: Option<f64>) -> f64 {
        let time = time.unwrap_or(0.0);
        match self.every_s {
            Some(every) => self.offset_s + self.number(time, every) * every,
            None => {
                self.times_s.iter().copied().min_by(|a, b| (time - a).abs().total_cmp(&(time - b).abs())).unwrap_or(0.0)
            }
        }
    }

    /// The impacts that are known to be the ones whose strength counts.
    fn struck(&self, probe: &Probe<'_>) -> Vec<Hit> {
        let strength = |time: f64| {
            let far = |beat: &f64| (time - beat).abs();
            let beats = self.times_s.iter().zip(&self.strengths);
            beats.min_by(|a, b| far(a.0).total_cmp(&far(b.0))).map_or(1.0, |(_, strength)| *strength)
        };
        let struck = |hit: &Impact| [hit.impulse, strength(hit.time)];
        let hits = || probe.hits(&self.body, &self.with, self.faster_than);
        match self.each {
            Each::Body => {
                let is_known = probe.is_whole() || self.nth > 0;
                let found = probe.bodies(&self.body).filter_map(|body| self.event(body).found(probe));
                found.filter(|_| is_known).map(struck).collect()
            }
            Each::Impact => hits().map(struck).collect(),
            Each::Beat => {
                let one = |(beat, strength): (&f64, &f64)| {
                    let far = |hit: &&Impact| (hit.time - beat).abs();
                    let nearest = hits().min_by(|a, b| far(a).total_cmp(&far(b)))?;
                    let is_known = probe.is_whole() || far(&nearest) <= probe.known() - beat;
                    is_known.then_some([nearest.impulse, *strength])
                };
                self.times_s.iter().zip(&self.strengths).filter_map(one).collect()
            }
        }
    }

    /// The range of the mark of impacts' strengths, if these matter.
    fn strong(&self, probe: &Probe<'_>) -> Option<Reach> {
        let strongest = self.strengths.iter().copied().fold(0.0, f64::max);
        let most = self.strength.as_ref()?.mark(&self.struck(probe), strongest);
        Some(Reach { least: if probe.is_whole() { most } else { Mark::of(-FAR) }, most })
    }

    /// Refuses strengths without beats that have them, and beats without their strengths.
    fn check_strengths(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        let wrong = |key: &str, message: &str| Err(place.at(key).wrong(message));
        let (beats, count) = (self.times_s.len(), self.strengths.len());
        match (&self.strength, count) {
            (None, 0) => Ok(()),
            (None, _) => wrong("strengths", "nothing asks for them: add `strength = {}`, or leave them out"),
            (Some(_), _) if self.every_s.is_some() => {
                wrong("strength", "regular beats have no strengths: list the beats in `times_s`")
            }
            (Some(_), 0) => wrong("strength", "the beats have no strengths: give `strengths` or `times_from`"),
            (Some(_), _) if count != beats => {
                wrong("strengths", &format!("{count} strengths of {beats} beats: give one for each in `times_s`"))
            }
            (Some(_), _) if !self.strengths.iter().all(|one| *one > 0.0 && *one <= 1e9) => {
                wrong("strengths", "numbers above 0, up to 1e9")
            }
            (Some(_), _) => Ok(()),
        }
    }

    /// What happened at a beat.
    fn timed(&self, what: String, beat: f64, found: Option<f64>) -> Timed {
        let within = 1e-3 * self.within_ms;
        Timed { what, wanted: Window { from: beat - within, to: beat + within }, found }
    }

    fn margin(&self, off: f64) -> f64 {
        ((1e-3 * self.within_ms - off) / (1e-3 * self.scale_ms)).max(-FAR)
    }

    /// The range of the margin of every single condition.
    fn parts(&self, probe: &Probe<'_>) -> Vec<Reach> {
        let best = self.margin(0.0);
        let open = Reach::between(-FAR, best);
        let hits = || probe.hits(&self.body, &self.with, self.faster_than);
        match self.each {
            Each::Body => {
                let one = |body| {
                    let time = self.event(body).time(probe);
                    match (time.low == time.high, time.low.is_finite()) {
                        (true, true) => Reach::certain(self.margin(self.off(time.low))),
                        (true, false) => Reach::NEVER,
                        _ => open,
                    }
                };
                probe.bodies(&self.body).map(one).collect()
            }
            Each::Impact => {
                let more = (!probe.is_whole()).then(|| Reach::between(-FAR, best));
                hits().map(|hit| Reach::certain(self.margin(self.off(hit.time)))).chain(more).collect()
            }
            Each::Beat => {
                let one = |beat: &f64| {
                    let known = hits().map(|hit| (hit.time - beat).abs()).fold(f64::INFINITY, f64::min);
                    let later = if probe.is_whole() { f64::INFINITY } else { (probe.known() - beat).max(0.0) };
                    Reach::between(self.margin(known), self.margin(known.min(later)))
                };
                self.times_s.iter().map(one).collect()
            }
        }
    }
}

impl Ask for Beats {
    /// Stores the times in `times_s` and their strengths, so that a run no longer needs the file.
    fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        let Some(from) = &self.times_from else { return Ok(()) };
        if self.every_s.is_some() || !self.times_s.is_empty() {
            let message = "give the beats in one way: `every_s`, `times_s` or `times_from`";
            return Err(ConfigError::new(format!("{key}.times_from"), message));
        }
        if !self.strengths.is_empty() {
            let message = "the file has them: leave `strengths` out, or write `times_s`";
            return Err(ConfigError::new(format!("{key}.strengths"), message));
        }
        if from.strengths.is_some() && self.strength.is_none() {
            let message = "nothing asks for strengths: add `strength = {}` beside `times_from`, or leave this out";
            return Err(ConfigError::new(format!("{key}.times_from.strengths"), message));
        }
        [self.times_s, self.strengths] = from.read(&format!("{key}.times_from"), files, self.strength.is_some())?;
        self.times_from = None;
        Ok(())
    }

    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.body("body", &self.body)?;
        place.partner("with", &self.with)?;
        if self.nth == 0 {
            return Err(place.at("nth").wrong("there is no impact 0: count from 1 forwards, or from −1 backwards"));
        }
        self.check_strengths(place)?;
        let longest = place.cast().longest;
        if let Some(late) = self.times_s.iter().find(|time| !(**time >= 0.0 && **time <= longest.min(3600.0))) {
            let message =
                format!("a beat at {late} s: beats are from 0 s to the end, {} s at most", longest.min(3600.0));
            return Err(place.at("times_s").wrong(&message));
        }
        match (self.every_s, self.times_s.is_empty(), self.each) {
            (Some(_), false, _) => Err(place.wrong("give the beats in one way: `every_s` or `times_s`")),
            (None, true, _) => Err(place.wrong("there are no beats: give `every_s`, `times_s` or `times_from`")),
            (Some(_), _, Each::Beat) => {
                Err(place.at("each").wrong("regular beats never end: list the beats that need an impact in `times_s`"))
            }
            (Some(_), ..) if self.offset_s > longest => {
                Err(place.at("offset_s").wrong(&format!("the first beat is after the end, {longest} s")))
            }
            _ => Ok(()),
        }
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        let hits = || probe.hits(&self.body, &self.with, self.faster_than).map(|hit| hit.time);
        match self.each {
            Each::Body => {
                let one = |body: &str| {
                    let event = self.event(body);
                    let found = known(&event, probe);
                    self.timed(words(&event, probe), self.nearest(found), found)
                };
                probe.bodies(&self.body).map(one).collect()
            }
            Each::Impact => (1..)
                .zip(hits())
                .map(|(k, time)| self.timed(format!("impact {k}"), self.nearest(Some(time)), Some(time)))
                .collect(),
            Each::Beat => (1..)
                .zip(&self.times_s)
                .map(|(k, &beat)| {
                    let found = hits().min_by(|a, b| (a - beat).abs().total_cmp(&(b - beat).abs()));
                    self.timed(format!("beat {k}"), beat, found)
                })
                .collect(),
        }
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        self.strength.is_none().then(|| Nat::of(self.scale_ms, "ms"))
    }

    /// Each condition costs what its margin lacks, and so does each impact's strength; the margin is that of the worst.
    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let parts: Vec<Reach> = self.parts(probe).into_iter().chain(self.strong(probe)).collect();
        let whole = |end: fn(&Reach) -> Mark| {
            let marks = parts.iter().map(end);
            marks.fold(Mark { margin: self.margin(0.0), log: 0.0 }, |all, one| Mark {
                margin: all.margin.min(one.margin),
                log: all.log + one.log,
            })
        };
        Reach { least: whole(|reach| reach.least), most: whole(|reach| reach.most) }
    }

    /// After each beat that needs an impact; an impact may be off any.
    fn looks(&self) -> Looks {
        let times = if self.each == Each::Beat { self.times_s.as_slice() } else { &[] };
        Looks {
            times: times.iter().map(|beat| beat + 1e-3 * self.within_ms).collect(),
            impacts: true,
            ..Looks::default()
        }
    }
}
