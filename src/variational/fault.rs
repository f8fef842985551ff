//! Planted faults, so that tests can show that bounds catch them. Not for users.

use nalgebra::Vector3;

use super::chain::Motion;
use super::force::joint::JointForce;
use super::map::{Map, OwnStep};
use super::rattle::{Failure, Rattle};
use super::tree::spatial::{Spatial, Wrench};
use crate::mechanics::State;

/// A known way to get the method wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The constraint iteration stops at a residual of 1e-8 m.
    LooseTolerance,
    /// Positions, attitudes and momenta are plain sums.
    PlainSums,
    /// A step starts from the joints' impulses on the bodies as they were in the last step: those are not in the range
    /// of `G(q0)^T`.
    WarmBodyImpulses,
    /// Dampers push.
    DampingSign,
    /// The first half kick forgets one force component of the first joint after the drift.
    DroppedMultiplier,
}

/// Where the iteration stops with [`Fault::LooseTolerance`], m.
const LOOSE: f64 = 1e-8;

/// An integrator that makes a known mistake.
#[derive(Clone, Debug)]
pub struct Faulty {
    rattle: Rattle,
    fault: Fault,
    /// What the joints did to the bodies in the first half kicks so far, for [`Fault::WarmBodyImpulses`].
    carried: Vec<Wrench>,
}

impl Faulty {
    pub fn new(mut rattle: Rattle, fault: Fault) -> Faulty {
        match fault {
            Fault::LooseTolerance => rattle = rattle.with_tolerance(LOOSE),
            Fault::DampingSign => {
                let forces = rattle.parts.iter_mut().flat_map(|parts| &mut parts.forces);
                forces.for_each(JointForce::push_instead_of_damping);
            }
            Fault::PlainSums | Fault::WarmBodyImpulses | Fault::DroppedMultiplier => {}
        }
        let carried = vec![Spatial::ZERO; rattle.chain.nodes.len()];
        Faulty { rattle, fault, carried }
    }

    /// [`Fault::WarmBodyImpulses`]: starts from what is carried in place of the joints' impulses.
    fn start_from_carried(&mut self, sign: f64) {
        if self.fault != Fault::WarmBodyImpulses {
            return;
        }
        self.rattle.memory.predictor.clear();
        for (body, carried) in self.rattle.now.bodies.iter_mut().zip(&self.carried) {
            body.p.add(&(sign * carried.linear));
            body.pi.add(&(sign * carried.angular));
        }
    }

    /// [`Fault::WarmBodyImpulses`]: keeps what the joints did to the bodies in the first half kick.
    fn carry(&mut self, h: f64) {
        let (chain, trial) = (&self.rattle.chain, &self.rattle.trial);
        for (i, carried) in self.carried.iter_mut().enumerate().skip(1) {
            let gravity = Spatial::new(0.5 * h * chain.nodes[i].mass * chain.gravity, Vector3::zeros());
            *carried += trial.bodies[i].kick - gravity;
        }
    }

    /// [`Fault::DroppedMultiplier`]: takes one force component of the first joint out of the momenta, with its moment
    /// at the start of the step. With that at the end it would not show: the next step's multipliers would make up for
    /// it.
    fn drop_multiplier(&mut self) {
        let Rattle { now, trial, .. } = &mut self.rattle;
        let (arm, axis) = (now.frames[1].arm, now.pose[1].r.column(0).into_owned());
        let back = Motion { s: -trial.bodies[1].motion.s, ..Motion::NONE };
        let at_start = arm + back.turned(&arm);
        let lost = Spatial::new(-axis * axis.dot(&trial.wrench[1].linear), Vector3::zeros()).wrench_from(&at_start);
        now.bodies[1].p.add(&lost.linear);
        now.bodies[1].pi.add(&lost.angular);
    }

    /// [`Fault::PlainSums`]: drops what the sums keep beside their values.
    fn forget(&mut self) {
        for body in &mut self.rattle.now.bodies {
            body.x.forget();
            body.q.forget();
            body.p.forget();
            body.pi.forget();
        }
    }
}

impl Map for Faulty {
    const STAYS_ON_FAILURE: bool = true;

    fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.start_from_carried(1.0);
        if let Err(failure) = self.rattle.drift_onto_constraints(h) {
            self.start_from_carried(-1.0);
            return Err(failure);
        }
        match self.fault {
            Fault::WarmBodyImpulses => self.carry(h),
            Fault::DroppedMultiplier => self.drop_multiplier(),
            Fault::PlainSums => self.forget(),
            Fault::LooseTolerance | Fault::DampingSign => {}
        }
        self.rattle.kick_onto_constraints(h)
    }

    fn write_state(&self, out: &mut State) {
        self.rattle.write_state(out);
    }

    fn rattle(&self) -> Option<&Rattle> {
        None
    }

    fn before_failure(&self, _h: f64) -> Option<Faulty> {
        Some(self.clone())
    }

    fn own_step(&self) -> Option<OwnStep> {
        None
    }
}
