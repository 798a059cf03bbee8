//! The closing words of a run.

use crate::clock::in_words;
use crate::console::{quoted, quoted_word};
use crate::progress::Monitor;
use crate::report;
use crate::table::{counted, grouped, rate};
use plaus_mcmc::{Ending, Plan};
use plaus_run::{ChainPhase, Diagnosis, Run, RunReader, SampleId};
use plaus_scenes::World;
use plaus_scenes::custom::Viewpoint;
use std::path::Path;

/// The closing table has this many rows; `plaus diagnose` shows all.
const SHOWN_SCALARS: usize = 16;

/// A run whose newest kind of solution came before this part of its iterations has hardly more of them.
const EXHAUSTED: u64 = 3;

/// Whether a run that found its newest solution at an iteration, and has done so many, has hardly more of them.
pub(super) fn is_exhausted(newest: u64, done: u64) -> bool {
    newest < done / EXHAUSTED
}

/// Which part of the distance that solutions had lets a run find as many as are wanted: as if they lay along a line;
/// where they fill an area, there are more.
pub(super) fn smaller(found: u64, wanted: u64) -> f64 {
    (5.0 * found as f64 / wanted as f64).floor().max(1.0) / 10.0
}

/// How far apart solutions of a run must be to count as different, in parts of the usual distance.
pub(super) fn distinct_scale(run: &Run) -> f64 {
    let keys: Option<toml::Table> = run.manifest().scenario.effective.parse().ok();
    let scale = keys.as_ref().and_then(|keys| keys.get("sampler")?.get("distinct_scale")?.as_float());
    scale.unwrap_or(1.0)
}

/// The command that samples the scenario again, for so many solutions that are `times` as far apart as this run's.
pub(super) fn sample_again(run: &Run, scenario: Option<&Path>, solutions: u64, times: f64) -> String {
    let scale = times * distinct_scale(run);
    let (manifest, path) = (run.manifest(), run.folder().path().display());
    // A run that is resumed knows its scenario file by name only.
    let known = Path::new(&manifest.scenario.file);
    let elsewhere = Path::new("PATH/TO").join(known);
    let file = quoted(scenario.unwrap_or(if known.exists() { known } else { &elsewhere }));
    let own = manifest.said().filter(|said| !said.contains("distinct_scale"));
    let sets: String = own.map(|said| format!(" --set {}", quoted_word(said))).collect();
    let new = (2..).map(|k| format!("{path}-{k}")).find(|new| !Path::new(new).exists()).unwrap_or_default();
    format!(
        "plaus sample {file}{sets} --set distinct_scale={scale} --solutions {solutions} --out {}",
        quoted_word(&new)
    )
}

/// Why a run ended, where, and how fast it was. Its chains have `recorded` so many iterations, in all sessions.
fn why_it_ended(plan: &Plan, monitor: &Monitor<'_>, ending: Ending, recorded: u64) -> String {
    let iterations = monitor.done();
    if ending == Ending::Stopped && recorded > 0 && monitor.begun_at() == iterations {
        return format!(
            "out of time before the next checkpoint: still at iteration {} of each chain; give it more time",
            grouped(recorded)
        );
    }
    let why = match ending {
        Ending::Complete => format!("done: {} iterations of each chain", grouped(plan.end())),
        Ending::EnoughSolutions => {
            format!("done: enough solutions after {} iterations of each chain", grouped(iterations))
        }
        Ending::Stopped => format!("out of time after {} iterations of each chain", of_all(iterations, plan)),
    };
    if monitor.rate() > 0.0 {
        format!("{why}, {} in {}", rate(monitor.rate()), in_words(monitor.seconds()))
    } else {
        why
    }
}

