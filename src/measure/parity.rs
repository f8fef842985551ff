//! The evidence that every engine was given the same mechanical system.
//!
//! Masses, centres of mass and inertias are read back from engines that keep their own. Energy and momentum are those
//! of the engine's first state with the masses that it holds. The joint accelerations at t = 0 come from the engine's
//! own steps: `(w(2h) - w(h)) / h` of the joint velocities `w`, extrapolated to `h = 0` from `h`, `h/2` and `h/4`. The
//! first step is left out because a solver that keeps velocities in the null space of the joints' Jacobian at the old
//! positions has no Coriolis acceleration in it. They are compared with those of an engine that shares no dynamics with
//! the others, found in the same way; masses and inertias that are not read back show in them.

use nalgebra::Vector3;

use super::trace::StartDifference;
use crate::engines::{self, Engine, Spec};
use crate::mechanics::coordinates::joint_coordinates;
use crate::mechanics::{State, System};

/// Differences between what an engine was found to hold and the system.
#[derive(Clone, Debug, PartialEq)]
pub struct Parity {
    pub engine: String,
    /// Of the masses and inertias that the engine keeps; `None` where it computes on the system itself.
    pub held: Option<HeldDifference>,
    /// Between the engine's first state and the system's.
    pub start: StartDifference,
    /// Of linear and angular momentum, over `sqrt(2 m E)` and `sqrt(2 I E)` with the energy scale `E`.
    pub momentum: [f64; 2],
    /// Largest difference of a joint acceleration, relative to the largest of them or to 1 rad/s^2 or m/s^2; `None`
    /// where the reference does not take the system.
    pub acceleration: Option<f64>,
    /// The same with the engine's constraints solved to the end, where its own settings leave them half solved.
    pub acceleration_solved: Option<f64>,
    /// The bounds that hold for its precision.
    pub bounds: Bounds,
}

/// Largest relative differences of masses and principal moments, and the largest distance of a centre of mass from
/// where it should be, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldDifference {
    pub mass: f64,
    pub inertia: f64,
    pub com: f64,
}

/// Differences that roundoff, and for accelerations the extrapolation, may leave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub system: f64,
    /// `None` where accelerations are told and not judged. In motions that the steps do not resolve, as with stiff
    /// springs, the extrapolation says nothing about an acceleration; in single precision the roundoff of velocities
    /// over the length of a step can be as large as an acceleration, and that of constraints which iterations solve is.
    pub acceleration: Option<f64>,
}

/// In double and in single precision.
const DOUBLE: Bounds = Bounds { system: 1e-12, acceleration: Some(1e-6) };
const SINGLE: Bounds = Bounds { system: 1e-5, acceleration: None };

/// Accelerations of rapier's multibody joints in single precision may be off by this and by so many times the roundoff
/// of their differences. Measured on the shipped scenes: 1.4e-5 (`chain_10`) where they start at rest, otherwise at
/// most 2.9 times the roundoff (`joint_zoo`), 5.2 times where that is too large to judge (`tumbling_body`).
const SINGLE_LEAST: f64 = 4e-5;
const SINGLE_ROUNDOFF: f64 = 8.0;
/// A larger bound judges nothing: 1 % of the inertia of `heavy_top` changes its accelerations by 5e-3.
const SINGLE_MOST: f64 = 4e-3;

/// In double precision for engines whose constraints iterations solve. With the iterations taken to the end, their
/// second step still holds a correction of the joints. Measured on the shipped scenes whose motion the steps resolve:
/// 7e-2 of the largest acceleration on `joint_zoo`, 6e-3 on `torso`, 4e-3 on `arm_6`, 3e-7 and less on the other trees.
/// The bound finds a joint, an axis, a force or a body that is missing or wrong; what is smaller shows in the masses
/// and inertias that are read back from such engines.
const ITERATED: Bounds = Bounds { system: 1e-12, acceleration: Some(0.2) };

/// Steps for the accelerations, s: long enough that roundoff does not hide one percent of an inertia.
const DOUBLE_STEP: f64 = 1e-4;
const SINGLE_STEP: f64 = 2e-3;

