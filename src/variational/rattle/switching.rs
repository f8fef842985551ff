//! Which rule each body turns by, and how a body goes over to another one.

use super::failure::Failure;
use super::state::Rattle;
use crate::variational::chain::Node;
use crate::variational::rotation::Rotation;

impl Rattle {
    /// Turns the bodies by another rule than [`Rotation::MoserVeselov`].
    pub fn with_rotation(mut self, rotation: Rotation) -> Rattle {
        self.memory.rules = rules(&self.chain.nodes, rotation);
        self.settings.automatic = false;
        self
    }

    /// Turns the bodies by [`Rotation::MoserVeselov`] while that has a solution. A body for which it has none goes over
    /// to [`Rotation::Splitting`] for the rest of the run: both maps are symplectic and time-reversible and conserve
    /// energies that differ by `O(h^2)`, so that each body changes the energy that is conserved at most once.
    pub fn with_automatic_rotation(mut self) -> Rattle {
        self.memory.rules = rules(&self.chain.nodes, Rotation::MoserVeselov);
        self.settings.automatic = true;
        self
    }

    /// The bodies that [`Rattle::with_automatic_rotation`] has moved to the splitting, by index, and when (s).
    pub fn switched(&self) -> &[(usize, f64)] {
        &self.memory.switched
    }

    /// (1) to (3), with another rotation rule for the bodies that need one. When that does not help, nothing has
    /// changed.
    pub(super) fn solve_or_switch(&mut self, h: f64) -> Result<(), Failure> {
        let before = self.memory.switched.len();
        loop {
            let failure = match self.solve_constraints(h) {
                Err(failure) if self.settings.automatic => failure,
                result => return result,
            };
            let body = match failure {
                Failure::Rotation { body, .. } => Some(body),
                Failure::Constraint { .. }
                | Failure::Loop { .. }
                | Failure::Leap { .. }
                | Failure::Stalled { .. }
                | Failure::NoStep { .. }
                | Failure::Singular { .. }
                | Failure::NotFinite { .. } => None,
            };
            let candidate = body.filter(|body| self.memory.rules[body + 1] == Rotation::MoserVeselov);
            let Some(body) = candidate else {
                for (body, _) in self.memory.switched.drain(before..) {
                    self.memory.rules[body + 1] = Rotation::MoserVeselov;
                }
                return Err(failure);
            };
            self.memory.rules[body + 1] = Rotation::Splitting;
            self.memory.switched.push((body, self.now.time.value.x));
        }
    }
}

/// The rotation rule of each node: light bodies always turn by [`Rotation::Cayley`].
pub(super) fn rules(nodes: &[Node], rotation: Rotation) -> Vec<Rotation> {
    nodes.iter().map(|node| if node.light { Rotation::Cayley } else { rotation }).collect()
}
