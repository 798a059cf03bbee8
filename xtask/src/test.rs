//! Everything that must pass: what `cargo xtask test` checks of the code, what `cargo xtask profiles` checks of it in
//! other profiles, and what `cargo xtask clients` checks with other programs and libraries. CI runs all of them.

use crate::command::{Command, Failure, built, cargo, root, target};
use crate::steps::{self, Done, Step};
use crate::{clients, documented, examples, registry};

/// All packages except benches and comparisons with other libraries. Those take longer to build than everything else,
/// and make cargo build shared dependencies differently; clippy checks our side of them. Every build in the profile
/// `dev` begins with these words. If packages or dev-dependencies differed, cargo would choose other features for
/// shared dependencies, and build all of them again.
pub(crate) const ALL: [&str; 7] =
    ["--workspace", "--exclude", "plaus-tradeoff", "--exclude", "plaus-benches", "--exclude", "plaus-oracle"];

/// The same without what draws figures, whose libraries take long to build too: the product and its tests. CI checks
/// everything.
const CODE: [&str; 9] = [
    "--workspace",
    "--exclude",
    "plaus-tradeoff",
    "--exclude",
    "plaus-benches",
    "--exclude",
    "plaus-oracle",
    "--exclude",
    "plaus-figures",
];

/// What is compared in release: both packages at once, for the same reason.
const IN_RELEASE: [&str; 7] =
    ["--release", "--package", "plaus-cli", "--package", "plaus-tests", "--features", "plaus-cli/usd"];

/// Checks the code.
pub(crate) fn run() -> Result<(), Failure> {
    steps::run(code(&CODE, &CODE))
}

/// What shows within a minute or so whether a change is sound: everything except the long tests, other profiles, and
/// other programs.
pub(crate) fn quick() -> Result<(), Failure> {
    // The Python extension has no tests, but cargo would build it nevertheless.
    let words = ["--exclude", "plaus-python", "--lib", "--bins", "--test", "golden", "--test", "tidy"];
    steps::run(vec![
        format(),
        clippy(&CODE),
        Step::command("unit tests, golden traces, what no compiler checks", cargo(&["test"]).args(CODE).args(words)),
    ])
}

/// Golden traces without any optimisation and with all of it.
pub(crate) fn profiles() -> Result<(), Failure> {
    steps::run(in_other_profiles())
}

/// The code, also in other profiles, and what other programs make of the output.
pub(crate) fn ci() -> Result<(), Failure> {
    let mut all = code(&["--workspace"], &ALL);
    all.extend(in_other_profiles());
    all.extend(with_clients());
    steps::run_all(all)
}

/// Every command that README, docs and scenario files show.
pub(crate) fn shown() -> Result<(), Failure> {
    let shown = Step::new("every command that is shown", documented::run);
    steps::run(vec![steps::released(), crate::reference::checked(), shown])
}

/// Only the checks that need other programs: figures, ArviZ, engines, viewers, browsers.
pub(crate) fn clients() -> Result<(), Failure> {
    let mut all = vec![steps::released()];
    all.extend(with_clients());
    steps::run(all)
}

/// Whether Blender plays exports correctly.
pub(crate) fn blender() -> Vec<Step> {
    exported(Step::new("Blender plays them", clients::blender))
}

/// Whether Godot plays exports correctly.
pub(crate) fn godot() -> Result<(), Failure> {
    steps::run(exported(Step::new("Godot plays them", clients::godot)))
}

/// What one program makes of exports of every scene.
fn exported(program: Step) -> Vec<Step> {
    vec![
        steps::released(),
        Step::command("every shape", cargo(&["build", "--package", "plaus-export", "--example", "tumbling"])),
        Step::new("exports of every scene", clients::export),
        program,
    ]
}

fn format() -> Step {
    Step::command("format", cargo(&["fmt", "--all", "--", "--check"]))
}

fn clippy(packages: &[&'static str]) -> Step {
    Step::command("clippy", cargo(&["clippy"]).args(packages).args(["--all-targets", "--", "-D", "warnings"]))
}

/// Packages whose text is checked, and packages whose tests are run.
fn code(checked: &[&'static str], tested: &[&'static str]) -> Vec<Step> {
    let docs = cargo(&["doc", "--no-deps"]).args(checked).env("RUSTDOCFLAGS", "-D warnings");
    vec![
        format(),
        crate::wheel::licences(),
        clippy(checked),
        // Tests and examples. Clippy has checked the rest: benches and the Python extension.
        Step::command("build", cargo(&["test"]).args(tested).args(["--no-run"])),
        Step::command("tests", cargo(&["test"]).args(tested).args(["--no-fail-fast"])),
        Step::command("docs", docs),
        Step::new("examples", examples::run),
    ]
}

fn in_other_profiles() -> Vec<Step> {
    let golden = ["--package", "plaus-tests", "--test", "golden"];
    vec![
        Step::command("golden traces, unoptimised", cargo(&["test", "--profile", "unoptimised"]).args(golden)),
        Step::command("release", cargo(&["build"]).args(IN_RELEASE).args(["--bin", "plaus", "--example", "golden"])),
        Step::command("golden traces, release", Command::new(built("release/examples", "golden"))),
    ]
}

fn with_clients() -> Vec<Step> {
    let figures = |what: &'static str, words: &[&str]| {
        let out = target().join(what);
        Step::command(
            what,
            Command::new(built("debug", "plaus-figures")).args(words).args(["--quick", "--out"]).args([out]),
        )
    };
    // A test is included for the features of its dev-dependencies.
    let programs = ["--bin", "plaus-figures", "--example", "tumbling", "--test", "golden"];
    let mut all = vec![
        Step::command("distances beside another library", cargo(&["test", "--package", "plaus-oracle"])),
        Step::command("what draws figures, and every shape", cargo(&["build"]).args(ALL).args(programs)),
        figures("figures-quick", &[]),
        figures("plausibility-quick", &["plausibility"]),
        Step::new("ArviZ reads a run", crate::arviz::run),
        Step::new("pieces on engines, quick", crate::engines::quick),
    ];
    all.extend(clients::steps());
    all.extend(crate::site::checked());
    all.push(Step::new("workflows", workflows));
    all.push(crate::archive::checked());
    all.push(crate::wheel::tried());
    all.push(crate::blender::extension());
    all.push(crate::reference::checked());
    all.push(Step::new("every command that is shown", documented::run));
    all
}

/// What two linters find in the workflows: mistakes, and what an attacker could use.
fn workflows() -> Result<Done, Failure> {
    let folder = root().join(".github/workflows");
    let Some(node) = clients::node()? else { return registry::absent(clients::NO_PACKAGES) };
    let files = clients::with_ending(&folder, ".yml")?;
    Command::new("node").args([node.join("lint_workflows.mjs")]).args(&files).run()?;
    let script = Command::new("python3").args(["xtask/python/lint_workflows.py", "--venv"]);
    let script = script.args([target().join("workflows-venv"), folder]);
    registry::outcome(script.status()?, "workflows are not safe")
}
