//! This package contains only tests: `cargo test -p plaus-oracle`.
