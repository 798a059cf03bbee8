//! The page: markup, style, three.js, the program and the data in one file.

use crate::live::World;
use crate::pack::joined;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use plaus_run::Manifest;
use plaus_scenes::Scenario;
use plaus_scenes::scenario::schema;
use serde_json::{Value, json};
use std::io::Write as _;

/// The beginning of every gallery.
pub(crate) const HEAD: &str = "<!doctype html>\n<!-- a gallery made by plaus";

const MARKUP: &str = include_str!("../web/page.html");
const STYLE: &str = include_str!("../web/style.css");
/// three.js and its orbit controls as one script, made by `web/build.mjs`.
const THREE: &str = include_str!("../web/dist/three.iife.js");
/// What makes GIFs, likewise.
const GIF: &str = include_str!("../web/dist/gifenc.iife.js");
/// The page's own program; parts come after the parts that they need.
const PROGRAM: &[&str] = &[
    include_str!("../web/app/data.js"),
    include_str!("../web/app/motion.js"),
    include_str!("../web/app/looks.js"),
    include_str!("../web/app/lod.js"),
    include_str!("../web/app/trails.js"),
    include_str!("../web/app/stage.js"),
    include_str!("../web/app/views.js"),
    include_str!("../web/app/glb.js"),
    include_str!("../web/app/map.js"),
    include_str!("../web/app/tiles.js"),
    include_str!("../web/app/filter.js"),
    include_str!("../web/app/sound.js"),
    include_str!("../web/app/camera.js"),
    include_str!("../web/app/player.js"),
    include_str!("../web/app/record.js"),
    include_str!("../web/app/gif.js"),
    include_str!("../web/app/details.js"),
    include_str!("../web/app/steer.js"),
    include_str!("../web/app/live.js"),
    include_str!("../web/app/playground.js"),
    include_str!("../web/app/main.js"),
];
/// What a worker of a live page runs.
const WORKER: &str = include_str!("../web/app/worker.js");
/// The sampler, compressed: made by `cargo xtask wasm` of the package `plaus-wasm`.
const MODULE: &[u8] = include_bytes!("../web/dist/plaus.wasm.gz");

/// What a page shows.
pub(crate) struct Packed {
    pub(crate) meta: Value,
    pub(crate) bytes: Vec<u8>,
    pub(crate) name: String,
    pub(crate) title: String,
    /// What its sampler knows of the run, as text, if it has one.
    pub(crate) live: Option<String>,
}

/// What a live page may do: run its own scripts and its module, and nothing over a network. Scripts are known by the
/// hash of the scenario, which no text within the scenario can name.
fn policy(nonce: &str) -> String {
    format!(
        "\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'nonce-{nonce}' \
         'wasm-unsafe-eval'; worker-src blob:; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; \
         form-action 'none'\">"
    )
}

pub(crate) fn html(manifest: &Manifest, packed: &Packed) -> String {
    let live = packed.live.as_ref().map(|run| (manifest.scenario.hash.as_str(), blocks(run, "")));
    let data = compressed(&joined(&packed.meta, &packed.bytes));
    whole(&manifest.plaus, [&packed.title, &packed.name], live, data)
}

/// A page without solutions, for scenarios that are written on it: at first this one, with the files of shapes that it
/// names. It is one HTML file like a gallery, and samples like a live one.
///
/// # Errors
/// In words, if a file has no shapes.
pub fn playground(text: &str, scenario: &Scenario) -> Result<String, String> {
    let files = World::of(scenario)?.files;
    // No text ends a block of the page.
    let start = json!({"text": text, "files": files}).to_string().replace('<', "\\u003c");
    let blocks = blocks("", &block("start", "application/json", &start));
    Ok(whole(
        env!("CARGO_PKG_VERSION"),
        ["playground · plaus", "playground"],
        Some(("playground", blocks)),
        String::new(),
    ))
}

fn block(id: &str, kind: &str, text: &str) -> String {
    format!("<script id=\"{id}\" type=\"{kind}\">{text}</script>\n")
}

/// What a page needs to sample: what it knows of a run, the schema of scenarios, the module, what workers run; and
/// `more`.
fn blocks(run: &str, more: &str) -> String {
    let packed = "application/octet-stream";
    [
        &block("live-run", packed, &compressed(run.as_bytes())),
        &block("live-schema", packed, &compressed(schema().to_string().as_bytes())),
        &block("live-module", packed, &STANDARD.encode(MODULE)),
        &block("live-worker", "text/plain", WORKER),
        more,
    ]
    .concat()
}

/// A page with this title and name; what it needs to sample, with what its scripts are known by, if it does.
fn whole(plaus: &str, [title, name]: [&str; 2], live: Option<(&str, String)>, data: String) -> String {
    let [policy, nonce, live] =
        live.map_or_else(Default::default, |(known, blocks)| [policy(known), format!(" nonce=\"{known}\""), blocks]);
    let program = format!("(() => {{\n'use strict';\n{}\n}})();", PROGRAM.join("\n"));
    let parts = [
        ("{{title}}", escaped(title)),
        ("{{name}}", escaped(name)),
        ("{{style}}", STYLE.to_owned()),
        ("{{policy}}", policy),
        ("{{nonce}}", nonce),
        ("{{live}}", live),
        ("{{data}}", data),
        ("{{three}}", [THREE, GIF].concat()),
        ("{{program}}", program),
    ];
    let mut html = format!("{HEAD} {plaus} -->\n");
    let mut rest = MARKUP;
    while let Some((before, name, text, after)) = next(rest, &parts) {
        debug_assert!(!name.is_empty());
        html.push_str(before);
        html.push_str(text);
        rest = after;
    }
    html.push_str(rest);
    html
}

/// The first placeholder in `text`: the text before it, its name, its value, and the text after it.
fn next<'a>(text: &'a str, parts: &'a [(&str, String)]) -> Option<(&'a str, &'a str, &'a str, &'a str)> {
    let found = parts.iter().filter_map(|(name, value)| text.find(name).map(|at| (at, *name, value.as_str())));
    let (at, name, value) = found.min_by_key(|(at, ..)| *at)?;
    Some((&text[..at], name, value, &text[at + name.len()..]))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// Bytes, compressed, as base64.
fn compressed(bytes: &[u8]) -> String {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    // Writing to memory cannot fail.
    let _ = encoder.write_all(bytes);
    STANDARD.encode(encoder.finish().unwrap_or_default())
}
