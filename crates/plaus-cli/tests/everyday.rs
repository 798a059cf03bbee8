//! The everyday commands: try, plot, replacing what was made before.

use crate::common::Place;
use std::fs;
use std::time::Duration;

/// A ball that is thrown at a box without walls on three sides.
const THROW: &str = "[world.custom]\nduration_s = 2\n\
    [[world.custom.materials]]\nname = \"felt\"\nfriction = 0.5\nrolling = 0.05\n\
    [[world.custom.fixed]]\nname = \"table\"\nmaterial = \"felt\"\nshape = { box = { size_mm = [2000, 2000, 20] } }\nat_mm = [0, 0, -10]\n\
    [[world.custom.bodies]]\nname = \"ball\"\nmaterial = \"felt\"\nshape = { ball = { radius_mm = 20 } }\nat_mm = [0, 0, 20]\n\
    velocity_m_s = [\"normal(0.5, 0.1)\", \"normal(0, 0.1)\", 0]\n\
    [[require]]\nrests_at = { body = \"ball\", x_mm = 200, y_mm = 0, within_mm = 150 }\n";

#[test]
fn a_try_takes_the_place_of_the_one_before_and_of_nothing_else() {
    let place = Place::new();
    place.write("throw.toml", THROW);
    place.ok("try throw.toml --no-open --seed 3").says(&[" different solutions in ", "throw-try/index.html"]);
    let first = fs::read(place.path("throw-try/run/manifest.json")).unwrap();
    place.ok("try throw.toml --no-open --seed 4 --solutions 3").says(&["seed 4", "until there are 3 solutions"]);
    assert!(first != fs::read(place.path("throw-try/run/manifest.json")).unwrap());
    let page = fs::read_to_string(place.path("throw-try/index.html")).unwrap();
    assert!(page.starts_with("<!doctype html>") || page.starts_with("<!DOCTYPE html>"), "{}", &page[..40]);
    // A scenario that is wrong leaves the last try as it was.
    place.write("throw.toml", THROW.replace("radius_mm = 20", "radius_mm = -20"));
    place.ends("try throw.toml --no-open", 2).says(&["radius_mm"]);
    assert!(place.path("throw-try/run/manifest.json").exists());
    // One that finds nothing too; its own run is beside it, to look at.
    let before = place.bytes("throw-try/run");
    place.write("throw.toml", THROW.replace("x_mm = 200", "x_mm = 1900").replace("normal(0.5, 0.1)", "0.5"));
    let failed = place.ends("try throw.toml --no-open --max-time 1s", 1);
    failed.says(&["--sample", "throw-try/failed", "throw-try still shows the last try that found something"]);
    assert_eq!(place.bytes("throw-try/run"), before);
    place.ok("plot throw-try").says(&["of "]);
    place.write("throw.toml", THROW);
    place.ok("try throw.toml --no-open --seed 4 --solutions 3");
    assert!(!place.path("throw-try/failed").exists());
    fs::write(place.path("throw-try/notes.txt"), "mine").unwrap();
    place.ends("try throw.toml --no-open", 2).says(&["holds notes.txt", "--out"]);
    fs::create_dir_all(place.path("other/run")).unwrap();
    fs::write(place.path("other/run/mine.txt"), "mine").unwrap();
    place.ends("try throw.toml --no-open --out other", 2).says(&["something other than a run"]);
    assert_eq!(fs::read_to_string(place.path("other/run/mine.txt")).unwrap(), "mine");
    fs::create_dir_all(place.path("third/failed")).unwrap();
    fs::write(place.path("third/failed/mine.txt"), "mine").unwrap();
    place.ends("try throw.toml --no-open --out third", 2).says(&["something other than a run"]);
    assert_eq!(fs::read_to_string(place.path("third/failed/mine.txt")).unwrap(), "mine");
}

