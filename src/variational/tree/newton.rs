//! The exact linearisation of a step's constraint equations, for moments in which the chord iteration does not contract.
//!
//! A change of the joint impulses at `q0` changes the momenta, the momenta move the bodies through the rotation rule, and
//! the joints are measured at `q1`. With `eta` the change of a body's position and attitude over `h`,
//!
//! ```text
//! M~ eta = G(q0)^T dlambda ,   G(q1) eta = -phi(q1) / h ,   M~ = diag(m 1, I~) ,
//! I~ = R0 1/2 K (1 + [s])^-1 R0^T ,   K = (1 + |s|^2) d(h m0)/ds .
//! ```
//!
//! It is the recursion of [`super`] with two motion subspaces: `S1` at `q1` on the side of the motion, `S0` at `q0` on
//! the side of the wrench, so that the blocks are not symmetric. It is made anew in every round; a few of them reach roundoff where the chord iteration diverges.

use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3, Vector6};

use super::elimination::{Singular, directions};
use super::spatial::{Spatial, Twist, Wrench};
use crate::mechanics::JointKind;
use crate::variational::chain::{JointFrame, Motion, Node};

type Matrix6x3 = SMatrix<f64, 6, 3>;
type Matrix3x6 = SMatrix<f64, 3, 6>;

/// A node in the step that is being tried.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Tried {
    pub motion: Motion,
    /// `I~`, kg m^2.
    pub inertia: Matrix3<f64>,
    /// [`RelativeMotion::turn`](crate::variational::chain::RelativeMotion::turn) of its joint.
    pub turn: Vector3<f64>,
    /// What its joint does not allow.
    pub locked: Twist,
    /// What its joint's own impulse is short of, and what it adds to `D`.
    pub along: Vector3<f64>,
    pub implicit: f64,
    /// What the impulses on a light body lack for balance, about its centre of mass.
    pub kick: Wrench,
}

/// Room for the linearisation at a trial configuration.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Newton {
    /// To be filled in before each correction.
    pub tried: Vec<Tried>,
    /// Twist at the joint point at `q1` to wrench about the joint point at `q0`, children included.
    a: Vec<Matrix6<f64>>,
    s1: Vec<Matrix6x3>,
    /// `A S1`
    u: Vec<Matrix6x3>,
    /// `D^-1 S0^T` and `D^-1 S0^T A`
    d_s: Vec<Matrix3x6>,
    v: Vec<Matrix3x6>,
    /// Right-hand sides, summed towards the root.
    rhs: Vec<Vector6<f64>>,
    /// `D^-1 (S0^T rhs - along)`
    sigma: Vec<Vector3<f64>>,
    eta: Vec<Vector6<f64>>,
    /// From the parent's joint point to this one, at `q1`.
    offset1: Vec<Vector3<f64>>,
}

impl Newton {
    pub(in crate::variational) fn new(nodes: usize) -> Newton {
        let rest = Tried {
            motion: Motion::NONE,
            inertia: Matrix3::zeros(),
            turn: Vector3::zeros(),
            locked: Spatial::ZERO,
            along: Vector3::zeros(),
            implicit: 0.0,
            kick: Spatial::ZERO,
        };
        Newton {
            tried: vec![rest; nodes],
            a: vec![Matrix6::zeros(); nodes],
            s1: vec![Matrix6x3::zeros(); nodes],
            u: vec![Matrix6x3::zeros(); nodes],
            d_s: vec![Matrix3x6::zeros(); nodes],
            v: vec![Matrix3x6::zeros(); nodes],
            rhs: vec![Vector6::zeros(); nodes],
            sigma: vec![Vector3::zeros(); nodes],
            eta: vec![Vector6::zeros(); nodes],
            offset1: vec![Vector3::zeros(); nodes],
        }
    }

