//! Pieces of a run, merged, are byte for byte the run that one machine makes. Pieces that do not make a whole run are
//! refused, and nothing is overwritten.

use crate::common::Place;

/// Seven chains with three rungs, so that pieces are uneven and each chain has a ladder.
const RUN: &str = "sample ball.toml --chains 7 --set rungs=3 --set swap_every=5 --iterations 500 -q";

fn cut(place: &Place, run: &str, of: u32, folder: &str) {
    for piece in 1..=of {
        place.ok(&format!("{run} --shard {piece}/{of} --out {folder}/{{shard}}"));
    }
}

fn lines(place: &Place, command: &str) -> String {
    let ended = place.run(command);
    ended.out + &ended.err
}

#[test]
fn merged_pieces_are_the_run_that_one_machine_makes() {
    let place = Place::new();
    place.ok(&format!("{RUN} --out whole"));
    let whole = place.bytes("whole");
    for of in [1, 2, 3, 7] {
        cut(&place, RUN, of, &format!("cut{of}"));
        place.ok(&format!("merge cut{of} --out all{of}"));
        assert!(place.bytes(&format!("all{of}")) == whole, "{of} pieces");
    }
    // Pieces may be named one by one, in any order, and come from different cuts.
    place.ok("merge cut2/2 cut7/1 cut7/3 cut7/2 --out mixed");
    assert!(place.bytes("mixed") == whole);
    assert!(place.names().iter().all(|name| !name.starts_with('.')), "no drafts are left");
}

/// A chain's files do not depend on how many chains there are.
#[test]
fn chains_of_runs_with_fewer_and_more_chains_have_the_same_bytes() {
    let place = Place::new();
    for chains in [4, 8] {
        place.ok(&format!("sample ball.toml --chains {chains} --out of{chains} -q"));
    }
    let (few, many) = (place.bytes("of4"), place.bytes("of8"));
    let mut same = 0;
    for (name, bytes) in few.iter().filter(|(name, _)| name.starts_with("chain-")) {
        assert!(bytes == &many[name], "{name}");
        same += 1;
    }
    assert_eq!(same, 4, "records of four chains");
    assert!(many["checkpoints"].starts_with(&few["checkpoints"]), "the checkpoints of the first four chains");
    assert_ne!(few["manifest.json"], many["manifest.json"]);
}

