//! Prints the JSON Schema of scenario files as their types make it: what `cargo xtask reference` commits.

fn main() {
    println!("{:#}", plaus_scenes::scenario::made_schema());
}
