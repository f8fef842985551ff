//! Constrained Lobatto IIIA-IIIB methods of 2 to 5 stages, of order 2, 4, 6 and 8.
//!
//! The symplectic partitioned Runge-Kutta method of Jay (1996; Marsden and West 2001, section 3.5.6; Hairer, Lubich and
//! Wanner 2006, section VII.1.4) on the linear space of positions and attitude matrices, `(x, R)` in `R^3 x R^(3x3)` for every body,
//! with the kinetic energy `1/2 m |xdot|^2 + 1/2 tr(Rdot Jd Rdot^T)`, `Jd = 1/2 tr(J) 1 - J`, and the constraints
//! `R^T R = 1` and the joints. With the IIIA coefficients `a`, the IIIB coefficients `ahat`, weights `b` and `q = (x, R)`,
//!
//! ```text
//! Q_i = q0 + h sum_j a_ij M^-1 P_j ,                                    phi(Q_i) = 0 , i = 2 ... s      (1)
//! P_i = p0 + h sum_j ahat_ij (f(Q_j) + G(Q_j)^T lambda_j)                                               (2)
//! q1 = Q_s ,  p1 = p0 + h sum_j b_j (f(Q_j) + G(Q_j)^T lambda_j) ,      G(q1) M^-1 p1 = 0               (3)
//! ```
//!
//! `Q_1 = q0`, and `ahat_is = 0`, so that `lambda_1 ... lambda_(s-1)` follow from (1) and `lambda_s` from the projection in (3).
//! Two stages are RATTLE. The map is symplectic, symmetric and of order `2 s - 2` on the constraint manifold.
//!
//! For given forces of the joints at the stages each body is solved on its own ([`attitude`]), as the discrete
//! Moser-Veselov equation is in RATTLE. The joints are closed by a chord iteration: their gaps at the stages `i = 2 ... s`
//! are combined by the inverse of `(a ahat)_ik` into what the forces at each stage `k = 1 ... s-1` have to close, by the
//! articulated-body recursion at that stage. With the recursion at `q0` for all of them a thin rod, whose compliance is
//! large about one axis, would make the iteration diverge.
//!
//! What it does not do: joint damping, and bodies with a `Jd` that is not positive (a flat plate has none along its
//! normal). It knows nothing of the loops, couplings, springs and drives of a system: the engine refuses them with this method.
//!
//! `tests/core/independent/` solves (1) to (3) as they stand, with all multipliers, by a dense Newton method on random trees:
//! both agree to 3e-15 in the coordinates and, relatively, to 3e-14 in the momenta with 3 to 5 stages, and to 1.1e-13 with 2.

mod attitude;
mod tableau;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::mechanics::{BodyState, State, System};
use crate::variational::chain::{JointFrame, Motion, Node, Pose, RelativeMotion, keep_locked, mismatch, nodes};
use crate::variational::closing::stop::LIMITS;
use crate::variational::map::{Map, OwnStep};
use crate::variational::rattle::{Body, Failure, RETURN, Rattle, bodies, norm_defect, turn_less_one, world_inertia};
use crate::variational::tree::spatial::{Spatial, Twist, Wrench};
use crate::variational::tree::{Singular, Tree};
use attitude::{Attitude, MOST_ITERATIONS};
use tableau::{MOST_STAGES, Tableau};

/// Rounds without progress after which the iteration is at roundoff.
const STALLED: usize = 3;

/// A body and its joint at a stage.
#[derive(Clone, Copy, Debug)]
struct Stage {
    /// Change of the position, m.
    dx: Vector3<f64>,
    frame: JointFrame,
    /// The joint's force on the child about its joint point, axes of the joint frame in the parent, N and N m.
    wrench: Wrench,
    /// Force of the joints on the body (N) and what they exert on it beside the moments of these forces (N m), world axes.
    load: Wrench,
    /// `sum f r^T` over the forces at points `r` of the body, in the body's frame at the start, N m. It does not change
    /// while the body turns.
    virial: Matrix3<f64>,
    /// The twist that closes the joint at this stage in a time `h`, axes of the joint frame in the parent.
    closing: Spatial,
}

