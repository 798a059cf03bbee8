//! A run that is killed at any write, or meets a full disk, continues to the same bytes.

use crate::common::{FailingDisk, adapting, bytes_of, recipe, tempered, weighing};
use plaus_run::disk::{Disk, RealDisk};
use plaus_run::{Error, Folder, More, Recipe, Run, Sampling, Shard, Unwatched};
use plaus_run::{Watch, resume, sample, sample_shard};

/// Asks for checkpoints only now and then, as the clock would.
struct Seldom(u32);

impl Watch for Seldom {
    fn round(&mut self, _: &plaus_mcmc::Progress<'_>) -> plaus_mcmc::Control {
        plaus_mcmc::Control::Continue
    }
    fn checkpoint_due(&mut self) -> bool {
        self.0 += 1;
        self.0.is_multiple_of(3)
    }
}

fn sample_on(disk: &dyn Disk, folder: &Folder, recipe: &Recipe, watch: &mut dyn Watch) -> Result<(), Error> {
    piece_on(disk, folder, recipe, None, watch)
}

fn piece_on(
    disk: &dyn Disk,
    folder: &Folder,
    recipe: &Recipe,
    shard: Option<Shard>,
    watch: &mut dyn Watch,
) -> Result<(), Error> {
    sample_shard(folder, recipe, shard, Sampling { threads: 1, disk, watch, further: None }).map(|_| ())
}

/// Number of deaths, spread over a run: this many after some number of bytes, and as many after some number of
/// operations.
const DEATHS: usize = 50;

/// A run of some forty blocks, the last ones of full size.
fn shortened(mut recipe: Recipe) -> Recipe {
    let sampler = &mut recipe.scenario.sampler;
    (sampler.warmup, sampler.iterations, sampler.checkpoint_every) = (40, 172, 20);
    recipe
}

fn killed_everywhere(recipe: Recipe, crash: bool) {
    piece_killed_everywhere(recipe, None, crash);
}

fn piece_killed_everywhere(recipe: Recipe, shard: Option<Shard>, crash: bool) {
    let recipe = &shortened(recipe);
    // Makes nothing durable. That would take most of the time, and matters only if the power fails.
    let peaceful = FailingDisk::new(u64::MAX, u64::MAX, crash);
    let place = tempfile::tempdir().unwrap();
    let whole = Folder::new(place.path().join("whole"));
    let disk = FailingDisk::new(u64::MAX, u64::MAX, crash);
    piece_on(&disk, &whole, recipe, shard, &mut Unwatched).unwrap();
    let expected = bytes_of(&whole);
    let (bytes, operations) = disk.used();
    assert!(bytes > 2_000 && operations > 300, "{bytes} bytes in {operations} operations prove little");
    // With odd steps every kind of operation is met, however regularly these follow each other.
    let step = |all: u64| (all as usize / DEATHS) | 1;
    let limits = (0..bytes).step_by(step(bytes)).map(|bytes| (bytes, u64::MAX));
    let stops = (0..operations).step_by(step(operations)).map(|operations| (u64::MAX, operations));
    for (index, (bytes, operations)) in limits.chain(stops).enumerate() {
        // In a folder of its own, because pieces look at the pieces beside them.
        let folder = Folder::new(place.path().join(format!("run{index}")).join("piece"));
        let failing = FailingDisk::new(bytes, operations, crash);
        let first: &mut dyn Watch = if index % 2 == 0 { &mut Unwatched } else { &mut Seldom(0) };
        if piece_on(&failing, &folder, recipe, shard, first).is_ok() {
            continue;
        }
        // Die again after continuing, then continue undisturbed.
        if folder.path().exists() {
            let again = FailingDisk::new(bytes / 3 + 50, operations / 2, crash);
            let _ = resume(
                &folder,
                More::default(),
                Sampling { threads: 2, disk: &again, watch: &mut Seldom(0), further: None },
            );
            resume(
                &folder,
                More::default(),
                Sampling { threads: 1, disk: &peaceful, watch: &mut Unwatched, further: None },
            )
            .unwrap();
        } else {
            piece_on(&peaceful, &folder, recipe, shard, &mut Unwatched).unwrap();
        }
        assert_eq!(bytes_of(&folder), expected, "after {bytes} bytes or {operations} operations");
        std::fs::remove_dir_all(folder.path()).unwrap();
    }
}

#[test]
fn a_process_killed_anywhere_loses_nothing_final() {
    killed_everywhere(recipe(None), true);
}

#[test]
fn a_tempered_run_killed_anywhere_loses_nothing_final() {
    killed_everywhere(tempered(None), true);
}

#[test]
fn a_run_killed_while_it_adapts_loses_nothing_final() {
    killed_everywhere(adapting(1), true);
    killed_everywhere(weighing(3), true);
}

