//! Mass matrix by composite rigid bodies and bias force by recursive Newton-Euler, in link axes (Featherstone, Rigid
//! Body Dynamics Algorithms, 2008, sections 5.3 and 6.2).
//!
//! With the motion subspace `S` of each joint, the velocity and acceleration of link `i` are
//!
//! ```text
//! V_i = X V_parent + S v_i ,     A_i = X A_parent + S a_i + V_i x S v_i ,     A_ground = -g ,
//! ```
//!
//! the wrench that it needs is `F_i = I_i A_i + V_i x* I_i V_i`, summed towards the root, and the joint force is
//! `S^T F_i`.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::loops::Loops;
use crate::reduced::model::Model;
use crate::reduced::number::linear;
use crate::reduced::spring::End;

/// A twist (linear, angular) at the origin of a link frame, or a wrench (force, torque) about it, in link axes.
type Pair = (Vector3<f64>, Vector3<f64>);

/// A rigid body inertia about the origin of a link frame.
#[derive(Clone, Copy, Debug)]
struct Rigid {
    mass: f64,
    first_moment: Vector3<f64>,
    inertia: Matrix3<f64>,
}

impl Rigid {
    /// `p = m v + omega x mc`, `L = J omega + mc x v`.
    fn times(&self, (v, omega): &Pair) -> Pair {
        (self.mass * v + omega.cross(&self.first_moment), self.inertia * omega + self.first_moment.cross(v))
    }

    /// The same inertia in the parent's frame, in which this frame has axes `r` and origin `at`.
    fn carried(&self, r: &Matrix3<f64>, at: &Vector3<f64>) -> Rigid {
        let moment = r * self.first_moment;
        let far = self.mass * at + moment;
        let cross = at.cross_matrix();
        // J + terms of the parallel axis theorem about a point that is not the centre of mass
        let inertia = r * self.inertia * r.transpose() - cross * moment.cross_matrix() - far.cross_matrix() * cross;
        Rigid { mass: self.mass, first_moment: far, inertia }
    }

    fn plus(&self, other: &Rigid) -> Rigid {
        Rigid {
            mass: self.mass + other.mass,
            first_moment: self.first_moment + other.first_moment,
            inertia: self.inertia + other.inertia,
        }
    }
}

/// The dense equations of motion `H(q) a + b(q, v) = tau`, with room for their evaluation.
#[derive(Clone, Debug)]
pub struct Dynamics {
    model: Model,
    /// Axes and origin of each link frame in the parent's link frame.
    places: Vec<(Matrix3<f64>, Vector3<f64>)>,
    twists: Vec<Pair>,
    accelerations: Vec<Pair>,
    wrenches: Vec<Pair>,
    /// Axes and origin of each link frame in the world, where springs between points need them.
    world: Vec<(Matrix3<f64>, Vector3<f64>)>,
    composites: Vec<Rigid>,
    mass: DMatrix<f64>,
    force: DVector<f64>,
    loops: Option<Loops>,
}

impl Dynamics {
    pub fn new(model: Model) -> Dynamics {
        let (n, zero) = (model.links.len(), (Vector3::zeros(), Vector3::zeros()));
        let rigid = Rigid { mass: 0.0, first_moment: Vector3::zeros(), inertia: Matrix3::zeros() };
        Dynamics {
            places: vec![(Matrix3::identity(), Vector3::zeros()); n],
            twists: vec![zero; n],
            accelerations: vec![zero; n],
            wrenches: vec![zero; n],
            world: vec![(Matrix3::identity(), Vector3::zeros()); if model.springs.is_empty() { 0 } else { n }],
            composites: vec![rigid; n],
            mass: DMatrix::zeros(model.velocities, model.velocities),
            force: DVector::zeros(model.velocities),
            loops: Loops::new(&model),
            model,
        }
    }

    pub fn model(&self) -> &Model {
        &self.model
    }

    fn place(&mut self, q: &[f64]) {
        for i in 0..self.model.links.len() {
            let pose = self.model.links[i].in_parent * self.model.transform(i, q);
            self.places[i] = (pose.rotation.to_rotation_matrix().into_inner(), pose.translation.vector);
        }
    }

    /// Joint forces that give the accelerations `a` at the positions and velocities given: inverse dynamics. Dampers,
    /// springs and drives are not part of them.
    pub fn inverse(&mut self, q: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        self.place(q);
        self.newton_euler(v, Some(a));
        self.sum_wrenches();
        out.copy_from_slice(self.force.as_slice());
    }

