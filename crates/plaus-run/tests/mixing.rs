//! While a run is sampled, its report on mixing is the same as its diagnosis afterwards, from as many draws.

use crate::common::FailingDisk;
use plaus_mcmc::{Control, Progress};
use plaus_run::disk::Disk;
use plaus_run::{Diagnosis, Folder, Mixing, More, Recipe, Run, RunReader, Sampling, Watch, resume, sample};
use plaus_scenes::Role;

/// Asks after each round, and may stop the run.
#[derive(Default)]
struct Curious {
    found: Vec<(u64, Mixing)>,
    last: Option<Mixing>,
    stop_from: Option<u64>,
}

impl Watch for Curious {
    fn round(&mut self, progress: &Progress<'_>) -> Control {
        self.found.extend(self.last.take().map(|mixing| (progress.end_iteration, mixing)));
        if self.stop_from.is_some_and(|from| progress.end_iteration >= from) {
            Control::Stop
        } else {
            Control::Continue
        }
    }
    fn looks_at_mixing(&self) -> bool {
        true
    }
    fn mixing_due(&mut self) -> bool {
        true
    }
    fn mixing(&mut self, mixing: Option<Mixing>) {
        self.last = mixing;
    }
}

/// The same from the records, with at most this many draws per chain.
fn of_records(run: &RunReader<'_>, most: u64) -> Mixing {
    let diagnosis = Diagnosis::of(run, Some(most)).unwrap();
    let rows = diagnosis.scalars.iter().filter(|row| row.scalar.role == Role::Outcome);
    let rows: Vec<_> = rows.map(|row| (row.scalar.name.clone(), row.summary.unwrap())).collect();
    let rhat = rows.iter().map(|(name, row)| (name.clone(), row.rhat.unwrap()));
    let ess = rows.iter().map(|(name, row)| (name.clone(), row.ess_bulk.min(row.ess_tail)));
    Mixing { rhat: rhat.max_by(|a, b| a.1.total_cmp(&b.1)), ess: ess.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap() }
}

fn recipe(iterations: u64, thin: u64) -> Recipe {
    let mut recipe = crate::common::recipe(None);
    let sampler = &mut recipe.scenario.sampler;
    (sampler.warmup, sampler.iterations, sampler.thin, sampler.checkpoint_every) = (100, iterations, thin, 500);
    recipe
}

#[test]
fn mixing_reported_meanwhile_is_that_of_the_records() {
    let place = tempfile::tempdir().unwrap();
    // Makes nothing durable, which would take most of the time.
    let disk = FailingDisk::new(u64::MAX, u64::MAX, false);
    let disk: &dyn Disk = &disk;
    // Few draws, all of which are kept; and many, of which every second one is kept, as in the diagnosis.
    for (iterations, thin) in [(400, 1), (399, 3), (2048, 1)] {
        let recipe = recipe(iterations, thin);
        let [whole, parts] =
            ["whole", "parts"].map(|name| Folder::new(place.path().join(format!("{name}{iterations}"))));
        let mut watch = Curious::default();
        sample(&whole, &recipe, Sampling { threads: 1, disk, watch: &mut watch, further: None }).unwrap();
        let of_records = of_records(&Run::open(&whole).unwrap().reader().unwrap(), 1024);
        let (end, last) = watch.found.last().unwrap();
        assert_eq!((*end, last), (100 + iterations, &of_records));
        assert!(watch.found.iter().all(|(end, _)| *end > 100), "nothing is said of the warm-up");

        // A run that is continued knows what it recorded before.
        let mut first = Curious { stop_from: Some(300), ..Curious::default() };
        sample(&parts, &recipe, Sampling { threads: 2, disk, watch: &mut first, further: None }).unwrap();
        let mut second = Curious::default();
        resume(&parts, More::default(), Sampling { threads: 2, disk, watch: &mut second, further: None }).unwrap();
        assert_eq!(second.found.last().unwrap().1, of_records);
    }
}
