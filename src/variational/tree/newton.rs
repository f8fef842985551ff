//! The exact linearisation of a step's constraint equations, for moments in which the chord iteration contracts slowly.
//!
//! A change of the joint impulses at `q0` changes the momenta, the momenta move the bodies through the rotation rule,
//! and the joints are measured at `q1`. With `eta` the change of a body's position and attitude over `h`,
//!
//! ```text
//! M~ eta = G(q0)^T dlambda ,   G(q1) eta = -phi(q1) / h ,   M~ = diag(m 1, R0 I~ R0^T) ,
//! ```
//!
//! `I~` is [`crate::variational::Rotation::inertia`]. It is the recursion of [`super`] with two motion subspaces,
//! `S1` at `q1` on the side of the motion, `S0` at `q0` on the side of the wrench, so that the blocks are not
//! symmetric:
//!
//! ```text
//! U = A S1 ,   V = S0^T A ,   D = V S1 ,   A_parent += A - U D^-1 V .
//! ```
//!
//! Its factors serve for several rounds: made near the solution, they are wrong by as little as the trial was.

use nalgebra::{Const, LU, Matrix3, Vector3};

use super::elimination::{Singular, directions};
use super::response::Response;
use super::spatial::{Spatial, Twist, Wrench};
use crate::mechanics::JointKind;
use crate::variational::chain::{JointFrame, Motion, Node};

/// The free directions of a joint, eliminated.
#[derive(Clone, Debug)]
enum Elimination {
    /// One direction.
    One(One),
    /// Three directions.
    Three(Box<Three>),
    /// All six: nothing passes to the parent.
    Free(Box<LU<f64, Const<6>, Const<6>>>),
}

#[derive(Clone, Debug)]
struct One {
    s0: Spatial,
    s1: Spatial,
    u: Wrench,
    v: Spatial,
    d_inverse: f64,
}

#[derive(Clone, Debug)]
struct Three {
    s0: [Spatial; 3],
    s1: [Spatial; 3],
    u: [Wrench; 3],
    v: [Spatial; 3],
    d_inverse: Matrix3<f64>,
}

impl One {
    /// Eliminates the direction of a joint from `a`; `None` where it moves nothing. `implicit` is what the joint's own
    /// forces add to `D`.
    fn new(a: &Response, node: &Node, frame: &JointFrame, carried: &Motion, implicit: f64) -> Option<One> {
        let z = frame.axes.column(2).into_owned();
        let (z1, none) = (z + carried.turned(&z), Vector3::zeros());
        let (s0, s1, u, v) = if node.slides() {
            let (s0, s1) = (Spatial::new(z, none), Spatial::new(z1, none));
            (s0, s1, a.times(&s1), a.tr_times(&s0))
        } else {
            let (s0, s1) = (Spatial::new(none, z), Spatial::new(none, z1));
            (s0, s1, a.times_turn(&z1), a.tr_times_turn(&z))
        };
        let d = s0.dot(&u) + implicit;
        let d_inverse = 1.0 / d;
        (d != 0.0 && d_inverse.is_finite()).then_some(One { s0, s1, u, v, d_inverse })
    }
}

impl Three {
    /// The same for three directions.
    fn new(a: &Response, node: &Node, frame: &JointFrame, carried: &Motion, implicit: f64) -> Option<Three> {
        let axes1 = Matrix3::from_columns(&[0, 1, 2].map(|k| {
            let axis = frame.axes.column(k).into_owned();
            axis + carried.turned(&axis)
        }));
        let (s0, s1) = (directions(node.kind, &frame.axes), directions(node.kind, &axes1));
        let (u, v) = (s1.map(|s| a.times(&s)), s0.map(|s| a.tr_times(&s)));
        let d = Matrix3::from_fn(|r, c| s0[r].dot(&u[c])) + Matrix3::from_diagonal_element(implicit);
        Some(Three { s0, s1, u, v, d_inverse: d.try_inverse()? })
    }
}

