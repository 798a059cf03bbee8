//! Reads files that were damaged at random: bytes changed, left out, doubled, and ends cut off. A panic ends it. It
//! tells the slowest reading of each file, and the most memory.
//!
//! ```sh
//! cargo run --release -p plaus-asset --example mutated -- 100000 FILE …
//! ```

#![allow(clippy::print_stdout, reason = "what it is for")]
#![allow(clippy::disallowed_methods, reason = "it is about time")]

use std::time::Instant;

/// Uniform numbers, by Knuth's linear congruential generator (MMIX).
struct Uniform(u64);

impl Uniform {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % count.max(1)
    }
}

fn damaged(whole: &[u8], uniform: &mut Uniform) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..=uniform.below(3) {
        let at = uniform.below(bytes.len());
        let more = uniform.below(16).min(bytes.len() - at);
        match uniform.below(5) {
            0 => drop(bytes.drain(at..at + more)),
            1 => bytes.extend_from_within(at..at + more),
            2 => bytes.truncate(at),
            3 => bytes[at..at + more].fill(uniform.below(256) as u8),
            // Numbers are what damage that is not found at once changes.
            _ => match bytes[at..].iter().position(u8::is_ascii_digit) {
                Some(digit) => bytes[at + digit] = b"0123456789-e."[uniform.below(13)],
                None => bytes[at] = uniform.below(256) as u8,
            },
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

fn main() -> std::io::Result<()> {
    let mut said = std::env::args().skip(1);
    let count: usize = said.next().and_then(|count| count.parse().ok()).unwrap_or(1000);
    let mut uniform = Uniform(1);
    for path in said {
        let whole = std::fs::read(&path)?;
        let is_model = path.ends_with(".xml") || path.ends_with(".urdf");
        let (mut slowest, mut refused) = (0.0_f64, 0);
        for _ in 0..count {
            let bytes = damaged(&whole, &mut uniform);
            let begun = Instant::now();
            let is_read = if is_model {
                plaus_asset::read_model(&bytes, &mut |_| Err("none".into())).is_ok()
            } else if plaus_asset::Format::is_usd(&path) {
                let name = path.rsplit('/').next().unwrap_or_default();
                let packed = plaus_asset::usd::packed(name, &bytes, &mut |_| Err("none".into()));
                packed.is_ok_and(|glb| plaus_asset::read_any("a.glb", &glb).is_ok())
            } else {
                plaus_asset::read_any(&path, &bytes).is_ok()
            };
            slowest = slowest.max(begun.elapsed().as_secs_f64());
            refused += usize::from(!is_read);
        }
        println!("{path}: {count} damaged, {refused} refused, the slowest in {:.1} ms", 1e3 * slowest);
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status.lines().filter(|line| line.starts_with("VmHWM")).for_each(|line| println!("{line}"));
    Ok(())
}
