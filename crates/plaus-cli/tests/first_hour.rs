//! What a newcomer stumbled over in the first hour with the program. Each message comes where the mistake is made, and
//! helps.

use crate::common::{Place, SCENARIO};
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
    // Requirements have keys too, beside those of a scene or alone.
    place
        .ends("explain within_mm", 2)
        .says(&["world.dice.constraints[].passes.within_mm", "plaus explain require[].passes"]);
    place.ends("explain every_s", 2).says(&["a key of requirements", "plaus explain require[].beats"]);
    assert!(place.ok("explain require[].passes").out.starts_with("require[].passes\n"));
    place.ends("new ball2d my.json", 2).says(&["another ending; `my.toml` would do"]);
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
    assert!(asked.out.contains("distinct solutions (clearly different: `plaus explain distinct`)"), "{}", asked.out);
    // They were found in the warm-up, and are shown nevertheless.
    assert!(asked.out.contains("all first met in the warm-up, which statistics leave out"), "{}", asked.out);
    assert!(asked.out.contains("plaus gallery few"), "{}", asked.out);
    place.ends("diagnose few", 2).says(&["which statistics leave out"]);
    let more = place.ok("sample ball.toml --out more --solutions 28");
    assert!(more.out.contains("plaus diagnose more"), "{}", more.out);
    assert!(place.ok("sample ball.toml --out many").out.contains("R-hat"));
}

/// The next commands write beside the run, by its name, and last as long; a shell completes the slash.
#[test]
fn what_comes_next_is_named_after_the_run() {
    let place = Place::new();
    let found = place.ok("sample ball.toml --out some/few/ --solutions 3 --max-time 60s");
    found.says(&["4 chains until there are 3 solutions, after "]);
    let out = &found.out;
    assert!(out.contains("plaus gallery some/few --out few.html\n") && out.contains(" --out some/few-2\n"), "{out}");
    assert!(!out.contains("sampler.iterations"), "{out}");
    place.ok("gallery some/few --out few.html");
    let more = place.ok("resume some/few --solutions 14").out;
    assert!(more.contains("plaus gallery some/few --out few.html --force\n"), "{more}");
    let stuck = place.ends("resume some/few --solutions 1000 --max-time 0s", 1).out;
    assert!(stuck.contains("out of time before the next checkpoint: still at iteration "), "{stuck}");
    let page = std::fs::read_to_string(place.path("few.html")).unwrap();
    assert!(page.contains("<title>ball2d · ball.toml · plaus</title>"));
    let none = place.ends("sample ball.toml --out none --set tolerance=1e-9 --solutions 3 --max-time 1s", 1).err;
    assert!(none.contains(" with: plaus resume none --max-time 1s"), "{none}");
    place.ends("sample bal.toml --out none", 2).says(&["did you mean `ball.toml`?"]);
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
    std::fs::remove_file(place.path("run/checkpoints")).unwrap();
    for command in ["diagnose run", "resume run", "export run --format csv --out no.csv"] {
        place.ends(command, 2).says(&["checkpoints: this file is gone", "plaus export --salvage"]);
    }
    place
        .ok("export run --format csv --out d.csv --salvage")
        .says(&["salvaged the first 1,000 of 1,000 iterations of each chain; no damage in the records", "wrote d.csv"]);
}