#[test]
fn a_piece_is_a_run() {
    let place = Place::new();
    place.ok("sample ball.toml --out whole -q");
    cut(&place, "sample ball.toml -q", 2, "cut");
    assert!(lines(&place, "diagnose cut/2").contains("piece 2/2: chains 2 to 3"));
    let replayed = |run: &str| place.ok(&format!("replay {run} --sample 3:17")).out;
    assert_eq!(replayed("cut/2"), replayed("whole"));
    place.ends("replay cut/2 --sample 1:17", 2).says(&["there is no chain 1: the chains are 2 to 3"]);
    for run in ["whole", "cut/1", "cut/2"] {
        place.ok(&format!("export {run} --format csv --out {}.csv", run.replace('/', "-")));
        place.ok(&format!("export {run} --format zarr --out {}.zarr", run.replace('/', "-")));
    }
    let rows = |name: &str| {
        let text = std::fs::read_to_string(place.path(name)).unwrap();
        text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!([rows("cut-1.csv"), rows("cut-2.csv")].concat(), rows("whole.csv"));
    let chains = std::fs::read(place.path("cut-2.zarr/posterior/chain/c/0")).unwrap();
    assert_eq!(chains, [2_u64, 3].map(u64::to_le_bytes).concat());
    let json: serde_json::Value = serde_json::from_str(&place.run("diagnose cut/2 --json").out).unwrap();
    assert_eq!([&json["chains"][0]["chain"], &json["chains"][1]["chain"]], [2, 3]);
}

#[test]
fn a_piece_is_continued_and_made_longer() {
    let place = Place::new();
    place.ok("sample ball.toml --out whole -q");
    place.ok("resume whole --iterations 2000 -q");
    let piece = |more: &str| format!("sample ball.toml -q --shard 1/2 --out cut/1 --continue{more}");
    place.ends(&piece(" --max-time 0s"), 1).says(&["this piece is not finished; continue with: plaus resume cut/1"]);
    place.ok("sample ball.toml -q --shard 2/2 --out cut/2 --continue");
    place
        .ends("merge cut --out all", 2)
        .says(&["cut/1: piece 1/2 has done 0 of 1000 iterations: continue it with `plaus resume`"]);
    place.ok(&piece(""));
    place.ok(&piece("")); // nothing is left to do
    for piece in [1, 2] {
        place.ok(&format!("resume cut/{piece} --iterations 2000 -q"));
    }
    place.ok("merge cut --out all -q");
    assert!(place.bytes("all") == place.bytes("whole"));
    let other = place.ends("sample ball.toml --seed 8 -q --shard 1/2 --out cut/1 --continue", 2);
    other.says(&["error: cut/1: holds another run: it has `seed = 7` in [sampler], not `seed = 8`"]);
    place.ends("sample ball.toml -q --shard 2/2 --out cut/1 --continue", 2).says(&["cut/1: holds another run"]);
}

/// Engines may start a piece twice: one process makes it; the other one waits, and then finds nothing left to do.
#[test]
fn a_piece_started_twice_at_once_is_made_once() {
    let place = Place::new();
    place.ok("sample ball.toml -q --shard 1/2 --out alone");
    for again in 0..8 {
        let start = || {
            let command = format!("sample ball.toml -q --shard 1/2 --out both{again} --continue");
            place.command(&command).stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped()).spawn()
        };
        for process in [start().unwrap(), start().unwrap()] {
            let ended = crate::common::Ended::of(process.wait_with_output().unwrap(), "twice at once");
            assert_eq!(ended.code, Some(0), "{}", ended.err);
        }
        let (mut alone, mut both) = (place.bytes("alone"), place.bytes(&format!("both{again}")));
        // The file names the process that was last.
        alone.remove("progress.json");
        both.remove("progress.json");
        assert!(both == alone, "{again}");
    }
}

/// For a run that looks for solutions, all pieces together decide where it ends.
#[test]
fn solutions_are_counted_over_all_pieces() {
    let place = Place::new();
    for (name, more) in [("plain", ""), ("tempered", " --set rungs=2 --set swap_every=5"), ("thin", " --thin 3")] {
        for wanted in [1, 10, 20] {
            let run = format!("sample ball.toml -q --chains 5 --solutions {wanted}{more}");
            let [whole, pieces, all] = ["whole", "cut", "all"].map(|part| format!("{part}-{name}-{wanted}"));
            place.ok(&format!("{run} --out {whole}"));
            cut(&place, &run, 3, &pieces);
            place.ok(&format!("merge {pieces} --out {all} -q"));
            assert!(place.bytes(&all) == place.bytes(&whole), "{name} {wanted}");
        }
    }
    // More than there are: the run continues to its end, and so do its pieces.
    let run = "sample ball.toml -q --chains 5 --solutions 100000";
    place.ends(&format!("{run} --out whole"), 1);
    cut(&place, run, 2, "cut");
    place.ok("merge cut --out all -q");
    assert!(place.bytes("all") == place.bytes("whole"));
    // A piece that was stopped before has to be continued first.
    place.ends(&format!("{run} --shard 1/2 --out early/1 --max-time 0s"), 1);
    place.ok(&format!("{run} --shard 2/2 --out early/2"));
    place.ends("merge early --out no", 2).says(&["early/1: by iteration 0, where this piece ends", "`plaus resume`"]);
    // Pieces that were begun without looking for solutions cannot start to look for them.
    cut(&place, "sample ball.toml -q", 2, "blind");
    place.ends("resume blind/1 --solutions 10", 2).says(&["begun without `--solutions`"]);
}

