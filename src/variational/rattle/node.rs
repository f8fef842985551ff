//! What adaptive steps need of the integrator: a copy of its state, and how fast its bodies turn.

use super::failure::Failure;
use super::state::Rattle;

/// A body's kinetic energy, J, and the square of its angular velocity, rad^2/s^2.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Turning {
    pub kinetic: f64,
    pub omega_squared: f64,
}

impl Rattle {
    /// Takes over the state of another copy of the same integrator, without allocation. It goes on as that one would.
    ///
    /// # Errors
    /// [`Failure::Singular`], where the other could not have been factorised.
    pub(in crate::variational) fn copy_from(&mut self, other: &Rattle) -> Result<(), Failure> {
        self.now.time = other.now.time;
        self.now.bodies.copy_from_slice(&other.now.bodies);
        self.now.pose.copy_from_slice(&other.now.pose);
        self.now.twist.copy_from_slice(&other.now.twist);
        self.trial.bodies.copy_from_slice(&other.trial.bodies);
        self.trial.wrench.copy_from_slice(&other.trial.wrench);
        self.memory.copy_from(&other.memory);
        if let (Some(parts), Some(from)) = (&mut self.parts, &other.parts) {
            parts.copy_from(from);
        }
        self.place_joints();
        self.factorise(0.0)
    }

    /// Time since the start, s.
    pub(in crate::variational) fn time(&self) -> f64 {
        self.now.time.value.x
    }

    /// A length of the system, m.
    pub(in crate::variational) fn length(&self) -> f64 {
        self.chain.length
    }

    /// How the bodies turn in the present state, from the twists that fit the joints.
    pub(in crate::variational) fn turning(&self) -> impl Iterator<Item = Turning> {
        (1..self.chain.nodes.len()).map(|i| {
            let (node, twist) = (&self.chain.nodes[i], self.now.twist[i].twist_at(&-self.now.frames[i].arm));
            let spin = self.now.pose[i].r.tr_mul(&twist.angular);
            let spinning = spin.component_mul(&spin).dot(&node.inertia);
            Turning {
                kinetic: 0.5 * (node.mass * twist.linear.norm_squared() + spinning),
                omega_squared: twist.angular.norm_squared(),
            }
        })
    }
}
