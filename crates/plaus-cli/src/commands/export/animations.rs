//! Animations of samples, as files.

use super::Args;
use crate::{console, waiting};
use plaus_export::{Clip, Cut, ExportError, Exporter, glb, table};
use plaus_gallery::label;
use plaus_run::export::output;
use plaus_run::replay::{Replay, physics, replay_each_until};
use plaus_run::{Confirmation, Error, RunReader, SampleId, solutions};
use plaus_scenes::animation::{Animation, Physics, View};
use plaus_scenes::scenario::nearest;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Number of samples held in memory at a time.
const AT_A_TIME: usize = 64;
/// The file that marks a folder of animations. Only folders that have it are replaced.
const INDEX: &str = "plaus-export.json";

/// The animations to write.
pub(super) struct Animations<'a> {
    run: &'a RunReader<'a>,
    args: &'a Args,
    format: &'static dyn Exporter,
    samples: Vec<SampleId>,
}

impl<'a> Animations<'a> {
    pub(super) fn new(run: &'a RunReader<'a>, args: &'a Args, format: &'static dyn Exporter) -> Result<Self, Error> {
        let samples = if args.all_distinct {
            solutions::distinct(run)?.iter().map(|solution| solution.sample).collect()
        } else if let Some(count) = args.most_different {
            let count = usize::try_from(count).unwrap_or(usize::MAX);
            solutions::most_different(run, count)?.solutions.iter().map(|solution| solution.sample).collect()
        } else if args.confirmed {
            Confirmation::read(run)?.samples()
        } else {
            args.sample.clone()
        };
        if samples.is_empty() {
            let none = if args.confirmed {
                "none of the run's solutions holds at the accuracy at which they were confirmed"
            } else {
                "no sample of the run satisfies the constraint"
            };
            return Err(Error::Request(none.to_owned()));
        }
        Ok(Self { run, args, format, samples })
    }

    /// Writes them; gives their samples, in order.
    pub(super) fn write(self) -> Result<Vec<SampleId>, Error> {
        self.write_all()?;
        Ok(self.samples)
    }

    fn write_all(&self) -> Result<(), Error> {
        let (out, force) = (self.args.path(), self.args.force);
        let one = self.samples.len() == 1 && (!self.args.chooses() || self.args.makes_one());
        if out == Path::new("-") {
            if !self.format.is_table() {
                return Err(Error::Request("animations are written to files: name one by --out PATH".to_owned()));
            }
            let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
            self.all(Path::new("-"), &mut out)?;
            return out.flush().map_err(Error::Output);
        }
        if one || self.args.into.is_some() || self.format.is_table() {
            let (count, most) = (self.samples.len(), self.format.most());
            if count > most {
                let message = format!(
                    "{count} samples: one {} holds at most {most}; choose some by --sample, or make a folder by --out",
                    self.format.row().name
                );
                return Err(Error::Request(message));
            }
            output::file(out, force, |path| self.format.is_ours(path), |file| self.all(out, file))?;
            return self.beside(out);
        }
        output::folder(out, force, |path| path.join(INDEX).is_file(), |folder| self.fill(folder))
    }

    /// All samples as one file.
    fn all(&self, path: &Path, out: &mut dyn Write) -> Result<(), Error> {
        let (mut collection, out) = (self.format.begin(path), &mut Counted(out));
        for samples in self.samples.chunks(AT_A_TIME) {
            for replay in replay_each_until(self.run, samples, self.until(), |replay| self.as_asked(replay))? {
                self.clip(&replay, |clip| collection.add(&clip.watched(frames), out))?;
            }
        }
        collection.finish(out).map_err(refused)
    }

    fn until(&self) -> plaus_scenes::Until {
        self.args.motion.until.unwrap_or_default()
    }

    /// The same replay with only the impacts asked for, and seen from where that is asked for.
    fn as_asked(&self, mut replay: Replay) -> Replay {
        let motion = &self.args.motion;
        if let Some([x, y, z]) = motion.view {
            let seen = View::from(x, z, -y).exactly();
            let view = replay.animation.view.get_or_insert(seen);
            (view.from, view.exact) = (seen.from, true);
        }
        if motion.min_impulse.is_some() || motion.merge.is_some() {
            let impacts = &replay.animation.motion.impacts;
            replay.animation.motion.impacts =
                table::fewer(impacts, motion.min_impulse.unwrap_or(0.0), motion.merge.unwrap_or(0.0));
        }
        replay
    }

