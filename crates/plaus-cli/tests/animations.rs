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
    for (format, file) in [
        ("glb", "a.glb"),
        ("usda", "a.usda"),
        ("poses", "p.csv"),
        ("events", "e.csv"),
        ("events", "e.json"),
        ("json", "m.json"),
        ("wav", "s.wav"),
    ] {
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
    assert!(sidecar.contains("animation/fps=3840") && sidecar.contains("\"optimizer/enabled\": false"), "{sidecar}");
    place.ok("gallery run --out g.html --count 9").says(&["9 of ", "distinct solutions"]);
    place.ends("gallery run --out g.html", 2).says(&["--force"]);
    place.ok("gallery run --out g.html --force --count 3");
    let page = std::fs::read(place.path("g.html")).unwrap();
    place.ok("gallery run --out g.html --force --count 3 --until 40ms");
    assert!(std::fs::read(place.path("g.html")).unwrap().len() < page.len(), "animations end early");
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
        assert!(event["speed"].as_f64().unwrap() > 0.0 && event["impulse"].as_f64().unwrap() > 0.0);
        assert_eq!(event["materials"], serde_json::json!(["glossy orange", "maple"]));
    }
    let table = place.ok("export run --format events --sample 2:5 --sample 0:3 --out -").out;
    assert_eq!(table.lines().count(), 1 + 2 * 5);
    assert!(table.starts_with("chain,draw,kind,t,end,body,other,body_material,other_material,x,"), "{table}");
    assert!(table.lines().nth(1).unwrap().starts_with("2,5,impact,"), "{table}");
    let fewer = place.ok("export run --format events --sample 2:5 --merge 60s --out -").out;
    assert_eq!(fewer.lines().count(), 2, "{fewer}");
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
fn all_distinct_solutions_go_into_one_file() {
    let place = sampled();
    let count = place.ok("export run --format poses --all-distinct --fps 1 --out -").out;
    let sample = |row: &str| row.splitn(3, ',').take(2).map(str::to_owned).collect::<Vec<_>>();
    let samples: std::collections::BTreeSet<_> = count.lines().skip(1).map(sample).collect();
    place.ok("export run --format glb --all-distinct --into all.glb");
    let glb = gltf_json(&std::fs::read(place.path("all.glb")).unwrap());
    let clips = glb["animations"].as_array().unwrap();
    assert_eq!(clips.len(), samples.len());
    assert!(clips[0]["name"].as_str().unwrap().starts_with("ball2d_"));
    let balls = glb["nodes"].as_array().unwrap().iter().filter(|node| node["name"] == "ball_0").count();
    assert_eq!(balls, 1, "one ball for all");
    place.ok("export run --format usda --all-distinct --into all.usda");
    let usda = std::fs::read_to_string(place.path("all.usda")).unwrap();
    assert_eq!(usda.matches("def Xform \"ball_0\"").count(), 1);
    assert_eq!(usda.matches("over \"ball_0\"").count(), samples.len());
}

/// Played without a library: at the end of its keys the body is where its table of poses says, with z up and in
/// centimetres.
#[test]
fn one_body_carries_its_motion_itself() {
    let place = sampled();
    place.ok("export run --format glb --sample 0:3 --root-motion ball_0 --up z --scale 100 --out a.glb");
    let bytes = std::fs::read(place.path("a.glb")).unwrap();
    let glb = gltf_json(&bytes);
    let number = |value: &serde_json::Value| value.as_u64().unwrap() as usize;
    let root = number(&glb["scenes"][0]["nodes"][0]);
    assert_eq!(glb["nodes"].as_array().unwrap().len(), 1);
    assert_eq!(glb["nodes"][root]["name"], "ball_0");
    let scale: Vec<f64> = serde_json::from_value(glb["nodes"][root]["scale"].clone()).unwrap();
    assert_eq!(scale, [100.0; 3]);
    let channels = glb["animations"][0]["channels"].as_array().unwrap();
    let places = channels.iter().find(|channel| channel["target"]["path"] == "translation").unwrap();
    assert_eq!(number(&places["target"]["node"]), root);
    let sampler = &glb["animations"][0]["samplers"][number(&places["sampler"])];
    let accessor = &glb["accessors"][number(&sampler["output"])];
    let view = &glb["bufferViews"][number(&accessor["bufferView"])];
    let start = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize + 8;
    let offset = |value: &serde_json::Value| value["byteOffset"].as_u64().unwrap_or(0) as usize;
    let last = start + offset(view) + offset(accessor) + 12 * (number(&accessor["count"]) - 1);
    let float = |k: usize| f32::from_le_bytes(bytes[last + 4 * k..][..4].try_into().unwrap());
    let rows = place.ok("export run --format poses --sample 0:3 --out -").out;
    let names: Vec<&str> = rows.lines().next().unwrap().split(',').collect();
    let row: Vec<&str> = rows.lines().last().unwrap().split(',').collect();
    let cell = |name: &str| -> f64 { row[names.iter().position(|n| *n == name).unwrap()].parse().unwrap() };
    // y up becomes z up by a quarter turn about x.
    for (found, metres) in [(float(0), cell("x")), (float(1), -cell("z")), (float(2), cell("y"))] {
        assert!((f64::from(found) - 100.0 * metres).abs() < 1e-4, "{found} cm, {metres} m"); // single precision
    }
}

