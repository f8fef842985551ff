//! An engine that is watched: how far its joints part, and where its bodies are at agreed times.

use crate::engines::{Engine, SolverCounters, StepFailure};
use crate::measure::Horizon;
use crate::measure::scales::LinkLengths;
use crate::mechanics::coordinates::{JointCoordinates, joint_coordinates};
use crate::mechanics::{State, System};
use crate::numeric::larger;

/// The run is cut into so many parts; states are compared at the end of each.
pub(crate) const SAMPLES: u64 = 20;

/// Joints are looked at after at most so many steps of a run, evenly spread.
const LOOKS: u64 = 2000;

/// An engine with what is seen of it.
pub(crate) struct Watched<'a> {
    engine: Box<dyn Engine>,
    system: &'a System,
    links: LinkLengths,
    horizon: Horizon,
    taken: u64,
    state: State,
    coordinates: Vec<JointCoordinates>,
    /// Largest gap so far: over the length of a link, or rad.
    pub joint_gap: f64,
    /// The number of each sample that falls on a step, 1 to [`SAMPLES`], with the state there.
    pub samples: Vec<(u64, State)>,
}

impl<'a> Watched<'a> {
    pub fn new(engine: Box<dyn Engine>, system: &'a System, horizon: Horizon) -> Watched<'a> {
        Watched {
            engine,
            system,
            links: LinkLengths::of(system),
            horizon,
            taken: 0,
            state: system.initial.clone(),
            coordinates: system.initial_coordinates.clone(),
            joint_gap: 0.0,
            samples: Vec::new(),
        }
    }

    /// The sample that is due after the present step, if one is.
    fn sample(&self) -> Option<u64> {
        let (part, steps) = (self.taken * SAMPLES, self.horizon.steps);
        part.is_multiple_of(steps).then_some(part / steps)
    }

    /// Steps between two looks.
    fn stride(&self) -> u64 {
        self.horizon.steps.div_ceil(LOOKS)
    }

    fn look(&mut self) {
        joint_coordinates(self.system, &self.state, &mut self.coordinates);
        let bodies = self.system.bodies.iter().zip(&self.state.bodies).zip(&self.coordinates);
        for ((body, state), coordinates) in bodies {
            let joint = &body.joint;
            let ground = joint.parent.map(|p| self.state.bodies[p].pose());
            let above = ground.map_or(joint.in_parent, |pose| pose * joint.in_parent);
            let allowed = above * joint.kind.transform(&coordinates.position);
            let gap = allowed.inv_mul(&(state.pose() * joint.in_child));
            self.joint_gap = larger(self.joint_gap, gap.translation.vector.norm() / self.links.mean);
            self.joint_gap = larger(self.joint_gap, gap.rotation.angle());
        }
        for closure in &self.system.parts.loops {
            let locked = (0..6).filter(|&i| closure.locked()[i]);
            for (component, residual) in locked.zip(closure.residual(&self.state).0) {
                let scale = if component < 3 { self.links.mean } else { 1.0 };
                self.joint_gap = larger(self.joint_gap, residual.abs() / scale);
            }
        }
    }
}

impl Engine for Watched<'_> {
    fn step(&mut self) -> Result<(), StepFailure> {
        self.engine.step()?;
        self.taken += 1;
        let sample = self.sample();
        if sample.is_some() || self.taken.is_multiple_of(self.stride()) {
            self.engine.write_state(&mut self.state);
            self.look();
        }
        if let Some(sample) = sample {
            self.samples.push((sample, self.state.clone()));
        }
        Ok(())
    }

    fn write_state(&self, out: &mut State) {
        self.engine.write_state(out);
    }

    fn position_lag_s(&self) -> f64 {
        self.engine.position_lag_s()
    }

    fn solver(&self) -> Option<SolverCounters> {
        self.engine.solver()
    }

    fn chooses_its_steps(&self) -> bool {
        self.engine.chooses_its_steps()
    }
}