/// Why a system cannot be advanced by these methods.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    #[error("joint {joint} is damped")]
    Damped { joint: usize },
    #[error("body {body} has no mass along a principal axis (Jd = {least:e} kg m^2)")]
    Flat { body: usize, least: f64 },
    #[error("{0:?}")]
    Failure(Failure),
}

/// The integrator. Nothing is allocated after [`Lobatto::new`]. Arrays run over the nodes as in [`crate::variational::Rattle`].
#[derive(Clone, Debug)]
pub struct Lobatto {
    tableau: Tableau,
    nodes: Vec<Node>,
    gravity: Vector3<f64>,
    bodies: Vec<Body>,
    pose: Vec<Pose>,
    frames: Vec<JointFrame>,
    /// The factorisation at `q0`.
    tree: Tree,
    /// Joints' frames and factorisations at the stages `2 ... s-1`, for the chord iteration.
    inner: Vec<(Vec<JointFrame>, Tree)>,
    /// The part of the joints' mismatch at the start that the step takes away.
    gap0: Vec<Twist>,
    /// Twists that close the joints at one stage.
    bias: Vec<Twist>,
    /// Node by node, `tableau.stages` entries each.
    stages: Vec<Stage>,
    /// Attitudes at the stages, node by node.
    attitudes: Vec<Attitude>,
    /// Twists at the joint points after the last projection.
    twist: Vec<Twist>,
    /// Step of the multipliers in `stages`, s; 0 where there are none.
    last_step: f64,
    length: f64,
}

impl Lobatto {
    /// Starts from the system's initial state with 2 to 5 stages; other numbers are taken to the nearest.
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn new(system: &System, stages: usize) -> Result<Lobatto, Unfit> {
        Lobatto::from_state(system, &system.initial, stages)
    }

    /// Starts from a state of the system.
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn from_state(system: &System, state: &State, stages: usize) -> Result<Lobatto, Unfit> {
        let nodes = nodes(system);
        for (i, node) in nodes.iter().enumerate().skip(1) {
            if system.bodies[i - 1].joint.damping > 0.0 {
                return Err(Unfit::Damped { joint: i - 1 });
            }
            let least = 0.5 * node.inertia.sum() - node.inertia.max();
            if !(least > 1e-9 * node.inertia.max()) {
                return Err(Unfit::Flat { body: i - 1, least });
            }
        }
        let n = nodes.len();
        let tableau = Tableau::new(stages);
        let rest = Stage {
            dx: Vector3::zeros(),
            frame: JointFrame::GROUND,
            wrench: Spatial::ZERO,
            load: Spatial::ZERO,
            virial: Matrix3::zeros(),
            closing: Spatial::ZERO,
        };
        let (bodies, pose) = bodies(system, state);
        let arms: f64 = nodes.iter().map(|node| node.mount.arm.norm().max(node.mount.parent_arm.norm())).sum();
        let mut lobatto = Lobatto {
            gravity: system.gravity,
            bodies,
            pose,
            frames: vec![JointFrame::GROUND; n],
            tree: Tree::new(&nodes),
            inner: vec![(vec![JointFrame::GROUND; n], Tree::new(&nodes)); tableau.stages - 2],
            gap0: vec![Spatial::ZERO; n],
            bias: vec![Spatial::ZERO; n],
            stages: vec![rest; n * tableau.stages],
            attitudes: nodes.iter().map(|node| Attitude::new(&node.inertia, tableau.stages)).collect(),
            twist: vec![Spatial::ZERO; n],
            last_step: 0.0,
            length: if arms > 0.0 { arms / (n - 1) as f64 } else { 1.0 },
            tableau,
            nodes,
        };
        lobatto.factorise().map_err(Unfit::Failure)?;
        lobatto.project_momenta();
        Ok(lobatto)
    }

