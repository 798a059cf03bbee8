//! Bad input: exit code 2, a message that says where and what, nothing overwritten.

use crate::common::Place;

#[test]
fn all_problems_of_a_scenario_are_shown_where_they_are() {
    let place = Place::new();
    place.write(
        "bad.toml",
        "[sampler]\nchians = 4\niterations = 1e3\nwarmup = true\n[world.ball2d]\nsigma_d = -0.1\nsigma_theta_deg = nan\ncollisions = 0\n\
         restitution = \"high\"\ndownward = \"bakc\"\n",
    );
    for command in ["check bad.toml", "sample bad.toml --out run"] {
        place.ends(command, 2).says(&[
            "error: sampler.chians: unknown key `chians`\n --> bad.toml:2:1",
            "did you mean `chains`?",
            "bad.toml:3:14",
            "write 1000",
            "bad.toml:4:10",
            "error: world.ball2d.sigma_d: -0.1 is out of range: it must be from 1e-9 to 1e6 D\n --> bad.toml:6:11",
            "nan is out of range: it must be from 1e-9 to 90°",
            "0 is out of range: it must be from 1 to 64\n --> bad.toml:8:14",
            "expected a number, from 0 to 1, found the string \"high\"",
            "it must be \"mirror\", \"reject\", \"zero\", \"level\" or \"back\"",
            "did you mean \"back\"?",
        ]);
    }
    assert_eq!(place.names(), ["bad.toml", "ball.toml"]);
}

#[test]
fn very_many_problems_are_counted() {
    let place = Place::new();
    let keys: String = (0..300).map(|key| format!("k{key} = 1\n")).collect();
    place.write("bad.toml", format!("[world.ball2d]\n{keys}"));
    let ended = place.ends("check bad.toml", 2);
    ended.says(&["unknown key `k0`", "error: and 280 more problems in bad.toml"]);
    assert!(ended.err.lines().count() < 200);
}

#[test]
fn files_that_are_no_scenarios_are_refused() {
    let place = Place::new();
    for (text, says) in [
        (&b""[..], &["error: world: missing", "in no.toml", "add a table [world.ball2d]"][..]),
        (b"[world.bal2d]", &["no.toml:1:8", "did you mean `world.ball2d`?"]),
        (b"[world.ball2d", &["no.toml:1:14", "unclosed table"]),
        (b"[world.ball2d]\nsigma_d = 1\nsigma_d = 1", &["no.toml:3:1", "duplicate key"]),
        (b"world.ball2d = 3", &["no.toml:1:16", "expected a table"]),
        (b"a\xff", &["no.toml:1:2", "byte 1 (0xff) is not UTF-8 text"]),
    ] {
        place.write("no.toml", text);
        place.ends("check no.toml", 2).says(says);
    }
    place.ends("check nope.toml", 2).says(&["error: nope.toml: cannot read the scenario"]);
    place.ends("check ball2d", 2).says(&["`plaus new ball2d ball2d.toml` writes one"]);
    place.ends("check .", 2).says(&["error: .: cannot read the scenario"]);
    place.write("huge.toml", vec![b'#'; (16 << 20) + 1]);
    place.ends("check huge.toml", 2).says(&["huge.toml: longer than 16777216 bytes"]);
}

#[test]
fn wrong_flags_are_named_as_they_were_given() {
    let place = Place::new();
    for (flags, says) in [
        ("--set sigma_d=-1", &["error: --set sigma_d=-1: -1 is out of range: it must be from 1e-9 to 1e6 D"][..]),
        ("--set sigmad=1", &["error: --set sigmad=1: unknown key", "did you mean `world.ball2d.sigma_d`?"]),
        ("--set sigma_d", &["an override has the form `key=value`"]),
        ("--chains 0", &["error: --chains 0: 0 is out of range: it must be from 1 to 100_000"]),
        ("--seed 18446744073709551615", &["error: --seed 18446744073709551615: ", "9_223_372_036_854_775_807"]),
        ("--iterations -5", &["invalid value '-5' for '--iterations <N>': it must be a whole number, 0 or more"]),
        ("--solutions 0", &["invalid value '0' for '--solutions <K>'"]),
        ("--max-time -1s", &["a time cannot be negative"]),
        ("--max-time 5parsecs", &["unknown unit `parsecs`: ms, s, m, h and d are known"]),
        ("--seed 99999999999999999999", &["invalid value '99999999999999999999' for '--seed <S>': it is too large"]),
        ("--threads x", &["invalid value 'x' for '--threads <T>'"]),
    ] {
        place.ends(&format!("sample ball.toml --out run {flags}"), 2).says(says);
    }
    assert_eq!(place.names(), ["ball.toml"]);
}

