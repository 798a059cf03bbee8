//! The output of the commands.

use crate::common::{Ended, Place};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

fn rows(place: &Place, file: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(place.path(file)).unwrap();
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// The number after `"key":`, read by the standard library, because a JSON parser may be off by a bit.
fn number(json: &str, key: &str) -> f64 {
    let start = json.find(&format!("\"{key}\":")).unwrap() + key.len() + 3;
    let end = json[start..].find([',', '}']).unwrap();
    json[start..start + end].parse().unwrap()
}

#[test]
fn the_table_has_a_row_per_chain_and_draw() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    place.ok("export run --format csv --out d.csv");
    let rows = rows(&place, "d.csv");
    assert_eq!(rows[0].join(","), "chain,draw,log_p,satisfied,rest_x,theta_1,theta_2,theta_3,theta_4,theta_5");
    assert_eq!(rows.len(), 1 + 4 * 900);
    for (index, row) in rows[1..].iter().enumerate() {
        assert_eq!(row[..2], [(index / 900).to_string(), (index % 900).to_string()]);
        let numbers: Vec<f64> = row[4..].iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(row[3] == "true", (numbers[0] - 1.0).abs() <= 0.1, "rest_x in D, near the target: {row:?}");
        // log p is quadratic in degrees over their σ, and in D over σ_d, up to a constant.
        let squares = |numbers: &[f64], sigma: f64| numbers.iter().map(|x| x * x).sum::<f64>() / (sigma * sigma);
        let energy = 0.5 * (squares(&numbers[1..], 10.0) + squares(&[numbers[0] - 1.0], 0.1));
        let first: Vec<f64> = rows[1][4..].iter().map(|cell| cell.parse().unwrap()).collect();
        let first_energy = 0.5 * (squares(&first[1..], 10.0) + squares(&[first[0] - 1.0], 0.1));
        let log_p = |row: &[String]| row[2].parse::<f64>().unwrap();
        assert!((log_p(row) + energy - log_p(&rows[1]) - first_energy).abs() < 1e-9, "{row:?}");
    }
    let printed = place.ok("export run --format csv --out -").out;
    assert_eq!(printed.as_bytes(), std::fs::read(place.path("d.csv")).unwrap());
}

#[test]
fn a_replay_is_the_stored_draw_bit_for_bit() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    place.ok("export run --format csv --out d.csv");
    let rows = rows(&place, "d.csv");
    for (chain, draw) in [(0, 0), (1, 17), (3, 899)] {
        let json = place.ok(&format!("replay run --sample {chain}:{draw} --format json")).out;
        let row = &rows[1 + chain * 900 + draw];
        for (name, cell) in
            rows[0].iter().zip(row).filter(|(name, _)| !["chain", "draw", "satisfied"].contains(&&***name))
        {
            assert_eq!(number(&json, name).to_bits(), cell.parse::<f64>().unwrap().to_bits(), "{name}");
        }
        let read: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(read["satisfied"].to_string(), row[3]);
        let last = read["poses"].as_array().unwrap().last().unwrap()["x"].as_f64().unwrap();
        let rest_x = read["scalars"]["rest_x"].as_f64().unwrap();
        assert!((last - 0.1 * rest_x).abs() < 1e-12, "the ball, 0.1 m wide, rests at {last} m, not {rest_x} D");
        let table = place.ok(&format!("replay run --sample {chain}:{draw}"));
        assert!(table.out.starts_with("t,body,x,y,z,qx,qy,qz,qw,impact,origin_x,origin_y,origin_z\n0.0,"));
        table.says(&["rebuilt bit for bit"]);
    }
}