    /// Takes one step of size `h` (s). After a failure the state is the one before the step.
    ///
    /// # Errors
    /// [`Failure::Constraint`], [`Failure::NotFinite`], [`Failure::Singular`].
    pub fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.predict(h);
        if self.iterate(h).is_err() {
            self.forget();
            if let Err(failure) = self.iterate(h) {
                self.forget();
                return Err(failure);
            }
        }
        self.last_step = h;
        for i in 1..self.nodes.len() {
            let (linear, angular) = self.impulse(i, h);
            let (end, body, pose) = (self.stage(i, self.tableau.stages - 1), &mut self.bodies[i], &mut self.pose[i]);
            let s = cayley_vector(&self.attitudes[i].turn[self.tableau.stages - 1]);
            let dx = end.dx;
            body.p.add(&linear);
            body.pi.add(&(pose.r * angular));
            body.x.add(&dx);
            body.q.add(&(Quaternion::from(pose.q) * turn_less_one(&s)).coords);
            body.q.add(&norm_defect(&body.q));
            *pose = Pose::new(&body.x, body.q.value);
        }
        self.factorise()?;
        self.project_momenta();
        Ok(())
    }

    fn stage(&self, node: usize, k: usize) -> Stage {
        self.stages[node * self.tableau.stages + k]
    }

    /// Starts the multipliers from the polynomial through those of the last step.
    fn predict(&mut self, h: f64) {
        let s = self.tableau.stages;
        if self.last_step != h {
            self.forget();
            return;
        }
        for (node, stages) in self.nodes.iter().zip(self.stages.chunks_exact_mut(s)) {
            let mut old = [Spatial::ZERO; MOST_STAGES];
            for (old, stage) in old.iter_mut().zip(stages.iter()) {
                *old = stage.wrench;
            }
            for (k, stage) in stages.iter_mut().enumerate().take(s - 1) {
                stage.wrench = Spatial::ZERO;
                for (weight, wrench) in self.tableau.ahead[k].iter().zip(&old).take(s - 1) {
                    stage.wrench += wrench.scaled(*weight);
                }
                // Extrapolation would let the roundoff along the free directions grow from step to step.
                keep_locked(node, &JointFrame::GROUND, &mut stage.wrench);
            }
        }
        for attitude in &mut self.attitudes[1..] {
            attitude.predict(&self.tableau);
        }
    }

    /// Starts the multipliers from zero.
    fn forget(&mut self) {
        self.last_step = 0.0;
        for stage in &mut self.stages {
            (stage.wrench, stage.dx) = (Spatial::ZERO, Vector3::zeros());
        }
        for attitude in &mut self.attitudes[1..] {
            attitude.forget();
            attitude.turn = [Matrix3::zeros(); MOST_STAGES];
        }
    }

    /// (1) and (2): the chord iteration, down to roundoff.
    fn iterate(&mut self, h: f64) -> Result<(), Failure> {
        let (mut best, mut stalled) = (f64::INFINITY, 0);
        for rounds in 0.. {
            self.place_and_load();
            self.move_stages(h)?;
            let (joint, residual, roundoff) = self.measure(h);
            if !residual.is_finite() {
                return Err(Failure::NotFinite { body: joint });
            }
            // The contraction alternates, and the forces are much larger than the gaps that they close: only a residual that
            // has not fallen for several rounds is roundoff.
            stalled = if residual < 0.5 * best { 0 } else { stalled + 1 };
            best = residual.min(best);
            if residual == 0.0 || (stalled >= STALLED && best <= 64.0 * roundoff) {
                return Ok(());
            }
            if rounds == LIMITS.rounds {
                return Err(Failure::Constraint { joint, rounds, residual });
            }
            // The first round puts the bodies where the prediction has them; one that hardly helps calls for another look.
            if rounds == 0 || stalled >= STALLED {
                self.factorise_stages()?;
            }
            self.correct(h);
        }
        Ok(())
    }

    /// Places the joints in every stage and puts their forces on the bodies.
    fn place_and_load(&mut self) {
        let s = self.tableau.stages;
        for k in 0..s {
            for i in 1..self.nodes.len() {
                let parent = self.nodes[i].parent;
                let parent_arm = self.stages[parent * s + k].frame.arm;
                let (pose, above) = (self.pose_at(i, k), self.pose_at(parent, k));
                self.stages[i * s + k].frame = JointFrame::new(&self.nodes[i], &pose, &above, &parent_arm);
                self.stages[i * s + k].load = Spatial::ZERO;
                self.stages[i * s + k].virial = Matrix3::zeros();
            }
            for i in 1..self.nodes.len() {
                let (stage, parent) = (self.stages[i * s + k], self.nodes[i].parent);
                let axes = &stage.frame.axes;
                let wrench = Spatial::new(axes * stage.wrench.linear, axes * stage.wrench.angular);
                let force = self.pose[i].r.tr_mul(&wrench.linear);
                self.stages[i * s + k].load += wrench;
                self.stages[i * s + k].virial += force * self.nodes[i].mount.arm.transpose();
                if parent > 0 {
                    let arm = self.stages[parent * s + k].frame.arm + stage.frame.offset;
                    let arm = self.pose_at(parent, k).r.tr_mul(&arm);
                    let force = self.pose[parent].r.tr_mul(&wrench.linear);
                    self.stages[parent * s + k].load -= wrench;
                    self.stages[parent * s + k].virial -= force * arm.transpose();
                }
            }
        }
    }

    fn pose_at(&self, node: usize, k: usize) -> Pose {
        let (pose, stage) = (&self.pose[node], &self.stages[node * self.tableau.stages + k]);
        if node == 0 {
            return Pose::GROUND;
        }
        pose.moved(&stage.dx, pose.r + pose.r * self.attitudes[node].turn[k])
    }

    /// (1) and (2) with the present forces of the joints.
    fn move_stages(&mut self, h: f64) -> Result<(), Failure> {
        let s = self.tableau.stages;
        for i in 1..self.nodes.len() {
            let omega = self.body_velocity(i) * h;
            let mass = self.nodes[i].mass;
            let velocity = self.bodies[i].p.value / mass;
            let mut forces = [(Vector3::zeros(), Matrix3::zeros()); MOST_STAGES];
            for (k, (torque, virial)) in forces.iter_mut().enumerate().take(s - 1) {
                let (f, stage) = (Matrix3::identity() + self.attitudes[i].turn[k], &self.stages[i * s + k]);
                *torque = f.tr_mul(&self.pose[i].r.tr_mul(&stage.load.angular)) * (h * h);
                *virial = stage.virial * (h * h);
            }
            self.attitudes[i].solve(&self.tableau, &omega, &forces).map_err(|change| Failure::Constraint {
                joint: i - 1,
                rounds: MOST_ITERATIONS,
                residual: self.length * change,
            })?;
            for k in 1..s {
                let mut dx = velocity * (h * self.tableau.c[k]);
                for j in 0..s - 1 {
                    let acceleration = self.stages[i * s + j].load.linear / mass + self.gravity;
                    dx += acceleration * (h * h * self.tableau.product[k][j]);
                }
                self.stages[i * s + k].dx = dx;
            }
        }
        Ok(())
    }

    /// `Omega = J^-1 R^T pi` at the start of the step.
    fn body_velocity(&self, i: usize) -> Vector3<f64> {
        self.pose[i].r.tr_mul(&self.bodies[i].pi.value).component_div(&self.nodes[i].inertia)
    }

    /// The joint where a stage is farthest from holding, how far (m; angles times the system's length), and how
    /// small roundoff lets that become.
    fn measure(&mut self, h: f64) -> (usize, f64, f64) {
        let s = self.tableau.stages;
        let (mut worst, mut joint, mut roundoff) = (0.0, 0, RETURN * self.length);
        for k in 1..s {
            for i in 1..self.nodes.len() {
                let (node, parent) = (&self.nodes[i], self.nodes[i].parent);
                let (motion, above) = (self.motion(i, k), self.motion(parent, k));
                let moved = RelativeMotion::new(&self.frames[i], &self.frames[parent].arm, &motion, &above);
                let gap = moved.locked(node, &self.frames[i], &above) + self.gap0[i].scaled(self.tableau.c[k]);
                let size = gap.linear.norm() + self.length * gap.angular.norm();
                let load = &self.stages[i * s + k].load;
                // A turn is known to the roundoff of the momentum, which weighs most about the thinnest axis.
                let spin = h * self.bodies[i].pi.value.norm() / node.inertia.min();
                let limit = motion.dx.norm() + self.length * spin.abs() + (load.linear.norm() / node.mass) * (h * h);
                if size > worst || !(size + limit).is_finite() {
                    (worst, joint) = (size + 0.0 * limit, i - 1);
                }
                roundoff = limit.max(roundoff);
                let axes = &self.frames[i].axes;
                let gap = Spatial::new(axes.tr_mul(&gap.linear), axes.tr_mul(&gap.angular));
                self.stages[i * s + k].closing = gap.scaled(-1.0 / h);
            }
        }
        (joint, worst, f64::EPSILON * roundoff)
    }

    fn motion(&self, node: usize, k: usize) -> Motion {
        if node == 0 {
            return Motion::NONE;
        }
        let stage = &self.stages[node * self.tableau.stages + k];
        Motion { dx: stage.dx, s: self.pose[node].r * cayley_vector(&self.attitudes[node].turn[k]) }
    }

    /// Factorises at the inner stages as they stand.
    fn factorise_stages(&mut self) -> Result<(), Failure> {
        let s = self.tableau.stages;
        let mut inner = std::mem::take(&mut self.inner);
        let mut result = Ok(());
        for (k, (frames, tree)) in (1..).zip(&mut inner) {
            for (i, frame) in frames.iter_mut().enumerate().skip(1) {
                *frame = self.stages[i * s + k].frame;
            }
            let inertia = |i: usize| world_inertia(&self.nodes[i], &self.pose_at(i, k));
            result = result.and(tree.factorise(&self.nodes, frames, inertia, |_| 0.0));
        }
        self.inner = inner;
        result.map_err(|Singular { node }| Failure::Singular { joint: node - 1 })
    }

    /// One round: the gaps of all stages, combined into those that the forces at one stage have to close, close them with
    /// the factorisation at that stage.
    fn correct(&mut self, h: f64) {
        let s = self.tableau.stages;
        for k in 0..s - 1 {
            let (frames, tree) = match k.checked_sub(1) {
                None => (&self.frames, &mut self.tree),
                Some(inner) => {
                    let (frames, tree) = &mut self.inner[inner];
                    (&*frames, tree)
                }
            };
            for i in 1..self.nodes.len() {
                let mut bias = Spatial::ZERO;
                for row in 1..s {
                    bias += self.stages[i * s + row].closing.scaled(self.tableau.inverse[k][row - 1] / h);
                }
                let axes = &frames[i].axes;
                self.bias[i] = Spatial::new(axes * bias.linear, axes * bias.angular);
            }
            let (bias, stages) = (&self.bias, &mut self.stages);
            let add = |i: usize, _: &Twist, f: Wrench| {
                let axes = &frames[i].axes;
                stages[i * s + k].wrench += Spatial::new(axes.tr_mul(&f.linear), axes.tr_mul(&f.angular));
            };
            tree.correct(&self.nodes, frames, |i| bias[i], |_| Vector3::zeros(), add);
        }
    }

    /// (3) without the last stage's multipliers: the impulse on the body (N s), and the change of its spin in its frame at
    /// the start: `hat(pi) = P F^T - F P^T` with `P = Rdot Jd`.
    fn impulse(&self, i: usize, h: f64) -> (Vector3<f64>, Vector3<f64>) {
        let (attitude, s) = (&self.attitudes[i], self.tableau.stages);
        let jd = attitude.jd();
        let mut linear = self.gravity * (h * self.nodes[i].mass);
        let mut change = Matrix3::zeros();
        for k in 0..s - 1 {
            linear += self.stages[i * s + k].load.linear * (h * self.tableau.b[k]);
            change += attitude.x[k] * jd * (self.tableau.b[k] / h);
        }
        let turn = &attitude.turn[s - 1];
        let end = Matrix3::identity() + turn;
        let x = self.body_velocity(i).cross_matrix() * jd * turn.transpose() + change * end.transpose();
        (linear, twice_skew(&x))
    }

    fn factorise(&mut self) -> Result<(), Failure> {
        for i in 1..self.nodes.len() {
            let parent = self.nodes[i].parent;
            let parent_arm = self.frames[parent].arm;
            let (node, pose, above) = (&self.nodes[i], &self.pose[i], &self.pose[parent]);
            self.frames[i] = JointFrame::new(node, pose, above, &parent_arm);
            self.gap0[i] = mismatch(node, pose, above).scaled(RETURN);
        }
        let (nodes, pose) = (&self.nodes, &self.pose);
        self.tree
            .factorise(nodes, &self.frames, |i| world_inertia(&nodes[i], &pose[i]), |_| 0.0)
            .map_err(|Singular { node }| Failure::Singular { joint: node - 1 })
    }

    /// (3): the last stage's multipliers, which make the twists fit.
    fn project_momenta(&mut self) {
        let s = self.tableau.stages;
        let (nodes, bodies, twist, bias) = (&self.nodes, &self.bodies, &mut self.twist, &mut self.bias);
        self.tree.project(
            nodes,
            &self.frames,
            |i| Spatial::new(bodies[i].p.value, bodies[i].pi.value),
            |i, v, f| {
                twist[i] = *v;
                bias[i] = f;
            },
        );
        for i in 1..self.nodes.len() {
            self.stages[i * s].load = Spatial::ZERO;
        }
        for i in 1..self.nodes.len() {
            let (frame, parent) = (&self.frames[i], self.nodes[i].parent);
            // A difference of momenta: what roundoff leaves along the free directions would be an impulse there.
            keep_locked(&self.nodes[i], frame, &mut self.bias[i]);
            self.stages[i * s].load += self.bias[i].wrench_from(&frame.arm);
            if parent > 0 {
                self.stages[parent * s].load -= self.bias[i].wrench_from(&(self.frames[parent].arm + frame.offset));
            }
        }
        for i in 1..self.nodes.len() {
            let impulse = self.stages[i * s].load;
            self.bodies[i].p.add(&impulse.linear);
            self.bodies[i].pi.add(&impulse.angular);
        }
    }

    /// Writes the present state: poses, and the twists that fit the joints.
    pub fn write_state(&self, out: &mut State) {
        for (i, b) in out.bodies.iter_mut().enumerate() {
            let twist = self.twist[i + 1].twist_at(&-self.frames[i + 1].arm);
            *b = BodyState {
                position: self.bodies[i + 1].x.value,
                attitude: UnitQuaternion::new_unchecked(Quaternion::from(self.bodies[i + 1].q.value)),
                velocity: twist.linear,
                angular_velocity: twist.angular,
            };
        }
    }
}

impl Map for Lobatto {
    const STAYS_ON_FAILURE: bool = true;

    fn step(&mut self, h: f64) -> Result<(), Failure> {
        Lobatto::step(self, h)
    }

    fn write_state(&self, out: &mut State) {
        Lobatto::write_state(self, out);
    }

    fn rattle(&self) -> Option<&Rattle> {
        None
    }

    fn before_failure(&self, _h: f64) -> Option<Lobatto> {
        Some(self.clone())
    }

    fn own_step(&self) -> Option<OwnStep> {
        None
    }
}

/// `v` in `hat(v) = X - X^T`.
fn twice_skew(x: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(x[(2, 1)] - x[(1, 2)], x[(0, 2)] - x[(2, 0)], x[(1, 0)] - x[(0, 1)])
}

/// The Cayley vector of the rotation `F = 1 + B`: `hat(s) = (F - F^T) / (1 + tr F)`.
fn cayley_vector(turn: &Matrix3<f64>) -> Vector3<f64> {
    twice_skew(turn) / (4.0 + turn.trace())
}
