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
        place.ok(&format!("sample ball.toml --out some{threads} --solutions 25 --threads {threads} -q"));
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
    place.ok("sample ball.toml --out run --warmup 0 --solutions 15 -q");
    assert_eq!(distinct("run"), 15);
    place.ends("resume run --solutions 14", 2).says(&["15 distinct solutions are already asked for"]);
    place.ok("resume run --solutions 25 -q");
    place.ok("sample ball.toml --out direct --warmup 0 --solutions 25 -q");
    assert_eq!(distinct("run"), 25);
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
    // Files of many chains are waited for together.
    let many = "sample ball.toml --chains 80 --set checkpoint_every=20 --iterations 300 -q --out";
    place.run(&format!("{many} short --max-time 1ms"));
    place.run("resume short -q --max-time 100ms");
    place.ok("resume short -q");
    place.ok(&format!("{many} long"));
    assert_eq!(place.bytes("short"), place.bytes("long"));
    let found = place.ends("sample ball.toml --out few --max-time 1ms --solutions 100000", 1);
    // Whether it had found one by then is a matter of time.
    found.says(&["; continue with: plaus resume few"]);
}

/// Blocks so long that none ends before the run is stopped, except the short ones at the beginning of a run.
#[test]
fn a_run_is_stopped_in_the_middle_of_a_block() {
    let place = Place::new();
    let endless = "sample ball.toml --set checkpoint_every=1000000000 --chains 3 --warmup 0 --iterations 1000000000 -q";
    let end_of = |run: &str| {
        // Nothing is said of a run in which no block has ended.
        let json = place.run(&format!("diagnose {run} --json")).out;
        serde_json::from_str::<serde_json::Value>(&json).map_or(0, |facts| facts["iterations"].as_u64().unwrap())
    };
    let long = format!("{endless} --out long");
    let child = start(&place, &long);
    pause(300);
    signal(&child, "-INT");
    let ended = Ended::of(child.wait_with_output().unwrap(), &long);
    assert_eq!(ended.code, Some(130), "{}", ended.err);
    place.ok(&format!("{endless} --out short --max-time 100ms"));
    // On a busy machine, the first block may take longer.
    for run in ["long", "short"] {
        for _ in 0..100 {
            if end_of(run) > 0 {
                break;
            }
            place.ok(&format!("resume {run} -q --max-time 200ms"));
        }
    }
    // Both are cut at ends of blocks. Continued from there, they meet.
    let (long, short) = (end_of("long"), end_of("short"));
    assert!(long > 0 && short > 0);
    place.ok("resume short -q --max-time 200ms");
    let (a, b) = (place.bytes("long"), place.bytes("short"));
    let (a, b) = (&a["chain-00002.records"], &b["chain-00002.records"]);
    let common = a.len().min(b.len());
    assert!(common > 1000 && a[..common] == b[..common]);
}

/// A tower of blocks, whose simulation takes the longer the more there are and the longer it lasts.
fn tower(blocks: u32, seconds: f64) -> String {
    format!(
        "[sampler]\nchains = 2\nwarmup = 0\niterations = 6\ncheckpoint_every = 1\nmethod = 'chain'\n\
         [world.custom]\nduration_s = {seconds}\n[[world.custom.fixed]]\nname = 'floor'\nshape = {{ plane = {{}} }}\n\
         [[world.custom.bodies]]\nname = 'block'\ncount = {blocks}\nshape = {{ box = {{ size_mm = [60, 60, 30] }} }}\n\
         at_mm = ['normal(0, 12)', 'normal(0, 3)', '15 + 30.2 * i']\nturn_deg = [0, 0, 'normal(0, 5)']\n\
         [[require]]\ninside = {{ body = 'block_{blocks}', x_mm = [-1000, -60], how = 'at_end', scale_mm = 30 }}\n"
    )
}

/// An interrupt does not wait for a simulation to end. These would take minutes: in a trial, when chains start, and in
/// an estimate of chance.
#[test]
fn an_interrupt_ends_a_simulation_that_runs() {
    let place = Place::new();
    place.write("tower.toml", tower(60, 20.0));
    for (arguments, told) in [
        (
            "sample tower.toml --out tried --set method=auto",
            "interrupted while choosing how to sample; continue with: plaus resume tried",
        ),
        ("sample tower.toml --out run --solutions 3", "interrupted before all chains had started"),
        ("chance tower.toml", ""),
    ] {
        let mut child = start(&place, arguments);
        pause(1500);
        assert!(child.try_wait().unwrap().is_none(), "plaus {arguments} has ended already");
        signal(&child, "-INT");
        // It takes some milliseconds; other programs may keep the processor busy.
        let ended = (0..300).any(|_| {
            pause(50);
            child.try_wait().unwrap().is_some()
        });
        if !ended {
            child.kill().unwrap();
        }
        let ended = ended.then(|| Ended::of(child.wait_with_output().unwrap(), arguments));
        let Some(ended) = ended else { panic!("plaus {arguments} went on") };
        assert_eq!(ended.code, Some(130), "plaus {arguments}: {}", ended.err);
        ended.says(&[told]);
    }
}

/// Wherever an interrupt cuts simulations off, the run continues as if there had been none: in the trial of methods,
/// or in chains.
#[test]
fn interrupted_simulations_leave_no_trace() {
    let place = Place::new();
    place.write("tower.toml", tower(5, 0.4));
    for method in ["auto", "chain"] {
        let sample = format!("sample tower.toml -q --set sampler.method={method} --out");
        let whole = place.run(&format!("{sample} whole-{method}"));
        assert!(matches!(whole.code, Some(0 | 1)), "{}", whole.err);
        for milliseconds in [40, 90, 150, 260, 420] {
            let run = format!("{method}-{milliseconds}");
            let child = start(&place, &format!("{sample} {run}"));
            pause(milliseconds);
            signal(&child, "-INT");
            child.wait_with_output().unwrap();
            if place.path(&run).exists() {
                place.run(&format!("resume {run} -q"));
                let whole = place.bytes(&format!("whole-{method}"));
                assert_eq!(place.bytes(&run), whole, "{method}, interrupted after {milliseconds} ms");
            }
        }
    }
}

/// A run whose time is over before it is decided how to sample continues as if it had had enough.
#[test]
fn a_trial_that_is_out_of_time_is_repeated() {
    let place = Place::new();
    place.write("tower.toml", tower(5, 0.4));
    let sample = "sample tower.toml --set sampler.method=auto --out";
    let cut = place.ends(&format!("{sample} cut --max-time 1ms"), 1);
    cut.says(&["out of time while choosing how to sample; continue with: plaus resume cut"]);
    let again = place.ends("resume cut --max-time 1ms", 1);
    again.says(&["out of time while choosing how to sample; continue with: plaus resume cut"]);
    let whole = place.run(&format!("{sample} whole -q --max-time 1h"));
    assert!(matches!(whole.code, Some(0 | 1)), "{}", whole.err);
    place.run("resume cut -q");
    let bytes = place.bytes("whole");
    assert_eq!(place.bytes("cut"), bytes);
    // What there is already is not given up for it.
    let forced = place.ends(&format!("{sample} whole --force --max-time 1ms"), 1);
    forced.says(&["out of time while choosing how to sample; the run that it was to replace is as it was"]);
    assert_eq!(place.bytes("whole"), bytes);
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
