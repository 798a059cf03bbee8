//! `plaus export`

mod animations;
mod formats;

use crate::console;
use crate::failure::{Failure, Outcome};
use crate::waiting::Waiting;
use animations::Animations;
use formats::Format;
pub(super) use formats::endings;
use plaus_export::{Between, Engines, Style, Up};
use plaus_run::export::{csv, output, zarr};
use plaus_run::{ChainPhase, Error, RunReader, SampleId};
use plaus_scenes::Until;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Which run, in which format, and to which file or folder.
#[derive(clap::Args)]
#[command(after_long_help = formats::help())]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// What to write; by default, what the ending of the file says
    #[arg(long, value_parser = formats::parser())]
    format: Option<Format>,
    /// File or folder to make; `-` writes csv, poses and events to standard output
    #[arg(long, alias = "output", value_name = "PATH", required_unless_present = "into")]
    out: Option<PathBuf>,
    /// Write all samples into this one file: clips of a GLB, variants of a USD prim, tiles of a picture or video
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    into: Option<PathBuf>,
    /// A sample to animate, as CHAIN:DRAW, e.g. 0:17; may be given several times
    #[arg(long, value_name = "CHAIN:DRAW")]
    sample: Vec<SampleId>,
    /// Animate one sample of each distinct solution
    #[arg(long, conflicts_with = "sample")]
    all_distinct: bool,
    /// Animate the N distinct solutions that differ most: the likeliest, then always the one that looks least like
    /// those before
    #[arg(long, value_name = "N", conflicts_with_all = ["sample", "all_distinct"], value_parser = super::from_one)]
    most_different: Option<u64>,
    /// Animate one sample of each distinct solution that `--confirm` found to hold
    #[arg(long, conflicts_with_all = ["sample", "all_distinct", "most_different"])]
    confirmed: bool,
    #[command(flatten)]
    motion: Motion,
    /// Replace what is there, if it was made by such an export
    #[arg(long)]
    force: bool,
    /// Read a damaged run as far as it is intact, and report what is lost
    #[arg(long)]
    salvage: bool,
}

/// How motion is written.
#[derive(clap::Args)]
struct Motion {
    /// Frames per second: where keys may lie, besides those at every impact [default: 60; gif 20, mp4 30]
    #[arg(long)]
    fps: Option<f64>,
    /// Animate only the time from FROM to TO, in seconds
    #[arg(long, value_name = "FROM:TO", value_parser = range)]
    time_range: Option<(f64, f64)>,
    /// Where an animation ends: `rest`, when everything is at rest; `decided`, once it is certain whether it is a
    /// solution; or after a time, e.g. `5s` [default: rest]
    #[arg(long, value_name = "rest|decided|SECONDSs", value_parser = until)]
    until: Option<Until>,
    /// glb: how keys are joined: straight lines, which every program reads correctly, or cubic splines, exact in
    /// programs that follow glTF [default: linear]
    #[arg(long, value_enum)]
    keys: Option<Keys>,
    /// usda: time codes per second, the frame rate of the scene that opens it [default: 24]
    #[arg(long, value_name = "RATE")]
    time_codes: Option<f64>,
    /// glb and usda: the axis that points up [default: y]
    #[arg(long, value_enum)]
    up: Option<UpAxis>,
    /// glb and usda: units per metre, e.g. 100 for centimetres [default: 1]
    #[arg(long, value_name = "UNITS")]
    scale: Option<f64>,
    /// glb: write only this body, as the root node, for game engines that move an actor by its animation
    #[arg(long, value_name = "BODY")]
    root_motion: Option<String>,
    /// glb: colliders, masses, materials and joints at the start (`KHR_physics_rigid_bodies`), beside the motion or,
    /// for engines to simulate, alone
    #[arg(long, value_enum, value_name = "beside|alone", num_args = 0..=1, default_missing_value = "beside")]
    physics: Option<WithPhysics>,
    /// png, gif and mp4: pixels across and down, e.g. 1920x1080
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,
    /// png, gif and mp4: where to look from, as a direction with z up: 0,-1,0.5 is from the front and above
    #[arg(long, value_name = "X,Y,Z", value_parser = view, allow_hyphen_values = true)]
    view: Option<[f64; 3]>,
    /// events and wav: leave out impacts with a smaller impulse, in N s
    #[arg(long, value_name = "NS")]
    min_impulse: Option<f64>,
    /// events and wav: merge repeated impacts of a pair of bodies if they follow the first within this time, e.g. 2ms
    #[arg(long, value_name = "TIME", value_parser = seconds)]
    merge: Option<f64>,
}

