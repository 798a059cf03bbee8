//! Animations and galleries as the program writes them.

use crate::common::Place;

fn sampled() -> Place {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    place
}

#[test]
fn every_format_is_written_and_nothing_is_overwritten_unasked() {
    let place = sampled();
    for (format, file) in
        [("glb", "a.glb"), ("usda", "a.usda"), ("poses", "p.csv"), ("events", "e.csv"), ("events", "e.json")]
    {
        let export = format!("export run --format {format} --sample 1:17 --out {file}");
        place.ok(&export);
        let bytes = std::fs::read(place.path(file)).unwrap();
        place.ends(&export, 2).says(&[file, "--force"]);
        place.ok(&format!("{export} --force"));
        assert_eq!(std::fs::read(place.path(file)).unwrap(), bytes, "{file} made again");
        place.write(file, "somebody else's");
        place.ends(&format!("{export} --force"), 2).says(&["was not made by such an export"]);
    }
    let sidecar = std::fs::read_to_string(place.path("a.glb.import")).unwrap();
    assert!(sidecar.contains("animation/fps=60") && sidecar.contains("\"optimizer/enabled\": false"), "{sidecar}");
    place.ok("gallery run --out g.html --count 9").says(&["9 of ", "distinct solutions"]);
    place.ends("gallery run --out g.html", 2).says(&["--force"]);
    place.ok("gallery run --out g.html --force --count 3");
}

#[test]
fn events_are_the_impacts_of_the_replay() {
    let place = sampled();
    place.ok("export run --format events --sample 2:5 --out e.json");
    let read = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    let events = read(&std::fs::read_to_string(place.path("e.json")).unwrap());
    let replay = read(&place.ok("replay run --sample 2:5 --format json").out);
    let events = events["impacts"][0]["impacts"].as_array().unwrap();
    assert_eq!(events.len(), 5);
    for (event, hit) in events.iter().zip(replay["impacts"].as_array().unwrap()) {
        assert_eq!((&event["t"], &event["point"]), (&hit["time"], &hit["point"]));
        assert_eq!(event["pair"], serde_json::json!(["ball_0", "table"]));
        assert!(event["speed"].as_f64().unwrap() > 0.0);
    }
    let table = place.ok("export run --format events --sample 2:5 --sample 0:3 --out -").out;
    assert_eq!(table.lines().count(), 1 + 2 * 5);
    assert!(table.starts_with("chain,draw,t,body,other,x,y,z,nx,ny,nz,speed,impulse\n2,5,"));
}

#[test]
fn all_distinct_solutions_make_a_folder() {
    let place = sampled();
    place.ok("export run --format glb --all-distinct --out all --time-range 0.1:0.6 --fps 30");
    let files = place.bytes("all");
    let index: serde_json::Value = serde_json::from_slice(&files["plaus-export.json"]).unwrap();
    let animations = index["animations"].as_array().unwrap();
    assert!(animations.len() > 5, "{}", animations.len());
    assert_eq!(files.len(), 1 + 2 * animations.len(), "a GLB and a sidecar each, and the list");
    for animation in animations {
        assert!(files[animation["file"].as_str().unwrap()].starts_with(b"glTF"));
        assert_eq!(animation["facts"]["satisfied"], true);
        let range = animation["facts"]["time_range"].as_array().unwrap();
        assert_eq!(range[0], 0.1);
        // Some animations end before that.
        assert!((0.1..=0.6).contains(&range[1].as_f64().unwrap()));
    }
    place.ends("export run --format glb --all-distinct --out all", 2).says(&["--force"]);
    place.ok("export run --format glb --all-distinct --out all --force");
    std::fs::create_dir(place.path("mine")).unwrap();
    place
        .ends("export run --format usda --all-distinct --out mine --force", 2)
        .says(&["was not made by such an export"]);
}

#[test]
fn wrong_requests_are_refused() {
    let place = sampled();
    for (arguments, says) in [
        ("export run --format glb --out a.glb", "--sample CHAIN:DRAW, --all-distinct, or --confirmed"),
        ("export run --format csv --sample 0:0 --out a.csv", "csv and zarr hold all draws"),
        ("export run --format glb --sample 0:900 --out a.glb", "there is no draw 900"),
        ("export run --format usda --sample 9:0 --out a.usda", "there is no chain 9"),
        ("export run --format glb --sample 0:0 --out -", "animations are files"),
        ("export run --format glb --sample 0:0 --out a.glb --fps 0", "--fps 0"),
        ("export run --format glb --sample 0:0 --out a.glb --time-range 90:91", "--time-range 90:91"),
        ("export run --format glb --sample 0:0 --out a.glb --time-range x", "FROM:TO"),
        ("gallery nowhere --out g.html", "no such run"),
    ] {
        place.ends(arguments, 2).says(&[says]);
    }
    assert_eq!(place.names(), ["ball.toml", "run"], "nothing is left behind");
    place.ends("sample ball.toml --out hopeless -q --set target=1e5 --set sigma_d=1e6", 1);
    for arguments in ["gallery hopeless --out g.html", "export hopeless --format glb --all-distinct --out all"] {
        place.ends(arguments, 2).says(&["no sample of the run satisfies the constraint"]);
    }
}