/// The linearisation at a trial configuration, with room for the solves.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Newton {
    /// Twist at the joint point at `q1` to wrench about the joint point at `q0`, children included.
    a: Vec<Response>,
    elimination: Vec<Elimination>,
    /// From the parent's joint point to this one, at `q1`.
    offset1: Vec<Vector3<f64>>,
    /// Right-hand sides about the joint points, summed towards the root.
    rhs: Vec<Wrench>,
    bias: Vec<Twist>,
    /// `D^-1 (S0^T rhs - along)`
    sigma: Vec<Vector3<f64>>,
    eta: Vec<Twist>,
}

impl Newton {
    pub(in crate::variational) fn new(nodes: &[Node]) -> Newton {
        let elimination = |node: &Node| {
            let (zero, three) = (Spatial::ZERO, [Spatial::ZERO; 3]);
            match node.kind {
                JointKind::Revolute | JointKind::Prismatic => {
                    Elimination::One(One { s0: zero, s1: zero, u: zero, v: zero, d_inverse: 0.0 })
                }
                JointKind::Planar | JointKind::Spherical => {
                    let d_inverse = Matrix3::zeros();
                    Elimination::Three(Box::new(Three { s0: three, s1: three, u: three, v: three, d_inverse }))
                }
                JointKind::Floating => Elimination::Free(Box::new(Response::ZERO.to_matrix().lu())),
            }
        };
        Newton {
            a: vec![Response::ZERO; nodes.len()],
            elimination: nodes.iter().map(elimination).collect(),
            offset1: vec![Vector3::zeros(); nodes.len()],
            rhs: vec![Spatial::ZERO; nodes.len()],
            bias: vec![Spatial::ZERO; nodes.len()],
            sigma: vec![Vector3::zeros(); nodes.len()],
            eta: vec![Spatial::ZERO; nodes.len()],
        }
    }

    /// Factorises at the end of the given motions. `inertia(i)` is `R0 I~ R0^T` of node `i`, `implicit(i)` what the
    /// joint's own forces add to `D`.
    ///
    /// # Errors
    /// A block that cannot be inverted.
    pub(in crate::variational) fn factorise(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        motion: impl Fn(usize) -> Motion,
        inertia: impl Fn(usize) -> Matrix3<f64>,
        implicit: impl Fn(usize) -> f64,
    ) -> Result<(), Singular> {
        for i in 1..nodes.len() {
            let (frame, parent) = (&frames[i], nodes[i].parent);
            let (moved, carried) = (motion(i), motion(parent));
            let turned = moved.turned(&frame.arm);
            self.a[i] = Response::of_body(nodes[i].mass, &inertia(i), &frame.arm, &(frame.arm + turned));
            self.offset1[i] = frame.offset + (moved.dx - carried.dx) + turned - carried.turned(&frames[parent].arm);
        }
        for i in (1..nodes.len()).rev() {
            let (frame, node, parent) = (&frames[i], &nodes[i], nodes[i].parent);
            let mut passed = self.a[i];
            match &mut self.elimination[i] {
                Elimination::One(one) => {
                    let carried = motion(parent);
                    *one = One::new(&passed, node, frame, &carried, implicit(i)).ok_or(Singular { node: i })?;
                    passed.subtract_product(&one.u.scaled(one.d_inverse), &one.v);
                }
                Elimination::Three(three) => {
                    let carried = motion(parent);
                    **three = Three::new(&passed, node, frame, &carried, implicit(i)).ok_or(Singular { node: i })?;
                    let Three { u, v, d_inverse, .. } = &**three;
                    for (k, v) in v.iter().enumerate() {
                        let column = d_inverse.column(k);
                        let scaled = u[0].scaled(column[0]) + u[1].scaled(column[1]) + u[2].scaled(column[2]);
                        passed.subtract_product(&scaled, v);
                    }
                }
                Elimination::Free(factors) => {
                    **factors = passed.to_matrix().lu();
                    if !factors.is_invertible() {
                        return Err(Singular { node: i });
                    }
                    continue;
                }
            }
            if parent > 0 {
                self.a[parent].add_shifted(&passed, &frame.offset, &self.offset1[i]);
            }
        }
        Ok(())
    }