#[test]
fn pieces_that_make_no_whole_run_are_refused_by_name() {
    let place = Place::new();
    cut(&place, "sample ball.toml -q", 4, "cut");
    place.ok("sample ball.toml -q --seed 8 --shard 3/4 --out seed/3");
    place.ok("sample ball.toml -q --set sigma_d=0.2 --shard 3/4 --out scenario/3");
    place.ok("sample ball.toml -q --shard 1/2 --out half/1");
    let before = place.bytes("cut/3");
    for (pieces, says) in [
        ("cut/1 cut/2 cut/4", &["piece 3/4 is missing", "has chain 2"][..]),
        ("cut/2 cut/3", &["piece 1/4 is missing"]),
        ("cut/1 cut/2", &["pieces 3/4, 4/4 are missing", "has chains 2 to 3"]),
        ("cut cut/3", &["cut/3: is piece 3/4: its chain 2 is also in cut/3"]),
        ("half/1 cut", &["is piece 1/2: its chain 0 is also in cut/1"]),
        (
            "cut/1 cut/2 seed/3 cut/4",
            &["seed/3: does not belong to the same run as cut/1", "`seed = 8` in [sampler], not `seed = 7`"],
        ),
        (
            "cut/1 cut/2 scenario/3 cut/4",
            &["scenario/3: does not belong to the same run", "`sigma_d = 0.2`", "not `sigma_d = 0.1`"],
        ),
        ("cut/1 nowhere", &["nowhere: there is no such run"]),
        ("ball.toml", &["ball.toml: not an estimate of a chance"]),
    ] {
        place.ends(&format!("merge {pieces} --out all"), 2).says(says);
    }
    std::fs::create_dir(place.path("empty")).unwrap();
    place.ends("merge empty --out all", 2).says(&["empty: is not a piece of a run and holds none"]);
    place.ends("merge cut --out cut/3", 2).says(&["cut/3: already exists"]);
    place.ends("merge cut --out ball.toml", 2).says(&["ball.toml: already exists"]);
    place.ends("merge --out all", 2).says(&["<PIECES>"]);
    assert_eq!(place.bytes("cut/3"), before);
    assert_eq!(place.names(), ["ball.toml", "cut", "empty", "half", "scenario", "seed"]);
}

#[test]
fn a_version_that_differs_is_named() {
    let place = Place::new();
    cut(&place, "sample ball.toml -q", 2, "cut");
    // As another version would have written it, with a new checksum.
    let folder = plaus_run::Folder::new(place.path("cut/2"));
    let mut manifest = plaus_run::Manifest::read(&folder).unwrap();
    manifest.plaus = "0.0.9".to_owned();
    std::fs::write(folder.manifest(), manifest.to_json().unwrap()).unwrap();
    place
        .ends("merge cut --out all", 2)
        .says(&["cut/2: does not belong to the same run", "it was made by plaus 0.0.9, not 0.1.0"]);
}

#[test]
fn damaged_pieces_are_named() {
    let place = Place::new();
    cut(&place, "sample ball.toml -q", 2, "cut");
    let path = place.path("cut/2/chain-00003.records");
    let whole = std::fs::read(&path).unwrap();
    let mut flipped = whole.clone();
    let last = flipped.len() - 40;
    flipped[last] ^= 1;
    let foreign = std::fs::read(place.path("cut/2/chain-00002.records")).unwrap();
    let changes: [(&[u8], &[&str]); 4] = [
        (&flipped, &["cut/2/chain-00003.records: at byte ", "checksum", "that the chain recorded before are intact"]),
        (
            &whole[..whole.len() - 10],
            &["cut/2/chain-00003.records: at byte ", "that the chain recorded before are intact"],
        ),
        (&whole[..0], &["cut/2/chain-00003.records: at byte 0"]),
        (&foreign, &["cut/2/chain-00003.records: the frame at byte 0 does not follow the previous one"]),
    ];
    for (bytes, says) in changes {
        std::fs::write(&path, bytes).unwrap();
        place.ends("merge cut --out all", 2).says(says);
    }
    std::fs::remove_file(&path).unwrap();
    place.ends("merge cut --out all", 2).says(&["cut/2/chain-00003.records: cannot read"]);
    std::fs::write(&path, &whole).unwrap();
    std::fs::write(place.path("cut/1/checkpoints"), b"\x89plaus\r\n").unwrap();
    place.ends("merge cut --out all", 2).says(&["cut/1/checkpoints: at byte 0"]);
    std::fs::remove_file(place.path("cut/1/checkpoints")).unwrap();
    place.ends("merge cut --out all", 2).says(&["cut/1/checkpoints: this file is gone"]);
    std::fs::write(place.path("cut/1/checkpoints"), b"").unwrap();
    place.ends("merge cut --out all", 2).says(&["cut/1/checkpoints: it holds 0 of 2 checkpoints"]);
    assert_eq!(place.names(), ["ball.toml", "cut"], "nothing is left of what failed");
}

