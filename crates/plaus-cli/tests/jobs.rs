//! Jobs for engines: the files that engines are given run as written, whatever the names of files and folders.

use crate::common::{Ended, Place, SCENARIO};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// A folder and a file whose names contain everything that is special in shells, TOML, JSON and templates.
const JOB: &str = "it's a \"job\" $HOME $(date) `id` %j {shard} {{Param.Piece0}} \\n ;&|*?";
const FILE: &str = "ball's $(1) \"2d\" {shard} {{x}}.toml";

/// Runs `plaus` with these arguments.
fn plaus(place: &Place, words: &[&str]) -> Ended {
    let output: Output = place.command("").args(words).output().unwrap();
    Ended::of(output, &words.join(" "))
}

/// A place with a whole run to compare with, and a job for the engine. Returns the job's folder.
fn job(place: &Place, engine: &str, shards: &str) -> PathBuf {
    place.write(FILE, SCENARIO);
    let run = ["--set", "sigma_d=0.2", "--seed", "5"];
    let whole = plaus(place, &[&["sample", FILE, "--out", "whole", "-q"], &run[..]].concat());
    assert_eq!(whole.code, Some(0), "{}", whole.err);
    let written =
        plaus(place, &[&["submit", FILE, "--to", engine, "--shards", shards, "--out", JOB], &run[..]].concat());
    assert_eq!(written.code, Some(0), "{}", written.err);
    written.says(&["nothing has been submitted yet"]);
    place.path(JOB)
}

fn is_the_whole(place: &Place) {
    assert!(place.bytes(&format!("{JOB}/run")) == place.bytes("whole"));
    assert_eq!(place.names(), [FILE, "ball.toml", JOB, "whole"]);
}