    /// Takes all impulses off the bodies, and holds all joints.
    pub(in crate::variational) fn unload(&mut self) {
        self.rhs.fill(Spatial::ZERO);
        self.bias.fill(Spatial::ZERO);
    }

    /// Puts an impulse on a node for the next [`Newton::solve`], about its joint point at `q0`.
    pub(in crate::variational) fn load(&mut self, node: usize, impulse: Wrench) {
        self.rhs[node] += impulse;
    }

    /// Twist of a node at its joint point in the last solution.
    pub(in crate::variational) fn motion(&self, node: usize) -> Twist {
        self.eta[node]
    }

    /// Closes a joint by a twist ([`closing_twist`]) in the next [`Newton::solve`].
    #[inline(always)]
    pub(in crate::variational) fn close(&mut self, node: usize, twist: Twist) {
        self.bias[node] = twist;
    }

    /// What the impulses of [`Newton::load`] and the twists of [`Newton::close`] cause, with `S0 . f = -along`: `add(i,
    /// f)` gets the change of each joint's impulse, [`Newton::motion`] has the twists.
    pub(in crate::variational) fn solve(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        along: impl Fn(usize) -> Vector3<f64>,
        mut add: impl FnMut(usize, Wrench),
    ) {
        for i in (1..nodes.len()).rev() {
            let mut rhs = self.rhs[i] - self.a[i].times(&self.bias[i]);
            match &self.elimination[i] {
                Elimination::One(One { s0, u, d_inverse, .. }) => {
                    let sigma = d_inverse * (s0.dot(&rhs) - along(i).x);
                    self.sigma[i].x = sigma;
                    rhs -= u.scaled(sigma);
                }
                Elimination::Three(three) => {
                    let Three { s0, u, d_inverse, .. } = &**three;
                    let sigma = d_inverse * (Vector3::from_fn(|k, _| s0[k].dot(&rhs)) - along(i));
                    self.sigma[i] = sigma;
                    rhs -= u[0].scaled(sigma.x) + u[1].scaled(sigma.y) + u[2].scaled(sigma.z);
                }
                Elimination::Free(_) => continue,
            }
            let parent = nodes[i].parent;
            if parent > 0 {
                self.rhs[parent] += rhs.wrench_from(&frames[i].offset);
            }
        }
        for i in 1..nodes.len() {
            let carried = self.eta[nodes[i].parent].twist_at(&self.offset1[i]);
            let mut eta = carried + self.bias[i];
            match &self.elimination[i] {
                Elimination::One(One { s1, v, d_inverse, .. }) => {
                    eta += s1.scaled(self.sigma[i].x - d_inverse * v.dot(&carried));
                }
                Elimination::Three(three) => {
                    let Three { s1, v, d_inverse, .. } = &**three;
                    let sigma = self.sigma[i] - d_inverse * Vector3::from_fn(|k, _| v[k].dot(&carried));
                    eta += s1[0].scaled(sigma.x) + s1[1].scaled(sigma.y) + s1[2].scaled(sigma.z);
                }
                Elimination::Free(factors) => {
                    // Factors that are not of full rank are refused when they are made.
                    let eta =
                        factors.solve(&self.rhs[i].to_vector()).map_or(Spatial::ZERO, |x| Spatial::from_vector(&x));
                    self.eta[i] = eta;
                    add(i, Spatial::ZERO);
                    continue;
                }
            }
            self.eta[i] = eta;
            add(i, self.a[i].times(&eta) - self.rhs[i]);
        }
    }
}

/// The relative twist that closes a joint in `h`: the change of the Cayley vector `turn` by `-e` is a rotation by
/// `-2 / (1 + |turn|^2) (e + turn x e)` before the parent's own rotation.
#[inline(always)]
pub(in crate::variational) fn closing_twist(locked: &Twist, turn: &Vector3<f64>, carried: &Motion) -> Twist {
    let e = 0.5 * locked.angular;
    let rotation = (e + turn.cross(&e)) * (2.0 / (1.0 + turn.norm_squared()));
    Spatial::new(locked.linear, rotation + carried.turned(&rotation))
}