#[test]
fn misspelt_names_get_a_hint() {
    let place = Place::new();
    place.ends("new bowl", 2).says(&["there is no scene `bowl`; did you mean `bowling`?"]);
    place.ends("new", 2).says(&["name a scene: ball2d, bowling", "--from ASSET"]);
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

#[test]
fn a_scenario_that_was_edited_is_told_wherever_its_run_is_read() {
    let place = Place::new();
    place.ok("sample ball.toml --out run --solutions 3 -q");
    let commands = ["gallery run --out g.html", "export run --format events --all-distinct --out -", "resume run"];
    for command in commands {
        assert!(!place.ok(command).err.contains("not as it was"), "{command}");
    }
    place.write("ball.toml", format!("{SCENARIO}\n# edited\n"));
    for command in [&commands[1..], &["gallery run --out h.html", "replay run --sample 0:w0"]].concat() {
        place.ok(command).says(&["ball.toml has changed since this run began: the run uses its own copy"]);
    }
}

#[test]
fn names_that_would_mislead_are_refused() {
    let place = Place::new();
    place.ok("sample ball.toml --out run --solutions 3 -q");
    let all = "export run --format glb --all-distinct";
    for (command, says) in [
        ("gallery run --out x.png", "x.png: a gallery does not make .png; did you mean x.html?"),
        ("gallery run --out x", "a gallery makes a file that ends in .html or .htm; did you mean x.html?"),
        ("export run --format glb --sample 0:w0 --out x", "makes a file that ends in .glb; did you mean x.glb?"),
        ("export run --format events --sample 0:w0 --out x", "ends in .csv or .json; did you mean x.csv?"),
        ("export run --format csv --out x.html", "does not make .html; did you mean x.csv?"),
        (
            &format!("{all} --out th.glb"),
            "several samples make a folder, of one file each: `--out th`; all in one file: \
          `--into th.glb`",
        ),
    ] {
        place.ends(command, 2).says(&[says]);
    }
    assert_eq!(place.names(), ["ball.toml", "run"]);
    place.ok(&format!("{all} --into th.glb"));
    place.ok(&format!("{all} --out th"));
    place.ok("export run --most-different 1 --out one.glb");
    assert!(place.names().contains(&"one.glb".to_owned()));
}

/// The hint for more solutions says how far it looks, and what helps if there are no more; both commands work as they
/// are printed.
#[test]
fn more_solutions_are_promised_only_where_there_are_more() {
    let place = Place::new();
    let said = place.ok("sample ball.toml --out run --solutions 2 --set distinct_scale=3").out;
    let more = "plaus resume run --solutions 4   # looks for more, until iteration 1,000\n";
    assert!(said.contains(more) && said.contains("too alike"), "{said}");
    assert!(said.contains("   # w: found in the warm-up\n"), "{said}");
    let few = place.ends("resume run --solutions 60", 1).err;
    let again =
        few.lines().find_map(|line| line.split_once("To count smaller differences (`plaus explain distinct`): plaus"));
    let again = again.unwrap_or_else(|| panic!("{few}")).1;
    assert!(again.contains("--set distinct_scale=0.") && again.ends_with(" --solutions 60 --out run-2"), "{again}");
    place.ok(again);
    assert!(place.ok("explain solution").out.contains("0:w17 is draw 17 of its warm-up"));
}

/// A world in which a ball is thrown onto a floor that stops it.
const THROW: &str = "[[world.custom.materials]]\nname = 'rubber'\nrolling = 0.03\n[[world.custom.bodies]]\nname = 'ball'\n\
    shape = { ball = { radius_mm = 30 } }\nmaterial = 'rubber'\nat_mm = [0, 0, 500]\n\
    velocity_m_s = [{ normal = [1.0, 0.3] }, 0, 0]\n";

#[test]
fn a_place_that_nothing_comes_near_is_noted() {
    let place = Place::new();
    place
        .write("high.toml", format!("{THROW}[[require]]\nrests_at = {{ x_mm = 1000, z_mm = 900, within_mm = 100 }}\n"));
    let said = place.ok("check high.toml").err;
    let note = said.lines().find(|line| {
        line.starts_with("note: none of 200 random draws meets require[0].rests_at (the nearest: missed by 7")
    });
    assert!(note.is_some_and(|note| note.ends_with(" mm)")), "the ball rests 870 mm below, 100 are allowed: {said}");
    let table = place.ok("check high.toml --draws 100").out;
    assert!(table.starts_with("of 100 draws:") && table.contains(" mm\n") && !table.contains("nat"), "{table}");
    let missed = place.ends("sample high.toml --out run --iterations 20 --warmup 10", 1).err;
    assert!(missed.contains("missed by 7") && missed.contains(" mm\n"), "{missed}");
    // Nothing comes to rest where nothing resists rolling.
    place.write("ever.toml", std::fs::read_to_string(place.path("high.toml")).unwrap().replace("0.03", "0"));
    place.ok("check ever.toml").says(&["note: a requirement wants \"ball\" to come to rest", "it never happened\n"]);
    let counted = place.ok("check ever.toml --draws 20");
    counted.says(&["note: a requirement wants \"ball\" to come to rest, but once it rolls on \"floor\" it never does"]);
    let table = counted.out;
    let ends = "\nhow they ended: never came to rest; still moving after 10 s (ball): 100.0%\n";
    assert!(table.contains(ends), "{table}");
    let found = place.ends("sample ever.toml --out ever --iterations 20 --warmup 10", 1).err;
    assert!(found.contains("\nhow they ended") && found.contains("still moving after 10 s (ball)"), "{found}");
    // What rolls is stopped, but nothing stops it from spinning in place.
    place.write(
        "top.toml",
        std::fs::read_to_string(place.path("high.toml"))
            .unwrap()
            .replace("rolling", "spinning = 0\nrolling")
            .replace("at_mm", "spin_deg_s = [0, 0, 9000]\nat_mm"),
    );
    let table = place.ok("check top.toml --draws 20").out;
    assert!(
        table.contains("\nit never came to rest: ball spins on the spot for ever unless a material sets `rolling` or"),
        "{table}"
    );
}

#[test]
fn check_shows_what_a_file_says() {
    let place = Place::new();
    place.write("throw.toml", THROW);
    let checked = place.ok("check throw.toml --set sampler.chains=2");
    checked.says(&["throw.toml is valid; uncertain: ball.vx\n", "`--all` shows the defaults too"]);
    assert!(checked.out.contains("chains = 2\n") && !checked.out.contains("seed"), "{}", checked.out);
    assert!(checked.out.lines().count() < 25, "{}", checked.out);
    place.write("said.toml", &checked.out);
    let [all, said] =
        ["throw.toml --set sampler.chains=2", "said.toml"].map(|file| place.ok(&format!("check {file} --all")).out);
    assert!(all.contains("seed = 1\n") && all == said, "{said}");
}

#[test]
fn slips_in_a_world_get_the_hint_that_mends_them() {
    let place = Place::new();
    let ball = "[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\n";
    for (text, says, never) in [
        (ball.replace("radius_mm", "radius"), "did you mean `radius_mm`?", "missing"),
        (ball.replace("30", "'30 mm'"), "\"30 mm\": write 30 without a unit", "token"),
        (ball.replace("30", "{ uniform = [30, 20] }"), "uniform law: high is 20, but must be above low", "Wrapped"),
        (ball.replace("30", "{ normal = [30, -2] }"), "normal law: standard deviation is -2", "Gaussian"),
        (format!("{ball}[[require]]\nrest_at = {{ x_mm = 5 }}\n"), "did you mean `rests_at`?", "known:"),
        (format!("{ball}[[require]]\nrests_at = {{ x = 5 }}\n"), "did you mean `x_mm`?", "known in"),
        (format!("{ball}[require]\nrests_at = {{ x_mm = 5 }}\n"), "write [[require]] with two brackets", "holds all"),
        (format!("{ball}[sampler]\nthin = 'two'\n"), "expected an integer", "?"),
        (String::new(), "`plaus new custom FILE.toml` writes a file to begin with", "?"),
    ] {
        place.write("slip.toml", &text);
        let said = place.ends("check slip.toml", 2);
        said.says(&[says]);
        assert!(!said.err.contains(never), "{}", said.err);
    }
    let zero = "it must be a whole number, 1 or more";
    place.ends("check ball.toml --draws 0", 2).says(&[zero]);
    place.ends("sample ball.toml --solutions 0 --out run", 2).says(&[zero]);
    place.ends("resume ball.toml --solutions 0", 2).says(&[zero, "or `all`"]);
}

#[test]
fn a_new_world_asks_for_something_that_happens() {
    let place = Place::new();
    place.ok("new custom my.toml");
    let checked = place.ok("check my.toml");
    assert!(checked.out.contains("[require.rests_at]") && checked.out.contains("rolling = 0.03"), "{}", checked.out);
    let said = place.ok("sample my.toml --solutions 2 --out run").out;
    assert!(said.contains("2 distinct solutions"), "{said}");
}

#[test]
fn a_warm_up_longer_than_what_follows_is_noted() {
    let place = Place::new();
    let note = "longer than the 20 iterations asked for, and statistics leave it out. To shorten it: --warmup 20";
    place.run("sample ball.toml --iterations 20 --out run").says(&[note]);
    assert!(!place.run("sample ball.toml --iterations 20 --warmup 20 --out other").err.contains("--warmup"));
    let axes = place.ok("replay run --sample 0:0").err;
    assert!(axes.starts_with("t in seconds; x, y, z of each body's middle in metres, y up"), "{axes}");
}
