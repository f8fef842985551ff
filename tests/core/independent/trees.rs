//! Random trees of bodies in random states on their constraint manifold.

use std::ops::Range;

use nalgebra::{Isometry3, Vector3};
use proptest::array::{uniform3, uniform6};
use proptest::prelude::*;
use rattlebench::mechanics::coordinates::{JointCoordinates, forward_kinematics};
use rattlebench::mechanics::{Body, Closure, Joint, JointKind, Mobility, Parts, System};
use rattlebench::model::scene::LoopKind;

/// All joint kinds.
pub const KINDS: [JointKind; 5] =
    [JointKind::Revolute, JointKind::Prismatic, JointKind::Planar, JointKind::Spherical, JointKind::Floating];

/// All kinds of loop joints.
pub const LOOPS: [LoopKind; 4] = [LoopKind::Revolute, LoopKind::Spherical, LoopKind::Prismatic, LoopKind::Fixed];

/// A frame fixed in a body.
fn frame() -> impl Strategy<Value = Isometry3<f64>> {
    (uniform3(-0.5..0.5), uniform3(-2.0..2.0))
        .prop_map(|(offset, turn)| Isometry3::new(Vector3::from(offset), Vector3::from(turn)))
}

/// A body on a joint to the ground or to any body before it.
fn body(index: usize) -> impl Strategy<Value = (Body, JointCoordinates)> {
    (
        -1.0..1.0_f64,
        uniform3(0.02..0.2_f64),
        (prop::sample::select(&KINDS), 0..=index),
        (frame(), frame()),
        (uniform6(-1.0..1.0), uniform6(prop_oneof![0.5..3.0, -3.0..-0.5])),
    )
        .prop_map(move |(exponent, spread, (kind, parent), (in_parent, in_child), (position, velocity))| {
            let mass = 10_f64.powf(exponent);
            // Second moments of the mass along the axes, kg m^2.
            let jd = spread.map(|s| mass * s * s);
            let inertia = Vector3::new(jd[1] + jd[2], jd[2] + jd[0], jd[0] + jd[1]);
            let parent = parent.checked_sub(1);
            let joint = Joint { name: format!("joint {index}"), kind, parent, in_parent, in_child, damping: 0.0 };
            let d = kind.degrees_of_freedom();
            let first = |values: [f64; 6]| std::array::from_fn(|k| if k < d { values[k] } else { 0.0 });
            let theta = JointCoordinates { position: first(position), velocity: first(velocity) };
            (Body { name: format!("body {index}"), mass, inertia, joint }, theta)
        })
}

/// A tree of 1 to 5 bodies under gravity in any direction.
pub fn tree() -> impl Strategy<Value = System> {
    let bodies = (1_usize..=5).prop_flat_map(|n| (0..n).map(body).collect::<Vec<_>>());
    (bodies, uniform3(-10.0..10.0)).prop_map(|(list, gravity)| {
        let (bodies, initial_coordinates): (Vec<_>, Vec<_>) = list.into_iter().unzip();
        System {
            name: "random tree".into(),
            initial: forward_kinematics(&bodies, &initial_coordinates),
            bodies,
            gravity: Vector3::from(gravity),
            initial_coordinates,
            energy_scale: 1.0,
            floating_base: None,
            parts: Parts::default(),
            mobility: Mobility::default(),
        }
    })
}

/// A tree of 2 to 5 bodies with one or two loops. Each is a joint laid where two bodies happen to be, so that it is closed;
/// the velocities are not yet consistent with it.
pub fn linkage() -> impl Strategy<Value = System> {
    let closure = (prop::sample::select(&LOOPS), any::<prop::sample::Index>(), any::<prop::sample::Index>(), frame());
    (tree().prop_filter("two bodies", |system| system.bodies.len() > 1), prop::collection::vec(closure, 1..=2))
        .prop_map(|(mut system, closures)| {
            for (kind, child, parent, in_child) in closures {
                let n = system.bodies.len();
                let child = child.index(n);
                // Any other body, or the ground.
                let parent = (child + 1 + parent.index(n)) % (n + 1);
                let parent = (parent < n).then_some(parent);
                let pose = |body: usize| {
                    let state = &system.initial.bodies[body];
                    Isometry3::from_parts(state.position.into(), state.attitude)
                };
                let in_parent = parent.map_or(Isometry3::identity(), |b| pose(b).inverse()) * pose(child) * in_child;
                let name = format!("loop {}", system.parts.loops.len());
                system.parts.loops.push(Closure { name, kind, parent, child: Some(child), in_parent, in_child });
            }
            system
        })
}

/// A step of `10^exponent` s, forward or, as in the compositions of high order, backward.
pub fn step_size(exponents: Range<f64>) -> impl Strategy<Value = f64> {
    (exponents, any::<bool>()).prop_map(|(exponent, backward)| {
        let h = 10_f64.powf(exponent);
        if backward { -h } else { h }
    })
}
