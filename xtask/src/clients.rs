//! Reads exports and galleries with other programs: the Khronos validator, three.js, Babylon.js, Pixar's USD, Blender,
//! Godot, ffmpeg, Chromium, Firefox.

use crate::command::{Command, Failure, built, cargo, plaus, root, target};
use crate::registry;
use crate::steps::{Done, Step};
use crate::test::ALL;
use std::fs;
use std::path::{Path, PathBuf};

/// Keys per second of the exports, and of the tables with which poses between keys are compared.
const FPS: [&str; 2] = ["60", "240"];
/// Poses per second of the table with which Blender is compared at any time.
const DENSE: &str = "960";
/// Samples of each scene that are exported.
const SAMPLES: [&str; 2] = ["0:0", "0:10"];

/// Scenarios whose galleries are opened in a browser, one for each scene.
const GALLERIES: [&str; 4] = ["ball2d", "bowling-strike", "dice-one", "spelling-hi"];

/// Iterations of each chain: enough to find solutions to look at, however long a simulation takes.
fn iterations(scenario: &str) -> &'static str {
    match scenario {
        bowling if bowling.starts_with("bowling") => "150",
        "dice-six-together" => "300",
        _ => "2000",
    }
}

/// npm tries three times, seconds apart, so that within half a minute it is clear if a registry is out of reach.
const RETRIES: [&str; 3] = ["--fetch-retries=2", "--fetch-retry-mintimeout=2000", "--fetch-retry-maxtimeout=8000"];
/// Why there are no Node.js packages; npm has reported the cause above.
pub(crate) const NO_PACKAGES: &str =
    "npm cannot install the packages of this check (no npm, or its registry is out of reach)";

fn folder() -> PathBuf {
    target().join("clients")
}

/// Needs `plaus` in release, and the example `tumbling`.
pub(crate) fn steps() -> Vec<Step> {
    vec![
        Step::new("exports of every scene", export),
        Step::new("glTF validator and three.js read them", gltf),
        Step::new("USD reads them", usd),
        Step::new("Blender plays them", blender),
        Step::new("Godot plays them", godot),
        Step::new("videos and loops show them", pictures),
        Step::new("galleries in a browser", gallery),
        Step::new("live galleries in a browser", live),
        Step::new("every state of pages", looks),
        Step::new("galleries in Firefox", firefox),
        Step::command(
            "the module of live galleries makes the same draws",
            cargo(&["test"]).args(ALL).args(["--test", "module", "--", "--ignored"]),
        ),
        Step::new("the committed bundles are what their script makes", bundle),
    ]
}

/// Samples every scenario, and exports some of each in every format.
pub(crate) fn export() -> Result<Done, Failure> {
    let exports = folder().join("exports");
    if exports.exists() {
        fs::remove_dir_all(&exports).map_err(Failure::new)?;
    }
    fs::create_dir_all(&exports).map_err(Failure::new)?;
    // Every shape and kind of rotation, even if no scene has it.
    Command::new(built("debug/examples", "tumbling")).args([&exports]).shown_and_run()?;
    for scenario in scenarios()? {
        let name = scenario.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let run = exports.join(format!("{name}.run"));
        let sampled = plaus(&["sample"]).args([&scenario]).args(["--out"]).args([&run]);
        let iterations = iterations(&name);
        let short = ["--seed", "1", "--iterations", iterations, "--threads", "2", "--max-time", "180s", "--quiet"];
        let all = ["--set", "sampler.warmup=0", "--set", "sampler.thin=1"];
        let sampled = sampled.args(short).args(all);
        println!("$ {}", sampled.shown());
        // Exit code 1: there is no solution in so few iterations. Any sample can be exported.
        let code = sampled.status()?;
        if code > 1 {
            return Err(Failure(format!("sampling {name} failed with exit code {code}")));
        }
        for sample in SAMPLES {
            let stem = format!("{name}-{}", sample.replace(':', "-"));
            let export = |format: &str, file: String, fps: &str| {
                let command = plaus(&["export"]).args([&run]).args(["--format", format, "--sample", sample, "--out"]);
                command.args([exports.join(file)]).args(["--fps", fps]).shown_and_run()
            };
            export("glb", format!("{stem}.glb"), FPS[0])?;
            export("json", format!("{stem}.json"), FPS[0])?;
            export("usda", format!("{stem}.usda"), FPS[0])?;
            export("poses", format!("{stem}.poses.csv"), FPS[0])?;
            export("poses", format!("{stem}.between.csv"), FPS[1])?;
            export("events", format!("{stem}.events.json"), FPS[0])?;
        }
        if !GALLERIES.contains(&name.as_str()) {
            continue;
        }
        let page = exports.join(format!("{name}.html"));
        plaus(&["gallery"]).args([&run]).args(["--out"]).args([&page]).shown_and_run()?;
    }
    Ok(Done::Passed)
}

