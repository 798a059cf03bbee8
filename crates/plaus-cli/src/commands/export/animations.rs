//! Animations of samples, as files.

use super::{Args, Format};
use crate::label;
use plaus_export::{Clip, Cut, ExportError, Label, glb, ours, table, usda};
use plaus_run::export::output;
use plaus_run::replay::{Replay, replay_each};
use plaus_run::{Confirmation, Error, RunOf, SampleId, solutions};
use plaus_scenes::Scene;
use serde_json::{Value, json};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Samples that are held in memory at a time while a table is written.
const AT_A_TIME: usize = 64;
/// What a folder of animations has; only such folders are replaced.
const INDEX: &str = "plaus-export.json";
/// Frames a second unless said otherwise.
const FPS: f64 = 60.0;

/// Animations to be written.
pub(super) struct Animations<'a, S: Scene> {
    run: &'a RunOf<'a, S>,
    args: &'a Args,
    samples: Vec<SampleId>,
}

impl<'a, S: Scene> Animations<'a, S> {
    pub(super) fn new(run: &'a RunOf<'a, S>, args: &'a Args) -> Result<Self, Error> {
        let samples = if args.all_distinct {
            solutions::distinct(run)?.iter().map(|solution| solution.sample).collect()
        } else if args.confirmed {
            Confirmation::read(run)?.samples()
        } else {
            args.sample.clone()
        };
        if samples.is_empty() {
            let none = if args.confirmed {
                "no solution holds at the accuracy of the list of confirmed solutions"
            } else {
                "no sample of the run satisfies the constraint"
            };
            return Err(Error::Request(none.to_owned()));
        }
        Ok(Self { run, args, samples })
    }

    pub(super) fn write(&self) -> Result<(), Error> {
        let out = self.args.out.as_path();
        let one = !self.args.all_distinct && !self.args.confirmed && self.samples.len() == 1;
        match self.args.format {
            Format::Poses | Format::Events if out == Path::new("-") => {
                let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
                self.table(&mut out, false)?;
                out.flush().map_err(Error::Output)
            }
            Format::Poses | Format::Events => {
                let json = self.args.format == Format::Events && out.extension().is_some_and(|end| end == "json");
                let start = if json { "{\"impacts\":".to_owned() } else { self.head() };
                let is_ours = |path: &Path| ours::begins_with(path, start.as_bytes());
                output::file(out, self.args.force, is_ours, |out| self.table(out, json))
            }
            _ if out == Path::new("-") => {
                Err(Error::Request("animations are files: name one by --out PATH".to_owned()))
            }
            Format::Usda if one => output::file(out, self.args.force, ours::is_usda, |out| self.single(out)),
            _ if one => {
                output::file(out, self.args.force, ours::is_glb, |out| self.single(out))?;
                self.sidecar(out)
            }
            _ => output::folder(out, self.args.force, |path| path.join(INDEX).is_file(), |folder| self.fill(folder)),
        }
    }

    fn head(&self) -> String {
        format!("chain,draw,{}", if self.args.format == Format::Poses { table::POSES } else { table::EVENTS })
    }

    fn cut(&self, replay: &Replay) -> Result<Cut, Error> {
        Cut::new(self.args.fps.unwrap_or(FPS), self.args.time_range, &replay.animation).map_err(refused)
    }

    /// The bytes of one animation.
    fn bytes(&self, replay: &Replay) -> Result<Vec<u8>, Error> {
        let cut = self.cut(replay)?;
        let label = self.label(replay, &cut);
        let clip = Clip { animation: &replay.animation, label: &label, cut };
        match self.args.format {
            Format::Usda => Ok(usda::to_string(&clip).into_bytes()),
            _ => glb::to_vec(&clip).map_err(refused),
        }
    }

    fn label(&self, replay: &Replay, cut: &Cut) -> Label {
        let mut label = label::of(self.run.run().manifest(), replay);
        label.facts.insert("fps".to_owned(), cut.fps().into());
        label.facts.insert("time_range".to_owned(), json!([cut.from(), cut.to()]));
        label
    }

    fn single(&self, out: &mut dyn Write) -> Result<(), Error> {
        for bytes in replay_each(self.run, &self.samples, |replay| self.bytes(&replay))? {
            out.write_all(&bytes?).map_err(Error::Output)?;
        }
        Ok(())
    }

    /// A Godot sidecar, where there is none: Godot writes its own notes into it.
    fn sidecar(&self, glb: &Path) -> Result<(), Error> {
        let name = glb.file_name().unwrap_or_default().to_string_lossy();
        let path = glb.with_file_name(format!("{name}.import"));
        let text = glb::godot_import(&name, self.args.fps.unwrap_or(FPS));
        match fs::File::create_new(&path) {
            Ok(mut file) => file.write_all(text.as_bytes()).map_err(Error::Output),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
            Err(error) => Err(Error::Output(error)),
        }
    }

    /// A folder of animations, one a sample, and a list of them.
    fn fill(&self, folder: &Path) -> Result<(), Error> {
        let end = if self.args.format == Format::Usda { "usda" } else { "glb" };
        let made = replay_each(self.run, &self.samples, |replay| -> Result<Value, Error> {
            let file = format!("sample-{}-{}.{end}", replay.sample.chain, replay.sample.draw);
            fs::write(folder.join(&file), self.bytes(&replay)?).map_err(Error::Output)?;
            if self.args.format == Format::Glb {
                self.sidecar(&folder.join(&file))?;
            }
            Ok(json!({"file": file, "facts": self.label(&replay, &self.cut(&replay)?).facts}))
        })?;
        let list = made.into_iter().collect::<Result<Vec<_>, _>>()?;
        let index = json!({"plaus": glb::GENERATOR, "animations": list});
        fs::write(folder.join(INDEX), format!("{index:#}\n")).map_err(Error::Output)
    }

    /// All samples as one table.
    fn table(&self, out: &mut dyn Write, json: bool) -> Result<(), Error> {
        if json {
            write!(out, "{{\"impacts\":[").map_err(Error::Output)?;
        } else {
            writeln!(out, "{}", self.head()).map_err(Error::Output)?;
        }
        for (number, samples) in self.samples.chunks(AT_A_TIME).enumerate() {
            let rows = replay_each(self.run, samples, |replay| self.rows(&replay, json))?;
            for (index, rows) in rows.into_iter().enumerate() {
                let comma = if json && number + index > 0 { ",\n" } else { "" };
                let rows = rows?;
                out.write_all(comma.as_bytes()).and_then(|()| out.write_all(&rows)).map_err(Error::Output)?;
            }
        }
        if json { writeln!(out, "]}}").map_err(Error::Output) } else { Ok(()) }
    }

    fn rows(&self, replay: &Replay, json: bool) -> Result<Vec<u8>, Error> {
        let label = Label::default();
        let clip = Clip { animation: &replay.animation, label: &label, cut: self.cut(replay)? };
        let SampleId { chain, draw } = replay.sample;
        let (prefix, mut rows) = (format!("{chain},{draw},"), Vec::new());
        if json {
            let sample = json!({"chain": chain, "draw": draw, "impacts": table::events_to_json(&clip)});
            rows = sample.to_string().into_bytes();
        } else if self.args.format == Format::Poses {
            table::write_poses(&mut rows, &clip, &prefix).map_err(Error::Output)?;
        } else {
            table::write_events(&mut rows, &clip, &prefix).map_err(Error::Output)?;
        }
        Ok(rows)
    }
}

fn refused(error: ExportError) -> Error {
    Error::Request(error.to_string())
}
