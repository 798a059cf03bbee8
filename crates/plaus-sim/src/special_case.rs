//! Special cases of the narrow phase and of times of impact: what is found in another way than by convex pieces. With
//! the feature `leave-out`, which only a bench turns on, each can be left out, so that its pairs take the general way;
//! without it, none can, and asking costs nothing.

#[cfg(feature = "leave-out")]
static LEFT_OUT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);

#[cfg(feature = "leave-out")]
static MET: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpecialCase {
    /// Two balls.
    Balls,
    /// Bodies of revolution and balls, by the balls and rings of their skins.
    RevolvedAndBall,
    /// Two bodies of revolution, likewise.
    Revolved,
    /// Bodies of revolution and large boxes, likewise.
    RingsOnBoxes,
    /// Flat faces of fixed parts as half spaces.
    Faces,
    /// Flush faces of several parts as one.
    Regions,
    /// Contact spheres and rings on half spaces.
    SpheresOnPlanes,
    /// A ball on a half space.
    BallOnPlane,
    /// The lowest point of a rim.
    Rim,
    /// Capsules around bodies.
    Capsules,
    /// A ball on a curved track.
    BallOnArc,
    /// A ball on triangles.
    BallOnMesh,
    /// What was found of two pieces, at the next time.
    Remembered,
    /// The best of the pieces' axes.
    BestAxis,
    /// All parts, where there are few.
    FewParts,
    /// Pairs that are not within a gap.
    MayBeWithin,
    /// A ball and a box.
    BallAndBox,
}

impl SpecialCase {
    /// All of them, with their names.
    pub const ALL: [(&str, Self); 17] = [
        ("two balls", Self::Balls),
        ("revolution and ball", Self::RevolvedAndBall),
        ("two of revolution", Self::Revolved),
        ("rings on boxes", Self::RingsOnBoxes),
        ("faces as planes", Self::Faces),
        ("flush faces", Self::Regions),
        ("spheres on planes", Self::SpheresOnPlanes),
        ("ball on plane", Self::BallOnPlane),
        ("lowest of a rim", Self::Rim),
        ("capsules", Self::Capsules),
        ("ball on arc", Self::BallOnArc),
        ("ball on mesh", Self::BallOnMesh),
        ("pairs remembered", Self::Remembered),
        ("best axis", Self::BestAxis),
        ("few parts", Self::FewParts),
        ("may be within", Self::MayBeWithin),
        ("ball and box", Self::BallAndBox),
    ];

    /// Whether it is treated as one.
    #[inline]
    #[must_use]
    pub(crate) fn is_on(self) -> bool {
        #[cfg(feature = "leave-out")]
        {
            use std::sync::atomic::Ordering::Relaxed;
            let bit = 1 << (self as u32);
            if MET.load(Relaxed) & bit == 0 {
                MET.fetch_or(bit, Relaxed);
            }
            LEFT_OUT.load(Relaxed) & bit == 0
        }
        #[cfg(not(feature = "leave-out"))]
        true
    }

    /// Whether it was met since it was last asked for this; then it counts as not met.
    #[cfg(feature = "leave-out")]
    pub fn take_met() -> Vec<bool> {
        let bits = MET.swap(0, std::sync::atomic::Ordering::Relaxed);
        (0..Self::ALL.len()).map(|k| bits >> k & 1 == 1).collect()
    }

    /// From now on, all worlds do without these.
    #[cfg(feature = "leave-out")]
    pub fn leave_out(cases: &[Self]) {
        let bits = cases.iter().fold(0, |bits, &case| bits | 1 << case as u32);
        LEFT_OUT.store(bits, std::sync::atomic::Ordering::Relaxed);
    }
}
