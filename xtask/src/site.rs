//! The site: pages to try it on, documents, and interfaces, as files for any host or none.

use crate::command::{Command, Failure, cargo, plaus, root, target};
use crate::steps::{self, Done, Step};
use crate::{clients, registry};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// What can be tried: one scenario of each scene, then worlds of users.
const TRIED: [&str; 10] = [
    "dice-one",
    "bowling-strike",
    "spelling-hi",
    "ball2d",
    "worlds/trick-shot",
    "worlds/dominoes-stop",
    "worlds/marble-run",
    "worlds/rim-shot",
    "worlds/billiards",
    "worlds/lever",
];
/// What a small site has, whose loop is the README's.
const SMALL: [&str; 1] = ["dice-one"];
/// The loop at the top is made from solutions of this one.
const STRIKES: &str = "bowling-strike";
/// Solutions that a page begins with, and those among which the nine of the loop are the most different.
const FIRST: &str = "6";
const MANY: &str = "40";
/// Packages that programs call.
const LIBRARIES: [&str; 10] =
    ["dist", "sim", "mcmc", "asset", "animation", "scenes", "run", "export", "picture", "gallery"];

/// `cargo xtask site [--out FOLDER] [--quick]`.
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    let (mut out, mut is_quick) = (target().join("site"), false);
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        match (*word, words.as_slice()) {
            ("--quick", _) => is_quick = true,
            ("--out", [folder, ..]) => {
                out = root().join(folder);
                words.next();
            }
            _ => return Err(Failure("cargo xtask site [--out FOLDER] [--quick]".to_owned())),
        }
    }
    let mut all = vec![steps::released()];
    let place = out.clone();
    all.push(Step::new("pages to try", move || tried(&place, if is_quick { &SMALL } else { &TRIED })));
    if !is_quick {
        let place = out.clone();
        all.push(Step::new("interfaces", move || interfaces(&place)));
    }
    let place = out.clone();
    all.push(Step::new("documents", move || script("build_site.py", "site-venv", &place)));
    all.push(Step::command("no dead link", links(&out)));
    steps::run(all)?;
    println!("open {}", out.join("index.html").display());
    Ok(())
}

/// A small site, its links, and what a browser makes of it; `plaus` has been built in release.
pub(crate) fn checked() -> Vec<Step> {
    let out = target().join("site-quick");
    let [first, second, third] = [out.clone(), out.clone(), out.clone()];
    vec![
        Step::new("a small site: pages to try", move || tried(&first, &SMALL)),
        Step::new("a small site: documents", move || script("build_site.py", "site-venv", &second)),
        Step::command(
            "the check of links finds dead ones",
            Command::new("python3").args(["xtask/python/test_links.py"]),
        ),
        Step::command("a small site: no dead link", links(&out)),
        Step::new("a small site in a browser", move || in_browser(&third)),
    ]
}

/// Begins the site anew, with a live page and a picture of each scenario, and the loop.
fn tried(out: &Path, scenarios: &[&str]) -> Result<Done, Failure> {
    anew(out)?;
    fs::create_dir_all(out.join("try")).map_err(Failure::new)?;
    let mut names = Vec::new();
    for scenario in scenarios {
        let name = scenario.rsplit('/').next().unwrap_or(scenario);
        let work = target().join("site-work").join(name);
        let file = root().join("scenarios").join(scenario).with_extension("toml");
        let solutions = if name == STRIKES { MANY } else { FIRST };
        let live = plaus(&["live", "--no-open", "--solutions", solutions, "--max-time", "5m"]);
        live.args([&file]).args(["--out"]).args([&work]).shown_and_run()?;
        let page = |ending: &str| out.join("try").join(name).with_extension(ending);
        fs::copy(work.join("index.html"), page("html")).map_err(Failure::new)?;
        let until = if name.starts_with("bowling") { "decided" } else { "rest" };
        let export = |words: &[&str], to: &Path| {
            let export = plaus(&["export", "--force", "--until", until]).args([work.join("run")]).args(words);
            export.args(["--into"]).args([to]).shown_and_run()
        };
        export(&["--most-different", "1", "--size", "640x360"], &page("png"))?;
        if name == STRIKES {
            let nine = ["--most-different", "9", "--size", "900x900"];
            export(&nine, &out.join("strikes.gif"))?;
            export(&nine, &out.join("strikes.png"))?;
        }
        names.push(format!("{name:?}"));
    }
    if !scenarios.contains(&STRIKES) {
        fs::copy(root().join("docs/pictures/strikes.gif"), out.join("strikes.gif")).map_err(Failure::new)?;
        fs::copy(out.join("try/dice-one.png"), out.join("strikes.png")).map_err(Failure::new)?;
    }
    fs::write(out.join("try/pages.json"), format!("[{}]\n", names.join(", "))).map_err(Failure::new)?;
    plaus(&["playground", "scenarios/worlds/trick-shot.toml", "--force", "--out"])
        .args([out.join("playground.html")])
        .shown_and_run()?;
    Ok(Done::Passed)
}

/// What programs can call, from Rust and from Python.
fn interfaces(out: &Path) -> Result<Done, Failure> {
    let made = target().join("doc");
    if made.exists() {
        fs::remove_dir_all(&made).map_err(Failure::new)?;
    }
    let packages = LIBRARIES.map(|name| format!("plaus-{name}"));
    let words = packages.iter().flat_map(|name| ["--package", name]);
    cargo(&["doc", "--no-deps"]).args(words).shown_and_run()?;
    copy(&made, &out.join("api/rust"))?;
    script("python_docs.py", "python-docs-venv", &out.join("api/python"))
}

/// Chromium opens the site from its folder, and uses it.
fn in_browser(out: &Path) -> Result<Done, Failure> {
    let Some(node) = clients::node()? else { return registry::absent(clients::NO_PACKAGES) };
    let shots = target().join("clients/pictures");
    Command::new("node").args([node.join("check_site.mjs"), shots]).args([out]).run().map(|()| Done::Passed)
}

fn links(out: &Path) -> Command {
    Command::new("python3").args(["xtask/python/check_links.py"]).args([out])
}

/// A script that makes pages in `out`, with packages of its own.
fn script(name: &str, venv: &str, out: &Path) -> Result<Done, Failure> {
    let script = Command::new("python3").args([Path::new("xtask/python").join(name)]).args(["--venv"]);
    let script = script.args([target().join(venv)]).args([out]);
    println!("$ {}", script.shown());
    registry::outcome(script.status()?, "pages cannot be made")
}

/// An empty folder in place of an earlier site; what is no site is left alone.
fn anew(out: &Path) -> Result<(), Failure> {
    let is_site = out.join("try").is_dir();
    if is_site {
        fs::remove_dir_all(out).map_err(Failure::new)?;
    } else if fs::read_dir(out).is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(Failure(format!("{} holds something other than a site", out.display())));
    }
    fs::create_dir_all(out).map_err(Failure::new)
}

/// A folder with all that is in it, but for what only programs read.
fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    fs::create_dir_all(to).map_err(Failure::new)?;
    for entry in fs::read_dir(from).map_err(Failure::new)? {
        let path: PathBuf = entry.map_err(Failure::new)?.path();
        let name = path.file_name().unwrap_or_default();
        if path.is_dir() {
            copy(&path, &to.join(name))?;
        } else if name != OsStr::new(".lock") {
            fs::copy(&path, to.join(name)).map_err(Failure::new)?;
        }
    }
    Ok(())
}
