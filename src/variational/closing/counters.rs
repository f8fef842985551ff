//! What solves took.

use super::stop::Ending;

/// What the solves of a run took, from its start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Steps of the map that were solved.
    pub solves: u64,
    /// Rounds of the constraint iteration, those of solves that failed included.
    pub rounds: u64,
    /// Exact linearisations, each of which factorises anew.
    pub refactorisations: u64,
    /// Solves that began again, from no impulses.
    pub restarts: u64,
    /// How many solves each of [`Ending::ALL`] has ended.
    endings: [u64; Ending::ALL.len()],
}

impl Counters {
    /// Takes in how a solve has ended.
    pub(super) fn end(&mut self, ending: Ending) {
        self.solves += 1;
        self.endings[ending as usize] += 1;
    }

    /// How many solves each rule has ended.
    pub fn endings(&self) -> impl Iterator<Item = (Ending, u64)> {
        Ending::ALL.into_iter().zip(self.endings)
    }
}