/// All scenario files.
fn scenarios() -> Result<Vec<PathBuf>, Failure> {
    with_ending(&root().join("scenarios"), ".toml")
}

/// Files of a folder whose names have this ending.
pub(crate) fn with_ending(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, Failure> {
    let entries = fs::read_dir(folder).map_err(Failure::new)?;
    let paths = entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>();
    let mut paths = paths.map_err(Failure::new)?;
    paths.retain(|path| path.to_string_lossy().ends_with(ending));
    paths.sort();
    Ok(paths)
}

/// Exports with the tables that belong to them.
fn with_tables(ending: &str, table: &str) -> Result<Vec<PathBuf>, Failure> {
    let files = with_ending(&folder().join("exports"), ending)?;
    // The part of the ending that belongs to the sample stays.
    let (own, _) = ending.split_once('.').unwrap_or((ending, ""));
    let table_of = |file: &PathBuf| PathBuf::from(file.to_string_lossy().replace(ending, &format!("{own}{table}")));
    Ok(files.iter().flat_map(|file| [file.clone(), table_of(file)]).collect())
}

/// The Khronos validator and three.js read every GLB.
fn gltf() -> Result<Done, Failure> {
    let Some(node) = node()? else { return registry::absent(NO_PACKAGES) };
    let script = Command::new("node").args([node.join("check_glb.mjs")]).args(with_tables(".glb", ".between.csv")?);
    script.run()?;
    let script =
        Command::new("node").args([node.join("check_motion.mjs")]).args(with_tables("-0.json", ".between.csv")?);
    script.run().map(|()| Done::Passed)
}

/// Pixar's own library reads every USDA.
fn usd() -> Result<Done, Failure> {
    let script =
        Command::new("python3").args(["xtask/python/check_usd.py", "--venv"]).args([target().join("usd-venv")]);
    let script = script.args(with_tables(".usda", ".between.csv")?);
    registry::outcome(script.status()?, "USD does not read what plaus wrote")
}

/// One export of each scene in each format, each with a dense table of poses, for comparison at any time.
fn densely(endings: &[&str]) -> Result<Vec<PathBuf>, Failure> {
    let exports = folder().join("exports");
    let mut files = Vec::new();
    for scenario in GALLERIES {
        let [run, poses] = ["run", "dense.csv"].map(|end| exports.join(format!("{scenario}.{end}")));
        let export = plaus(&["export"]).args([&run]).args(["--format", "poses", "--sample", SAMPLES[0], "--force"]);
        export.args(["--fps", DENSE, "--out"]).args([&poses]).shown_and_run()?;
        for end in endings {
            files.extend([exports.join(format!("{scenario}-0-0.{end}")), poses.clone()]);
        }
    }
    Ok(files)
}

/// Godot imports one GLB of each scene and plays it; only if it is installed, because no registry has all its versions.
pub(crate) fn godot() -> Result<Done, Failure> {
    const PROGRAM: &str = "godot";
    if !matches!(Command::new(PROGRAM).args(["--version"]).status(), Ok(0)) {
        return Ok(Done::Skipped(format!("there is no `{PROGRAM}` on the path")));
    }
    let script = Command::new("python3").args(["xtask/python/check_godot.py", "--godot", PROGRAM, "--project"]);
    script.args([folder().join("godot")]).args(densely(&["glb"])?).run().map(|()| Done::Passed)
}

/// Blender imports one GLB and one USDA of each scene, and plays them.
pub(crate) fn blender() -> Result<Done, Failure> {
    let script = Command::new("python3").args(["xtask/python/check_blender.py", "--venv"]);
    let script = script.args([target().join("blender-venv")]).args(densely(&["glb", "usda"])?);
    registry::outcome(script.status()?, "Blender does not play what plaus wrote")
}

/// ffmpeg and Pillow read a video and a loop.
fn pictures() -> Result<Done, Failure> {
    let script = Command::new("python3").args(["xtask/python/check_pictures.py", "--venv"]);
    let script = script.args([target().join("pictures-venv"), built("release", "plaus")]);
    let script = script.args([folder().join("exports/dice-one.run"), folder().join("pictures")]);
    registry::outcome(script.status()?, "videos do not show what they should")
}

/// Chromium opens every gallery from disk, offline, and uses it.
fn gallery() -> Result<Done, Failure> {
    let Some(node) = node()? else { return registry::absent(NO_PACKAGES) };
    let temporary = folder().join("tmp");
    fs::create_dir_all(&temporary).map_err(Failure::new)?;
    let pages = with_ending(&folder().join("exports"), ".html")?;
    let script = Command::new("node").args([node.join("check_gallery.mjs"), folder().join("pictures")]).args(pages);
    let script = script.env("PLAUS", &built("release", "plaus").to_string_lossy());
    script.env("TMPDIR", &temporary.to_string_lossy()).run().map(|()| Done::Passed)
}

/// A world of a user's with a name that tries to be code, which it must not.
const MARKUP: &str = r#"
[world.custom]

[[world.custom.materials]]
name = "rubber"
friction = 0.6
restitution = { uniform = [0.6, 0.8] }
rolling = 0.03

[[world.custom.bodies]]
name = "ball"
shape = { ball = { radius_mm = 30 } }
material = "rubber"
at_mm = [0, { uniform = [-500, 500] }, { uniform = [200, 1000] }]
velocity_m_s = [{ normal = [1.0, 0.5] }, { normal = [0, 0.5] }, { normal = [1, 1] }]

[[require]]
[require.named]
name = "</script><img src=x onerror=hacked=1>"
that = { rests_at = { body = "ball", x_mm = 1500, y_mm = 0, within_mm = 100 } }
"#;

/// Pages that go on sampling: of a built-in scene, and of a user's world.
fn live() -> Result<Done, Failure> {
    let Some(node) = node()? else { return registry::absent(NO_PACKAGES) };
    let pages = folder().join("live");
    fs::create_dir_all(&pages).map_err(Failure::new)?;
    let throw = pages.join("throw.toml");
    fs::write(&throw, MARKUP).map_err(Failure::new)?;
    let mut made = Vec::new();
    for scenario in [root().join("scenarios/dice-one.toml"), throw] {
        let [run, page] =
            ["run", "html"].map(|end| pages.join(scenario.file_name().unwrap_or_default()).with_extension(end));
        let sampled = plaus(&["sample"]).args([&scenario]).args(["--solutions", "4", "--quiet", "--force", "--out"]);
        sampled.args([&run]).shown_and_run()?;
        plaus(&["gallery", "--live", "--force"]).args([&run]).args(["--out"]).args([&page]).shown_and_run()?;
        made.push(page);
    }
    let page = pages.join("playground.html");
    let playground = plaus(&["playground", "scenarios/dice-one.toml", "--force", "--out"]);
    playground.args([&page]).shown_and_run()?;
    made.push(page);
    let temporary = folder().join("tmp");
    fs::create_dir_all(&temporary).map_err(Failure::new)?;
    let script = Command::new("node").args([node.join("check_live.mjs"), folder().join("pictures")]).args(made);
    let script = script.env("PLAUS", &built("release", "plaus").to_string_lossy());
    script.env("TMPDIR", &temporary.to_string_lossy()).run().map(|()| Done::Passed)
}

/// Pictures of every state of a gallery, a live page and a playground, and what keeps people out of them.
fn looks() -> Result<Done, Failure> {
    let Some(node) = node()? else { return registry::absent(NO_PACKAGES) };
    let script = Command::new("node").args([node.join("check_looks.mjs"), folder().join("pictures")]);
    let pages = ["exports/bowling-strike.html", "live/dice-one.html", "live/playground.html"];
    let script = script.args(pages.map(|page| folder().join(page)));
    script.env("TMPDIR", &folder().join("tmp").to_string_lossy()).run().map(|()| Done::Passed)
}

/// Firefox opens one page of each kind; only where it is in Debian's packages.
fn firefox() -> Result<Done, Failure> {
    let Some(node) = node()? else { return registry::absent(NO_PACKAGES) };
    let script = Command::new("python3").args(["xtask/python/check_firefox.py"]).args([target()]);
    let script = script.args([node.join("check_firefox.mjs"), folder().join("pictures")]);
    let script =
        script.args([folder().join("exports/dice-one.html")]).args(with_ending(&folder().join("live"), ".html")?);
    let temporary = folder().join("tmp");
    fs::create_dir_all(&temporary).map_err(Failure::new)?;
    match script.env("TMPDIR", &temporary.to_string_lossy()).status()? {
        0 => Ok(Done::Passed),
        77 => Ok(Done::Skipped("Firefox cannot be had (no Debian packages)".to_owned())),
        code => Err(Failure(format!("pages do not work in Firefox (exit code {code})"))),
    }
}

/// The bundles in the gallery are equal to what their script makes from the packages that it names.
fn bundle() -> Result<Done, Failure> {
    let files = ["build.mjs", "three.js", "gif.js", "dist/three.iife.js", "dist/gifenc.iife.js"];
    let Some(web) = packages("crates/plaus-gallery/web", "web", &files)? else {
        return registry::absent(NO_PACKAGES);
    };
    Command::new("node").args([web.join("build.mjs")]).args(["--check"]).run().map(|()| Done::Passed)
}

/// A folder with our scripts and the packages they need; `None` if those cannot be installed.
pub(crate) fn node() -> Result<Option<PathBuf>, Failure> {
    let scripts = [
        "check_glb.mjs",
        "three.mjs",
        "babylon.mjs",
        "check_gallery.mjs",
        "check_firefox.mjs",
        "check_live.mjs",
        "check_looks.mjs",
        "check_site.mjs",
        "lint_workflows.mjs",
        "check_motion.mjs",
        "motion.mjs",
        "world_pictures.mjs",
    ];
    packages("xtask/node", "node", &scripts)
}

/// Copies scripts to a folder under target/ and installs the packages they need there.
fn packages(from: &str, to: &str, scripts: &[&str]) -> Result<Option<PathBuf>, Failure> {
    let (from, to) = (root().join(from), folder().join(to));
    fs::create_dir_all(to.join("dist")).map_err(Failure::new)?;
    for file in scripts.iter().chain(&["package.json", "package-lock.json"]) {
        fs::copy(from.join(file), to.join(file)).map_err(Failure::new)?;
    }
    let (stamp, wanted) = (to.join("installed.json"), fs::read(from.join("package-lock.json")).map_err(Failure::new)?);
    if fs::read(&stamp).is_ok_and(|found| found == wanted) {
        return Ok(Some(to));
    }
    let install = Command::new("npm")
        .args(["ci", "--no-audit", "--no-fund", "--loglevel=error"])
        .args(RETRIES)
        .args(["--prefix"])
        .args([&to]);
    println!("$ {}", install.shown());
    if !matches!(install.status(), Ok(0)) {
        return Ok(None);
    }
    fs::write(stamp, wanted).map_err(Failure::new)?;
    Ok(Some(to))
}