/// How keys are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Keys {
    /// Cubic splines with exact tangents.
    Exact,
    /// Straight lines.
    Linear,
}

/// How a file has the world at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum WithPhysics {
    /// Beside the motion.
    Beside,
    /// Without any motion but that of bodies that follow keys.
    Alone,
}

/// The axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum UpAxis {
    /// glTF, Godot, Unity, Unreal.
    Y,
    /// Robotics, CAD.
    Z,
}

fn range(text: &str) -> Result<(f64, f64), String> {
    let parts = text.split_once(':').and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
    parts.ok_or_else(|| format!("`{text}` is not a range: write FROM:TO in seconds, e.g. 0.5:2"))
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once('x').and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    parts.ok_or_else(|| format!("`{text}` is not a size: write WIDTHxHEIGHT in pixels, e.g. 1280x720"))
}

/// A direction to look from, which has a level part: a view from straight above has no up.
fn view(text: &str) -> Result<[f64; 3], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let [x, y, z] = numbers.unwrap_or_default()[..] else {
        return Err(format!("`{text}` is not a direction: write X,Y,Z with z up, e.g. 0,-1,0.5"));
    };
    let level = x.abs().max(y.abs());
    if ![x, y, z].iter().all(|number| number.is_finite()) || level == 0.0 || level <= 1e-6 * z.abs() {
        return Err(format!("`{text}`: give it a level part, such as 0,-0.01,1"));
    }
    Ok([x, y, z])
}

/// A time above 0 with its unit.
fn seconds(text: &str) -> Result<f64, String> {
    let units = [("ms", 1e-3), ("s", 1.0)];
    let number = units.iter().find_map(|(unit, size)| Some(text.strip_suffix(unit)?.parse::<f64>().ok()? * size));
    let wrong = || format!("`{text}` is not a time: write a number above 0 with its unit, e.g. 2ms or 5s");
    number.filter(|time| *time > 0.0 && time.is_finite()).ok_or_else(wrong)
}

/// Where an animation ends.
pub(in crate::commands) fn until(text: &str) -> Result<Until, String> {
    match text {
        "rest" => Ok(Until::Rest),
        "decided" => Ok(Until::Decided),
        _ => seconds(text)
            .ok()
            .filter(|time| *time <= LONGEST)
            .map(Until::Time)
            .ok_or_else(|| format!("`{text}`: write rest, decided, or a time of at most {LONGEST} s, such as 5s")),
    }
}

/// Longest clip in s.
const LONGEST: f64 = 3600.0;

impl Motion {
    fn style(&self) -> Style {
        let usual = Style::default();
        Style {
            keys: if self.keys == Some(Keys::Exact) { Between::Exact } else { Between::Linear },
            time_codes: self.time_codes.unwrap_or(usual.time_codes),
            up: if self.up == Some(UpAxis::Z) { Up::Z } else { Up::Y },
            scale: self.scale.unwrap_or(usual.scale),
            root_motion: self.root_motion.is_some(),
            engines: match self.physics {
                None => Engines::Nothing,
                Some(WithPhysics::Beside) => Engines::Beside,
                Some(WithPhysics::Alone) => Engines::Alone,
            },
            size: self.size,
        }
    }

