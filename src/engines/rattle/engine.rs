//! A map with what a run needs beside its steps: names, the state before a step that fails, words.

use super::explain::Failed;
use super::messages::Names;
use super::remarks::{self, Told};
use crate::engines::engine::{Engine, SolverCounters, StepFailure};
use crate::mechanics::{State, System};
use crate::variational::Failure;

/// A map that takes the steps of a run.
pub(super) struct RattleEngine<M> {
    map: M,
    step: f64,
    taken: u64,
    names: Names,
    /// The state before the present step.
    before: State,
    /// Whether the map was lost on the way through a step, so that the state is the one before.
    lost: bool,
    /// What a reader should know of the method.
    remark: Option<&'static str>,
}

impl<M: Told> RattleEngine<M> {
    pub(super) fn new(map: M, system: &System, step: f64, remark: Option<&'static str>) -> RattleEngine<M> {
        let (names, before) = (Names::of(system), system.initial.clone());
        RattleEngine { map, step, taken: 0, names, before, lost: false, remark }
    }
}

impl<M: Told> Engine for RattleEngine<M> {
    fn step(&mut self) -> Result<(), StepFailure> {
        if !M::STAYS_ON_FAILURE {
            self.map.write_state(&mut self.before);
        }
        let Err(failure) = self.map.step(self.step) else {
            self.taken += 1;
            return Ok(());
        };
        if M::STAYS_ON_FAILURE {
            self.map.write_state(&mut self.before);
        }
        self.lost = !M::STAYS_ON_FAILURE;
        let (time, before, names) = (self.taken as f64 * self.step, &self.before, &self.names);
        let detail = Failed { map: &self.map, failure, time, step: self.step, before, names }.explain();
        Err(match failure {
            Failure::NotFinite { .. } => StepFailure::Diverged { detail },
            Failure::Rotation { .. }
            | Failure::Constraint { .. }
            | Failure::Loop { .. }
            | Failure::Leap { .. }
            | Failure::Stalled { .. }
            | Failure::NoStep { .. }
            | Failure::Singular { .. } => StepFailure::NotConverged { detail },
        })
    }

    fn write_state(&self, out: &mut State) {
        if self.lost {
            out.clone_from(&self.before);
        } else {
            self.map.write_state(out);
        }
    }

    fn chooses_its_steps(&self) -> bool {
        self.map.own_step().is_some()
    }

    fn solver(&self) -> Option<SolverCounters> {
        let counters = self.map.rattle()?.counters();
        Some(SolverCounters {
            solves: counters.solves,
            rounds: counters.rounds,
            refactorisations: counters.refactorisations,
            restarts: counters.restarts,
            steps_in_halves: self.map.steps_in_halves(),
            endings: counters.endings().map(|(ending, count)| (ending.name(), count)).collect(),
        })
    }

    fn remarks(&self) -> Vec<String> {
        let switched = self.map.rattle().map_or(&[][..], |rattle| rattle.switched());
        let switched = switched.iter().map(|&(body, time)| remarks::switched(&self.names.bodies[body], time));
        let told = self.remark.map(str::to_string).into_iter().chain(switched);
        told.chain(self.map.steps(self.step, self.taken)).collect()
    }
}
