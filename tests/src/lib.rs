//! Code that several of the tests in `tests/` share.

pub mod law;
