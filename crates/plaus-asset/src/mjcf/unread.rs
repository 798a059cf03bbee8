//! What of a model is not read, in words.

use super::xml::{Element, Place};
use std::collections::{BTreeMap, BTreeSet};

/// Most lines that are named for one thing.
const MOST_LINES: usize = 12;

/// What is read of each element. What `visual`, `statistic` and `size` say has no influence on motion.
const READ: [(&str, &[&str]); 18] = [
    ("mujoco", &["model"]),
    (
        "compiler",
        &["angle", "eulerseq", "coordinate", "autolimits", "strippath", "inertiafromgeom", "assetdir", "meshdir"],
    ),
    ("option", &["gravity"]),
    ("size", EVERY),
    ("visual", EVERY),
    ("statistic", EVERY),
    ("default", &["class"]),
    ("asset", &[]),
    ("material", &["name", "class", "rgba"]),
    ("mesh", &["name", "class", "file", "vertex", "refpos", "refquat", "scale", "normal", "texcoord", "face"]),
    ("freejoint", EVERY),
    ("worldbody", &["childclass"]),
    (
        "body",
        &["name", "childclass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "gravcomp", "mocap", "user"],
    ),
    ("frame", &["name", "childclass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"]),
    ("replicate", &["count", "offset", "euler", "sep", "childclass"]),
    ("inertial", &["mass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "diaginertia", "fullinertia"]),
    ("joint", &["name", "class", "type", "group", "pos", "axis", "range", "limited", "ref", "frictionloss", "user"]),
    (
        "geom",
        &[
            "name",
            "class",
            "type",
            "group",
            "pos",
            "quat",
            "axisangle",
            "euler",
            "xyaxes",
            "zaxis",
            "fromto",
            "size",
            "mesh",
            "mass",
            "density",
            "friction",
            "contype",
            "conaffinity",
            "condim",
            "material",
            "rgba",
            "user",
        ],
    ),
];
/// All attributes and all that is inside.
const EVERY: &[&str] = &["*"];

/// Kinds of things, each with where they are.
type Found = BTreeMap<String, BTreeSet<Place>>;

/// Elements that have no bearing on motion, wherever they are.
const HARMLESS: [&str; 7] = ["<light>", "<camera>", "<texture>", "<site>", "<skin>", "<key>", "<model>"];
/// Whole attributes, or elements, of which the same is true by what they are of or in.
const SEEN: [&str; 8] = [
    " of <material>",
    " of <texture>",
    " of <asset>",
    " in <sensor>",
    " in <custom>",
    " in <keyframe>",
    " in <visual>",
    "texturedir of <compiler>",
];
/// How MuJoCo computes, which the physics does not say.
const NUMERICS: [&str; 14] = [
    "timestep",
    "solver",
    "iterations",
    "tolerance",
    "ls_iterations",
    "ls_tolerance",
    "ccd_iterations",
    "ccd_tolerance",
    "noslip_iterations",
    "noslip_tolerance",
    "jacobian",
    "integrator",
    "sdf_iterations",
    "sdf_initpoints",
];

/// Whether something that is not read has no bearing on motion.
fn is_harmless(what: &str) -> bool {
    HARMLESS.contains(&what)
        || SEEN.iter().any(|end| what.ends_with(end))
        || what.strip_suffix(" of <option>").is_some_and(|name| NUMERICS.contains(&name))
}

/// One sentence for each kind of element, or attribute, that is not read, with its lines; first those that may change
/// motion, then those that have no bearing on it.
pub(super) fn unread(root: &Element) -> [Vec<String>; 2] {
    let mut found = Found::new();
    walk(root, "", &mut found);
    let said = |(what, places): (String, BTreeSet<Place>)| {
        let lines: BTreeSet<_> = places.iter().map(Place::line).collect();
        let some: Vec<String> = lines.iter().take(MOST_LINES).map(|(line, file)| format!("{line}{file}")).collect();
        let more = if lines.len() > MOST_LINES { ", …" } else { "" };
        let word = if lines.len() == 1 { "line" } else { "lines" };
        format!("{what} ({word} {}{more})", some.join(", "))
    };
    let (harmless, others): (Vec<_>, Vec<_>) = found.into_iter().partition(|(what, _)| is_harmless(what));
    [others, harmless].map(|list| list.into_iter().map(said).collect())
}

fn walk(of: &Element, above: &str, found: &mut Found) {
    let mut add = |what: String, place: &Place| {
        found.entry(what).or_default().insert(place.clone());
    };
    match READ.iter().find(|(tag, _)| *tag == of.tag) {
        Some((_, EVERY)) => return,
        Some((_, known)) => {
            for (name, value) in &of.attributes {
                // These are what every contact here is.
                let is_usual = match name.as_str() {
                    "condim" => matches!(value.trim(), "1" | "3"),
                    "contype" | "conaffinity" => matches!(value.trim(), "0" | "1"),
                    name => known.contains(&name),
                };
                if !is_usual {
                    add(format!("{name} of <{}>", of.tag), &of.place);
                }
            }
        }
        None if above == "mujoco" => {
            return of.children.iter().for_each(|part| add(format!("<{}> in <{}>", part.tag, of.tag), &part.place));
        }
        None => return add(format!("<{}>", of.tag), &of.place),
    }
    of.children.iter().for_each(|child| walk(child, &of.tag, found));
}