/// A change of the file is seen, and the page tells open ones that they are old; the limit only ends a test that fails.
#[test]
fn a_watched_scenario_is_tried_again_when_it_changes() {
    let place = Place::new();
    place.write("throw.toml", THROW);
    let mut child = place.command("try throw.toml --no-open --watch").spawn().unwrap();
    let seed = || {
        let manifest = fs::read_to_string(place.path("throw-try/run/manifest.json")).ok()?;
        place.path("throw-try/index.html").exists().then_some(())?;
        serde_json::from_str::<serde_json::Value>(&manifest).ok()?["run"]["plan"]["seed"].as_u64()
    };
    // When the page was made, as the file beside it says; it is written last.
    let made = || fs::read_to_string(place.path("throw-try/made.js")).ok().filter(|made| made.ends_with(";\n"));
    let mut wait_for = |wanted: u64, before: Option<&String>| {
        for _ in 0..1200 {
            let is_there = seed() == Some(wanted) && made().is_some() && made().as_ref() != before;
            if is_there || child.try_wait().unwrap().is_some() {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        let page = fs::read_to_string(place.path("throw-try/index.html")).unwrap();
        let made = made().unwrap();
        let number = made.trim_start_matches("window.made = ").trim_end_matches(";\n").to_owned();
        (seed(), made, page.contains(&format!("window.made > {number})")))
    };
    let (first, earlier, is_told) = wait_for(1, None);
    assert!(first == Some(1) && is_told, "{earlier}");
    place.write("throw.toml", format!("[sampler]\nseed = 9\n{THROW}"));
    let (second, later, is_told) = wait_for(9, Some(&earlier));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(second == Some(9) && is_told && later > earlier, "{later}");
}

#[test]
fn a_run_is_replaced_when_asked_to() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    let before = place.bytes("run");
    place.ends("sample ball.toml --out run -q --seed 8", 2).says(&["already exists"]);
    assert_eq!(place.bytes("run"), before);
    place.ok("sample ball.toml --out run -q --seed 8 --force");
    place.ok("sample ball.toml --out fresh -q --seed 8");
    assert_eq!(place.bytes("run"), place.bytes("fresh"), "as if nothing had been there");
    fs::create_dir(place.path("mine")).unwrap();
    place.ends("sample ball.toml --out mine -q --force", 2).says(&["something other than a run"]);
    assert!(place.names().iter().all(|name| !name.starts_with('.')), "{:?}", place.names());
}

#[test]
fn plots_hold_every_solution() {
    let place = Place::new();
    place.write("throw.toml", THROW);
    place.ok("sample throw.toml --out run -q --iterations 200 --set method=independent");
    let plan = place.ok("plot run").out;
    assert!(plan.contains("across: x from ") && plan.contains('@'), "{plan}");
    let bars = place.ok("plot run --of ball.end_x").out;
    assert!(bars.starts_with("ball.end_x (mm)\n") && bars.contains('█'), "{bars}");
    let shares = bars
        .lines()
        .filter_map(|line| line.split(" ± ").next()?.rsplit_once(' ')?.1.strip_suffix('%')?.parse::<f64>().ok());
    // Each of at most 24 shares is rounded to a tenth of a percent.
    assert!((shares.sum::<f64>() - 100.0).abs() <= 1.2, "{bars}");
    place.ok("plot run --out plots/plan.svg").says(&["wrote plots/plan.svg"]);
    let svg = fs::read_to_string(place.path("plots/plan.svg")).unwrap();
    assert!(svg.contains("<polygon") && svg.contains("<circle") && !svg.contains("NaN"));
    place.ends("plot run --out plots/plan.svg", 2).says(&["--force"]);
    place.ok("plot run --of ball.vx.law --out plots/plan.svg --force");
    place.ends("plot run --of ball.endx", 2).says(&["did you mean ball.end_x?"]);
    place.ends("plot run --out plan.png", 2).says(&["plan.svg"]);
}

#[test]
fn formats_follow_from_endings_and_folders_are_made() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    for file in ["new/all.csv", "new/all.zarr"] {
        place.ok(&format!("export run --out {file}"));
    }
    for file in ["new/a.glb", "new/a.usda", "new/deeper/a.wav"] {
        place.ok(&format!("export run --sample 0:3 --out {file}"));
        assert!(place.path(file).exists(), "{file}");
    }
    place.ends("export run --sample 0:3 --out a.csv", 2).says(&["--format poses or --format events"]);
    place.ends("export run --sample 0:3 --out a", 2).says(&["which format?", "--format glb"]);
    place.ends("export run --out a.glb", 2).says(&["an animation of which samples?"]);
}

/// Bodies called as prims that every file has.
#[test]
fn prims_are_unique_whatever_bodies_are_called() {
    let place = Place::new();
    place.write("throw.toml", THROW.replace("\"ball\"", "\"physics\"").replace("\"table\"", "\"Looks\""));
    place.ok("sample throw.toml --out run -q --solutions 1");
    let distinct = place.ok("export run --format usda --all-distinct --into a.usda");
    distinct.says(&["wrote a.usda"]);
    let text = fs::read_to_string(place.path("a.usda")).unwrap();
    let mut prims: Vec<&str> = text.lines().filter(|line| line.starts_with("    def ")).collect();
    assert!(prims.len() >= 4, "{prims:?}");
    let name = |line: &&str| line.rsplit_once(' ').map(|(_, name)| name.to_owned());
    prims.sort_by_key(name);
    assert!(prims.windows(2).all(|two| name(&two[0]) != name(&two[1])), "{prims:?}");
}