    /// The flags that were given, each with the formats that know it; no formats means all formats of animations.
    fn given(&self) -> Vec<(&'static str, &'static [&'static str])> {
        let layers: &[&str] = &["glb", "usda"];
        let all = [
            (self.fps.is_some(), "--fps", &[][..]),
            (self.time_range.is_some(), "--time-range", &[]),
            (self.until.is_some(), "--until", &[]),
            (self.keys.is_some(), "--keys", &["glb"]),
            (self.time_codes.is_some(), "--time-codes", &["usda"]),
            (self.up.is_some(), "--up", layers),
            (self.scale.is_some(), "--scale", layers),
            (self.root_motion.is_some(), "--root-motion", &["glb"]),
            (self.physics.is_some(), "--physics", &["glb"]),
            (self.size.is_some(), "--size", &["png", "gif", "mp4"]),
            (self.view.is_some(), "--view", &["png", "gif", "mp4"]),
            (self.min_impulse.is_some(), "--min-impulse", &["events", "wav"]),
            (self.merge.is_some(), "--merge", &["events", "wav"]),
        ];
        all.into_iter().filter(|(given, ..)| *given).map(|(_, flag, formats)| (flag, formats)).collect()
    }

    /// Checks that the numbers make sense.
    fn check(&self) -> Result<(), Failure> {
        let others = [
            (self.up == Some(UpAxis::Z), "--up z"),
            (self.scale.is_some(), "--scale"),
            (self.root_motion.is_some(), "--root-motion"),
            (self.time_range.is_some_and(|(from, _)| from > 0.0), "a --time-range that begins later"),
        ];
        if let Some((_, other)) = others.into_iter().find(|(given, _)| self.physics.is_some() && *given) {
            let message =
                format!("--physics does not go with {other}: it is in metres, y up, at the start of the motion");
            return Err(Failure::Message(message));
        }
        for (flag, value, low, high) in [
            ("--time-codes", self.time_codes, 1e-3, 1e6),
            ("--scale", self.scale, 1e-6, 1e6),
            ("--min-impulse", self.min_impulse, 0.0, f64::MAX),
        ] {
            if let Some(value) = value.filter(|value| !(low..=high).contains(value)) {
                let most = if high == f64::MAX { String::new() } else { format!(" and at most {high}") };
                return Err(Failure::Message(format!("{flag} {value}: must be at least {low}{most}")));
            }
        }
        Ok(())
    }
}

impl Args {
    /// Gives the samples that are animated, in order.
    fn write(&self, run: &RunReader<'_>, format: Format) -> Result<Vec<SampleId>, Error> {
        let out = self.path();
        match (format, out == Path::new("-")) {
            (Format::Csv, true) => {
                let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
                csv::write(run, &mut out)?;
                out.flush().map_err(Error::Output)
            }
            (Format::Csv, false) => output::file(out, self.force, csv::is_ours, |out| csv::write(run, out)),
            (Format::Zarr, true) => Err(Error::Request("a Zarr export is a folder: name one by --out PATH".to_owned())),
            (Format::Zarr, false) => output::folder(out, self.force, zarr::is_ours, |out| zarr::write(run, out)),
            (Format::Animation(format), _) => return Animations::new(run, self, format)?.write(),
        }?;
        Ok(Vec::new())
    }

    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let format = self.format()?;
        self.check(format)?;
        let run = super::opened(&self.run, self.salvage, "exports")?;
        let tables = !matches!(format, Format::Animation(_));
        let reader = run.reader()?;
        let draws =
            if tables { reader.draws(ChainPhase::Sampling) } else { super::diagnose::draws_that_count(&reader) };
        if draws == 0 {
            return Err(super::no_draws(&reader));
        }
        let out = self.path().display().to_string();
        // A table on standard output shows by itself how far it is.
        let waiting = (self.path() != Path::new("-")).then(|| Waiting::on(format!("writing {out}")));
        let written = self.write(&reader, format);
        drop(waiting);
        let samples = written.map_err(|error| Failure::from(error).about(&out))?;
        if self.path() != Path::new("-") {
            console::note_line(&format!("wrote {out}"));
        }
        if samples.len() > 1
            && self.into.is_some()
            && matches!(format, Format::Animation(one) if formats::is_picture(one.row().name))
        {
            let names: Vec<String> = samples.iter().map(ToString::to_string).collect();
            console::note_line(&format!("its tiles, row by row: {}", names.join(", ")));
        }
        Ok(Outcome::Done)
    }

    /// The file or folder to make.
    fn path(&self) -> &Path {
        self.into.as_deref().or(self.out.as_deref()).unwrap_or(Path::new("-"))
    }

