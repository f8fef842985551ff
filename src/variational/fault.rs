//! Planted faults, so that tests can show that bounds catch them. Not for users.

/// A known way to get the method wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The constraint iteration stops at a residual of 1e-8 m.
    LooseTolerance,
    /// Positions, attitudes and momenta are plain sums.
    PlainSums,
    /// A step starts from the joints' impulses on the bodies as they were in the last step: those are not in the range of
    /// `G(q0)^T`.
    WarmBodyImpulses,
    /// Dampers push.
    DampingSign,
    /// The first half kick forgets one force component of the first joint after the drift.
    DroppedMultiplier,
}

/// Where the iteration stops with [`Fault::LooseTolerance`], m.
pub(super) const LOOSE: f64 = 1e-8;
