//! `plaus plot`

use crate::console;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::plots::histogram::{self, Bins, Histogram};
use crate::plots::plan::Plan;
use crate::plots::values::{Place, Values, places};
use crate::scenario_file;
use crate::table::{counted, grouped};
use plaus_run::export::output as file;
use plaus_run::replay::replay;
use plaus_run::{Error, Run, RunReader, solutions};
use plaus_scenes::scenario::nearest;
use plaus_scenes::{Role, Scalar, Scene};
use std::path::{Path, PathBuf};

/// Which run, and which of its numbers.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// A number to show as a histogram, named as in `plaus diagnose`, such as ball.end_x; may be given several times.
    /// By default, the places where things end, seen from above
    #[arg(long, value_name = "NUMBER")]
    of: Vec<String>,
    /// With `--of`: the width of the bins, which are centred on its multiples; or, after a colon, one of their edges,
    /// e.g. 20:0
    #[arg(long, value_name = "WIDTH[:EDGE]", requires = "of", value_parser = bins, allow_hyphen_values = true)]
    bin: Option<Bins>,
    /// Draw into this file, instead of on the terminal
    #[arg(long, alias = "output", value_name = "FILE.svg")]
    out: Option<PathBuf>,
    /// Replace the file, if it is an SVG
    #[arg(long, requires = "out")]
    force: bool,
}

/// What is drawn.
enum Plot {
    Histograms(Vec<Histogram>),
    Plan(Plan),
}

impl Plot {
    fn in_words(&self) -> String {
        match self {
            Self::Histograms(all) => all.iter().map(Histogram::in_words).collect::<Vec<_>>().join("\n"),
            Self::Plan(plan) => plan.in_words(),
        }
    }

    fn picture(&self) -> String {
        match self {
            Self::Histograms(all) => histogram::picture(all),
            Self::Plan(plan) => plan.picture(),
        }
    }
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        if let Some(out) = &self.out {
            super::name_fits(out, "a plot", &["svg"])?;
        }
        let run = Run::open(&super::run_at(&self.run)?)?;
        scenario_file::tell_edited(run.manifest(), &self.run);
        let reader = run.reader()?;
        if super::diagnose::draws_that_count(&reader) == 0 {
            return Err(super::no_draws(&reader));
        }
        let scalars = reader.scene().scalars();
        let wanted = match self.of.is_empty() {
            true => Wanted::usual(&scalars),
            false => Wanted::Numbers(self.of.iter().map(|name| number(name, &scalars)).collect::<Result<_, _>>()?),
        };
        let values = Values::of(&reader, &wanted.numbers())?;
        if values.rows.is_empty() {
            return Err(Failure::Message(format!("{}: none of its draws is a solution", self.run.display())));
        }
        let plot = wanted.plot(&reader, &scalars, &values, self.bin)?;
        let solutions = values.solutions();
        let about = match solutions == values.draws {
            true => format!("of all {}", counted(solutions, "draw")),
            false => format!("of the {} that are solutions, of {}", counted(solutions, "draw"), grouped(values.draws)),
        };
        let about = about + values.caution;
        match &self.out {
            Some(out) => {
                let svg = plot.picture();
                file::file(out, self.force, is_svg, |to| to.write_all(svg.as_bytes()).map_err(Error::Output))
                    .map_err(|error| Failure::from(error).about(&out.display().to_string()))?;
                console::note_line(&format!("wrote {}, {about}", out.display()));
            }
            None => {
                console::note_line(&about);
                output::print(&plot.in_words())?;
            }
        }
        Ok(Outcome::Done)
    }
}

/// What is asked for.
enum Wanted {
    /// Histograms of these scalars.
    Numbers(Vec<usize>),
    /// The plan, with the places of these things.
    Places(Vec<Place>),
}

impl Wanted {
    /// Where things end, if the scene has such outcomes; else its first outcome, or its first variable.
    fn usual(scalars: &[Scalar]) -> Self {
        let mut places = places(scalars);
        if let Some(first) = places.first() {
            // One plan has one unit.
            let unit = scalars[first.at[0]].unit;
            places.retain(|place| scalars[place.at[0]].unit == unit);
            return Self::Places(places);
        }
        let outcome = scalars.iter().position(|scalar| scalar.role == Role::Outcome);
        Self::Numbers(vec![outcome.unwrap_or(0)])
    }

    /// The scalars that are needed.
    fn numbers(&self) -> Vec<usize> {
        match self {
            Self::Numbers(numbers) => numbers.clone(),
            Self::Places(places) => places.iter().flat_map(|place| place.at).collect(),
        }
    }

    fn plot(
        &self,
        run: &RunReader<'_>,
        scalars: &[Scalar],
        values: &Values,
        bin: Option<Bins>,
    ) -> Result<Plot, Failure> {
        match self {
            Self::Numbers(numbers) => {
                let of = |(column, &number): (usize, &usize)| {
                    Histogram::of(
                        &scalars[number],
                        bin,
                        values.caution.is_empty(),
                        values.rows.iter().map(move |(draws, row)| (*draws, row[column])),
                    )
                };
                let all: Result<_, String> = numbers.iter().enumerate().map(of).collect();
                Ok(Plot::Histograms(all.map_err(Failure::Message)?))
            }
            Self::Places(places) => {
                let sample = solutions::distinct(run)?.first().map(|solution| solution.sample);
                let sample = sample.ok_or_else(|| super::no_draws(run))?;
                let unit = scalars[places[0].at[0]].unit;
                Ok(Plot::Plan(Plan::new(places, unit, values, &replay(run, sample)?.animation)))
            }
        }
    }
}

/// A width above 0, and an edge.
pub(super) fn bins(text: &str) -> Result<Bins, String> {
    let (width, edge) = text.split_once(':').map_or((text, None), |(width, edge)| (width, Some(edge)));
    let width = width.parse().ok().filter(|width: &f64| *width > 0.0 && width.is_finite());
    let width = width.ok_or_else(|| "the width must be a number above 0".to_owned())?;
    let edge = edge.map_or(Ok(0.5 * width), str::parse).ok().filter(|edge: &f64| edge.is_finite());
    Ok([width, edge.ok_or_else(|| "the edge must be a number".to_owned())?])
}

/// The scalar of a name.
pub(super) fn number(name: &str, scalars: &[Scalar]) -> Result<usize, Failure> {
    let found = scalars.iter().position(|scalar| scalar.name == name);
    found.ok_or_else(|| {
        let names = || scalars.iter().map(|scalar| scalar.name.as_str());
        // A variable of a body may be meant by its own name alone.
        let of_body = || names().find(|full| full.rsplit('.').next() == Some(name));
        let near = of_body().or_else(|| nearest(name, names()));
        let hint = near.map(|near| format!("; did you mean {near}?")).unwrap_or_else(|| ".".to_owned());
        let names = names().collect::<Vec<_>>().join(", ");
        Failure::Message(format!("there is no number {name}{hint} There are {names}"))
    })
}

fn is_svg(path: &Path) -> bool {
    plaus_export::ours::begins_with(path, b"<svg ")
}
