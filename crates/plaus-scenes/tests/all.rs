//! All tests of scenarios from outside, as one program.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod curling;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_acting;
mod custom_arcs;
mod custom_bad;
mod custom_bumps;
mod custom_cases;
mod custom_contacts;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_cups;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_dice;
mod custom_driven;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_exact;
mod custom_failing;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_files;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_joints;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_late;
mod custom_marbles;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_optional;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_scatter;
mod custom_stages;
mod custom_strings;
mod custom_throws;
mod custom_unmet;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod custom_within;
mod distinct;
mod drawn;
mod imported;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod imported_axes;
mod imported_models;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod imported_physics;
mod imported_urdf;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod imported_usd;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod imported_usd_more;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod require_accents;
mod require_bad;
mod require_bounds;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod require_exact;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod require_kinds;
mod require_own;
mod require_quantities;
mod require_stop;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod require_view;
#[allow(clippy::disallowed_methods, reason = "expected numbers may differ in the last place")]
mod require_weights;
mod scenario_bad;
mod scenario_properties;
mod scenario_schema;
mod weigh;
