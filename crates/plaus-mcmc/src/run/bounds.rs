//! Where blocks end: the first ones soon, so that a run can be looked at, stopped and resumed from its first
//! iterations, however slow they are.

/// Blocks grow with the work done, until they have full size. A run that is cut short loses at most one part in this
/// many of its work.
const PART: u64 = 8;

/// End of the block that begins after iterations `0 .. done`; full blocks end at multiples of `block`. It is a function
/// of these two alone, so that a run that was stopped and continued records the same as one that was never stopped.
pub(super) fn end_of_block(done: u64, block: u64) -> u64 {
    let grown = (done / PART).max(1);
    let size = if grown >= block { block } else { 1 << grown.ilog2() };
    (done / size + 1).saturating_mul(size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_grow_to_full_size_and_stay_aligned() {
        let ends = |block: u64| {
            let next = move |&done: &u64| Some(end_of_block(done, block));
            std::iter::successors(Some(end_of_block(0, block)), next)
        };
        assert!(ends(1).take(50).eq(1..=50));
        let early: Vec<u64> = ends(100).take(30).collect();
        assert_eq!(early[..18], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 18, 20]);
        assert!(ends(100).skip_while(|&end| end < 800).take(5).eq([832, 900, 1000, 1100, 1200]));
        // Each block ends where a block that begins anywhere within it would end.
        for end in ends(100).take(60) {
            assert_eq!(end_of_block(end - 1, 100), end);
        }
        assert_eq!(end_of_block((1 << 48) - 1, u64::MAX), 1 << 48);
    }
}
