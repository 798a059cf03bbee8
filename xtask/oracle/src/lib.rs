//! Nothing but tests: `cargo test -p plaus-oracle`.
