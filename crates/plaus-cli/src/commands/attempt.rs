//! `plaus try`

use super::sample::{Sampled, Watched, Watching};
use super::wanted::Wanted;
use super::{gallery, summary};
use crate::clock::{parse_duration, unix_seconds};
use crate::console::{self, quoted};
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::progress::Stop;
use crate::scenario_file::located;
use crate::table::counted;
use crate::why;
use plaus_gallery::Options;
use plaus_mcmc::Ending;
use plaus_run::{Folder, Manifest, Run, RunFileError, RunReader, SampleId, solutions};
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, SystemTime};

/// Solutions of a try, unless the command line says how many.
const SOLUTIONS: u64 = 12;
/// Time between two looks at whether files changed.
const POLL: Duration = Duration::from_millis(200);
/// The run of a try's folder.
pub(super) const RUN: &str = "run";
/// Its page.
const PAGE: &str = "index.html";
/// While the scenario is watched: when the page was made.
const MADE: &str = "made.js";
/// The last run, if that found nothing.
const FAILED: &str = "failed";
/// All that a try's folder holds.
const NAMES: [&str; 4] = [RUN, PAGE, MADE, FAILED];
/// Where a try is sampled: it takes the place of the one before once it has found something.
const NEXT: &str = ".next";
/// What a page of a watched scenario ends with: it reloads itself once a later one is there. A page that is opened from
/// disk may read nothing but scripts.
const RELOADS: &str = "<script>
setInterval(() => {
  const script = document.createElement('script');
  script.onload = script.onerror = () => { script.remove(); if (window.made > {made}) location.reload(); };
  script.src = `made.js?${Date.now()}`;
  document.head.append(script);
}, 1000);
</script>
";

/// What to sample, and where its page is made.
#[derive(clap::Args)]
struct Made {
    #[command(flatten)]
    wanted: Wanted,
    /// Folder of the run and its page; an earlier one in it is replaced [default: the scenario's name and `-try`, or
    /// `-live`]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Make the page after this time at the latest, e.g. 20s or 2m
    #[arg(long, value_name = "TIME", value_parser = parse_duration, default_value = "60s", allow_hyphen_values = true)]
    max_time: Duration,
    /// Number of threads; 0: one per core. Results do not depend on it
    #[arg(long, value_name = "T", default_value_t = 0)]
    threads: usize,
    /// Do not open the page in the browser
    #[arg(long)]
    no_open: bool,
}

/// What to try.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    made: Made,
    /// Try again whenever the scenario, or a file that it names, changes
    #[arg(long)]
    watch: bool,
    /// The page keeps sampling while it is open
    #[arg(long)]
    live: bool,
}

/// What to begin a live page with.
#[derive(clap::Args)]
pub(crate) struct Live {
    #[command(flatten)]
    made: Made,
}

/// Solutions that a live page begins with, unless the command line says how many.
const FIRST: u64 = 3;

impl Live {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let Self { mut made } = self;
        made.wanted.solutions.get_or_insert(FIRST);
        made.out.get_or_insert_with(|| named(&made.wanted.scenario, "live"));
        Args { made, watch: false, live: true }.run()
    }
}

/// The folder that goes by a scenario's name.
fn named(scenario: &Path, what: &str) -> PathBuf {
    let name = scenario.file_stem().unwrap_or("plaus".as_ref()).to_string_lossy();
    PathBuf::from(format!("{name}-{what}"))
}

impl Args {
    pub(super) fn run(mut self) -> Result<Outcome, Failure> {
        self.made.wanted.solutions.get_or_insert(SOLUTIONS);
        let scenario = self.made.wanted.scenario.clone();
        let out = self.made.out.clone().unwrap_or_else(|| named(&scenario, "try"));
        refuse_foreign(&out)?;
        interrupt::listen()?;
        let mut is_open = self.made.no_open;
        loop {
            let files = Files::new(&scenario);
            let tried = self.attempt(&out, &files);
            if let (Ok(Outcome::Done), false) = (&tried, is_open) {
                open(&out.join(PAGE));
                is_open = true;
            }
            match tried {
                _ if !self.watch => return tried,
                Ok(Outcome::Interrupted) if interrupt::asked() => return Ok(Outcome::Done),
                Err(failure) => drop(failure.report()),
                Ok(_) => {}
            }
            if !files.have_changed() {
                console::note_line(&format!("watching {}; Ctrl-C ends it", scenario.display()));
            }
            while !files.have_changed() {
                if interrupt::asked() {
                    return Ok(Outcome::Done);
                }
                thread::sleep(POLL);
            }
        }
    }

