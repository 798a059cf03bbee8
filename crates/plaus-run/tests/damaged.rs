//! Damaged files of a run: each either reads as before or gives an error that says where the damage is. Nothing panics.

use crate::common::{all_draws, bytes_of, recipe};
use plaus_run::{ChainPhase, Folder, More, Run, Sampling, Unwatched, resume, sample};
use proptest::prelude::*;
use std::sync::LazyLock;
use tempfile::TempDir;

type Draws = Vec<Vec<Vec<u64>>>;

struct Whole {
    place: TempDir,
    files: Vec<(String, Vec<u8>)>,
    draws: Draws,
}

impl Whole {
    fn folder(&self) -> Folder {
        Folder::new(self.place.path().join("run"))
    }
}

static WHOLE: LazyLock<Whole> = LazyLock::new(|| {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    sample(&folder, &recipe(None), Sampling::new(1, &mut Unwatched)).unwrap();
    let files = bytes_of(&folder).into_iter().filter(|(name, _)| name != "lock").collect();
    let draws = read(&folder).unwrap();
    Whole { place, files, draws }
});

fn read(folder: &Folder) -> Result<Draws, String> {
    let run = Run::open(folder).map_err(|error| error.to_string())?;
    all_draws(&run, ChainPhase::Sampling)
}

/// A copy of the run with one file replaced.
fn with(name: &str, bytes: &[u8]) -> (TempDir, Folder) {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path().join("run"));
    std::fs::create_dir(folder.path()).unwrap();
    for entry in std::fs::read_dir(WHOLE.folder().path()).unwrap().map(Result::unwrap) {
        std::fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    std::fs::write(folder.path().join(name), bytes).unwrap();
    (place, folder)
}

/// Either the draws are as before, or there is an error. A resumed run ends with the same files, or changes none.
fn harmless(name: &str, bytes: &[u8]) -> Result<(), TestCaseError> {
    let (_place, folder) = with(name, bytes);
    let damaged = bytes_of(&folder);
    match read(&folder) {
        Ok(draws) => prop_assert_eq!(&draws, &WHOLE.draws),
        Err(error) => prop_assert!(error.contains(folder.path().to_str().unwrap()), "{}", error),
    }
    let salvaged = Run::open(&folder).map(|run| all_draws(&run.salvaged(), ChainPhase::Sampling));
    if let Ok(Ok(draws)) = salvaged {
        for (salvaged, whole) in draws.iter().zip(&WHOLE.draws) {
            prop_assert_eq!(&salvaged[..], &whole[..salvaged.len()]);
        }
    }
    match resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)) {
        Ok(_) => {
            let files = bytes_of(&folder);
            for (name, bytes) in WHOLE.files.iter().filter(|(name, _)| name.starts_with("chain")) {
                prop_assert_eq!(files.get(name), Some(bytes), "{}", name);
            }
        }
        Err(_) => prop_assert_eq!(bytes_of(&folder), damaged),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn flipped_bits_are_noticed(file in any::<prop::sample::Index>(), at in any::<prop::sample::Index>(), bit in 0..8) {
        let (name, bytes) = file.get(&WHOLE.files);
        let mut bytes = bytes.clone();
        let at = at.index(bytes.len());
        bytes[at] ^= 1_u8 << bit;
        harmless(name, &bytes)?;
        if name.starts_with("chain") {
            let (_place, folder) = with(name, &bytes);
            prop_assert!(read(&folder).is_err());
        }
    }

    #[test]
    fn cut_files_are_noticed(file in any::<prop::sample::Index>(), at in any::<prop::sample::Index>()) {
        let (name, bytes) = file.get(&WHOLE.files);
        let at = at.index(bytes.len());
        harmless(name, &bytes[..at])?;
    }

    #[test]
    fn mixed_up_bytes_are_survived(
        file in any::<prop::sample::Index>(),
        from in any::<prop::sample::Index>(),
        patch in prop::collection::vec(any::<u8>(), 1..40),
        insert in any::<bool>(),
    ) {
        let (name, bytes) = file.get(&WHOLE.files);
        let at = from.index(bytes.len());
        let rest = if insert { at } else { (at + patch.len()).min(bytes.len()) };
        harmless(name, &[&bytes[..at], &patch[..], &bytes[rest..]].concat())?;
    }

    #[test]
    fn swapped_files_are_noticed(a in any::<prop::sample::Index>(), b in any::<prop::sample::Index>()) {
        let ((name, _), (_, bytes)) = (a.get(&WHOLE.files), b.get(&WHOLE.files));
        harmless(name, bytes)?;
    }
}