    /// One Newton correction of a step of size `h`: calls `add(i, f)` with the change of each joint's impulse.
    ///
    /// # Errors
    /// A block that cannot be inverted.
    pub(in crate::variational) fn correct(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        h: f64,
        mut add: impl FnMut(usize, Wrench),
    ) -> Result<(), Singular> {
        for i in 1..nodes.len() {
            let (frame, parent) = (&frames[i], nodes[i].parent);
            let (tried, carried) = (&self.tried[i], &self.tried[parent].motion);
            let moved = &tried.motion;
            let arm1 = frame.arm + moved.turned(&frame.arm);
            let com =
                block(&(Matrix3::identity() * nodes[i].mass), &Matrix3::zeros(), &Matrix3::zeros(), &tried.inertia);
            self.a[i] = wrench_shift(&-frame.arm) * com * twist_shift(&-arm1);
            self.rhs[i] = tried.kick.wrench_from(&-frame.arm).to_vector();
            let parent_arm = frames[parent].arm;
            self.offset1[i] =
                frame.offset + (moved.dx - carried.dx) + moved.turned(&frame.arm) - carried.turned(&parent_arm);
        }
        for i in (1..nodes.len()).rev() {
            let (frame, parent) = (&frames[i], nodes[i].parent);
            if nodes[i].is_free() {
                continue;
            }
            let (tried, carried) = (&self.tried[i], &self.tried[parent].motion);
            let axes1 = Matrix3::from_columns(&[0, 1, 2].map(|k| {
                let axis = frame.axes.column(k).into_owned();
                axis + carried.turned(&axis)
            }));
            let (s0, s1) = (subspace(nodes[i].kind, &frame.axes), subspace(nodes[i].kind, &axes1));
            let u = self.a[i] * s1;
            let left = s0.transpose() * self.a[i];
            let mut d = s0.transpose() * u;
            for k in 0..3 {
                // A joint with one coordinate leaves two rows empty.
                d[(k, k)] += if k < nodes[i].kind.degrees_of_freedom() { tried.implicit } else { 1.0 };
            }
            let d_inverse = d.try_inverse().ok_or(Singular { node: i })?;
            (self.s1[i], self.u[i]) = (s1, u);
            (self.d_s[i], self.v[i]) = (d_inverse * s0.transpose(), d_inverse * left);
            let biased = self.rhs[i] - self.a[i] * closing_twist(&tried.locked, &tried.turn, carried, h).to_vector();
            self.sigma[i] = d_inverse * (s0.transpose() * biased - tried.along);
            if parent > 0 {
                let passed = self.a[i] - u * self.v[i];
                self.a[parent] += wrench_shift(&frame.offset) * passed * twist_shift(&self.offset1[i]);
                self.rhs[parent] += wrench_shift(&frame.offset) * (biased - u * self.sigma[i]);
            }
        }
        for i in 1..nodes.len() {
            let parent = nodes[i].parent;
            if nodes[i].is_free() {
                self.eta[i] = self.a[i].lu().solve(&self.rhs[i]).ok_or(Singular { node: i })?;
                continue;
            }
            let carried = twist_shift(&self.offset1[i]) * self.eta[parent];
            let sigma = self.sigma[i] - self.v[i] * carried;
            let tried = &self.tried[i];
            let bias = closing_twist(&tried.locked, &tried.turn, &self.tried[parent].motion, h).to_vector();
            self.eta[i] = carried + bias + self.s1[i] * sigma;
            add(i, Spatial::from_vector(&(self.a[i] * self.eta[i] - self.rhs[i])));
        }
        Ok(())
    }