#[test]
fn keys_can_be_set_on_the_command_line() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q --set sigma_d=0.05 --set collisions=3 --seed 9 --chains 2 --thin 10");
    place.ok("export run --format csv --out d.csv");
    let rows = rows(&place, "d.csv");
    assert_eq!(rows[0].join(","), "chain,draw,log_p,satisfied,rest_x,theta_1,theta_2,theta_3");
    assert_eq!(rows.len(), 1 + 2 * 90);
    let manifest = std::fs::read_to_string(place.path("run/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(manifest["run"]["plan"]["seed"], 9);
    assert_eq!(manifest["run"]["overrides"][0], "sigma_d=0.05");
    assert_eq!(manifest["run"]["scenario"]["text"], crate::common::SCENARIO);
    let effective = manifest["run"]["scenario"]["effective"].as_str().unwrap();
    assert!(effective.contains("sigma_d = 0.05\n") && effective.contains("collisions = 3\n"), "{effective}");
    let checked = place.ok("check ball.toml --set sigma_d=0.25");
    assert!(checked.out.contains("sigma_d = 0.25\n"));
}

#[test]
fn json_lines_go_to_stdout_and_the_seed_is_always_reported() {
    let place = Place::new();
    let ended = place.ok("sample ball.toml --out run --json");
    let lines: Vec<Value> = ended.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (first, last) = (&lines[0], &lines[lines.len() - 1]);
    assert_eq!((&first["event"], &first["seed"]), (&"begin".into(), &7.into()));
    assert_eq!((&last["event"], &last["ending"]), (&"end".into(), &"complete".into()));
    assert_eq!((&last["iterations"], &last["recorded_draws"]), (&900.into(), &900.into()));
    assert_eq!(ended.err, "");
    place.ok("sample ball.toml --out other").says(&["seed 7, 4 chains of 900 iterations"]);
    assert_eq!(place.ok("sample ball.toml --out quiet -q").err, "seed 7\n");
    let diagnosis = place.run("diagnose run --json").out;
    assert_eq!(serde_json::from_str::<Value>(&diagnosis).unwrap()["distinct"], last["distinct"]);
}

#[test]
fn progress_without_a_terminal_is_lines() {
    let place = Place::new();
    let arguments = "sample ball.toml --iterations 100000000 --chains 2 --threads 2 --max-time 1.5s --out run";
    let ended = place.ok(&format!("{arguments} -v"));
    ended.says(&[" found", "\niteration ", "\nhits ", "  chain 1\n", "  accepted:\n", "    perturb "]);
    // Time ends this run: most of it is over after a second, when the first line comes.
    let share = ended.err.lines().find_map(|line| line.split_once('%')?.0.parse::<u32>().ok());
    assert!(share.is_some_and(|share| share >= 50), "{}", ended.err);
    // Nobody can tell so soon how long it will take.
    assert!(!ended.err.contains(" left\n"), "{}", ended.err);
    assert!(!ended.err.contains('\x1b') && !ended.err.contains("  0 /s"), "{}", ended.err);
    let json = place.ok(&format!("{arguments}2 --json")).out;
    let progress: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let progress = progress.iter().find(|line| line["event"] == "progress").unwrap();
    assert!(progress["eta_seconds"].is_null() && progress["end"].as_u64() > Some(100_000_000));
    let endless = place.run("sample ball.toml --solutions 1000000 --max-time 1.5s --json --out endless").out;
    let endless: Vec<Value> = endless.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(endless.iter().any(|line| line["event"] == "progress" && line["end"].is_null()), "{endless:?}");
    assert!(progress["iterations_per_second"].as_f64().unwrap() > 0.0);
    assert!(progress["chains"][1]["acceptance"]["perturb"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_reader_that_stops_reading_is_no_error() {
    let place = Place::new();
    place.ok("sample ball.toml --out run --iterations 20000 -q");
    let commands = ["export run --format csv --out -", "replay run --sample 0:0 --fps 100000", "schema", "explain"];
    for command in commands.into_iter().chain(["sample ball.toml --out other --json"]) {
        let mut child = place.command(command).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::with_capacity(8, child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let ended = Ended::of(child.wait_with_output().unwrap(), command);
        assert_eq!(ended.code, Some(0), "{command}: {}", ended.err);
        assert!(!ended.err.contains("error"), "{command}: {}", ended.err);
    }
    place.ok("sample ball.toml --out whole -q");
    assert_eq!(place.bytes("other"), place.bytes("whole"));
}

#[test]
fn a_run_without_a_solution_ends_with_1() {
    let place = Place::new();
    let never = "--set target=1e5 --set sigma_d=1e6";
    let said = place.ends(&format!("sample ball.toml --out run {never}"), 1);
    // What to do comes once, after the table of what was not met.
    said.says(&["no sample satisfies the constraint: ask for less", "--draws", "plaus resume run --iterations 9000"]);
    assert!(said.err.find("nearest, if none") < said.err.find("ask for less"), "{}", said.err);
    for word in ["plaus resume", "R-hat"] {
        assert!(!said.out.contains(word), "{}", said.out);
    }
    let found = place.ends("diagnose run", 1).out;
    assert!(found.contains("no iteration satisfied the constraint"), "{found}");
}

#[test]
fn resuming_a_finished_run_says_so_and_how_to_go_on() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    place.ok("sample ball.toml --out few --solutions 3 -q");
    for (run, longer) in [("run", "--iterations 9000"), ("few", "--solutions 6")] {
        let said = place.ok(&format!("resume {run}")).out;
        assert!(said.starts_with("this run was finished already: "), "{said}");
        assert!(said.contains(&format!("plaus resume {run} {longer}\n")) && said.lines().count() <= 3, "{said}");
    }
    // Statistics need draws after the warm-up.
    place.ends("diagnose few", 2).says(&["plaus resume few --solutions all"]);
    let all = place.run("resume few --solutions all").out;
    assert!(all.starts_with("done: ") && all.contains("ESS bulk"), "{all}");
    let more = place.ok("resume run --iterations 9000").out;
    assert!(more.starts_with("done: "), "{more}");
}

#[test]
fn a_world_where_nothing_is_uncertain_is_told_so() {
    let place = Place::new();
    let world = |law: &str| {
        format!(
            "[sampler]\nchains = 2\nwarmup = 0\niterations = 20\n[world.custom]\n\
             fixed = [{{ name = \"floor\", shape = {{ plane = {{}} }} }}]\n\
             bodies = [{{ name = \"ball\", shape = {{ ball = {{ radius_mm = 20.0 }} }}, at_mm = [{law}, 0.0, 300.0] }}]\n"
        )
    };
    place.write("sure.toml", world("1.0"));
    place.write("unsure.toml", world("{ normal = [0.0, 9.0] }"));
    place.ok("check sure.toml").says(&["nothing is uncertain: every draw is the same animation"]);
    let same = "every draw is the same animation: nothing in this world is uncertain";
    assert!(place.ok("sample sure.toml --out sure").out.contains(same));
    assert!(!place.ok("check unsure.toml").err.contains("nothing is uncertain"));
    assert!(!place.ok("sample unsure.toml --out unsure").out.contains(same));
}

#[test]
fn a_new_scenario_is_valid_and_its_keys_are_explained() {
    let place = Place::new();
    place.ok("new ball2d new.toml").says(&["next: plaus try new.toml"]);
    assert_eq!(place.ok("new ball2d").out, std::fs::read_to_string(place.path("new.toml")).unwrap());
    place.ok("check new.toml").says(&["new.toml is valid"]);
    place.ends("new bal2d", 2).says(&["there is no scene `bal2d`; did you mean `ball2d`? known: ball2d"]);
    let keys = place.ok("explain").out;
    assert!(keys.contains("\n  words: chain, iteration, "), "{keys}");
    // The command's own tests ask for every key.
    for key in keys.lines().filter(|line| !line.starts_with(' ') && !line.is_empty()).step_by(50) {
        assert!(place.ok(&format!("explain {key}")).out.starts_with(key));
    }
    place.ends("explain sigmad", 2).says(&["did you mean `world.ball2d.sigma_d`?"]);
    serde_json::from_str::<Value>(&place.ok("schema").out).unwrap();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        assert!(place.ok(&format!("completions {shell}")).out.contains("max-time"), "{shell}");
    }
    assert!(place.ok("--version").out.starts_with("plaus "));
    assert!(place.ok("--help").out.contains("Exit codes: 0 done"));
    place.ends("", 2);
}

#[test]
fn times_that_are_asked_for_are_plotted_beside_those_found() {
    let place = Place::new();
    let asks = "[[require]]\nimpact = { when = { at_s = 0.3, within_ms = 60 } }\n\
                [[require]]\nrests = { when = { to_s = 5.0 } }\n";
    place.write("timed.toml", format!("{}{asks}", crate::common::SCENARIO));
    for (scenario, plotted) in [("timed", true), ("ball", false)] {
        place.ok(&format!("sample {scenario}.toml --out {scenario} -q"));
        let said = place.run(&format!("diagnose {scenario} --plots {scenario}-plots"));
        assert!(said.err.contains("plots"), "{}", said.err);
        let picture = std::fs::read_to_string(place.path(&format!("{scenario}-plots/times.svg")));
        assert_eq!(picture.is_ok(), plotted, "{scenario}");
        // A window without a beginning has no time to be shown.
        let Ok(picture) = picture else { continue };
        assert!(picture.contains("require[0].impact") && !picture.contains("require[1].rests"), "{picture}");
        assert!(picture.matches("<circle").count() > 3 && !picture.contains("NaN"), "{picture}");
    }
}
