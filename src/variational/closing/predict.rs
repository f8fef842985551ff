//! Where the constraint iteration starts.

use crate::variational::chain::keep_locked;
use crate::variational::rattle::Rattle;
use crate::variational::rattle::kick::kick_joint;
use crate::variational::tree::spatial::Spatial;

impl Rattle {
    /// (1) with wrenches extrapolated by a polynomial of the given degree, or with none.
    pub(super) fn predict(&mut self, h: f64, degree: Option<usize>) {
        let time = self.now.time.value.x;
        if let Some(loops) = self.parts.as_mut().and_then(|parts| parts.loops.as_mut()) {
            loops.predict(time, h, degree);
        }
        let (gravity, nodes, now) = (self.first_kick(h), &self.chain.nodes, &self.now);
        let (predictor, wrench, bodies) = (&self.memory.predictor, &mut self.trial.wrench, &mut self.trial.bodies);
        let weights = degree.map(|degree| predictor.weights(time, h, degree));
        for i in 1..nodes.len() {
            wrench[i] = weights.map_or(Spatial::ZERO, |w| predictor.impulse(&w, i, &now.pose[i]));
            if nodes[i].force.is_none() {
                keep_locked(&nodes[i], &now.frames[i], &mut wrench[i]);
            }
        }
        for i in 1..nodes.len() {
            kick_joint(bodies, nodes, &now.frames, i, &gravity, &wrench[i]);
        }
        self.kick_parts();
        self.start_light(h);
    }
}