fn run(words: &[String]) {
    let output = Command::new(&words[0]).args(&words[1..]).current_dir("/").output().unwrap();
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn scripts_of_slurm_run_as_they_are() {
    let place = Place::new();
    let job = job(&place, "slurm", "3");
    let script = |name: &str| job.join("submit").join(name);
    let text = std::fs::read_to_string(script("pieces.sh")).unwrap();
    assert!(
        text.contains("#SBATCH --array=1-3\n") && text.contains("/piece-\"$SLURM_ARRAY_TASK_ID\".txt 2>&1\n"),
        "{text}"
    );
    for task in ["1", "2", "3"] {
        let mut shell = Command::new("sh");
        shell.arg(script("pieces.sh")).env("SLURM_ARRAY_TASK_ID", task).env_remove("HQ_TASK_ID").current_dir("/");
        assert!(shell.status().unwrap().success());
    }
    assert!(std::fs::read_to_string(job.join("logs/piece-2.txt")).unwrap().contains("seed 5"));
    assert!(Command::new("sh").arg(script("merge.sh")).current_dir("/").status().unwrap().success());
    is_the_whole(&place);
}

/// The arguments that `sbatch` is given, from a stand-in that only writes them down.
#[test]
fn the_merge_is_submitted_as_depending_on_the_pieces() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    let job = job(&place, "slurm", "2");
    std::fs::create_dir(place.path("bin")).unwrap();
    let fake = "#!/bin/sh\nfor word in \"$@\"; do printf '%s\\n' \"$word\" >> \"$SAID\"; done\necho '4711;cluster'\n";
    place.write("bin/sbatch", fake);
    std::fs::set_permissions(place.path("bin/sbatch"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", place.path("bin").display(), std::env::var("PATH").unwrap());
    let mut command = place.command("submit --go --again");
    let output = command.arg(&job).env("PATH", path).env("SAID", place.path("said")).output().unwrap();
    assert_eq!(Ended::of(output, "submit").code, Some(0));
    let said = std::fs::read_to_string(place.path("said")).unwrap();
    let job = std::path::absolute(job).unwrap().display().to_string();
    let pieces = format!("--parsable\n{job}/submit/pieces.sh\n");
    let merge = format!("--parsable\n--dependency=afterok:4711\n{job}/submit/merge.sh\n");
    let expected = pieces + &merge;
    assert_eq!(said, expected);
}

#[test]
fn tasks_of_hyperqueue_run_as_they_are() {
    let place = Place::new();
    let job = job(&place, "hyperqueue", "3");
    let file: toml::Table = toml::from_str(&std::fs::read_to_string(job.join("submit/job.toml")).unwrap()).unwrap();
    let tasks = file["task"].as_array().unwrap();
    assert_eq!(tasks.len(), 4);
    assert_eq!(tasks[3]["deps"].as_array().unwrap().len(), 3, "the merge waits for all pieces");
    for task in tasks {
        let words = task["command"].as_array().unwrap().iter().map(|word| word.as_str().unwrap().to_owned());
        run(&words.collect::<Vec<_>>());
    }
    is_the_whole(&place);
}

#[test]
fn steps_of_a_template_run_as_they_are() {
    let place = Place::new();
    let job = job(&place, "openjd", "3");
    let template = std::fs::read_to_string(job.join("submit/template.json")).unwrap();
    let template: serde_json::Value = serde_json::from_str(&template).unwrap();
    let parameters = template["parameterDefinitions"].as_array().unwrap();
    let fill = |word: &str, piece: &str| {
        let named =
            |parameter: &&serde_json::Value| word == format!("{{{{Param.{}}}}}", parameter["name"].as_str().unwrap());
        let found = parameters.iter().find(named).map(|parameter| parameter["default"].as_str().unwrap().to_owned());
        found.unwrap_or_else(|| word.replace("{{Task.Param.Piece}}", piece))
    };
    let words = |step: usize, piece: &str| {
        let action = &template["steps"][step]["script"]["actions"]["onRun"];
        let words = std::iter::once(&action["command"]).chain(action["args"].as_array().unwrap());
        words.map(|word| fill(word.as_str().unwrap(), piece)).collect::<Vec<_>>()
    };
    assert_eq!(template["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0]["range"], "1-3");
    ["1", "2", "3"].iter().for_each(|piece| run(&words(0, piece)));
    run(&words(1, ""));
    is_the_whole(&place);
}

#[test]
fn a_job_runs_on_this_machine_and_its_status_is_shown() {
    let place = Place::new();
    let job = job(&place, "local", "3");
    let job = job.to_str().unwrap();
    let before = plaus(&place, &["status", job]);
    assert_eq!(before.code, Some(1));
    assert!(
        before.out.contains("3 pieces: 3 waiting") && before.out.contains("submit it: plaus submit --again '"),
        "{}",
        before.out
    );
    // A job is not a run, and a run not a job.
    plaus(&place, &["diagnose", job]).says(&["is a job that is not merged yet; its progress: plaus status "]);
    let merged = format!("{job}/run");
    plaus(&place, &["diagnose", &merged]).says(&["is not merged yet; the job's progress: plaus status "]);
    let ran = plaus(&place, &["submit", "--again", job, "--go"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    is_the_whole(&place);
    plaus(&place, &["diagnose", job]).says(&["is a job, not a run; its run is "]);
    plaus(&place, &["submit", "--again", &merged]).says(&["it is a run, which `plaus resume` continues"]);
    let after = plaus(&place, &["status", job, "--json"]);
    assert_eq!(after.code, Some(0));
    let after: serde_json::Value = serde_json::from_str(&after.out).unwrap();
    assert_eq!(after["summary"]["standings"]["done"], 3);
    assert_eq!(after["pieces"][2]["signal"]["iteration"], 1000);
    let again = plaus(&place, &["submit", "--again", job, "--go"]);
    assert_eq!(again.code, Some(0));
    again.says(&["this job is done"]);
}

/// Of many pieces that wait, only their number is told.
#[test]
fn pieces_that_wait_are_counted() {
    let place = Place::new();
    place.ok("submit ball.toml --chains 40 --to local --shards 40 --out job");
    let said = place.ends("status job", 1).out;
    assert!(said.contains("40 pieces not listed (`--all`)") && said.contains("40 pieces: 40 waiting"), "{said}");
    assert!(said.lines().count() < 6, "{said}");
    assert_eq!(place.ends("status job --all", 1).out.matches("  waiting\n").count(), 40);
}

/// A piece that is killed is started again from its checkpoint. A piece that fails says why, and can be continued.
#[test]
fn a_killed_piece_is_continued() {
    let place = Place::new();
    let long =
        ["--chains", "2", "--thin", "50", "--iterations", if cfg!(debug_assertions) { "150000" } else { "1500000" }];
    let start = |words: &[&str]| {
        let mut command = place.command("");
        command.args(words).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    plaus(&place, &[&["sample", "ball.toml", "--out", "whole", "-q"], &long[..]].concat());
    let job = ["submit", "ball.toml", "--to", "local", "--shards", "2", "--out", "job", "--go"];
    let running = start(&[&job[..], &long[..]].concat());
    let process = || -> Option<u64> {
        let signal = std::fs::read(place.path("job/pieces/2/progress.json")).ok()?;
        serde_json::from_slice::<serde_json::Value>(&signal).ok()?["process"].as_u64()
    };
    let process = loop {
        match process() {
            Some(process) => break process.to_string(),
            None => std::thread::sleep(Duration::from_millis(2)),
        }
    };
    assert!(Command::new("kill").args(["-KILL", &process]).status().unwrap().success());
    let ended = Ended::of(running.wait_with_output().unwrap(), "submit");
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    ended.says(&["piece 2 was killed", "it continues from its checkpoint"]);
    assert!(place.bytes("job/run") == place.bytes("whole"));
}

#[test]
fn requests_that_make_no_job_are_refused() {
    let place = Place::new();
    let submit = "submit ball.toml --to slurm";
    place
        .ends(&format!("{submit} --shards 5 --out job"), 2)
        .says(&["--shards 5: 4 chains cannot be cut into 5 pieces"]);
    place.ends(&format!("{submit} --shards 0 --out job"), 2).says(&["--shards"]);
    place.ends(&format!("{submit} --shards 2"), 2).says(&["--out <JOB>"]);
    place.ends("submit ball.toml --to pbs --shards 2 --out job", 2).says(&["slurm, hyperqueue, openjd, local"]);
    place.ends("submit --again nowhere", 2).says(&["nowhere: this is not a job"]);
    place.ends("submit nothing.toml --to slurm --shards 2 --out job", 2).says(&["nothing.toml: cannot read"]);
    place.ends(&format!("{submit} --shards 2 --out ball.toml"), 2).says(&["ball.toml: already exists"]);
    assert_eq!(place.names(), ["ball.toml"]);
    let replaced = place.ends("submit ball.toml --to hyperqueue --shards 2 --out %{TASK_ID}", 2);
    replaced.says(&["HyperQueue replaces `%{…}` in names"]);
    assert_eq!(place.names(), ["ball.toml"]);
    place.ok(&format!("{submit} --shards 2 --out job"));
    place.ends(&format!("{submit} --shards 2 --out job"), 2).says(&["job: already exists"]);
    let json = std::fs::read_to_string(place.path("job/job.json")).unwrap();
    place.write("job/job.json", json.replace("\"plaus\": \"0.1.0\"", "\"plaus\": \"0.0.9\""));
    place.ends("submit --again job", 2).says(&["job: made by plaus 0.0.9"]);
    place.write("job/job.json", "{");
    place.ends("submit --again job", 2).says(&["job/job.json: "]);
    place.ends("status nowhere", 2).says(&["nowhere"]);
}
