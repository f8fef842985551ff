//! Planted faults, so that tests can show that bounds catch them.

use nalgebra::Vector3;

use super::Rattle;
use crate::variational::fault::{Fault, LOOSE};
use crate::variational::forces::JointForce;
use crate::variational::joints::Motion;
use crate::variational::spatial::Spatial;

impl Rattle {
    /// Plants a fault, for tests of what checks catch.
    #[doc(hidden)]
    pub fn with_fault(mut self, fault: Fault) -> Rattle {
        match fault {
            Fault::LooseTolerance => self.tolerance = LOOSE,
            Fault::WarmBodyImpulses => self.carried = Some(vec![Spatial::ZERO; self.nodes.len()]),
            Fault::DampingSign => self.forces.iter_mut().for_each(JointForce::push_instead_of_damping),
            Fault::PlainSums | Fault::DroppedMultiplier => {}
        }
        Rattle { fault: Some(fault), ..self }
    }

    /// What the fault does between the drift and the second half kick.
    pub(super) fn do_wrong(&mut self, h: f64) {
        match self.fault {
            Some(Fault::WarmBodyImpulses) => self.carry(h),
            Some(Fault::DroppedMultiplier) => self.drop_multiplier(),
            Some(Fault::PlainSums) => self.forget(),
            Some(Fault::LooseTolerance | Fault::DampingSign) | None => {}
        }
    }

    /// [`Fault::WarmBodyImpulses`]: keeps what the joints did to the bodies in the first half kick.
    fn carry(&mut self, h: f64) {
        let Some(carried) = &mut self.carried else { return };
        for i in 1..carried.len() {
            let gravity = Spatial::new(0.5 * h * self.nodes[i].mass * self.gravity, Vector3::zeros());
            carried[i] = self.trial[i].kick - gravity;
        }
    }

    /// [`Fault::DroppedMultiplier`]: takes one force component of the first joint out of the momenta, with its moment at the start
    /// of the step. With that at the end it would not show: the next step's multipliers would make up for it.
    fn drop_multiplier(&mut self) {
        let (arm, axis) = (self.places[1].arm, self.pose[1].r.column(0).into_owned());
        let back = Motion { s: -self.trial[1].motion.s, ..Motion::NONE };
        let at_start = arm + back.turned(&arm);
        let lost = Spatial::new(-axis * axis.dot(&self.wrench[1].linear), Vector3::zeros()).wrench_from(&at_start);
        self.bodies[1].p.add(&lost.linear);
        self.bodies[1].pi.add(&lost.angular);
    }

    /// [`Fault::PlainSums`]: drops what the sums keep beside their values.
    fn forget(&mut self) {
        for body in &mut self.bodies {
            body.x.forget();
            body.q.forget();
            body.p.forget();
            body.pi.forget();
        }
    }
}