/// The description in a GLB.
fn gltf_json(bytes: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[test]
fn clips_end_where_they_are_asked_to() {
    let place = sampled();
    let last = |until: &str| -> f64 {
        let rows = place.ok(&format!("export run --format poses --sample 0:3 --out - {until}")).out;
        rows.lines().last().unwrap().split(',').nth(2).unwrap().parse().unwrap()
    };
    let rest = last("");
    assert_eq!(last("--until rest"), rest);
    assert_eq!(last("--until 5s"), 5.0);
    assert_eq!(last("--until 100ms"), 0.1);
    assert!(rest > 0.1 && rest < 5.0);
}

/// Help, completions and the guide show the one table of formats.
#[test]
fn every_format_is_in_help_completions_and_guide() {
    let place = Place::new();
    let (help, completions) = (place.ok("export --help").out, place.ok("completions fish").out);
    let guide = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/engines.md")).unwrap();
    for format in plaus_export::format::ALL {
        let row = format.row();
        assert!(help.contains(row.name) && completions.contains(row.about), "{}", row.name);
        assert!(guide.contains(&format!("| `{}` |", row.name)), "docs/engines.md has no row of `{}`", row.name);
    }
}

#[test]
fn wrong_requests_are_refused() {
    let place = sampled();
    for (arguments, says) in [
        (
            "export run --format glb --out a.glb",
            "--sample CHAIN:DRAW, --all-distinct, --most-different N, or --confirmed",
        ),
        ("export run --format csv --sample 0:0 --out a.csv", "csv and zarr hold all draws"),
        ("export run --format glb --sample 0:900 --out a.glb", "there is no draw 0:900"),
        ("export run --format usda --sample 9:0 --out a.usda", "there is no chain 9"),
        ("export run --format glb --sample 0:0 --out -", "animations are written to files"),
        ("export run --format glb --sample 0:0 --out a.glb --fps 0", "--fps 0"),
        ("export run --format glb --sample 0:0 --out a.glb --time-range 90:91", "--time-range 90:91"),
        ("export run --format glb --sample 0:0 --out a.glb --time-range x", "FROM:TO"),
        ("export run --format glb --sample 0:0 --out a.gltf", "did you mean a.glb?"),
        ("export run --format events --sample 0:0 --out a.glb", "did you mean a.csv?"),
        ("export run --format gbl --sample 0:0 --out a.glb", "'glb'"),
        ("export run --format usda --sample 0:0 --out a.usda --keys exact", "--keys goes with glb, not with usda"),
        ("export run --format glb --sample 0:0 --out a.glb --until soon", "rest, decided, or a time"),
        ("export run --format glb --sample 0:0 --out a.glb --scale 0", "--scale 0"),
        ("export run --format glb --sample 0:0 --out a.glb --root-motion bal_0", "did you mean ball_0?"),
        ("export run --format usda --sample 0:0 --out a.usda --root-motion ball_0", "--root-motion goes with glb"),
        ("export run --format csv --into a.csv", "csv and zarr hold all draws"),
        ("gallery nowhere --out g.html", "no such run"),
    ] {
        place.ends(arguments, 2).says(&[says]);
    }
    let many = format!("export run --format glb --into a.glb{}", " --sample 0:0".repeat(2001));
    place.ends(&many, 2).says(&["2001 samples: one glb holds at most 2000"]);
    assert_eq!(place.names(), ["ball.toml", "run"], "nothing is left behind");
    place.ends("sample ball.toml --out hopeless -q --set target=1e5 --set sigma_d=1e6", 1);
    for arguments in ["gallery hopeless --out g.html", "export hopeless --format glb --all-distinct --out all"] {
        place.ends(arguments, 2).says(&["no sample of the run satisfies the constraint"]);
    }
}

/// A run goes on where another one stood at a time; once it has begun, it no longer needs the file.
#[test]
fn a_state_is_where_another_world_starts() {
    let place = sampled();
    place.ends("export run --format state --sample 1:17 --out s.json", 2).says(&["only a world of your own"]);
    let sampler = "[sampler]\nchains = 1\nwarmup = 0\niterations = 3\n";
    let ball = |start: &str| {
        format!(
            "{sampler}[world.custom]\nfixed = []\nduration_s = 1\n{start}[[world.custom.bodies]]\nname = 'ball'\n\
             shape = {{ ball = {{ radius_mm = 20 }} }}\n"
        )
    };
    place.write("one.toml", ball("") + "at_mm = [0, 0, 900]\nvelocity_m_s = [{ normal = [1, 1] }, 0, 2]\n");
    place.ok("sample one.toml --out one -q");
    place.ends("export one --format state --sample 0:1 --time-range 0:0.5 --out s.json", 2).says(&["--until"]);
    place.ok("export one --format state --sample 0:1 --until 0.5s --out s.json");
    place.ok("export one --format state --sample 0:1 --until 0.5s --out s.json --force");
    let read = |name: &str| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(place.path(name)).unwrap()).unwrap()
    };
    let state = read("s.json");
    let vx = state["bodies"][0]["velocity_m_s"][0].as_f64().unwrap();
    assert_eq!((&state["time_s"], &state["sample"]), (&0.5.into(), &"0:1".into()));
    assert_eq!(state["bodies"][0]["velocity_m_s"][2].as_f64().unwrap(), 2.0 - 9.806_65 * 0.5);
    place.write("two.toml", ball("start_from = { file = \"s.json\" }\n"));
    place.ok("check two.toml --draws 1");
    place.ok("sample two.toml --out two -q");
    std::fs::remove_file(place.path("s.json")).unwrap();
    place.ok("export two --format state --sample 0:0 --until 0.25s --out t.json");
    let x = read("t.json")["bodies"][0]["at_mm"][0].as_f64().unwrap();
    assert!((x - 750.0 * vx).abs() < 1e-9, "{x}, {vx}");
    place.ends("check two.toml", 2).says(&["two.toml", "start_from", "s.json"]);
}