    /// The mass matrix `H(q)`.
    pub fn mass_matrix(&mut self, q: &[f64]) -> &DMatrix<f64> {
        self.place(q);
        self.composite_bodies();
        &self.mass
    }

    /// Accelerations of the joint coordinates under gravity, dampers, springs and drives at a time in s:
    /// `H a = tau - b`. Loops and mimic joints add the least `J^T lambda` that holds them. `None` where the mass matrix
    /// is not positive definite or not a number, or a loop where its path may fork.
    pub fn accelerations(&mut self, time: f64, q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        self.place(q);
        self.newton_euler(v, None);
        self.pull();
        self.sum_wrenches();
        self.composite_bodies();
        self.force.neg_mut();
        for link in &self.model.links {
            let mut efforts = [0.0; 6];
            let freedoms = link.kind.degrees_of_freedom();
            self.model.efforts(link, time, q, v, &mut efforts[..freedoms]);
            for (k, effort) in efforts[..freedoms].iter().enumerate() {
                self.force[link.velocity + k] += effort;
            }
        }
        let factor = self.mass.clone().cholesky()?;
        factor.solve_mut(&mut self.force);
        if let Some(loops) = &mut self.loops {
            loops.evaluate(&self.model, q, v);
            self.force += loops.least(factor.l_dirty(), &loops.acceleration_gap(&self.force))?;
        }
        out.copy_from_slice(self.force.as_slice());
        Some(())
    }

    /// Takes positions and velocities back to `phi(q) = 0`, `J v = 0`, by one Gauss-Newton step of the positions: what
    /// is taken back is of the size of a step's error, and its square is below roundoff. Both changes are the least in
    /// the metric of the mass matrix. Returns the loop that stays farthest open, and by how much (m or rad); `None`
    /// where [`accelerations`](Self::accelerations) has none.
    pub fn project(&mut self, q: &mut [f64], v: &mut [f64]) -> Option<(String, f64)> {
        if self.loops.is_none() {
            return Some((String::new(), 0.0));
        }
        self.place(q);
        self.composite_bodies();
        let factor = self.mass.clone().cholesky()?;
        let loops = self.loops.as_mut()?;
        loops.evaluate(&self.model, q, v);
        let change = loops.least(factor.l_dirty(), &-&loops.open)?;
        self.model.advance(q, change.as_slice(), 1.0);
        self.model.normalise(q);
        loops.evaluate(&self.model, q, v);
        let change = loops.least(factor.l_dirty(), &loops.velocity_gap(v))?;
        v.iter_mut().zip(&change).for_each(|(v, change)| *v += change);
        Some(loops.widest())
    }

    /// Leaves the wrench that each link needs by itself in `wrenches`.
    fn newton_euler(&mut self, v: &[f64], a: Option<&[f64]>) {
        let zero = (Vector3::zeros(), Vector3::zeros());
        for i in 0..self.model.links.len() {
            let link = &self.model.links[i];
            let (r, at) = &self.places[i];
            let (above, carried) = match link.parent {
                Some(p) => (self.twists[p], self.accelerations[p]),
                None => (zero, (-self.model.gravity, Vector3::zeros())),
            };
            let down = |(lin, ang): &Pair| (r.tr_mul(&(lin + ang.cross(at))), r.tr_mul(ang));
            let (joint, thrust) =
                (self.model.relative_twist(i, v), a.map_or(zero, |a| self.model.relative_twist(i, a)));
            let (lin, ang) = down(&above);
            let twist = (lin + joint.0, ang + joint.1);
            let (lin, ang) = down(&carried);
            let acceleration = (
                lin + thrust.0 + twist.1.cross(&joint.0) + twist.0.cross(&joint.1),
                ang + thrust.1 + twist.1.cross(&joint.1),
            );
            let body = Rigid { mass: link.mass, first_moment: link.first_moment, inertia: link.inertia };
            let (momentum, needed) = (body.times(&twist), body.times(&acceleration));
            self.wrenches[i] = (
                needed.0 + twist.1.cross(&momentum.0),
                needed.1 + twist.1.cross(&momentum.1) + twist.0.cross(&momentum.0),
            );
            (self.twists[i], self.accelerations[i]) = (twist, acceleration);
        }
    }