#[test]
fn damage_is_reported_with_place_and_what_is_intact() {
    let (name, bytes) = WHOLE.files.iter().find(|(name, _)| name == "chain-00001.records").unwrap();
    let mut bytes = bytes.clone();
    let last = bytes.len() - 40;
    bytes[last] ^= 1;
    let (_place, folder) = with(name, &bytes);
    let error = read(&folder).unwrap_err();
    // Every third iteration recorded, and 512 iterations before the last block.
    for part in
        ["chain-00001.records", "at byte ", "checksum", "The 171 draws that the chain recorded before are intact"]
    {
        assert!(error.contains(part), "{part} is not in: {error}");
    }
    let salvaged = all_draws(&Run::open(&folder).unwrap().salvaged(), ChainPhase::Sampling).unwrap();
    assert_eq!(salvaged[0].len(), 171 - 34);
}

#[test]
fn a_missing_checkpoint_is_an_error_for_resume() {
    let (_place, folder) = with("checkpoints", b"");
    std::fs::remove_file(folder.checkpoints()).unwrap();
    let error = resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)).unwrap_err().to_string();
    let says = ["checkpoints: this file is gone", "The records are not affected"];
    assert!(says.iter().all(|part| error.contains(part)), "{error}");
    // Reading the run gives the same message.
    let read = all_draws(&Run::open(&folder).unwrap(), ChainPhase::Sampling).unwrap_err();
    assert_eq!(read, error);
}

/// Nothing is lost by what is wrong with the checkpoints: no record is cut off.
#[test]
fn checkpoints_that_are_not_whole_are_refused_and_leave_the_records() {
    let (_, whole) = WHOLE.files.iter().find(|(name, _)| name == "checkpoints").unwrap();
    // Each frame begins with the same eight bytes.
    let starts: Vec<usize> = (0..whole.len()).filter(|&at| whole[at..].starts_with(b"\x89plaus\r\n")).collect();
    assert_eq!(starts.len(), 3, "a frame for each chain");
    let mut longer = whole.clone();
    longer.extend_from_slice(&whole[..starts[1]]);
    let swapped = [&whole[starts[1]..starts[2]], &whole[..starts[1]], &whole[starts[2]..]].concat();
    for (bytes, says) in [
        (&[][..], "it holds 0 of 3 checkpoints"),
        (&whole[..starts[2]], "it holds 2 of 3 checkpoints"),
        (&whole[..starts[2] - 1], "at byte "),
        (&longer, "it holds more than 3 checkpoints"),
        (&swapped, "is of chain 1, not 0"),
    ] {
        let (_place, folder) = with("checkpoints", bytes);
        let before = std::fs::read(folder.records(0)).unwrap();
        let error = resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)).unwrap_err().to_string();
        assert!(error.contains(says), "{says} is not in: {error}");
        assert!(!before.is_empty() && std::fs::read(folder.records(0)).unwrap() == before);
    }
}

#[test]
fn a_run_of_another_version_is_not_continued() {
    let (_place, folder) = with("lock", b"");
    let mut manifest = plaus_run::Manifest::read(&folder).unwrap();
    manifest.plaus = "0.0.7".into();
    std::fs::write(folder.manifest(), manifest.to_json().unwrap()).unwrap();
    let error = resume(&folder, More::default(), Sampling::new(1, &mut Unwatched)).unwrap_err().to_string();
    assert!(error.contains("made by plaus 0.0.7"), "{error}");
}
