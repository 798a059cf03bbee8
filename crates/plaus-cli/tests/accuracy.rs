//! Samples simulated again at another accuracy: `--confirm`, `export --confirmed`, `replay --accuracy`.

use crate::common::Place;
use serde_json::Value;

/// Two balls for two bins: often full, and quick to simulate.
const WORD: &str = "[sampler]\nseed = 3\nchains = 2\nwarmup = 0\niterations = 400\ncheckpoint_every = 100\n\n\
    [world.spelling]\nbitmap = \"##\"\n";

fn place() -> Place {
    let place = Place::new();
    place.write("word.toml", WORD);
    place
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn solutions_are_compared_with_the_reference_and_none_is_lost() {
    let place = place();
    place.ok("sample word.toml --out plain -q");
    let ended = place.ok("sample word.toml --out run --json --confirm");
    let last = json(ended.out.lines().last().unwrap());
    let confirmed = &last["confirmed"];
    assert_eq!(confirmed["accuracy"], "reference");
    let (checked, held) = (confirmed["checked"].as_u64().unwrap(), confirmed["held"].as_u64().unwrap());
    // Two labelled balls fill two bins in two ways. At a third of a bin from the partitions, a tiny error changes
    // nothing.
    assert!(checked == 2 && (1..=2).contains(&held), "{confirmed}");

    let list = json(&String::from_utf8(std::fs::read(place.path("run/confirmed.json")).unwrap()).unwrap());
    let solutions = list["solutions"].as_array().unwrap();
    assert_eq!(solutions.len() as u64, checked);
    assert_eq!(solutions.iter().filter(|one| one["holds"] == true).count() as u64, held);

    // The rest of the run is the same as without confirming. An older run can be confirmed later, with the same list.
    let mut run = place.bytes("run");
    let made = run.remove("confirmed.json").unwrap();
    assert_eq!(run, place.bytes("plain"));
    let said = place.ok("resume plain --confirm --threads 1");
    said.says(&[&format!("at reference accuracy {held} of {checked} distinct solutions hold; plain/confirmed.json")]);
    assert_eq!(place.bytes("plain")["confirmed.json"], made);

    place.ok("export run --format poses --confirmed --out poses.csv");
    let poses = std::fs::read_to_string(place.path("poses.csv")).unwrap();
    let mut samples: Vec<&str> =
        poses.lines().skip(1).map(|line| &line[..line.match_indices(',').nth(1).unwrap().0]).collect();
    samples.dedup();
    assert_eq!(samples.len() as u64, held);
}

/// What an unfinished list knows is not simulated again, and the whole list is the same.
#[test]
fn confirming_goes_on_where_it_was_cut() {
    let place = place();
    place.ok("sample word.toml --out run --confirm -q");
    let made = place.bytes("run")["confirmed.json"].clone();
    let mut list = json(&String::from_utf8(made.clone()).unwrap());
    let cut = list["solutions"].as_array_mut().unwrap().pop().unwrap();
    list["left"] = 1.into();
    list["held"] = (list["held"].as_u64().unwrap() - u64::from(cut["holds"] == true)).into();
    place.write("run/confirmed.json", list.to_string());
    place.ok("resume run --confirm");
    assert_eq!(place.bytes("run")["confirmed.json"], made);

    // A wrong number in such a list stays, because that solution is known; of another version it does not.
    list["solutions"][0]["log_p_there"] = (-12.5).into();
    for (version, stays) in [("0.0.0", false), (env!("CARGO_PKG_VERSION"), true)] {
        list["plaus"] = version.into();
        place.write("run/confirmed.json", list.to_string());
        place.ok("resume run --confirm");
        let whole = json(&String::from_utf8(place.bytes("run")["confirmed.json"].clone()).unwrap());
        assert_eq!(whole["solutions"][0]["log_p_there"] == -12.5, stays, "{version}: {whole}");
        assert!(whole.get("left").is_none() && whole["solutions"].as_array().unwrap().len() == 2, "{whole}");
    }
}

/// Twenty blocks on each other take minutes at reference accuracy, but a fraction of a second at draft.
#[test]
fn confirming_ends_when_its_time_is_over() {
    let place = Place::new();
    let world = "[sampler]\nchains = 1\n[world.custom]\nduration_s = 1\naccuracy = \"draft\"\n\
        [[world.custom.fixed]]\nname = \"floor\"\nshape = { plane = {} }\n\
        [[world.custom.bodies]]\nname = \"block\"\ncount = 20\nshape = { box = { size_mm = [60, 60, 30] } }\n\
        at_mm = [\"normal(0, 12)\", \"normal(0, 3)\", \"15 + 30.2 * i\"]\nturn_deg = [0, 0, \"normal(0, 5)\"]\n\
        [[require]]\ninside = { body = \"block_20\", x_mm = [-3000, 3000], how = \"at_end\" }\n";
    place.write("heap.toml", world);
    let ended = place
        .ends("sample heap.toml --out run --solutions 8 --set method=chain --max-time 5s --threads 1 --confirm", 130);
    ended.says(&["out of time while confirming: ", "continue with: plaus resume run --confirm"]);
    let list = json(&String::from_utf8(place.bytes("run")["confirmed.json"].clone()).unwrap());
    assert!(list["left"].as_u64().unwrap() > 0, "{list}");
}

#[test]
fn a_sample_is_replayed_at_another_accuracy_beside_what_was_recorded() {
    let place = place();
    place.ok("sample word.toml --out run -q");
    let recorded = json(&place.ok("replay run --sample 0:399 --format json").out);
    assert!(recorded.get("accuracy").is_none() && recorded["duration"].as_f64().unwrap() > 0.0);
    for accuracy in ["draft", "reference"] {
        let other = place.ok(&format!("replay run --sample 0:399 --format json --accuracy {accuracy}"));
        other.says(&[&format!("sample 0:399 simulated at {accuracy} accuracy: log p "), "; as recorded: log p "]);
        let other = json(&other.out);
        assert_eq!(other["accuracy"], accuracy);
        assert_eq!(other["recorded_log_p"], recorded["log_p"]);
        assert_eq!(other["recorded_satisfied"], recorded["satisfied"]);
        assert_eq!(other["log_prior"], recorded["log_prior"]);
        // Lasting contact is divided into other steps.
        assert_ne!(other["tracks"], recorded["tracks"]);
    }
    // At the run's own accuracy nothing differs.
    let same = json(&place.ok("replay run --sample 0:399 --format json --accuracy standard").out);
    assert_eq!((&same["tracks"], &same["log_p"]), (&recorded["tracks"], &recorded["log_p"]));
}

#[test]
fn meaningless_requests_are_refused_before_anything_is_sampled() {
    let place = place();
    let closed = "ball2d moves in closed form, which is always exact: there is no accuracy to choose";
    place.ends("sample ball.toml --out run --confirm", 2).says(&[closed, "there is nothing to confirm"]);
    assert!(!place.path("run").exists());
    place.ok("sample ball.toml --out run -q");
    place.ends("resume run --confirm", 2).says(&[closed]);
    place.ends("replay run --sample 0:0 --accuracy fine", 2).says(&[closed]);
    place.ends("replay run --sample 0:0 --accuracy finest", 2).says(&["draft, standard, fine, reference"]);
    place.ok("sample word.toml --out word -q");
    let none = "confirmed.json: no solution has been confirmed yet; `plaus resume RUN --confirm` makes the list";
    place.ends("export word --format glb --confirmed --out here", 2).says(&[none]);
    place.write("word/confirmed.json", "{}");
    place
        .ends("export word --format glb --confirmed --out here", 2)
        .says(&["confirmed solutions cannot be used: missing field"]);
}