/// The accelerations of the reference agree to this with those from half the step, or the steps do not resolve the
/// motion.
const RESOLVED: f64 = 1e-7;

/// The engine that accelerations are compared with.
pub(crate) const REFERENCE: &str = "reference";

impl Parity {
    /// Whether all that was found stands within the bounds. Accelerations are judged with the constraints solved.
    pub fn agrees(&self) -> bool {
        let held = self.held.unwrap_or_default();
        let system = [held.mass, held.inertia, held.com, self.start.energy, self.momentum[0], self.momentum[1]];
        let acceleration = self.acceleration_solved.or(self.acceleration);
        system.iter().all(|difference| *difference <= self.bounds.system)
            && match (acceleration, self.bounds.acceleration) {
                (Some(difference), Some(bound)) => difference <= bound,
                _ => true,
            }
    }
}

/// The differences between what each engine makes of the system that it is given, as far as it can be built, and a
/// system; a comparison gives them the same.
pub fn parity(given: &System, system: &System, engines: &[Spec]) -> Vec<Parity> {
    let truth = |step: f64| Spec::parse(REFERENCE).ok().and_then(|spec| accelerations(&spec, system, step));
    let (double, single) = (truth(DOUBLE_STEP), truth(SINGLE_STEP));
    let resolved = truth(0.5 * DOUBLE_STEP)
        .zip(double.as_ref())
        .and_then(|(half, whole)| relative(&half, whole))
        .is_some_and(|difference| difference <= RESOLVED);
    let single_bound = single.as_deref().and_then(|truth| single_bound(system, truth));
    let against =
        |bounds: Bounds| if bounds.system == SINGLE.system { (&single, SINGLE_STEP) } else { (&double, DOUBLE_STEP) };
    engines
        .iter()
        .filter_map(|spec| {
            let bounds = match engines::converged(spec) {
                None if resolved && is_single(spec, given) => Bounds { acceleration: single_bound, ..SINGLE },
                _ if is_single(spec, given) => SINGLE,
                Some(_) if resolved => ITERATED,
                None if resolved => DOUBLE,
                _ => Bounds { acceleration: None, ..DOUBLE },
            };
            let (truth, step) = against(bounds);
            of(spec, given, system, truth.as_deref(), bounds, step)
        })
        .collect()
}

/// What accelerations in single precision may be off by, relative to the largest of them; `None` where roundoff hides
/// what they are. In the quotients of [`accelerations`], of which the one of the shortest step has a weight of `8/3`,
/// half a unit of the last digit of `w`, the largest velocity within two steps, is
///
/// ```text
/// 16 2^-24 w / h ,   w = w(0) + 2 h |a| .
/// ```
fn single_bound(system: &System, truth: &[f64]) -> Option<f64> {
    let largest = truth.iter().fold(1.0, |scale: f64, a| scale.max(a.abs()));
    let bodies = system.initial.bodies.iter().map(|body| body.velocity.norm().max(body.angular_velocity.norm()));
    let speed = bodies.fold(0.0, f64::max) + 2.0 * SINGLE_STEP * largest;
    let roundoff = 16.0 * 0.5f64.powi(24) * speed / (SINGLE_STEP * largest);
    let bound = SINGLE_LEAST.max(SINGLE_ROUNDOFF * roundoff);
    (bound <= SINGLE_MOST).then_some(bound)
}

/// Single precision shows in the masses that are held.
fn is_single(spec: &Spec, system: &System) -> bool {
    engines::held(spec, system, DOUBLE_STEP).is_some_and(|held| held.single)
}

/// Compares an engine that was given one system with another system and its accelerations.
fn of(
    spec: &Spec,
    given: &System,
    system: &System,
    truth: Option<&[f64]>,
    bounds: Bounds,
    step: f64,
) -> Option<Parity> {
    let engine = engines::build(spec, given, step).ok()?;
    let mut state = given.initial.clone();
    engine.write_state(&mut state);
    let held = engines::held(spec, given, step);
    let theirs = held.as_ref().map_or_else(|| given.clone(), |held| held.as_system(given));
    // An engine without finite accelerations differs by more than any bound.
    let difference = |spec: &Spec| {
        truth.map(|truth| accelerations(spec, given, step).and_then(|a| relative(&a, truth)).unwrap_or(f64::MAX))
    };
    Some(Parity {
        engine: spec.to_string(),
        held: held.as_ref().map(|held| held_difference(system, held)),
        start: StartDifference::of(&theirs, system, &state),
        momentum: momentum_difference(system, &theirs, &state),
        acceleration: difference(spec),
        acceleration_solved: engines::converged(spec).and_then(|spec| difference(&spec)),
        bounds,
    })
}

