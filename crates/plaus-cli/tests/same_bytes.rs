//! A run's folder has the same bytes whatever the number of threads, and however often the process was killed or
//! interrupted.

use crate::common::{Ended, Place};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Long enough to be killed in the middle.
const LONG: &str = if cfg!(debug_assertions) {
    "sample ball.toml --chains 3 --set checkpoint_every=2000 --iterations 120000"
} else {
    "sample ball.toml --chains 3 --set checkpoint_every=2000 --iterations 1200000"
};

fn start(place: &Place, arguments: &str) -> Child {
    place.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

fn pause(milliseconds: u64) {
    std::thread::sleep(Duration::from_millis(milliseconds));
}

#[test]
fn threads_leave_no_trace() {
    let place = Place::new();
    for threads in [1, 2, 4] {
        place.ok(&format!("sample ball.toml --out all{threads} --threads {threads} -q"));
        place.ok(&format!("sample ball.toml --out some{threads} --solutions 60 --threads {threads} -q"));
    }
    for threads in [2, 4] {
        assert_eq!(place.bytes(&format!("all{threads}")), place.bytes("all1"));
        assert_eq!(place.bytes(&format!("some{threads}")), place.bytes("some1"));
    }
    assert_ne!(place.bytes("some1")["chain-00000.records"], place.bytes("all1")["chain-00000.records"]);
}

#[test]
fn a_run_stops_at_the_wanted_solution_and_looks_for_more_when_asked() {
    let place = Place::new();
    let distinct = |run: &str| {
        let json = place.run(&format!("diagnose {run} --json")).out;
        serde_json::from_str::<serde_json::Value>(&json).unwrap()["distinct"].as_u64().unwrap()
    };
    // What is found in the warm-up is not there to be diagnosed.
    place.ok("sample ball.toml --out run --warmup 0 --solutions 40 -q");
    assert_eq!(distinct("run"), 40);
    place.ends("resume run --solutions 39", 2).says(&["40 distinct solutions are already asked for"]);
    place.ok("resume run --solutions 60 -q");
    place.ok("sample ball.toml --out direct --warmup 0 --solutions 60 -q");
    assert_eq!(distinct("run"), 60);
    for run in ["run", "direct"] {
        place.ok(&format!("export {run} --format csv --out {run}.csv"));
    }
    assert_eq!(std::fs::read(place.path("run.csv")).unwrap(), std::fs::read(place.path("direct.csv")).unwrap());
    let short = place.ends("sample ball.toml --out short --solutions 100000", 1);
    short.says(&["of the 100000 distinct solutions were found; continue with: plaus resume short --iterations 9000"]);
}

#[test]
fn a_run_killed_at_any_moment_continues_to_the_same_bytes() {
    let place = Place::new();
    place.ok(&format!("{LONG} -q --out whole"));
    let whole = place.bytes("whole");
    let mut in_the_middle = 0;
    for (index, moments) in [[40, 300], [110, 60], [270, 170], [380, 20]].iter().enumerate() {
        let run = format!("run{index}");
        let mut child = start(&place, &format!("{LONG} -q --out {run} --threads {}", 1 + index % 2));
        for &moment in moments {
            pause(moment);
            child.kill().unwrap();
            in_the_middle += i32::from(child.wait().unwrap().code().is_none());
            if !place.path(&run).exists() {
                break; // killed before there was a run
            }
            child = start(&place, &format!("resume {run} -q"));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        if place.path(&run).exists() {
            place.ok(&format!("resume {run} -q"));
        } else {
            place.ok(&format!("{LONG} -q --out {run}"));
        }
        assert!(place.bytes(&run) == whole, "{run}");
    }
    assert!(in_the_middle >= 3, "only {in_the_middle} processes were killed while they worked");
}

#[test]
fn an_interrupted_run_says_how_to_continue_and_continues() {
    let place = Place::new();
    place.ok(&format!("{LONG} -q --out whole"));
    let long = format!("{LONG} --out run");
    let child = start(&place, &long);
    while !place.path("run/chain-00002.records").exists() {
        pause(5);
    }
    signal(&child, "-INT");
    let ended = Ended::of(child.wait_with_output().unwrap(), &long);
    assert_eq!(ended.code, Some(130), "{}", ended.err);
    ended.says(&["seed 7", "interrupted after iteration ", "with a checkpoint; continue with: plaus resume run"]);
    assert_ne!(place.bytes("run"), place.bytes("whole"));
    place.ok("resume run -q");
    assert!(place.bytes("run") == place.bytes("whole"));
}

/// `nohup` makes a program ignore the end of its terminal; SIGTERM still interrupts it.
#[cfg(target_os = "linux")]
#[test]
fn a_run_started_by_nohup_outlives_its_terminal() {
    let place = Place::new();
    let endless = "sample ball.toml --iterations 100000000 -q --out run";
    let script = format!("trap '' HUP; exec {} {endless}", env!("CARGO_BIN_EXE_plaus"));
    let mut shell = Command::new("sh");
    shell.args(["-c", &script]).current_dir(place.path(""));
    let mut child = shell.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while !place.path("run/chain-00003.records").exists() {
        pause(5);
    }
    signal(&child, "-HUP");
    let length = || std::fs::metadata(place.path("run/chain-00003.records")).unwrap().len();
    let before = length();
    while length() == before && child.try_wait().unwrap().is_none() {
        pause(5);
    }
    pause(100);
    assert!(child.try_wait().unwrap().is_none(), "it works on");
    signal(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn a_run_out_of_time_can_be_resumed() {
    let place = Place::new();
    let ended = place.run("sample ball.toml --out run --max-time 1ms");
    assert!(matches!(ended.code, Some(0 | 1)), "it may not have come to a solution yet: {}", ended.err);
    assert!(ended.out.contains("out of time after ") && ended.out.contains(" of 1,000 iterations"), "{}", ended.out);
    assert!(ended.out.contains("plaus resume run\n"));
    place.ok("resume run -q");
    place.ok("sample ball.toml --out whole -q");
    assert_eq!(place.bytes("run"), place.bytes("whole"));
    let found = place.ends("sample ball.toml --out few --max-time 1ms --solutions 100000", 1);
    // Whether it had found one by then is a matter of time.
    found.says(&["; continue with: plaus resume few\n"]);
}

/// Blocks so long that none ends before the run is stopped, except the short ones at the beginning of a run.
#[test]
fn a_run_is_stopped_in_the_middle_of_a_block() {
    let place = Place::new();
    let endless = "sample ball.toml --set checkpoint_every=1000000000 --chains 3 --warmup 0 --iterations 1000000000 -q";
    let end_of = |run: &str| {
        let json = place.run(&format!("diagnose {run} --json")).out;
        serde_json::from_str::<serde_json::Value>(&json).unwrap()["iterations"].as_u64().unwrap()
    };
    let long = format!("{endless} --out long");
    let child = start(&place, &long);
    pause(300);
    signal(&child, "-INT");
    let ended = Ended::of(child.wait_with_output().unwrap(), &long);
    assert_eq!(ended.code, Some(130), "{}", ended.err);
    place.ok(&format!("{endless} --out short --max-time 100ms"));
    // Both are cut at ends of blocks. Continued from there, they meet.
    let (long, short) = (end_of("long"), end_of("short"));
    assert!(long > 0 && short > 0);
    place.ok("resume short -q --max-time 200ms");
    let (a, b) = (place.bytes("long"), place.bytes("short"));
    let (a, b) = (&a["chain-00002.records"], &b["chain-00002.records"]);
    let common = a.len().min(b.len());
    assert!(common > 1000 && a[..common] == b[..common]);
}

#[test]
fn only_one_process_writes_a_run() {
    let place = Place::new();
    let mut child = start(&place, "sample ball.toml --iterations 100000000 --out run");
    while !place.path("run/chain-00003.records").exists() {
        pause(5);
    }
    place.ends("resume run", 2).says(&["run: another process is writing this run"]);
    child.kill().unwrap();
    child.wait().unwrap();
}
