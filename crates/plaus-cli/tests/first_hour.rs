//! What a newcomer stumbled over in the first hour with the program. Each message comes where the mistake is made, and
//! helps.

use crate::common::Place;
use std::time::{Duration, Instant};

#[test]
fn keys_in_lists_and_keys_of_one_name_are_explained() {
    let place = Place::new();
    let said = place.ok("explain constraints[0].rest_at").out;
    assert!(said.starts_with("world.dice.constraints[].rest_at\n"), "{said}");
    place.ends("explain ln_lambda", 2).says(&[
        "several keys are called `ln_lambda`; choose one:",
        "plaus explain world.spelling.ln_lambda",
        "plaus explain world.bowling.ln_lambda",
    ]);
    for word in ["chain", "distinct", "R-hat"] {
        let meaning = place.ok(&format!("explain {word}")).out;
        assert!(meaning.starts_with(&format!("{word}: ")), "{meaning}");
    }
}

#[test]
fn places_in_lists_can_be_set() {
    let place = Place::new();
    place.ok("new dice dice.toml");
    let moved = place.ok("check dice.toml --set constraints[0].rest_at.x_mm=20").out;
    assert!(moved.contains("x_mm = 20.0"), "{moved}");
    place.ends("check dice.toml --set constraints[9].rest_at.x_mm=20", 2).says(&["the list has no such entry"]);
    place
        .ends("check dice.toml --set rounding_mm=100", 2)
        .says(&["100 mm is too much", "less than half the shortest edge"]);
}

#[test]
#[allow(clippy::disallowed_methods, reason = "the clock is what is tested")]
fn threads_that_have_nothing_to_do_are_not_started() {
    let place = Place::new();
    let begun = Instant::now();
    place.ok("sample ball.toml --out run --threads 1000000").says(&["of 1,000,000 threads, because"]);
    // A million threads took minutes to start; this is a run of a second.
    assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", begun.elapsed());
}

#[test]
fn a_search_for_solutions_reports_solutions() {
    let place = Place::new();
    let asked = place.ok("sample ball.toml --out few --solutions 3");
    for statistics in ["R-hat", "ESS", "not to be trusted"] {
        assert!(!asked.out.contains(statistics), "{}", asked.out);
    }
    assert!(asked.out.contains("distinct solutions (different in kind: `plaus explain distinct`)"), "{}", asked.out);
    // They were found in the warm-up, and are shown nevertheless.
    assert!(asked.out.contains("all found in the warm-up, which statistics leave out"), "{}", asked.out);
    assert!(asked.out.contains("plaus gallery few"), "{}", asked.out);
    place.ends("diagnose few", 2).says(&["which statistics leave out"]);
    let more = place.ok("sample ball.toml --out more --solutions 120");
    assert!(more.out.contains("plaus diagnose more"), "{}", more.out);
    assert!(place.ok("sample ball.toml --out many").out.contains("R-hat"));
}

#[test]
fn long_tables_are_cut() {
    let place = Place::new();
    let said = place.ok("sample ball.toml --out run --set collisions=40").out;
    assert!(said.contains("more: plaus diagnose run"), "{said}");
    assert!(said.lines().filter(|line| line.starts_with("  theta_")).count() <= 16, "{said}");
    assert!(said.contains("  rest_x"), "outcomes come before random variables: {said}");
}

#[test]
fn a_run_that_records_nothing_says_why() {
    let place = Place::new();
    let said = place.ends("sample ball.toml --out run --thin 1000000", 1);
    assert!(
        said.out.contains("nothing was recorded after the warm-up: one in 1,000,000 iterations is"),
        "{}",
        said.out
    );
    assert!(!said.out.contains("still in the warm-up") && !said.err.contains("still in the warm-up"), "{}", said.err);
    place.ends("diagnose run", 2).says(&["(`thin`)"]);
}

#[test]
fn a_missing_checkpoint_is_named_and_the_records_are_saved() {
    let place = Place::new();
    place.ok("sample ball.toml --out run");
    std::fs::remove_file(place.path("run/chain-00002.checkpoint")).unwrap();
    for command in ["diagnose run", "resume run", "export run --format csv --out no.csv"] {
        place.ends(command, 2).says(&["chain-00002.checkpoint: this checkpoint is gone", "plaus export --salvage"]);
    }
    place
        .ok("export run --format csv --out d.csv --salvage")
        .says(&["salvaged the first 1,000 of 1,000 iterations of each chain; no damage in the records", "wrote d.csv"]);
}

#[test]
fn misspelt_names_get_a_hint() {
    let place = Place::new();
    place.ends("new bowl", 2).says(&["there is no scene `bowl`; did you mean `bowling`?"]);
    place.ends("sample ball.toml --ouput run", 2).says(&["'--output'"]);
    place.ok("sample ball.toml --output run");
    place.ends("export run --format glb --sample 0:0 --out x.gltf", 2).says(&["x.gltf", "did you mean x.glb?"]);
    place.ends("export run --format usda --sample 0:0 --out x.glb", 2).says(&["x.glb", "did you mean x.usda?"]);
    place.ok("export run --format glb --sample 0:0 --out x.glb").says(&["wrote x.glb"]);
    let table = place.ok("export run --format csv --out -");
    assert!(table.err.is_empty(), "{}", table.err);
}

/// What a requirement can be told is listed, with what each key holds.
#[test]
fn the_keys_of_a_requirement_are_explained() {
    let place = Place::new();
    for name in ["inside", "require[].inside", "require[0].inside"] {
        let said = place.ok(&format!("explain {name}")).out;
        assert!(said.starts_with("require[].inside\n"), "{said}");
        for key in ["\nbody (a string, may be left out): ", "\nradius_mm (a number, from ", "\nwhen ("] {
            assert!(said.contains(key), "{key}: {said}");
        }
    }
    for word in ["prior", "move", "outcome", "scalar", "barrier"] {
        assert!(place.ok(&format!("explain {word}")).out.starts_with(&format!("{word}: ")));
    }
}

/// Someone who replays a solution learns how to take it elsewhere, by a command that works as it is printed.
#[test]
fn a_replay_names_the_export_that_others_can_open() {
    let place = Place::new();
    place.ok("sample ball.toml --out run --solutions 3 -q");
    let id = place.ok("export run --format events --all-distinct --out -").out;
    let id = id.lines().nth(1).unwrap().splitn(3, ',').take(2).collect::<Vec<_>>().join(":");
    let said = place.ok(&format!("replay run --sample {id}")).err;
    let command = said.lines().find_map(|line| line.split_once("browsers: plaus ")).unwrap().1;
    place.ok(command).says(&["wrote sample-", ".glb"]);
}
