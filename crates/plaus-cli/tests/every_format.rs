//! Every way to get something out of a run, if the run, the sample or the output is not as it should be: a clear error,
//! nothing left behind, nothing overwritten.

use crate::common::Place;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

/// Ways to get something out of the run `run`, each with the output it makes.
const WAYS: [(&str, &str); 14] = [
    ("export run --format csv", "d.csv"),
    ("export run --format zarr", "d.zarr"),
    ("export run --format glb --sample 1:7", "a.glb"),
    ("export run --format usda --sample 1:7", "a.usda"),
    ("export run --format poses --sample 1:7", "p.csv"),
    ("export run --format events --sample 1:7", "e.csv"),
    ("export run --format events --sample 1:7", "e.json"),
    ("export run --format json --sample 1:7", "m.json"),
    ("export run --format wav --sample 1:7", "s.wav"),
    ("export run --format png --size 32x18 --sample 1:7", "p.png"),
    ("export run --format gif --size 32x18 --fps 5 --sample 1:7", "l.gif"),
    ("export run --format glb --all-distinct", "all"),
    ("export run --format usda --sample 0:3 --sample 1:7", "some"),
    ("gallery run --count 3", "g.html"),
];

/// Expects that all of these ways are refused in these words, and leave nothing.
fn all_are_refused(place: &Place, says: &[&str]) {
    let before = place.names();
    for (way, out) in WAYS {
        place.ends(&format!("{way} --out {out}"), 2).says(says);
    }
    assert_eq!(place.names(), before, "nothing is left behind");
}

/// Every byte of a file, or of all files in a folder.
fn bytes(place: &Place, out: &str) -> Vec<(String, Vec<u8>)> {
    fn collect(path: &Path, into: &mut Vec<(String, Vec<u8>)>) {
        if path.is_dir() {
            let mut entries: Vec<_> = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()).collect();
            entries.sort();
            entries.iter().for_each(|entry| collect(entry, into));
        } else {
            into.push((path.display().to_string(), std::fs::read(path).unwrap()));
        }
    }
    let mut all = Vec::new();
    collect(&place.path(out), &mut all);
    all
}

#[test]
fn existing_files_are_replaced_only_on_request_and_only_if_they_are_ours() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    for (way, out) in WAYS {
        let command = format!("{way} --out {out}");
        place.ok(&command);
        let made = bytes(&place, out);
        assert!(!made.is_empty(), "{command}");
        place.ends(&command, 2).says(&[&format!("error: {out}: already exists"), "--force"]);
        assert_eq!(bytes(&place, out), made, "{command}");
        place.ok(&format!("{command} --force"));
        assert_eq!(bytes(&place, out), made, "{command}: the same bytes again");
        let end = out.rsplit_once('.').map(|(_, end)| format!(".{end}")).unwrap_or_default();
        for theirs in [format!("theirs{end}"), format!("their_folder{end}")] {
            let theirs = theirs.as_str();
            if theirs == format!("theirs{end}") {
                place.write(theirs, "somebody else's");
            } else {
                std::fs::create_dir_all(place.path(theirs)).unwrap();
                std::fs::write(place.path(theirs).join("note"), "somebody else's").unwrap();
            }
            let before = bytes(&place, theirs);
            place.ends(&format!("{way} --out {theirs}"), 2).says(&[&format!("error: {theirs}: already exists")]);
            place.ends(&format!("{way} --out {theirs} --force"), 2).says(&["was not made by such an export"]);
            assert_eq!(bytes(&place, theirs), before, "{command}");
        }
    }
}

#[test]
fn folders_that_are_no_runs_are_refused() {
    let place = Place::new();
    all_are_refused(&place, &["error: run: ", "no such run"]);
    std::fs::create_dir(place.path("run")).unwrap();
    all_are_refused(&place, &["error: run: ", "is not a run"]);
    std::fs::remove_dir(place.path("run")).unwrap();
    place.write("run", "a file");
    all_are_refused(&place, &["error: run: ", "is not a run"]);
}

