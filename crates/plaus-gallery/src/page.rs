//! The page: markup, style, three.js, the program and the data in one file.

use crate::pack::joined;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use plaus_run::Manifest;
use serde_json::Value;
use std::io::Write as _;

/// The beginning of every gallery.
pub(crate) const HEAD: &str = "<!doctype html>\n<!-- a gallery made by plaus";

const MARKUP: &str = include_str!("../web/page.html");
const STYLE: &str = include_str!("../web/style.css");
/// three.js and its orbit controls as one script, made by `web/build.mjs`.
const THREE: &str = include_str!("../web/dist/three.iife.js");
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
    include_str!("../web/app/player.js"),
    include_str!("../web/app/details.js"),
    include_str!("../web/app/live.js"),
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
    let hash = &manifest.scenario.hash;
    let [policy, nonce, live] = packed.live.as_ref().map_or_else(Default::default, |run| {
        let block = |id: &str, kind: &str, text: &str| format!("<script id=\"{id}\" type=\"{kind}\">{text}</script>\n");
        let blocks = [
            block("live-run", "application/octet-stream", &compressed(run.as_bytes())),
            block("live-module", "application/octet-stream", &STANDARD.encode(MODULE)),
            block("live-worker", "text/plain", WORKER),
        ];
        [policy(hash), format!(" nonce=\"{hash}\""), blocks.concat()]
    });
    let program = format!("(() => {{\n'use strict';\n{}\n}})();", PROGRAM.join("\n"));
    let parts = [
        ("{{title}}", escaped(&packed.title)),
        ("{{name}}", escaped(&packed.name)),
        ("{{style}}", STYLE.to_owned()),
        ("{{policy}}", policy),
        ("{{nonce}}", nonce),
        ("{{live}}", live),
        ("{{data}}", compressed(&joined(&packed.meta, &packed.bytes))),
        ("{{three}}", THREE.to_owned()),
        ("{{program}}", program),
    ];
    let mut html = format!("{HEAD} {} -->\n", manifest.plaus);
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
