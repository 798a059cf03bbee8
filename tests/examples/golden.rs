//! The golden traces, compared by a program that is built as `plaus` is. A test is not: it unwinds where it fails, and
//! all that it needs would be built a second time.

#[allow(dead_code, unused_imports, reason = "the rest is for the tests")]
#[path = "../tests/golden.rs"]
mod golden;

fn main() {
    golden::compare();
    golden::simulator::compare();
}