#[test]
fn nothing_is_overwritten() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    let before = place.bytes("run");
    place.ends("sample ball.toml --out run --seed 3", 2).says(&["error: run: already exists", "`plaus resume`"]);
    place.ends("sample ball.toml --out ball.toml", 2).says(&["error: ball.toml: already exists"]);
    place.ends("new ball2d ball.toml", 2).says(&["ball.toml: already exists"]);
    place.ends("export run --format csv --out ball.toml", 2).says(&["already exists", "--force"]);
    place.ends("export run --format csv --out ball.toml --force", 2).says(&["not made by such an export"]);
    place.ends("export run --format zarr --out run --force", 2).says(&["not made by such an export"]);
    assert_eq!(place.bytes("run"), before);
    assert_eq!(std::fs::read_to_string(place.path("ball.toml")).unwrap(), crate::common::SCENARIO);
    for format in ["csv", "zarr"] {
        let export = format!("export run --format {format} --out out.{format}");
        place.ok(&export);
        place.ends(&export, 2);
        place.ok(&format!("{export} --force"));
    }
    assert_eq!(place.names(), ["ball.toml", "out.csv", "out.zarr", "run"], "no drafts are left");
}

#[test]
fn folders_that_are_no_runs_are_refused() {
    let place = Place::new();
    std::fs::create_dir(place.path("empty")).unwrap();
    let commands = |run: &str| {
        let export = format!("export {run} --format csv --out d.csv");
        [format!("resume {run}"), format!("diagnose {run}"), export, format!("replay {run} --sample 0:0")]
    };
    for (run, says) in [("nope", "no such run"), ("empty", "is not a run"), ("ball.toml", "is not a run")] {
        for command in commands(run) {
            place.ends(&command, 2).says(&[&format!("error: {run}: "), says]);
        }
    }
    assert!(place.bytes("empty").is_empty());
    assert_eq!(place.names(), ["ball.toml", "empty"]);
}

#[test]
fn samples_that_do_not_exist_are_refused() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    place.ends("replay run --sample 4:0", 2).says(&["there is no chain 4: the chains are 0 to 3"]);
    place.ends("replay run --sample 0:900", 2).says(&["there is no draw 0:900: the draws of each chain are 0 to 899"]);
    place.ends("replay run --sample 0:18446744073709551615", 2).says(&["there is no draw 0:18446744073709551615"]);
    place.ends("replay run --sample seven", 2).says(&["write CHAIN:DRAW, e.g. 0:17"]);
    for fps in ["0", "-1", "nan", "1e300"] {
        place.ends(&format!("replay run --sample 0:0 --fps={fps}"), 2).says(&["must be above 0"]);
    }
}

#[test]
fn a_damaged_run_says_what_can_be_recovered() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    let path = place.path("run/chain-00001.records");
    let mut bytes = std::fs::read(&path).unwrap();
    let last = bytes.len() - 40;
    bytes[last] ^= 1;
    std::fs::write(&path, &bytes).unwrap();
    let says = [
        "run/chain-00001.records: at byte ",
        "checksum",
        "The 960 draws that the chain recorded",
        "plaus export --salvage",
    ];
    for command in ["diagnose run", "export run --format csv --out d.csv", "resume run"] {
        place.ends(command, 2).says(&says);
    }
    place.ok("export run --format csv --out d.csv --salvage");
    let rows = std::fs::read_to_string(place.path("d.csv")).unwrap().lines().count();
    assert_eq!(rows, 1 + 4 * 860, "a header, then what all four chains have after 100 iterations of warm-up");
    std::fs::write(place.path("run/manifest.json"), "{").unwrap();
    place.ends("diagnose run", 2).says(&["run/manifest.json: the manifest cannot be read"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_named() {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    for command in ["diagnose run", "export run --format csv --out -", "check ball.toml", "schema"] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let ended = crate::common::Ended::of(place.command(command).stdout(full).output().unwrap(), command);
        assert_eq!(ended.code, Some(2), "{command}");
        ended.says(&["cannot write: No space left on device"]);
    }
}
