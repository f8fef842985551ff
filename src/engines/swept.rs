//! The settings that a sweep tries, with the numbers of steps that they are run with over its whole time.

/// A setting of an engine.
#[derive(Debug)]
pub(crate) struct Swept {
    pub spec: &'static str,
    pub counts: &'static [u64],
    /// In a quick sweep; empty where it is left out.
    pub quick: &'static [u64],
}

impl Swept {
    /// Left out of quick sweeps.
    pub(super) const fn full(spec: &'static str, counts: &'static [u64]) -> Swept {
        Swept { spec, counts, quick: &[] }
    }

    pub(super) const fn both(spec: &'static str, counts: &'static [u64], quick: &'static [u64]) -> Swept {
        Swept { spec, counts, quick }
    }
}

/// Steps over the whole time: for methods of high order, of order two, and of order one. The rivals at small errors,
/// compositions of high order, Galerkin methods and `dop853`, have neighbours whose costs differ by an eighth to a
/// third there: with wider gaps a cost would say more about the list than about the engine.
pub(crate) const LONG_STEPS: &[u64] = &[20, 40, 100, 200, 400, 1000, 2000];
pub(crate) const COMPOSED_STEPS: &[u64] = &[20, 40, 60, 80, 100, 140, 200, 260, 340, 400, 500, 600, 800, 1000, 2000];
pub(crate) const STEPS: &[u64] = &[40, 100, 200, 400, 1000, 2000, 4000, 10_000, 20_000];
pub(crate) const SHORT_STEPS: &[u64] = &[100, 200, 400, 1000, 2000, 4000, 10_000, 20_000];
/// For the settings of rapier that gain most by short steps, and those whose error stops falling.
pub(crate) const SHORTEST_STEPS: &[u64] = &[100, 200, 400, 1000, 2000, 4000, 10_000, 20_000, 40_000, 100_000];
/// For methods whose steps may be longer than the interval between two samples: every second, fourth or fifth is met
/// then.
pub(crate) const LONGEST_STEPS: &[u64] = &[4, 10, 20, 40, 60, 100, 200, 400, 1000];
pub(crate) const GALERKIN_STEPS: &[u64] =
    &[4, 5, 8, 10, 12, 16, 20, 25, 30, 35, 40, 50, 60, 70, 80, 100, 120, 140, 160, 200, 260, 400, 1000];
/// Engines whose error a tolerance controls: the state is read seldom, so that reading does not shorten their steps,
/// and at every sample.
pub(crate) const READ: &[u64] = &[4, 10, 20];

pub(crate) const QUICK_LONG_STEPS: &[u64] = &[20, 100, 400];
pub(crate) const QUICK_SHORT_STEPS: &[u64] = &[200, 1000, 4000];
pub(crate) const QUICK_COMPOSED_STEPS: &[u64] = &[20, 60, 80, 100, 140, 200, 400];
pub(crate) const QUICK_GALERKIN_STEPS: &[u64] = &[5, 10, 20, 25, 30, 40, 50, 60, 80, 100, 140, 200, 400];