#[test]
fn numbers_that_name_no_piece_are_refused() {
    let place = Place::new();
    for (shard, says) in [
        ("0/0", "--shard 0/0: there is no piece 0 of 0"),
        ("5/4", "--shard 5/4: there is no piece 5 of 4"),
        ("0/4", "--shard 0/4: there is no piece 0 of 4"),
        ("3", "--shard 3: `3` names no piece: write PIECE/PIECES, e.g. 3/16"),
        ("-1/4", "--shard -1/4: `-1/4` names no piece"),
        ("2/5", "4 chains cannot be cut into 5 pieces"),
        ("task/4", "--shard task/4: neither HQ_TASK_ID nor SLURM_ARRAY_TASK_ID is set"),
    ] {
        let mut command = place.command(&format!("sample ball.toml -q --out cut/1 --shard {shard}"));
        command.env_remove("HQ_TASK_ID").env_remove("SLURM_ARRAY_TASK_ID");
        let ended = crate::common::Ended::of(command.output().unwrap(), shard);
        assert_eq!(ended.code, Some(2), "{shard}");
        ended.says(&[says]);
    }
    assert_eq!(place.names(), ["ball.toml"]);
    place.ok("sample ball.toml -q --shard 1/2 --out cut");
    place.ends("sample ball.toml -q --shard 2/2 --out cut", 2).says(&["cut: already exists"]);
}

#[test]
fn engines_say_which_task_it_is() {
    let place = Place::new();
    for (index, (name, task)) in [("SLURM_ARRAY_TASK_ID", "2"), ("HQ_TASK_ID", "3")].into_iter().enumerate() {
        let mut command = place.command("sample ball.toml -q --shard task/4 --out cut/{shard}");
        // HyperQueue's workers run within Slurm, so HyperQueue's task counts.
        command.env("SLURM_ARRAY_TASK_ID", "2").env(name, task);
        let command = if index == 0 { command.env_remove("HQ_TASK_ID") } else { &mut command };
        assert!(command.status().unwrap().success());
        assert!(place.path(&format!("cut/{task}/chain-0000{}.records", index + 1)).exists());
    }
    let mut command = place.command("sample ball.toml -q --shard task/4 --out cut/{shard}");
    let ended = crate::common::Ended::of(command.env("HQ_TASK_ID", "9").output().unwrap(), "task 9");
    assert_eq!(ended.code, Some(2));
    ended.says(&["HQ_TASK_ID is `9`: there is no piece 9 of 4"]);
}

/// A whole run sends no signals, and did not die for that.
#[test]
fn the_status_of_a_whole_run_is_that_of_its_checkpoints() {
    let place = Place::new();
    place.ok("sample ball.toml --out whole -q");
    let done = place.ok("status whole").out;
    assert!(done.contains("\ndone: 100.0% of the iterations"), "{done}");
    place.ok("sample ball.toml --out enough --solutions 3 -q");
    // Its last iterations were not needed, so they are neither done nor left.
    let enough = place.ok("status enough").out;
    let said = ["at most 1,000", "\ndone: the solutions asked for were found before the last iteration"];
    assert!(said.iter().all(|said| enough.contains(said)) && !enough.contains('%'), "{enough}");
    place.ends("sample ball.toml --out stopped --max-time 0s -q", 1);
    let stopped = place.ends("status stopped", 1).out;
    assert!(stopped.contains("\nstopped: 0.0% of the iterations"), "{stopped}");
}
