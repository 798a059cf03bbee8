//! All tests of the simulator from outside, as one program: `cargo test -p plaus-sim --test all laws_random` runs one
//! file's tests.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/cases/mod.rs"]
mod cases;
mod common;
#[path = "common/fuzz/mod.rs"]
mod fuzz;
#[path = "common/laws/mod.rs"]
mod laws;
#[path = "common/small_steps/mod.rs"]
mod small_steps;
#[path = "common/swings/mod.rs"]
mod swings;

mod bounded;
mod contact_forces;
mod extremes;
mod field;
mod heights;
mod laws_cases;
mod laws_driven;
mod laws_instant;
mod laws_random;
mod laws_symmetry;
mod laws_truths;
mod laws_worlds;
mod marble_laws;
mod marble_truth;
mod marble_worlds;
mod marbles_exact;
mod metamorphic;
mod restart;
mod rigid_acted;
mod rigid_arc_throws;
mod rigid_arcs;
mod rigid_axes;
mod rigid_ball;
mod rigid_boxes;
mod rigid_chains;
mod rigid_coins;
mod rigid_crowds;
mod rigid_die;
mod rigid_driven;
mod rigid_extremes;
mod rigid_feet;
mod rigid_given;
mod rigid_heaps;
mod rigid_hulls;
mod rigid_joints;
mod rigid_ledges;
mod rigid_motors;
mod rigid_pieces;
mod rigid_pivot;
mod rigid_regions;
mod rigid_rests;
mod rigid_roll;
mod rigid_scatter;
mod rigid_slants;
mod rigid_stiction;
mod rigid_strings;
mod rigid_swings;
mod rigid_tables;
mod rigid_tops;
mod rigid_trees;
mod rigid_wedges;
mod rigid_yoyos;
