//! Everything that is tried of scenarios from outside, as one program.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

mod require_bad;
mod require_bounds;
mod require_exact;
mod require_kinds;
mod scenario_bad;
mod scenario_properties;
mod scenario_schema;
