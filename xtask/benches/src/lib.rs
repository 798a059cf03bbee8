//! This package contains only benches: `cargo xtask bench`.
