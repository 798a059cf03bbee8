//! What a run refuses to trust or to touch, and what it says when the disk refuses.

use crate::common::{bytes_of, recipe};
use plaus_run::disk::{Disk, RealDisk};
use plaus_run::{Diagnosis, Error, Folder, Manifest, More, Run, Sampling, Unwatched, resume, sample};
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use tempfile::TempDir;

fn sampled() -> (TempDir, Folder) {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    sample(&folder, &recipe(None), Sampling::new(1, &mut Unwatched)).unwrap();
    (place, folder)
}

/// The checksum is right, but this scenario makes no such plan: zero steps, lengths that overflow.
#[test]
fn a_plan_that_does_not_follow_from_its_scenario_is_not_believed() {
    let (_place, folder) = sampled();
    let manifest = Manifest::read(&folder).unwrap();
    let changes: [fn(&mut Manifest); 7] = [
        |manifest| manifest.plan.thin = 0,
        |manifest| manifest.plan.chains = u32::MAX,
        |manifest| manifest.plan.block = 0,
        |manifest| manifest.plan.iterations = u64::MAX,
        |manifest| {
            manifest.extended_from.push(manifest.plan.iterations);
            manifest.plan.iterations = u64::MAX;
        },
        |manifest| manifest.plan.warmup = u64::MAX,
        |manifest| manifest.scene = "other".into(),
    ];
    for change in changes {
        let mut changed = manifest.clone();
        change(&mut changed);
        std::fs::write(folder.manifest(), changed.to_json().unwrap()).unwrap();
        for error in [
            Run::open(&folder).map(|_| ()).unwrap_err(),
            resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)).map(|_| ()).unwrap_err(),
        ] {
            assert!(matches!(error, Error::StoredScenario(_)), "{error}");
        }
    }
}

#[test]
fn a_checkpoint_that_never_ends_is_not_read_to_its_end() {
    let (_place, folder) = sampled();
    std::fs::write(folder.checkpoints(), b"").unwrap();
    std::fs::File::options().write(true).open(folder.checkpoints()).unwrap().set_len(1 << 40).unwrap();
    let error = resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)).unwrap_err().to_string();
    assert!(error.contains("checkpoints: at byte 0: no frame of plaus begins here"), "{error}");
    assert!(error.contains("the records are not affected"), "{error}");
}

/// Processes of two containers may have the same number, and write to the same disk.
#[test]
fn the_draft_of_another_process_is_left_alone() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    let draft = place.path().join(format!(".run.{}.draft", std::process::id()));
    std::fs::create_dir(&draft).unwrap();
    std::fs::write(draft.join("manifest.json"), "theirs").unwrap();
    let error = sample(&folder, &recipe(None), Sampling::new(1, &mut Unwatched)).unwrap_err().to_string();
    assert!(error.contains(draft.to_str().unwrap()), "{error}");
    assert_eq!(std::fs::read(draft.join("manifest.json")).unwrap(), b"theirs");
    assert!(!folder.path().exists());
}

#[test]
fn wrong_requests_for_more_are_refused_before_anything_changes() {
    let (_place, folder) = sampled();
    let before = bytes_of(&folder);
    let says = |more| resume(&folder, more, Sampling::new(1, &mut Unwatched)).unwrap_err().to_string();
    let iterations = |wanted| More { iterations: Some(wanted), solutions: None };
    assert!(says(iterations(429)).contains("430 iterations are already planned"));
    for absurd in [1_000_000_000_001, 1 << 48, u64::MAX] {
        let message = says(iterations(absurd));
        assert!(message.contains("it must be from 1 to 1_000_000_000_000"), "{message}");
    }
    assert_eq!(bytes_of(&folder), before);
}

#[test]
fn folders_that_are_no_runs_get_no_lock() {
    let place = tempfile::tempdir().unwrap();
    let says = |name: &str| {
        let folder = Folder::new(place.path().join(name));
        resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)).unwrap_err().to_string()
    };
    assert!(says("").contains("is not a run"));
    assert!(says("nothing").contains("nothing: there is no such run"));
    assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
}

/// A disk that refuses an append, but not because it is full.
struct Revoked(AtomicU32);

impl Disk for Revoked {
    fn append(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        match self.0.fetch_sub(1, Ordering::Relaxed) {
            0 => Err(io::ErrorKind::PermissionDenied.into()),
            _ => RealDisk.append(path, bytes),
        }
    }
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        RealDisk.write(path, bytes)
    }
    fn sync(&self, path: &Path) -> io::Result<()> {
        RealDisk.sync(path)
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        RealDisk.rename(from, to)
    }
    fn truncate(&self, path: &Path, length: u64) -> io::Result<()> {
        RealDisk.truncate(path, length)
    }
    fn remove(&self, path: &Path) -> io::Result<()> {
        RealDisk.remove(path)
    }
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        RealDisk.create_folder(path)
    }
}

#[test]
fn the_error_for_any_refusal_of_the_disk_says_what_is_safe() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    let disk = Revoked(AtomicU32::new(7)); // three chains: the second append of the third round
    let error =
        sample(&folder, &recipe(None), Sampling { threads: 1, disk: &disk, watch: &mut Unwatched, further: None })
            .unwrap_err();
    assert!(matches!(error, Error::BrokenOff { safe: 2, .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("chain-00001.records: cannot write") && text.contains("safe up to iteration 2:"), "{text}");
    assert!(text.contains("ask whoever owns it for permission"), "{text}");
    resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)).unwrap();
    assert_eq!(bytes_of(&folder), bytes_of(&sampled().1));
}

#[test]
fn a_disk_without_room_for_a_manifest_is_blamed_on_the_run() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    let disk = crate::common::FailingDisk::new(10, u64::MAX, false);
    let error =
        sample(&folder, &recipe(None), Sampling { threads: 1, disk: &disk, watch: &mut Unwatched, further: None })
            .unwrap_err();
    assert!(error.to_string().starts_with(&format!("{}: cannot write", folder.path().display())), "{error}");
    assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0, "the draft is removed");
}

/// Thinning counts from iteration 0, so a short phase may hold one draw more than its length suggests.
#[test]
fn recorded_draws_are_counted_not_divided() {
    let recorded = |folder: &Folder| -> (u64, u64) {
        let diagnosis = Diagnosis::of(&Run::open(folder).unwrap().reader().unwrap(), None).unwrap();
        (diagnosis.recorded, diagnosis.tally.chains.iter().map(|chain| chain.satisfying_draws).sum())
    };
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    let mut short = recipe(None);
    // Records 300 and, with thin 3, 301..303: none.
    (short.scenario.sampler.warmup, short.scenario.sampler.iterations) = (299, 4);
    sample(&folder, &short, Sampling::new(1, &mut Unwatched)).unwrap();
    let (draws, satisfying) = recorded(&folder);
    assert_eq!(draws, 1);
    assert!(satisfying <= 3 * draws);
    (short.scenario.sampler.warmup, short.scenario.sampler.iterations) = (300, 4); // 300 and 303
    let folder = Folder::new(place.path().join("longer"));
    sample(&folder, &short, Sampling::new(1, &mut Unwatched)).unwrap();
    assert_eq!(recorded(&folder).0, 2);
}