#[test]
fn a_run_without_draws_is_refused() {
    let place = Place::new();
    // Stopped in the warm-up, whose draws have no numbers.
    let stopped = place.ends("sample ball.toml --out run --warmup 1000000 --max-time 0s", 1);
    stopped.says(&[
        "still in the warm-up, and no iteration has satisfied the constraint yet; continue with: plaus resume run",
    ]);
    assert!(stopped.out.starts_with("out of time after 0 of 1,000,900 iterations"), "{}", stopped.out);
    all_are_refused(&place, &["error: run: ", "holds no draws yet", "in its warm-up", "`plaus resume run`"]);
    place.ends("replay run --sample 0:17", 2).says(&["holds no draws yet", "`plaus resume` continues it"]);
}

#[test]
fn a_damaged_run_is_refused_and_salvaged() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    let path = place.path("run/chain-00001.records");
    let mut records = std::fs::read(&path).unwrap();
    let last = records.len() - 40;
    records[last] ^= 1;
    std::fs::write(&path, &records).unwrap();
    all_are_refused(&place, &["run/chain-00001.records: at byte ", "checksum", "--salvage"]);
    for (way, out) in WAYS {
        place.ok(&format!("{way} --out {out} --salvage"));
        assert!(!bytes(&place, out).is_empty(), "{way}");
    }
    std::fs::write(place.path("run/manifest.json"), "{").unwrap();
    let way = |(way, out): &(&str, &str)| place.ends(&format!("{way} --out new-{out}"), 2).says(&["run/manifest.json"]);
    WAYS.iter().for_each(way);
    assert!(!WAYS.iter().any(|(_, out)| place.path(&format!("new-{out}")).exists()));
}

#[test]
fn samples_that_do_not_exist_are_refused() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    for format in ["glb", "usda", "poses", "events"] {
        for (sample, says) in [
            ("0:900", "there is no draw 0:900: the draws of each chain are 0 to 899"),
            ("4:0", "there is no chain 4: the chains are 0 to 3"),
            ("0:0 --sample 0:900", "there is no draw 0:900"),
        ] {
            let file = format!("out.{}", if ["glb", "usda"].contains(&format) { format } else { "csv" });
            let file = if sample.contains(' ') && file != "out.csv" { "out" } else { &file };
            place.ends(&format!("export run --format {format} --sample {sample} --out {file}"), 2).says(&[says]);
        }
        place.ends(&format!("export run --format {format} --sample 0 --out out"), 2).says(&["CHAIN:DRAW"]);
    }
    assert_eq!(place.names(), ["ball.toml", "run"], "nothing is left behind");
}

/// A run that continues until it is dropped.
struct Going(Child);

impl Drop for Going {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_run_that_is_being_written_is_read_as_of_its_last_checkpoint() {
    let place = Place::new();
    let mut command =
        place.command("sample ball.toml --out run -q --warmup 0 --iterations 1000000000 --thin 1000 --threads 1");
    let going = Going(command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap());
    // Checkpoints are written every second: wait for one with enough draws in it.
    let enough = (0..600).any(|_| {
        std::thread::sleep(Duration::from_millis(100));
        place.run("export run --format events --sample 1:7 --out -").code == Some(0)
    });
    assert!(enough, "no checkpoint within a minute");
    for (way, out) in WAYS {
        place.ok(&format!("{way} --out {out}")).says(&["the run is still being written", "its last checkpoint"]);
        assert!(!bytes(&place, out).is_empty(), "{way}");
    }
    drop(going);
    // Killed at any byte, it is read as before, and nothing says that it is still being written.
    let ended = place.ok("export run --format glb --sample 1:7 --out after.glb");
    assert!(!ended.err.contains("being written"), "{}", ended.err);
    assert_eq!(bytes(&place, "after.glb")[0].1, bytes(&place, "a.glb")[0].1, "the same sample, the same bytes");
}