    /// What impulses on the bodies at `q0` cause beside the joints' closing, with the factors of the last
    /// [`Newton::correct`]: `load` writes them about the joint points, `add(i, f)` gets the change of each joint's impulse,
    /// [`Newton::motion`] has the twists.
    ///
    /// # Errors
    /// A block that cannot be inverted.
    pub(in crate::variational) fn respond(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        load: impl FnOnce(&mut [Vector6<f64>]),
        mut add: impl FnMut(usize, Wrench),
    ) -> Result<(), Singular> {
        self.rhs.fill(Vector6::zeros());
        load(&mut self.rhs);
        for i in (1..nodes.len()).rev().filter(|&i| !nodes[i].is_free()) {
            self.sigma[i] = self.d_s[i] * self.rhs[i];
            let passed = self.rhs[i] - self.u[i] * self.sigma[i];
            self.rhs[nodes[i].parent] += wrench_shift(&frames[i].offset) * passed;
        }
        self.eta[0] = Vector6::zeros();
        for i in 1..nodes.len() {
            if nodes[i].is_free() {
                self.eta[i] = self.a[i].lu().solve(&self.rhs[i]).ok_or(Singular { node: i })?;
                continue;
            }
            let carried = twist_shift(&self.offset1[i]) * self.eta[nodes[i].parent];
            self.eta[i] = carried + self.s1[i] * (self.sigma[i] - self.v[i] * carried);
            add(i, Spatial::from_vector(&(self.a[i] * self.eta[i] - self.rhs[i])));
        }
        Ok(())
    }

    /// Twist of a node at its joint point in the last solution.
    pub(in crate::variational) fn motion(&self, node: usize) -> Twist {
        Spatial::from_vector(&self.eta[node])
    }
}

/// The relative twist that closes a joint in `h`: the change of the Cayley vector `turn` by `-e` is a rotation by
/// `-2 / (1 + |turn|^2) (e + turn x e)` before the parent's own rotation.
pub(in crate::variational) fn closing_twist(locked: &Twist, turn: &Vector3<f64>, carried: &Motion, h: f64) -> Twist {
    let e = 0.5 * locked.angular;
    let rotation = (e + turn.cross(&e)) * (2.0 / (1.0 + turn.norm_squared()));
    Spatial::new(locked.linear, rotation + carried.turned(&rotation)).scaled(-1.0 / h)
}

/// `I~` of a body: `R0 1/2 K (1 + [s])^-1 R0^T`, with `k` as [`crate::variational::Rotation::derivative`] gives it.
pub(in crate::variational) fn turning_inertia(r0: &Matrix3<f64>, s: &Vector3<f64>, k: &Matrix3<f64>) -> Matrix3<f64> {
    // (1 + [s])^-1 = (1 - [s] + s s^T) / (1 + |s|^2)
    let inverse = (Matrix3::identity() - s.cross_matrix() + s * s.transpose()) / (1.0 + s.norm_squared());
    r0 * (0.5 * k * inverse) * r0.transpose()
}

/// The free directions as columns; empty ones for a joint with one coordinate.
fn subspace(kind: JointKind, axes: &Matrix3<f64>) -> Matrix6x3 {
    Matrix6x3::from_columns(&directions(kind, axes).map(Spatial::to_vector))
}

fn block(a: &Matrix3<f64>, b: &Matrix3<f64>, c: &Matrix3<f64>, d: &Matrix3<f64>) -> Matrix6<f64> {
    let mut all = Matrix6::zeros();
    all.fixed_view_mut::<3, 3>(0, 0).copy_from(a);
    all.fixed_view_mut::<3, 3>(0, 3).copy_from(b);
    all.fixed_view_mut::<3, 3>(3, 0).copy_from(c);
    all.fixed_view_mut::<3, 3>(3, 3).copy_from(d);
    all
}

/// [`Spatial::twist_at`] as a matrix.
fn twist_shift(r: &Vector3<f64>) -> Matrix6<f64> {
    block(&Matrix3::identity(), &-r.cross_matrix(), &Matrix3::zeros(), &Matrix3::identity())
}

/// [`Spatial::wrench_from`] as a matrix.
fn wrench_shift(r: &Vector3<f64>) -> Matrix6<f64> {
    block(&Matrix3::identity(), &Matrix3::zeros(), &r.cross_matrix(), &Matrix3::identity())
}
