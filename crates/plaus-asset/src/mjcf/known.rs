//! What is read of models in MJCF.

use crate::unread::{EVERY, Known};
use crate::xml::Attributes;

pub(super) const KNOWN: Known = Known { root: "mujoco", read: &READ, is_usual, is_harmless };

/// What is read of each element. What `visual`, `statistic` and `size` say has no influence on motion.
const READ: [(&str, &[&str]); 19] = [
    ("mujoco", &["model"]),
    (
        "compiler",
        &["angle", "eulerseq", "coordinate", "autolimits", "strippath", "inertiafromgeom", "assetdir", "meshdir"],
    ),
    ("option", &["gravity"]),
    ("flag", &["gravity"]),
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
    (
        "joint",
        &[
            "name",
            "class",
            "type",
            "group",
            "pos",
            "axis",
            "range",
            "limited",
            "ref",
            "frictionloss",
            "stiffness",
            "springref",
            "damping",
            "user",
        ],
    ),
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
            "material",
            "rgba",
            "user",
        ],
    ),
];
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
/// Flags about how MuJoCo computes.
const NUMERICAL_FLAGS: [&str; 12] = [
    "autoreset",
    "ccd",
    "eulerdamp",
    "energy",
    "fwdinv",
    "invdiscrete",
    "island",
    "midphase",
    "multiccd",
    "nativeccd",
    "sensor",
    "warmstart",
];

/// Whether something that is not read has no bearing on motion.
fn is_harmless(what: &str) -> bool {
    HARMLESS.contains(&what)
        || SEEN.iter().any(|end| what.ends_with(end))
        || what.strip_suffix(" of <option>").is_some_and(|name| NUMERICS.contains(&name))
        || what.strip_suffix(" of <flag>").is_some_and(|name| NUMERICAL_FLAGS.contains(&name))
}

/// What every contact here is.
fn is_usual(name: &str, said: &Attributes) -> bool {
    match (name, said.get(name).map_or("", |value| value.trim())) {
        ("condim", value) => matches!(value, "1" | "3"),
        ("contype" | "conaffinity", value) => matches!(value, "0" | "1"),
        _ => false,
    }
}