/// What the run did, what it found, and which commands come next.
pub(super) fn summary(
    reader: &RunReader<'_>,
    scenario: Option<&Path>,
    diagnosis: &Diagnosis,
    monitor: &Monitor<'_>,
    ending: Ending,
) -> String {
    let run = reader.run();
    let path = quoted(run.folder().path());
    let plan = run.manifest().plan;
    let iterations = monitor.done();
    if ending != Ending::Stopped && iterations > 0 && monitor.begun_at() == iterations {
        return nothing_left(run, diagnosis, &path);
    }
    let mut text = why_it_ended(&plan, monitor, ending, reader.iterations()) + "\n";
    text += &report::solutions(run.manifest(), diagnosis);
    text += &report::failures(&diagnosis.tally.failures);
    text += report::certain(diagnosis);
    if ending == Ending::Complete && diagnosis.draws == 0 {
        return text + &nothing_recorded(&plan, &path);
    }
    // Restarts are counted from the end of the warm-up, over all sessions; the clock knows only this session.
    let sampling = monitor.seconds() * diagnosis.share_after_warmup(iterations, plan.warmup);
    let sampling = (monitor.begun_at() == 0).then_some(sampling);
    text += &report::independent(diagnosis, sampling);
    text += &report::tempering(run.manifest(), diagnosis, sampling);
    if diagnosis.draws == 0 {
        let still = match plan.warmup {
            0 => "\nthere are no draws yet\n",
            _ => "\nstill in the warm-up: there are no draws for statistics yet\n",
        };
        if diagnosis.tally.distinct == 0 {
            return text + still + &format!("\nnext:\n  plaus resume {path}\n");
        }
        if ending != Ending::EnoughSolutions {
            text += still;
        }
        if plan.solutions.is_none() {
            text += &format!(
                "if you resume it, only solutions after the warm-up count; `plaus resume {path} --solutions all` keeps \
                 these too\n"
            );
        }
    }
    text += &match plan.enough() {
        _ if diagnosis.draws == 0 || !diagnosis.tally.is_satisfied() => String::new(),
        Some(_) => format!("(do they represent the distribution? `plaus diagnose {path}`)\n"),
        None => statistics(diagnosis, &path),
    };
    text += "\nnext:\n";
    if let Some(best) = diagnosis.tally.best() {
        let warmup = if best.phase.is_sampling() { "" } else { "   # w: found in the warm-up" };
        let page = named_after(run, "html");
        let again = if Path::new(&page).exists() { " --force" } else { "" };
        text += &format!("  plaus gallery {path} --out {page}{again}\n  {}{warmup}\n", export_of(&path, "glb", best));
    } else if let Some(last) = diagnosis.draws.checked_sub(1) {
        let last = SampleId { chain: run.manifest().chains().start, phase: ChainPhase::Sampling, draw: last };
        text += &format!("  {}   # what happens instead\n", export_of(&path, "png", last));
    }
    if diagnosis.draws > 0 {
        let table = named_after(run, "csv");
        text += &format!("  plaus diagnose {path}\n  plaus export {path} --out {table}\n");
    }
    match ending {
        Ending::Stopped => text += &format!("  plaus resume {path}\n"),
        Ending::Complete if !diagnosis.is_healthy() && plan.enough().is_none() && diagnosis.tally.is_satisfied() => {
            text += &format!("  plaus resume {path}{}\n", longer(&plan))
        }
        Ending::EnoughSolutions => {
            let wanted = plan.solutions.unwrap_or(1);
            text += &format!(
                "  plaus resume {path} --solutions {}   # looks for more{}\n",
                twice(wanted, diagnosis),
                until(&plan)
            );
            if wanted > 1 {
                let again = sample_again(run, scenario, wanted, 2.0);
                text += &format!(
                    "if they look too alike, ask for larger differences (`plaus explain distinct`):\n  {again}\n"
                );
            }
        }
        Ending::Complete => {}
    }
    text
}

/// A file named after the run, where the command is run.
fn named_after(run: &Run, ending: &str) -> String {
    let name = run.folder().path().file_name().unwrap_or("run".as_ref());
    quoted(&Path::new(name).with_added_extension(ending))
}