    /// The format that is asked for, or that the ending of the file says.
    fn format(&self) -> Result<Format, Failure> {
        if let Some(format) = self.format {
            return Ok(format);
        }
        let path = self.path();
        let animated = !self.sample.is_empty() || self.chooses();
        let named = || formats::all().into_iter().filter(|(_, row)| super::has_ending(path, row.endings));
        let fits = |format: &Format| matches!(format, Format::Animation(_)) == animated;
        let rows: Vec<(Format, &str)> =
            named().filter(|(format, _)| fits(format)).map(|(format, row)| (format, row.name)).collect();
        let flags =
            |names: Vec<&str>| names.iter().map(|name| format!("--format {name}")).collect::<Vec<_>>().join(" or ");
        match rows.as_slice() {
            [(format, _)] => Ok(*format),
            [] if !animated && named().next().is_some() => Err(Failure::Message(format!(
                "{}: an animation of which samples? Choose them by --sample CHAIN:DRAW, --all-distinct or \
                 --most-different N",
                path.display()
            ))),
            [] => {
                let (animations, tables): (Vec<_>, Vec<_>) =
                    formats::all().into_iter().partition(|(format, _)| matches!(format, Format::Animation(_)));
                let [animations, tables] =
                    [animations, tables].map(|rows| flags(rows.into_iter().map(|(_, row)| row.name).collect()));
                Err(Failure::Message(format!(
                    "{}: which format? Animations of samples (`--sample`, `--all-distinct`, `--most-different`) are \
                     written by {animations}; tables of all draws by {tables}",
                    path.display(),
                )))
            }
            several => Err(Failure::Message(format!(
                "{}: several formats have this ending: {}",
                path.display(),
                flags(several.iter().map(|(_, name)| *name).collect())
            ))),
        }
    }

    /// Whether a flag chooses solutions, in place of samples that are named.
    fn chooses(&self) -> bool {
        self.all_distinct || self.confirmed || self.most_different.is_some()
    }

    /// Whether the one solution that is asked for goes into a file that has a name of its own.
    fn makes_one(&self) -> bool {
        self.most_different == Some(1) && self.path().extension().is_some()
    }

    /// Checks that the flags fit together.
    fn check(&self, wanted: Format) -> Result<(), Failure> {
        let chosen = !self.sample.is_empty() || self.chooses();
        let given = self.motion.given();
        let Format::Animation(format) = wanted else {
            if chosen || self.into.is_some() || !given.is_empty() {
                let flags: Vec<&str> = given.iter().map(|(flag, _)| *flag).collect();
                let message = format!(
                    "--sample, --all-distinct, --most-different, --confirmed and {} are for animations: csv and zarr hold all draws",
                    if flags.is_empty() { "--into".to_owned() } else { flags.join(", ") }
                );
                return Err(Failure::Message(message));
            }
            return self.check_name(if matches!(wanted, Format::Csv) { "csv" } else { "zarr" }, false);
        };
        if !chosen {
            let message =
                "an animation needs a sample: --sample CHAIN:DRAW, --all-distinct, --most-different N, or --confirmed";
            return Err(Failure::Message(message.to_owned()));
        }
        let row = format.row();
        for (flag, formats) in given {
            if !formats.is_empty() && !formats.contains(&row.name) {
                let message = format!("{flag} goes with {}, not with {}", formats.join(" and "), row.name);
                return Err(Failure::Message(message));
            }
        }
        self.motion.check()?;
        let several = self.sample.len() > 1 || self.chooses() && !self.makes_one();
        if several && self.into.is_some() && self.motion.physics.is_some() {
            let message = "--physics is for one sample a file: give --out, or one --sample".to_owned();
            return Err(Failure::Message(message));
        }
        self.check_name(row.name, several && self.into.is_none() && !format.is_table())
    }

    /// Refuses a name that does not fit the format: of a file with another ending or none, of a folder with one.
    fn check_name(&self, name: &str, makes_folder: bool) -> Result<(), Failure> {
        let path = self.path();
        let rows = formats::all();
        let own = rows.iter().find(|(_, row)| row.name == name).map_or(&[][..], |(_, row)| row.endings);
        if makes_folder {
            if !super::has_ending(path, own) {
                return Ok(());
            }
            let (shown, folder) = (path.display(), path.with_extension(""));
            return Err(Failure::Message(format!(
                "{shown}: several samples make a folder, of one file each: `--out {}`; all in one file: `--into {shown}`",
                folder.display(),
            )));
        }
        // A folder may be called as one likes.
        if path == Path::new("-") || (name == "zarr" && path.extension().is_none()) {
            return Ok(());
        }
        super::name_fits(path, &format!("--format {name}"), own)
    }
}
