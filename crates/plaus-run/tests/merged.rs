//! A merge that is killed anywhere, or finds no room, leaves nothing behind and does not change the pieces.

use crate::common::{FailingDisk, bytes_of, recipe, tempered};
use plaus_run::disk::{Disk, RealDisk};
use plaus_run::merge::{MergePulse, Merged, Merging, merge};
use plaus_run::{Error, Folder, Recipe, Sampling, Shard, Unwatched, sample, sample_shard};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Two pieces of a run of three chains, and the whole.
fn pieces(recipe: &Recipe) -> (TempDir, Vec<PathBuf>, Folder) {
    let place = tempfile::tempdir().unwrap();
    let whole = Folder::new(place.path().join("whole"));
    sample(&whole, recipe, Sampling::new(1, &mut Unwatched)).unwrap();
    for shard in Shard::all(2) {
        let folder = Folder::new(place.path().join("pieces").join(shard.piece().to_string()));
        sample_shard(&folder, recipe, Some(shard), Sampling::new(1, &mut Unwatched)).unwrap();
    }
    let paths = vec![place.path().join("pieces")];
    (place, paths, whole)
}

fn merge_on(disk: &dyn Disk, paths: &[PathBuf], out: &Path) -> Result<Merged, Error> {
    let merging = Merging { threads: 1, disk, pulse: &MergePulse::default() };
    merge(paths, &Folder::new(out), merging)
}

/// Number of failures of the disk: this many after some number of bytes, and as many after some number of operations.
const FAILURES: u64 = 12;

#[test]
fn a_merge_that_fails_leaves_nothing() {
    for (recipe, crash) in [(recipe(None), true), (tempered(Some(30)), true), (recipe(Some(30)), false)] {
        let (place, paths, whole) = pieces(&recipe);
        let disk = FailingDisk::new(u64::MAX, u64::MAX, true);
        let out = place.path().join("all");
        merge_on(&disk, &paths, &out).unwrap();
        assert_eq!(bytes_of(&Folder::new(&out)), bytes_of(&whole));
        std::fs::remove_dir_all(&out).unwrap();
        let before: Vec<_> = [1, 2].map(|n| bytes_of(&Folder::new(paths[0].join(n.to_string())))).into();
        let (bytes, operations) = disk.used();
        // Every n-th; with odd steps every kind of operation is met.
        let limits = (0..bytes).step_by((bytes / FAILURES) as usize | 1).map(|bytes| (bytes, u64::MAX));
        let stops =
            (0..operations).step_by((operations / FAILURES) as usize | 1).map(|operations| (u64::MAX, operations));
        let mut failed = 0;
        for (bytes, operations) in limits.chain(stops) {
            let merged = merge_on(&FailingDisk::new(bytes, operations, crash), &paths, &out);
            if merged.is_ok() {
                std::fs::remove_dir_all(&out).unwrap();
                continue;
            }
            failed += 1;
            // The last operation makes the new name durable, so a merge that dies there has made the run.
            if out.exists() {
                assert_eq!(bytes_of(&Folder::new(&out)), bytes_of(&whole));
                std::fs::remove_dir_all(&out).unwrap();
            }
        }
        assert!(failed >= FAILURES, "only {failed} merges failed");
        let after: Vec<_> = [1, 2].map(|n| bytes_of(&Folder::new(paths[0].join(n.to_string())))).into();
        assert!(before == after);
        let names: Vec<_> = std::fs::read_dir(place.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names.len(), 2, "{names:?}");
        merge_on(&RealDisk, &paths, &out).unwrap();
        assert_eq!(bytes_of(&Folder::new(&out)), bytes_of(&whole));
    }
}

#[test]
fn a_merge_that_is_stopped_leaves_nothing() {
    let (place, paths, _) = pieces(&recipe(None));
    let pulse = MergePulse::default();
    pulse.stop();
    let out = Folder::new(place.path().join("all"));
    let merging = Merging { threads: 1, disk: &RealDisk, pulse: &pulse };
    let error = merge(&paths, &out, merging).unwrap_err();
    assert!(error.to_string().contains("nothing was made"), "{error}");
    assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 2);
}

/// Pieces that look for solutions side by side stop soon after the run would, instead of each finding all solutions by
/// itself. The merged run is the same.
#[test]
fn pieces_that_look_for_solutions_learn_from_those_beside_them() {
    let mut recipe = recipe(Some(12));
    let sampler = &mut recipe.scenario.sampler;
    (sampler.chains, sampler.iterations, sampler.checkpoint_every) = (6, 20_000, 50);
    let place = tempfile::tempdir().unwrap();
    let whole = Folder::new(place.path().join("whole"));
    sample(&whole, &recipe, Sampling::new(1, &mut Unwatched)).unwrap();
    let size = |folder: &Folder| -> usize { bytes_of(folder).values().map(Vec::len).sum() };
    let mut sizes = Vec::new();
    for together in [true, false] {
        let run = |shard: Shard| {
            let beside = if together { "together".to_owned() } else { format!("alone/{}", shard.piece()) };
            let folder = Folder::new(place.path().join(beside).join(format!("piece{}", shard.piece())));
            sample_shard(&folder, &recipe, Some(shard), Sampling::new(1, &mut Unwatched)).unwrap();
            folder
        };
        let folders: Vec<Folder> = std::thread::scope(|scope| {
            let threads: Vec<_> = Shard::all(6).map(|shard| scope.spawn(move || run(shard))).collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        let out = place.path().join(format!("all-{together}"));
        let paths: Vec<PathBuf> = folders.iter().map(|folder| folder.path().to_owned()).collect();
        merge_on(&RealDisk, &paths, &out).unwrap();
        assert_eq!(bytes_of(&Folder::new(&out)), bytes_of(&whole), "together: {together}");
        sizes.push(folders.iter().map(size).sum::<usize>());
    }
    assert!(sizes[0] < sizes[1], "{sizes:?}");
}