/// The statistics of a run that was not made for solutions alone: how its numbers are spread, and whether to trust
/// them.
fn statistics(diagnosis: &Diagnosis, path: &str) -> String {
    let mut text = format!("\n{}", report::scalar_table(diagnosis, SHOWN_SCALARS));
    let more = diagnosis.scalars.len().saturating_sub(SHOWN_SCALARS);
    if more > 0 {
        text += &format!("  and {more} more: plaus diagnose {path}\n");
    }
    if diagnosis.stride > 1 {
        text += &format!("(from one draw in {}; `plaus diagnose` uses all)\n", diagnosis.stride);
    }
    match diagnosis.findings.as_slice() {
        [] => {}
        [first] => text += &format!("\nnot to be trusted yet: {first}\n"),
        [first, rest @ ..] => {
            text += &format!("\nnot to be trusted yet: {first}; `plaus diagnose` has {} more findings\n", rest.len());
        }
    }
    text
}

/// What ends a run that has no planned end.
pub(super) fn for_a_while(plan: &Plan) -> &'static str {
    if plan.is_endless() { " --max-time 1m" } else { "" }
}

/// In a world of one's own that does not say what is to be seen: that differences are judged by that.
pub(super) fn or_frame(run: &Run) -> &'static str {
    let World::Custom(world) = &run.scenario().world else { return "" };
    match world.view == Viewpoint::default() {
        true => "\nor frame what matters, as differences count by what is seen (`plaus explain view`)",
        false => "",
    }
}

/// A run that was finished before it was resumed: how to go on with it.
fn nothing_left(run: &Run, diagnosis: &Diagnosis, path: &str) -> String {
    let (plan, found) = (run.manifest().plan, diagnosis.tally.distinct);
    let more = match plan.enough() {
        Some(wanted) if found >= wanted => format!(
            "to look for more{}: plaus resume {path} --solutions {}\nto go on to the planned iterations, for \
             statistics: plaus resume {path} --solutions all{}\n",
            until(&plan),
            twice(wanted, diagnosis),
            for_a_while(&plan)
        ),
        _ => format!("to make it longer: plaus resume {path}{}\n", longer(&plan)),
    };
    format!("this run was finished already: {}; nothing was done\n{more}", counted(found, "distinct solution"))
}

/// A number of iterations, out of all that are planned.
fn of_all(iterations: u64, plan: &Plan) -> String {
    match plan.is_endless() {
        true => grouped(iterations),
        false => format!("{} of {}", grouped(iterations), grouped(plan.end())),
    }
}

/// Where a run that looks for more solutions ends if it does not find them.
fn until(plan: &Plan) -> String {
    if plan.is_endless() { String::new() } else { format!(", until iteration {}", grouped(plan.end())) }
}

/// A number of solutions that asks for more than were asked for, and than were found.
fn twice(wanted: u64, diagnosis: &Diagnosis) -> u64 {
    wanted.max(diagnosis.tally.distinct).saturating_mul(2)
}

/// A finished run whose sampling phase recorded nothing.
fn nothing_recorded(plan: &Plan, path: &str) -> String {
    let (thin, iterations) = (grouped(plan.thin), grouped(plan.iterations));
    format!(
        "\nnothing was recorded after the warm-up: one in {thin} iterations is recorded, and there were only \
         {iterations}\n\nnext:\n  sample again with a smaller --thin, or make the run longer:\n  plaus resume {path} \
         --iterations {}\n",
        plan.thin.saturating_mul(100)
    )
}

/// The command that writes one sample as a file.
pub(super) fn export_of(path: &str, format: &str, sample: SampleId) -> String {
    let name = sample.to_string().replace(':', "-");
    format!("plaus export {path} --sample {sample} --out sample-{name}.{format}")
}

/// The flags that make a finished run ten times as long.
pub(super) fn longer(plan: &Plan) -> String {
    format!(" --iterations {}", plan.iterations.saturating_mul(10))
}
