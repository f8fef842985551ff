//! Accelerations in O(n) by articulated bodies (Featherstone 1983), in world axes.
//!
//! Each link is seen at its joint point. With the classical acceleration `a` of that point and the angular acceleration
//! `alpha`, a body needs the wrench `I (a, alpha) + beta`,
//!
//! ```text
//! beta = (omega x (omega x mc) - m g ,  omega x J omega - mc x g) ,
//! ```
//!
//! and is carried along with its parent's acceleration plus `gamma`, what the motion at constant joint velocities
//! gives. One sweep places the links, one eliminates the joints from the leaves to the root, one finds the
//! accelerations.

use crate::reduced::elimination::Elimination;
use crate::reduced::inertia::Inertia;
use crate::reduced::joint::for_kind;
use crate::reduced::joint_frame::JointFrame;
use crate::reduced::link::Link;
use crate::reduced::link_frame::LinkFrame;
use crate::reduced::model::Model;
use crate::reduced::number::linear::{Matrix3, Vector3};
use crate::reduced::spatial::Spatial;
use crate::reduced::spring::LinkMotion;

/// A link in the course of the recursion.
#[derive(Clone, Debug)]
struct LinkState {
    frame: LinkFrame<f64>,
    twist: Spatial<f64>,
    /// Acceleration at constant joint velocities, less what the parent's acceleration gives; then the acceleration.
    motion: Spatial<f64>,
    /// `beta`, summed towards the root.
    needed: Spatial<f64>,
    inertia: Inertia<f64>,
    elimination: Elimination<f64>,
}

/// The equations of motion of a model, with room for their evaluation.
#[derive(Clone, Debug)]
pub struct Articulated {
    model: Model,
    states: Vec<LinkState>,
    /// The joint points, m, world, where springs between points need them.
    origins: Vec<Vector3<f64>>,
}

impl Articulated {
    pub fn new(model: Model) -> Articulated {
        let state = |link: &Link| LinkState {
            frame: LinkFrame::ground(),
            twist: Spatial::zero(),
            motion: Spatial::zero(),
            needed: Spatial::zero(),
            inertia: Inertia::zero(),
            elimination: for_kind!(link.kind, Joint => Joint::elimination()),
        };
        let origins = vec![Vector3::zeros(); if model.springs.is_empty() { 0 } else { model.links.len() }];
        Articulated { states: model.links.iter().map(state).collect(), origins, model }
    }

    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Accelerations of the joint coordinates under gravity, dampers, springs and drives at a time in s. `None` where a
    /// joint can move without moving any mass, or the state is not a number.
    pub fn accelerations(&mut self, time: f64, q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        for i in 0..self.states.len() {
            self.place(i, q, v);
        }
        if !self.model.springs.is_empty() {
            self.pull();
        }
        for i in (0..self.states.len()).rev() {
            let link = &self.model.links[i];
            let (before, rest) = self.states.split_at_mut(i);
            let state = &mut rest[0];
            let rhs = &mut out[link.velocity..link.velocity + link.kind.degrees_of_freedom()];
            self.model.efforts(link, time, q, v, rhs);
            let needed = state.needed + state.inertia.times(&state.motion);
            state.elimination.eliminate(&state.frame.axes, &mut state.inertia)?;
            let passed = state.elimination.inward(rhs, &needed);
            if let Some(p) = link.parent {
                before[p].inertia.add_shifted(&state.inertia, &state.frame.offset);
                before[p].needed += passed.wrench_from(&state.frame.offset);
            }
        }
        for (i, link) in self.model.links.iter().enumerate() {
            let above = link.parent.map_or(Spatial::zero(), |p| self.states[p].motion);
            let state = &mut self.states[i];
            let carried = above.twist_at(&state.frame.offset);
            // `rhs` already holds what `gamma` needs: only the parent's part remains to be taken off.
            state.motion += state.elimination.outward(&mut out[link.velocity..], &carried);
        }
        Some(())
    }

    /// Takes what springs between points exert off the wrenches that the links need.
    fn pull(&mut self) {
        for (i, link) in self.model.links.iter().enumerate() {
            let above = link.parent.map_or(Vector3::zeros(), |p| self.origins[p]);
            self.origins[i] = above + self.states[i].frame.offset;
        }
        for spring in &self.model.springs {
            let (states, origins) = (&self.states, &self.origins);
            let motion = |i: usize| LinkMotion { r: states[i].frame.axes, origin: origins[i], twist: states[i].twist };
            for (link, wrench) in spring.wrenches(motion) {
                if let Some(i) = link {
                    self.states[i].needed += wrench.scaled(-1.0);
                }
            }
        }
    }

    #[inline(always)]
    fn place(&mut self, i: usize, q: &[f64], v: &[f64]) {
        let link = &self.model.links[i];
        let (r, above) = match link.parent {
            Some(p) => (self.states[p].frame.axes, self.states[p].twist),
            None => (Matrix3::identity(), Spatial::zero()),
        };
        let frame = JointFrame::of(link).link_frame(link.kind, &r, &q[link.position..], f64::sin_cos);
        let joint = for_kind!(link.kind, Joint => Joint::twist(&frame.axes, &v[link.velocity..]));
        let swept = above.ang.cross(&frame.offset);
        let omega = above.ang + joint.ang;
        let moment = frame.axes.times(&Vector3::of(&link.first_moment));
        let inertia = Inertia::of_body(link.mass, &moment, &Matrix3::of(&link.inertia), &frame.axes);
        let turning = inertia.times(&Spatial::new(Vector3::zeros(), omega)).ang;
        let gravity = Vector3::of(&self.model.gravity);
        let state = &mut self.states[i];
        state.twist = Spatial::new(above.lin + swept + joint.lin, omega);
        state.motion =
            Spatial::new(above.ang.cross(&(swept + joint.lin)) + omega.cross(&joint.lin), above.ang.cross(&joint.ang));
        state.needed = Spatial::new(
            omega.cross(&omega.cross(&moment)) - gravity * link.mass,
            omega.cross(&turning) - moment.cross(&gravity),
        );
        (state.frame, state.inertia) = (frame, inertia);
    }
}