    /// Samples, and makes the page. With `--watch` it stops early once the files change.
    fn attempt(&self, out: &Path, files: &Files) -> Result<Outcome, Failure> {
        let scenario = &self.made.wanted.scenario;
        let recipe = self.made.wanted.clone().recipe(true)?;
        let [place, folder, failed] = [RUN, NEXT, FAILED].map(|name| Folder::new(out.join(name)).replacing());
        for replaced in [&place, &failed] {
            replaced.refuse_to_replace()?;
        }
        fs::create_dir_all(out).map_err(|error| Failure::Message(format!("{}: {error}", out.display())))?;
        let watching = Watching::for_a_while(self.made.max_time, self.made.threads);
        let watched = Watched { folder: &folder, waits: false, scenario: Some(scenario), more: String::new() };
        let changed = || self.watch && files.have_changed();
        let sampled = watching.sampled(&watched, &changed, |sampling| {
            plaus_run::sample_shard(&folder, &recipe, None, sampling).map_err(|error| located(error, scenario, &recipe))
        })?;
        let (monitor, ending) = match sampled {
            Sampled::Run(monitor, ending) => (monitor, ending),
            Sampled::Nothing(_, stop) => {
                files.also(&folder);
                let _ = folder.remove(); // best effort: the next try replaces it
                if stop == Stop::Interrupted {
                    return Ok(Outcome::Interrupted);
                }
                console::note_line("out of time while choosing how to sample: give it more by --max-time");
                return Ok(Outcome::Unsatisfied);
            }
        };
        files.also(&folder);
        if changed() || interrupt::asked() {
            let _ = folder.remove(); // best effort: the next try replaces it
            return Ok(Outcome::Interrupted);
        }
        let found = solutions::distinct(&Run::open(&folder)?.reader()?)?;
        let named = if found.is_empty() { &failed } else { &place };
        named.replace_by(&folder)?;
        let run = Run::open(named)?;
        let reader = run.reader()?;
        if found.is_empty() {
            return self.tell_nothing(&reader, out);
        }
        let _ = failed.remove(); // best effort: it only shows what a try before this one did
        let page = out.join(PAGE);
        let options = Options {
            count: gallery::SHOWN as usize,
            run: place.path().display().to_string(),
            until: None,
            live: self.live,
        };
        gallery::page(&reader, &page, true, &options)?;
        if self.watch {
            tell_when_made(&page).map_err(|error| Failure::Message(format!("{}: {error}", page.display())))?;
        }
        let short = if ending == Ending::Stopped { ", out of time" } else { "" };
        let best = found.iter().max_by(|a, b| a.log_p.total_cmp(&b.log_p));
        let export = best.map(|best| summary::export_of(&quoted(place.path()), "glb", best.sample));
        let (newest, found) = (found.last().map_or(0, |solution| solution.iteration), found.len() as u64);
        console::note_line(&format!(
            "{} in {}{short}: {}\n{}",
            counted(found, "different solution"),
            crate::clock::in_words(monitor.seconds()),
            page.display(),
            export.map(|command| format!("take one: {command}")).unwrap_or_default()
        ));
        if let Some(wanted) = run.manifest().plan.enough().filter(|&wanted| found < wanted) {
            console::note_line(&match summary::is_exhausted(newest, monitor.done()) {
                true => format!(
                    "hardly any more differ as much; to count smaller differences (`plaus explain distinct`): plaus try \
                     {} --set distinct_scale={}{}",
                    quoted(scenario),
                    summary::smaller(found, wanted) * summary::distinct_scale(&run),
                    summary::or_frame(&run)
                ),
                false => format!(
                    "for more, give it more time: plaus try {} --max-time {:.0}s",
                    quoted(scenario),
                    3.0 * self.made.max_time.as_secs_f64()
                ),
            });
        }
        Ok(Outcome::Done)
    }