    /// The sample's whole animation, or the part about one body if only that is to be written.
    fn shown<'r>(&self, replay: &'r Replay) -> Result<Cow<'r, Animation>, Error> {
        let whole = &replay.animation;
        let Some(name) = &self.args.motion.root_motion else { return Ok(Cow::Borrowed(whole)) };
        whole.motion.only(name).map(|motion| Cow::Owned(Animation::from(motion))).ok_or_else(|| {
            let names: Vec<&str> = whole.motion.tracks.iter().map(|track| track.name.as_str()).collect();
            let near = nearest(name, names.iter().copied());
            let hint = near.map_or_else(|| "there are".to_owned(), |near| format!("did you mean {near}? There are"));
            Error::Request(format!("--root-motion {name}: there is no such body; {hint} {}", names.join(", ")))
        })
    }

    /// Passes a sample to `make` in the form in which it is written.
    fn clip<T>(&self, replay: &Replay, make: impl FnOnce(Clip<'_>) -> Result<T, ExportError>) -> Result<T, Error> {
        let (motion, animation) = (&self.args.motion, self.shown(replay)?);
        if !replay.satisfied {
            console::remark(&format!(
                "sample {} is not a solution: not everything that was asked for happens",
                replay.sample
            ));
        }
        let cut = Cut::new(self.fps(), motion.time_range, &replay.animation).map_err(refused)?;
        let label = label::of(self.run.run().manifest(), replay).timed(&cut);
        let world = self.world(replay)?;
        let clip = Clip::new(&animation, &label, cut).styled(motion.style()).with_physics(world.as_ref());
        make(clip).map_err(refused)
    }

    /// The world at the start of a sample, if that is asked for; tells what of it the file will not say.
    fn world(&self, replay: &Replay) -> Result<Option<Physics>, Error> {
        if self.args.motion.physics.is_none() {
            return Ok(None);
        }
        let Some(world) = physics(self.run, replay.sample)? else {
            let message = "--physics: this scene does not tell the world at its start";
            return Err(Error::Request(message.to_owned()));
        };
        let pairs = glb::other_pairs(&world);
        let pairs = (pairs > 0).then(|| format!("friction or restitution of {pairs} pairs of materials"));
        for what in world.left_out.iter().chain(&pairs) {
            console::remark(&format!("not said to physics engines: {what}"));
        }
        Ok(Some(world))
    }

    fn fps(&self) -> f64 {
        self.args.motion.fps.unwrap_or(self.format.fps())
    }

    /// Writes what belongs beside the file, unless something is there already: other programs keep their own notes in
    /// it.
    fn beside(&self, path: &Path) -> Result<(), Error> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let Some((end, text)) = self.format.beside(&name) else { return Ok(()) };
        match File::create_new(path.with_file_name(format!("{name}.{end}"))) {
            Ok(mut file) => file.write_all(text.as_bytes()).map_err(Error::Output),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
            Err(error) => Err(Error::Output(error)),
        }
    }

    /// A folder of animations, one for each sample, and a list of them.
    fn fill(&self, folder: &Path) -> Result<(), Error> {
        let mut list = BufWriter::new(File::create_new(folder.join(INDEX)).map_err(Error::Output)?);
        write!(list, "{{\"plaus\": {}, \"animations\": [", json!(glb::GENERATOR)).map_err(Error::Output)?;
        let (mut between, mut done) = ("\n", 0);
        for samples in self.samples.chunks(AT_A_TIME) {
            for made in
                replay_each_until(self.run, samples, self.until(), |replay| self.file(folder, &self.as_asked(replay)))?
            {
                write!(list, "{between}{}", made?).map_err(Error::Output)?;
                (between, done) = (",\n", done + 1);
                waiting::far(done, self.samples.len() as u64, "animations");
            }
        }
        list.write_all(b"\n]}\n").and_then(|()| list.flush()).map_err(Error::Output)
    }

    /// Writes one animation of a folder; gives its entry in the list.
    fn file(&self, folder: &Path, replay: &Replay) -> Result<Value, Error> {
        let (clip, sample) = (self.run.run().manifest().name(), replay.sample);
        let name = format!("{clip}-{}.{}", sample.to_string().replace(':', "-"), self.format.row().ending());
        let path = folder.join(&name);
        let mut out = BufWriter::new(File::create_new(&path).map_err(Error::Output)?);
        let facts = self.clip(replay, |clip| {
            let mut collection = self.format.begin(&path);
            collection.add(&clip, &mut out)?;
            collection.finish(&mut out)?;
            Ok(clip.label.facts.clone())
        })?;
        out.flush().map_err(Error::Output)?;
        self.beside(&path)?;
        Ok(json!({"file": name, "facts": facts}))
    }
}

fn refused(error: ExportError) -> Error {
    match error {
        ExportError::Output(error) => Error::Output(error),
        ExportError::Fps(fps) => Error::Request(format!("--fps {fps}: {error}")),
        ExportError::Range { from, to, .. } => Error::Request(format!("--time-range {from}:{to}: {error}")),
        other => Error::Request(other.to_string()),
    }
}

/// Notes how many frames are drawn.
fn frames(done: u64, of: u64) {
    waiting::far(done, of, "frames");
}

/// Notes how many bytes are written.
struct Counted<'a>(&'a mut dyn Write);

impl Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes).inspect(|bytes| waiting::wrote(*bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
