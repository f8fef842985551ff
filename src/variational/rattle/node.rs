//! What adaptive steps need of the integrator: a copy of its state, and how fast its bodies turn.

use super::{Failure, Rattle};

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
        self.bodies.copy_from_slice(&other.bodies);
        self.pose.copy_from_slice(&other.pose);
        self.trial.copy_from_slice(&other.trial);
        self.wrench.copy_from_slice(&other.wrench);
        self.twist.copy_from_slice(&other.twist);
        self.rules.copy_from_slice(&other.rules);
        self.switched.clear();
        self.switched.extend_from_slice(&other.switched);
        self.predictor.copy_from(&other.predictor);
        self.forces.iter_mut().zip(&other.forces).for_each(|(force, from)| force.copy_from(from));
        if let (Some(loops), Some(from)) = (&mut self.loops, &other.loops) {
            loops.copy_from(from);
        }
        (self.time, self.rounds, self.contraction) = (other.time, other.rounds, other.contraction);
        self.place_joints();
        self.factorise(0.0)
    }

    /// Time since the start, s.
    pub(in crate::variational) fn time(&self) -> f64 {
        self.time.value.x
    }

    /// A length of the system, m.
    pub(in crate::variational) fn length(&self) -> f64 {
        self.length
    }

    /// How the bodies turn in the present state, from the twists that fit the joints.
    pub(in crate::variational) fn turning(&self) -> impl Iterator<Item = Turning> {
        (1..self.nodes.len()).map(|i| {
            let (node, twist) = (&self.nodes[i], self.twist[i].twist_at(&-self.places[i].arm));
            let spin = self.pose[i].r.tr_mul(&twist.angular);
            let spinning = spin.component_mul(&spin).dot(&node.inertia);
            Turning {
                kinetic: 0.5 * (node.mass * twist.linear.norm_squared() + spinning),
                omega_squared: twist.angular.norm_squared(),
            }
        })
    }
}
