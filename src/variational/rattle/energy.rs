//! The discrete energy of a step.

use super::state::Rattle;

/// A discrete energy and the sum of the sizes of its terms, J.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct DiscreteEnergy {
    pub energy: f64,
    pub size: f64,
}

impl Rattle {
    /// The discrete energy of the step of size `h` (s) that was taken last (Marsden and West 2001, sections 4.5 and
    /// 4.9),
    ///
    /// ```text
    /// E_d = -d/dh L_d(q0, q1, h) = sum_b m |x1 - x0|^2 / (2 h^2) + T_b(F)/h^2 - m g . (x0 + x1)/2 + V_s(q0, q1)
    /// ```
    ///
    /// at fixed ends, where `T_b / h` is the rotational part of `L_d` ([`Rotation::action`]) and `V_s` the potential of
    /// the springs in the middle of the step. For a system without dampers and drives.
    pub(in crate::variational) fn discrete_energy(&self, h: f64) -> DiscreteEnergy {
        let (mut kinetic, mut potential, mut size) = (0.0, 0.0, 0.0);
        for i in 1..self.chain.nodes.len() {
            let (node, body, trial) = (&self.chain.nodes[i], &self.now.bodies[i], &self.trial.bodies[i]);
            let turning = self.memory.rules[i].action(&node.inertia, &trial.s, &trial.hm);
            kinetic += (0.5 * node.mass * trial.motion.dx.norm_squared() + turning) / (h * h);
            let middle = body.x.value - 0.5 * trial.motion.dx;
            potential -= node.mass * self.chain.gravity.dot(&middle);
            size += node.mass * self.chain.gravity.norm() * middle.norm();
        }
        let joints: f64 = self.parts.iter().flat_map(|parts| &parts.forces).map(|force| force.potential()).sum();
        let loops = self.parts.as_ref().and_then(|parts| parts.loops.as_ref());
        let springs = joints + loops.map_or(0.0, |loops| loops.potential());
        DiscreteEnergy { energy: kinetic + (potential + springs), size: kinetic + size + springs }
    }

    /// Keeps the rotation rules of the bodies from now on: each has a discrete energy of its own.
    pub(in crate::variational) fn keep_rotation(&mut self) {
        self.settings.automatic = false;
    }
}