    /// Says why nothing was found, and how to see what happened instead.
    fn tell_nothing(&self, run: &RunReader<'_>, out: &Path) -> Result<Outcome, Failure> {
        console::note_line(&why::in_words(run.scene(), &why::of_run(run)?, "recorded states"));
        let folder = run.run().folder().path();
        if let Some(nearest) = nearest(run)? {
            console::note_line(&format!("to see the nearest: {}", summary::export_of(&quoted(folder), "gif", nearest)));
        }
        if out.join(PAGE).exists() {
            console::note_line(&format!("{} still shows the last try that found something", out.display()));
        }
        Ok(Outcome::Unsatisfied)
    }
}

/// The recorded draw that is nearest to a solution.
fn nearest(run: &RunReader<'_>) -> Result<Option<SampleId>, RunFileError> {
    let mut best: Option<(f64, SampleId)> = None;
    for chain in run.chains() {
        for &phase in run.counted() {
            run.walk(chain, phase, |repeats| -> Result<(), RunFileError> {
                let log = repeats.entry.state.log_constraint.value();
                if best.is_none_or(|(most, _)| log > most) {
                    best = Some((log, SampleId { chain, phase, draw: repeats.draw }));
                }
                Ok(())
            })?;
        }
    }
    Ok(best.map(|(_, sample)| sample))
}

/// Pages that this process made.
static PAGES: AtomicU64 = AtomicU64::new(0);

/// Lets open pages of this name show the new one.
fn tell_when_made(page: &Path) -> io::Result<()> {
    // Each is later than the one before, also within a second.
    let made = 1000 * unix_seconds() + PAGES.fetch_add(1, Relaxed);
    let mut whole = fs::OpenOptions::new().append(true).open(page)?;
    whole.write_all(RELOADS.replace("{made}", &made.to_string()).as_bytes())?;
    fs::write(page.with_file_name(MADE), format!("window.made = {made};\n"))
}

/// Refuses a folder that holds other things than a try.
fn refuse_foreign(out: &Path) -> Result<(), Failure> {
    let Ok(entries) = fs::read_dir(out) else {
        return match out.exists() {
            true => Err(Failure::Message(format!("{}: is not a folder; choose another name by --out", out.display()))),
            false => Ok(()),
        };
    };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        // Names with a dot are drafts, or of the system.
        if !NAMES.contains(&name.as_str()) && !name.starts_with('.') {
            let message =
                format!("{}: holds {name}, so it is no earlier try; choose another name by --out", out.display());
            return Err(Failure::Message(message));
        }
    }
    Ok(())
}

/// Opens a page in the browser, if there is a screen.
fn open(page: &Path) {
    let has_screen = !cfg!(all(unix, not(target_os = "macos")))
        || ["DISPLAY", "WAYLAND_DISPLAY", "WSL_DISTRO_NAME"].iter().any(|name| std::env::var_os(name).is_some());
    if has_screen && open::that_detached(page).is_err() {
        console::note_line(&format!("no browser was found: open {}", page.display()));
    }
}

/// The files of a scenario, as they were at first.
struct Files(Mutex<Vec<(PathBuf, Stamp)>>);

/// When a file was last written, and its length; `None` while it is not there.
type Stamp = Option<(SystemTime, u64)>;

impl Files {
    fn new(scenario: &Path) -> Self {
        Self(Mutex::new(vec![(scenario.to_owned(), stamp(scenario))]))
    }

    /// From now on, also those that the scenario of a run names, if there is one.
    fn also(&self, run: &Folder) {
        let Ok(manifest) = Manifest::read(run) else { return };
        let mut files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = files[0].0.parent().map(Path::to_owned).unwrap_or_default();
        for path in manifest.assets.keys() {
            let path = folder.join(path);
            if files.iter().all(|(known, _)| *known != path) {
                files.push((path.clone(), stamp(&path)));
            }
        }
    }

    fn have_changed(&self) -> bool {
        let files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        files.iter().any(|(path, before)| stamp(path) != *before)
    }
}

fn stamp(path: &Path) -> Stamp {
    let about = fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}