    /// Takes what springs between points exert off the wrenches that the links need.
    fn pull(&mut self) {
        if self.model.springs.is_empty() {
            return;
        }
        let ground = (Matrix3::identity(), Vector3::zeros());
        for (i, link) in self.model.links.iter().enumerate() {
            let (above, (r, at)) = (link.parent.map_or(ground, |p| self.world[p]), &self.places[i]);
            self.world[i] = (above.0 * r, above.0 * at + above.1);
        }
        for spring in &self.model.springs {
            let place = |end: &End| match end.link {
                Some(i) => {
                    let ((r, at), (lin, ang)) = (&self.world[i], &self.twists[i]);
                    (r * end.point + at, r * (lin + ang.cross(&end.point)))
                }
                None => (end.point, Vector3::zeros()),
            };
            let ((from, from_rate), (to, to_rate)) = (place(&spring.from), place(&spring.to));
            let pull = spring.pull(&linear::Vector3::of(&(to - from)), &linear::Vector3::of(&(to_rate - from_rate)));
            let force = Vector3::new(pull.x, pull.y, pull.z);
            for (end, force) in [(&spring.from, force), (&spring.to, -force)] {
                if let Some(i) = end.link {
                    let force = self.world[i].0.tr_mul(&force);
                    self.wrenches[i].0 -= force;
                    self.wrenches[i].1 -= end.point.cross(&force);
                }
            }
        }
    }

    /// Sums the wrenches towards the root and leaves the joint forces in `force`.
    fn sum_wrenches(&mut self) {
        for i in (0..self.model.links.len()).rev() {
            let (f, tau) = self.wrenches[i];
            self.write_along(i, &(f, tau), |force, k, value| force[k] = value);
            if let Some(p) = self.model.links[i].parent {
                let (r, at) = &self.places[i];
                let f = r * f;
                self.wrenches[p].0 += f;
                self.wrenches[p].1 += r * tau + at.cross(&f);
            }
        }
    }

    /// Hands out `S^T F` of a joint, component by component.
    fn write_along(&mut self, i: usize, (f, tau): &Pair, write: impl Fn(&mut DVector<f64>, usize, f64)) {
        let link = &self.model.links[i];
        let all = [f.x, f.y, f.z, tau.x, tau.y, tau.z];
        let free = link.kind.free();
        for (k, slot) in (0..6).filter(|&s| free[s]).enumerate() {
            write(&mut self.force, link.velocity + k, all[slot]);
        }
    }

    /// Leaves `H` in `mass`: with the composite inertia `I_c` of the links beyond joint `i`, `H_ij = S_j^T I_c S_i` for
    /// every joint `j` between `i` and the root.
    fn composite_bodies(&mut self) {
        for (composite, link) in self.composites.iter_mut().zip(&self.model.links) {
            *composite = Rigid { mass: link.mass, first_moment: link.first_moment, inertia: link.inertia };
        }
        self.mass.fill(0.0);
        for i in (0..self.model.links.len()).rev() {
            let (r, at) = self.places[i];
            if let Some(p) = self.model.links[i].parent {
                self.composites[p] = self.composites[p].plus(&self.composites[i].carried(&r, &at));
            }
            for k in 0..self.model.links[i].kind.degrees_of_freedom() {
                self.fill_column(i, k);
            }
        }
    }

    fn fill_column(&mut self, i: usize, k: usize) {
        let column = self.model.links[i].velocity + k;
        let mut unit = [0.0; 6];
        let free = self.model.links[i].kind.free();
        if let Some(slot) = (0..6).filter(|&s| free[s]).nth(k) {
            unit[slot] = 1.0;
        }
        let direction = (Vector3::new(unit[0], unit[1], unit[2]), Vector3::new(unit[3], unit[4], unit[5]));
        let mut wrench = self.composites[i].times(&direction);
        let mut at = i;
        loop {
            let link = &self.model.links[at];
            let all = [wrench.0.x, wrench.0.y, wrench.0.z, wrench.1.x, wrench.1.y, wrench.1.z];
            let free = link.kind.free();
            for (row, slot) in (0..6).filter(|&s| free[s]).enumerate() {
                self.mass[(link.velocity + row, column)] = all[slot];
                self.mass[(column, link.velocity + row)] = all[slot];
            }
            let Some(parent) = link.parent else { break };
            let (r, offset) = &self.places[at];
            let f = r * wrench.0;
            wrench = (f, r * wrench.1 + offset.cross(&f));
            at = parent;
        }
    }
}
