//! Jobs that compute a chance in pieces. Merged, the pieces give the file that one machine makes, whatever the names of
//! files and folders.

use crate::common::{Ended, Place, SCENARIO};
use std::path::PathBuf;
use std::process::Command;

/// A folder and a file whose names are special in shells and templates.
const JOB: &str = "it's a \"job\" $HOME %j {shard}.json";
const FILE: &str = "ball's \"2d\".toml";
/// A requirement that few draws meet, and a small amount of work.
const ASKING: [&str; 8] = [
    "--set=target=4",
    "--set=tolerance=0.05",
    "--seed=5",
    "--batches=6",
    "--draws=50",
    "--particles=20",
    "--steps=5",
    "--rungs=4",
];

fn plaus(place: &Place, words: &[&str]) -> Ended {
    Ended::of(place.command("").args(words).output().unwrap(), &words.join(" "))
}

/// A place with a file to compare with, and a job for the engine. Returns the job's folder.
fn job(place: &Place, engine: &str) -> PathBuf {
    place.write(FILE, SCENARIO);
    let asking = [&ASKING[..], &["--iterations=100"]].concat();
    let whole = plaus(place, &[&["chance", FILE, "--out", "whole.json", "-q"], &asking[..]].concat());
    assert!(whole.code < Some(2) && whole.out.contains("stones"), "{}{}", whole.out, whole.err);
    let submit = ["submit", "--chance", FILE, "--to", engine, "--shards", "3", "--out", JOB];
    let written = plaus(place, &[&submit[..], &asking[..]].concat());
    assert_eq!(written.code, Some(0), "{}", written.err);
    place.path(JOB)
}

fn is_the_whole(place: &Place) {
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert!(read(&format!("{JOB}/chance.json")) == read("whole.json"));
}

fn status(place: &Place) -> serde_json::Value {
    serde_json::from_str(&plaus(place, &["status", JOB, "--json"]).out).unwrap()
}

#[test]
fn a_chance_is_computed_in_pieces_on_this_machine() {
    let place = Place::new();
    job(&place, "local");
    let before = plaus(&place, &["status", JOB]);
    assert!(before.out.contains("3 pieces: 3 waiting  0.0% of the batches"), "{}", before.out);
    let ran = plaus(&place, &["submit", "--again", JOB, "--go"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    ran.says(&["done: plaus chance"]);
    is_the_whole(&place);
    let after = status(&place);
    assert_eq!(after["summary"]["standings"]["done"], 3);
    assert_eq!(after["pieces"][2]["batches"], serde_json::json!([8, 8]));
    plaus(&place, &["submit", "--again", JOB, "--go"]).says(&["this job is done"]);
}

#[test]
fn scripts_for_a_chance_run_as_they_are() {
    let place = Place::new();
    let job = job(&place, "slurm");
    for task in ["1", "2", "3"] {
        let mut shell = Command::new("sh");
        shell.arg(job.join("submit/pieces.sh")).env("SLURM_ARRAY_TASK_ID", task).env_remove("HQ_TASK_ID");
        assert!(shell.current_dir("/").status().unwrap().success());
    }
    assert!(Command::new("sh").arg(job.join("submit/merge.sh")).current_dir("/").status().unwrap().success());
    is_the_whole(&place);
}

/// Pieces whose process died, pieces that failed and pieces that wait are told apart, and all are continued.
#[test]
fn a_job_continues_where_it_stopped() {
    let place = Place::new();
    let job = job(&place, "local");
    let words = std::fs::read_to_string(job.join("job.json")).unwrap();
    assert!(words.contains("--batches=6") && words.contains("--iterations=100"), "{words}");
    let out = job.join("pieces/2.json");
    let out = out.to_str().unwrap();
    let asking = [&ASKING[..], &["--iterations=100", "--threads=1", "-q"]].concat();
    let begin = ["chance", FILE, "--shard", "2/3", "--out", out];
    let piece = |more: &[&str]| plaus(&place, &[&begin[..], &asking[..], more].concat());
    piece(&[]);
    // Changed by hand.
    let text = std::fs::read_to_string(out).unwrap();
    let mut file: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(file["chance"]["split"].as_object().unwrap().len(), 2);
    let merge = ["merge", &format!("{JOB}/pieces"), "--out", "none.json"].map(str::to_owned);
    let merge = merge.each_ref().map(String::as_str);
    plaus(&place, &merge).says(&["piece 1/3 is missing"]);
    file["chance"]["split"] = serde_json::json!({});
    std::fs::write(out, file.to_string()).unwrap();
    let failed = status(&place);
    assert_eq!(failed["summary"]["standings"]["failed"], 1, "a file that was changed is no piece: {failed}");
    assert!(failed["pieces"][1]["why"].as_str().unwrap().contains("checksum"), "{failed}");
    std::fs::remove_file(out).unwrap();
    // Out of time, then on a disk that refuses writes.
    assert_eq!(piece(&["--max-time", "0s"]).code, Some(1));
    assert_eq!(status(&place)["summary"]["standings"]["stopped"], 1);
    std::fs::create_dir(out).unwrap();
    assert_eq!(piece(&[]).code, Some(2));
    let failed = status(&place);
    assert_eq!(failed["pieces"][1]["standing"], "failed");
    std::fs::remove_dir(out).unwrap();
    let ran = plaus(&place, &["submit", "--again", JOB, "--go"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    is_the_whole(&place);
}

#[test]
fn the_piece_that_differs_from_most_is_named() {
    let place = Place::new();
    for (piece, seed) in [(1, 8), (2, 7), (3, 7)] {
        let asked = format!("--batches 3 --draws 20 --seed {seed} --shard {piece}/3 --out {piece}.json");
        place.ok(&format!("chance ball.toml --method counting {asked}"));
    }
    let said = place.ends("merge 1.json 2.json 3.json --out all.json", 2).err;
    assert!(said.contains("1.json: does not belong to the other pieces: it has another seed"), "{said}");
}

#[test]
fn one_file_has_one_writer() {
    let place = Place::new();
    let lock = std::fs::File::create(place.path(".a.json.lock")).unwrap();
    lock.lock().unwrap();
    place.ends("chance ball.toml --out a.json", 2).says(&["a.json: another process is writing"]);
    drop(lock);
    place.ok("chance ball.toml --method counting --batches 2 --draws 200 --out a.json --set tolerance=1");
}

#[test]
fn requests_that_make_no_job_of_a_chance_are_refused() {
    let place = Place::new();
    let submit = "submit ball.toml --to slurm --out job";
    place.ends(&format!("{submit} --shards 2 --batches 4"), 2).says(&["--batches=4 can only be used with --chance"]);
    place.ends(&format!("{submit} --shards 2 --chance --chains 4"), 2).says(&["--chains is for a run"]);
    place.ends(&format!("{submit} --shards 5 --chance --batches 4"), 2).says(&["cannot be cut into 5 pieces"]);
    place.ends(&format!("{submit} --shards 2 --chance --method luck"), 2).says(&["counting, splitting, stones"]);
    assert_eq!(place.names(), ["ball.toml"]);
}