fn held_difference(system: &System, held: &engines::Held) -> HeldDifference {
    let mut all = HeldDifference::default();
    for (ours, theirs) in system.bodies.iter().zip(&held.bodies) {
        let axes = theirs.axes.angle();
        all.mass = all.mass.max((theirs.mass / ours.mass).add_scalar(-1.0).amax());
        all.inertia = all.inertia.max(theirs.inertia.component_div(&ours.inertia).add_scalar(-1.0).amax()).max(axes);
        all.com = all.com.max(theirs.com.norm());
    }
    all
}

/// Linear momentum, then angular momentum about the world's origin.
fn momentum(system: &System, state: &State) -> [Vector3<f64>; 2] {
    let mut total = [Vector3::zeros(); 2];
    for (body, s) in system.bodies.iter().zip(&state.bodies) {
        let omega = s.attitude.inverse_transform_vector(&s.angular_velocity);
        let linear = body.mass * s.velocity;
        total[0] += linear;
        total[1] += s.position.cross(&linear) + s.attitude * body.inertia.component_mul(&omega);
    }
    total
}

fn momentum_difference(system: &System, theirs: &System, state: &State) -> [f64; 2] {
    let bodies = || system.bodies.iter().zip(&system.initial.bodies);
    let mass: f64 = bodies().map(|(body, _)| body.mass).sum();
    let inertia: f64 = bodies().map(|(b, s)| b.mass * s.position.norm_squared() + b.inertia.max()).sum();
    let scales = [mass, inertia].map(|m| (2.0 * m * system.energy_scale).sqrt());
    let (ours, theirs) = (momentum(system, &system.initial), momentum(theirs, state));
    std::array::from_fn(|i| (ours[i] - theirs[i]).norm() / scales[i])
}

/// The accelerations of all joint coordinates at t = 0 as an engine's steps of about `h` (s) have them.
fn accelerations(spec: &Spec, system: &System, h: f64) -> Option<Vec<f64>> {
    let [a, b, c] = [h, 0.5 * h, 0.25 * h].map(|h| quotient(spec, system, h));
    let (a, b, c) = (a?, b?, c?);
    Some(a.iter().zip(&b).zip(&c).map(|((a, b), c)| (a - 6.0 * b + 8.0 * c) / 3.0).collect())
}

/// `(w(2h) - w(h)) / h` of all joint velocities.
fn quotient(spec: &Spec, system: &System, h: f64) -> Option<Vec<f64>> {
    let mut engine = engines::build(spec, system, h).ok()?;
    let mut next = || -> Option<Vec<f64>> {
        engine.step().ok()?;
        Some(joint_velocities(system, engine.as_ref()))
    };
    let (one, two) = (next()?, next()?);
    Some(one.iter().zip(&two).map(|(a, b)| (b - a) / h).collect())
}

fn joint_velocities(system: &System, engine: &dyn Engine) -> Vec<f64> {
    let mut state = system.initial.clone();
    engine.write_state(&mut state);
    let mut joints = system.initial_coordinates.clone();
    joint_coordinates(system, &state, &mut joints);
    let count = |i: usize| system.bodies[i].joint.kind.degrees_of_freedom();
    joints.iter().enumerate().flat_map(|(i, joint)| joint.velocity[..count(i)].to_vec()).collect()
}

fn relative(a: &[f64], b: &[f64]) -> Option<f64> {
    let scale = b.iter().fold(1.0, |scale: f64, x| scale.max(x.abs()));
    let worst = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let finite = a.iter().chain(b).all(|x| x.is_finite());
    finite.then_some(worst / scale)
}