/// A longer run keeps the scales that were frozen; the tally shows what was adapted.
#[test]
fn a_longer_run_keeps_its_scales() {
    use plaus_run::tally::{ScaleTally, Tally};
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    let values = || {
        let tally = Tally::of(&Run::open(&folder).unwrap().reader().unwrap()).unwrap();
        let chains: Vec<Vec<ScaleTally>> = tally.chains.into_iter().map(|chain| chain.scales).collect();
        let one = |scales: &Vec<ScaleTally>| {
            assert!(scales.len() == 1 && scales[0].frozen && scales[0].kernel == "perturb", "{scales:?}");
            (scales[0].value.unwrap(), scales[0].tried)
        };
        chains.iter().map(one).collect::<Vec<_>>()
    };
    sample(&folder, &adapting(1), Sampling::new(1, &mut Unwatched)).unwrap();
    let short = values();
    resume(&folder, More { iterations: Some(900), solutions: None }, Sampling::new(1, &mut Unwatched)).unwrap();
    for (short, long) in short.iter().zip(values()) {
        assert!(short.0 == long.0 && long.1 > short.1 && short.0 < 5.0, "{short:?} {long:?}");
    }
    assert!(short[0].0 != short[1].0, "each chain has its own");
}

#[test]
fn a_process_killed_anywhere_finds_the_same_solutions() {
    killed_everywhere(recipe(Some(30)), true);
}

#[test]
fn a_piece_killed_anywhere_loses_nothing_final() {
    let second = Shard::new(2, 2).ok();
    piece_killed_everywhere(recipe(None), second, true);
    piece_killed_everywhere(tempered(Some(30)), second, true);
    piece_killed_everywhere(recipe(Some(30)), second, false);
}

#[test]
fn a_full_disk_leaves_the_run_resumable() {
    killed_everywhere(recipe(None), false);
}

#[test]
fn a_full_disk_is_named_with_what_is_safe() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    let disk = FailingDisk::new(20_000, u64::MAX, false);
    let error = sample_on(&disk, &folder, &recipe(None), &mut Unwatched).unwrap_err();
    let Error::DiskFull { safe, .. } = &error else { panic!("{error}") };
    assert!(*safe > 0 && Run::open(&folder).unwrap().reader().unwrap().iterations() == *safe, "{safe}");
    assert!(error.to_string().contains("free some space, then continue with `plaus resume`"), "{error}");
}

#[test]
fn threads_and_checkpoints_leave_no_trace() {
    let place = tempfile::tempdir().unwrap();
    for (recipe, name) in [(recipe(None), "plain"), (tempered(None), "tempered")] {
        let run = |threads, watch: &mut dyn Watch| {
            let folder = Folder::new(place.path().join(format!("{name}{threads}")));
            sample(&folder, &recipe, Sampling { threads, disk: &RealDisk, watch, further: None }).unwrap();
            bytes_of(&folder)
        };
        let one = run(1, &mut Unwatched);
        assert_eq!(run(2, &mut Seldom(0)), one);
        assert_eq!(run(4, &mut Seldom(1)), one);
    }
}

#[test]
fn a_longer_run_begins_like_the_shorter() {
    use plaus_run::{ChainPhase, Manifest};
    let place = tempfile::tempdir().unwrap();
    let (short, long) = (Folder::new(place.path().join("short")), Folder::new(place.path().join("long")));
    sample(&short, &recipe(None), Sampling::new(1, &mut Unwatched)).unwrap();
    let mut more = recipe(None);
    more.scenario.sampler.iterations = 700;
    sample(&long, &more, Sampling::new(1, &mut Unwatched)).unwrap();
    resume(&short, More { iterations: Some(700), solutions: None }, Sampling::new(1, &mut Unwatched)).unwrap();
    assert_eq!(Manifest::read(&short).unwrap().extended_from, [430]);
    let draws = |folder: &Folder| crate::common::all_draws(&Run::open(folder).unwrap(), ChainPhase::Sampling);
    assert_eq!(draws(&short), draws(&long));
    let shorter =
        resume(&short, More { iterations: Some(5), solutions: None }, Sampling::new(1, &mut Unwatched)).unwrap_err();
    assert!(shorter.to_string().contains("700 iterations are already planned"), "{shorter}");
}

#[test]
fn two_processes_cannot_write_one_run() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    sample(&folder, &recipe(None), Sampling::new(1, &mut Unwatched)).unwrap();
    let claim = folder.claim().unwrap();
    assert!(folder.is_being_written());
    let error = resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)).unwrap_err();
    assert!(error.to_string().contains("another process is writing"), "{error}");
    drop(claim);
    assert!(!folder.is_being_written());
    let again = sample(&folder, &recipe(None), Sampling::new(1, &mut Unwatched)).unwrap_err();
    assert!(again.to_string().contains("already exists"), "{again}");
}
