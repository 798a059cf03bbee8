use super::*;
use proptest::prelude::*;

const KIND: Kind = Kind::new(*b"test", 3, "a test value");

type Value = (u64, Vec<f64>, Option<String>);

fn file(values: &[Value]) -> Vec<u8> {
    let mut out = Vec::new();
    for value in values {
        append(KIND, value, &mut out).unwrap();
    }
    out
}

fn read(bytes: &[u8]) -> (Vec<Value>, Option<FrameError>) {
    let mut values = Vec::new();
    for value in Frames::<Value, _>::new(KIND, bytes, bytes.len() as u64) {
        match value {
            Ok(value) => values.push(value),
            Err(error) => return (values, Some(error)),
        }
    }
    (values, None)
}

/// Frames written by this version must be readable by every later one: the bytes are pinned.
#[test]
fn the_bytes_are_pinned() {
    let bytes = encode(KIND, &(300_u64, vec![1.5_f64], Some("x".to_owned()))).unwrap();
    let hex: String = bytes[..HEADER + 14].iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(hex, "89706c6175730d0a74657374030000000f00000000000000fb2c0101000000000000f83f0101");
}

#[test]
fn each_problem_is_named() {
    let good = file(&[(1, vec![0.5], None)]);
    let with = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        decode::<Value>(KIND, &bytes).unwrap_err().problem
    };
    assert!(matches!(with(0, 0), FrameProblem::Magic));
    assert!(matches!(with(8, b'x'), FrameProblem::Kind { .. }));
    assert!(matches!(with(12, 4), FrameProblem::Version { found: 4, known: 3, .. }));
    assert!(matches!(with(16, 200), FrameProblem::Truncated { .. }));
    assert!(matches!(with(23, 1), FrameProblem::TooLong { .. }));
    assert!(matches!(with(HEADER, 9), FrameProblem::Checksum));
    assert!(matches!(decode::<Value>(KIND, b"").unwrap_err().problem, FrameProblem::Truncated { present: 0, .. }));
    let long = [&good[..], b"!"].concat();
    assert!(matches!(decode::<Value>(KIND, &long).unwrap_err().problem, FrameProblem::Trailing { bytes: 1 }));
    let short = encode(KIND, &(1_u64, Vec::<f64>::new())).unwrap();
    assert!(matches!(decode::<Value>(KIND, &short).unwrap_err().problem, FrameProblem::Payload { .. }));
    let more = encode(KIND, &((1_u64, Vec::<f64>::new(), None::<String>), 1_u8)).unwrap();
    assert!(matches!(decode::<Value>(KIND, &more).unwrap_err().problem, FrameProblem::Payload { .. }));
}

/// A payload with a right checksum that claims an absurd length must neither abort nor allocate it.
#[test]
fn absurd_claims_inside_the_payload_fail() {
    for claim in [u64::MAX, 1 << 40, 1 << 31] {
        let bytes = encode(KIND, &(1_u64, claim)).unwrap();
        assert!(matches!(decode::<Value>(KIND, &bytes).unwrap_err().problem, FrameProblem::Payload { .. }));
    }
}

/// Gives at most this many bytes at a time, as a pipe or a network disk may.
struct Slow<'a>(&'a [u8], usize);

impl Read for Slow<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let most = self.1.min(buffer.len());
        self.0.read(&mut buffer[..most])
    }
}

/// Frames that are shorter and longer than one read: passed on in parts, they are the whole file.
#[test]
fn the_parts_passed_on_are_the_file() {
    let lengths = [0, 3, 40_000, 1, 2, 33_000, 32_760, 32_761, 32_762, 0, 90_000, 5];
    let values: Vec<Value> = (0..).zip(lengths).map(|(k, length)| (k, vec![0.5; length], None)).collect();
    let bytes = file(&values);
    for at_a_time in [7_777, usize::MAX] {
        let mut frames = Frames::<(), _>::new(KIND, Slow(&bytes, at_a_time), bytes.len() as u64);
        let (mut passed, mut parts, mut count) = (Vec::new(), 0, 0);
        while let Some(frame) = frames.next_raw() {
            assert_eq!(decode::<Value>(KIND, frame.unwrap()).unwrap(), values[count]);
            count += 1;
            if let Some(part) = frames.passed() {
                passed.extend_from_slice(part);
                parts += 1;
            }
        }
        assert_eq!(count, values.len());
        assert!(passed == bytes && parts < count, "{parts} parts of {count} frames");
    }
}

fn values() -> impl Strategy<Value = Vec<Value>> {
    let value = (any::<u64>(), prop::collection::vec(-1e300..1e300, 0..9), any::<Option<String>>());
    prop::collection::vec(value, 1..5)
}

proptest! {
    #[test]
    fn written_values_are_read_back(values in values()) {
        prop_assert_eq!(read(&file(&values)), (values, None));
    }

    #[test]
    fn any_changed_byte_is_noticed(values in values(), at in any::<prop::sample::Index>(), flip in 1..=255_u8) {
        let mut bytes = file(&values);
        let at = at.index(bytes.len());
        bytes[at] ^= flip;
        let (intact, error) = read(&bytes);
        let offset = error.expect("the change is noticed").offset;
        prop_assert!(offset <= at as u64);
        prop_assert_eq!(&intact[..], &values[..intact.len()]);
        prop_assert_eq!(file(&intact).len() as u64, offset);
    }

    #[test]
    fn any_cut_is_noticed(values in values(), at in any::<prop::sample::Index>()) {
        let bytes = file(&values);
        let at = at.index(bytes.len());
        let (intact, error) = read(&bytes[..at]);
        prop_assert_eq!(&intact[..], &values[..intact.len()]);
        prop_assert_eq!(file(&intact).len() == at, error.is_none());
    }

    #[test]
    fn any_bytes_at_all_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let (values, error) = read(&bytes);
        prop_assert!(values.is_empty() && error.is_none() == bytes.is_empty());
    }
}

impl PartialEq for FrameError {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}
