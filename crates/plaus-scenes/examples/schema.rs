//! Prints the JSON Schema of scenario files as their types make it: what `cargo xtask reference` commits.

#![allow(clippy::print_stdout, reason = "what it is for")]

fn main() {
    println!("{:#}", plaus_scenes::scenario::made_schema());
}
