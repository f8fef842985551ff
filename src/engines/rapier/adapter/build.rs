//! Builds rapier's bodies and joints from a system and puts them at its initial state.

use std::f64::consts::PI;

use super::super::rapier::math::Real;
use super::super::rapier::prelude::{
    GenericJoint, IntegrationParameters, JointAxesMask, JointAxis, MassProperties, MotorModel, MultibodyIndex,
    PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients, SpringJointBuilder,
};
use super::super::{PRECISION, narrow};
use super::convert::{pose, vector};
use super::seat::Seat;
use crate::engines::engine::Unsupported;
use crate::engines::rapier::settings::Settings;
use crate::mechanics::{Body, Joint, JointSpring, System};

/// Rapier takes what is below it for zero when it inverts (`INV_EPSILON` of its `utils`).
const SMALLEST_INVERTED: f64 = 1e-20;

const AXES: [JointAxis; 6] =
    [JointAxis::LinX, JointAxis::LinY, JointAxis::LinZ, JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ];

/// The world, and where each body of the system sits in it.
pub(super) fn build(system: &System, settings: &Settings, step: f64) -> Result<(PhysicsWorld, Vec<Seat>), Unsupported> {
    check(system, settings, step).map_err(|what| Unsupported { engine: settings.spec.clone(), what })?;
    let mut physics = PhysicsWorld::new();
    physics.gravity = vector(&system.gravity);
    physics.integration_parameters = parameters(settings, step);
    physics.physics_pipeline.counters.disable();
    let handles = insert_bodies(system, settings, &mut physics);
    insert_joints(system, settings, &handles, &mut physics)?;
    insert_point_springs(system, &handles, &mut physics);
    let link_of = |body| physics.multibody_joints.rigid_body_link(body).map(|link| (link.multibody, link.id));
    let seats: Vec<Seat> = (system.bodies.iter().zip(&handles))
        .map(|(body, &handle)| Seat { name: body.name.clone(), body: handle, link: link_of(handle) })
        .collect();
    place_multibodies(system, &seats, &mut physics);
    Ok((physics, seats))
}

/// Whether the numbers of the system mean to rapier what they mean to us; says what does not.
fn check(system: &System, settings: &Settings, step: f64) -> Result<(), String> {
    let substep = narrow(step) / narrow(settings.substeps as f64);
    if !substep.is_normal() {
        return Err(format!("a step of {step:e} s in {} substeps: it vanishes in {PRECISION}", settings.substeps));
    }
    if !vector(&system.gravity).is_finite() {
        return Err(format!("a gravity of {:e} m/s^2: it overflows in {PRECISION}", system.gravity.norm()));
    }
    for (i, body) in system.bodies.iter().enumerate() {
        let values =
            [("mass", body.mass), ("moment of inertia", body.inertia.min()), ("moment of inertia", body.inertia.max())];
        for (what, value) in values {
            let inverse = narrow(1.0) / narrow(value);
            if !(narrow(value).is_normal() && inverse.is_normal() && inverse > narrow(SMALLEST_INVERTED)) {
                let name = &body.name;
                return Err(format!(
                    "the {what} {value:e} of body '{name}': its inverse vanishes or overflows in {PRECISION}"
                ));
            }
        }
        let name = &body.joint.name;
        let spring = system.joint_spring(i);
        let whose = format!("of joint '{name}'");
        check_spring(spring.stiffness, spring.damping, substep, !settings.joints.are_coordinates(), &whose)?;
        let wound = system.initial_coordinates[i].position[0] - spring.rest;
        let turns = spring.stiffness > 0.0 && body.joint.kind.angle_index().is_some() && wound.abs() > PI;
        if turns && !settings.joints.are_coordinates() {
            return Err(format!("a spring {whose} wound up by {wound:.3} rad: a motor knows angles modulo a turn"));
        }
    }
    for (i, spring) in system.parts.point_springs.iter().enumerate() {
        if settings.joints.are_coordinates() {
            return Err("springs between points with joints=multibody: a spring joint does not act on its links".into());
        }
        check_spring(spring.stiffness, spring.damping, substep, true, &format!("of point spring {i}"))?;
    }
    Ok(())
}

/// Whether a spring's numbers stay numbers in a substep. A motor is solved with the compliance `1 / (h^2 k + h c)`,
/// which rapier takes for zero, a lock, where the denominator is too small.
fn check_spring(stiffness: f64, damping: f64, substep: Real, motor: bool, whose: &str) -> Result<(), String> {
    let numbers = || match (stiffness > 0.0, damping > 0.0) {
        (true, true) => format!("the stiffness {stiffness:e} and damping {damping:e} {whose}"),
        (true, false) => format!("the stiffness {stiffness:e} {whose}"),
        _ => format!("the damping {damping:e} {whose}"),
    };
    let pull = substep * substep * narrow(stiffness) + substep * narrow(damping);
    if !(pull.is_finite() && narrow(stiffness).is_finite()) {
        return Err(format!("{}: it overflows in {PRECISION}", numbers()));
    }
    if motor && (stiffness > 0.0 || damping > 0.0) && pull <= narrow(SMALLEST_INVERTED) {
        return Err(format!("{}: so weak a motor acts as a lock", numbers()));
    }
    Ok(())
}

fn parameters(settings: &Settings, step: f64) -> IntegrationParameters {
    IntegrationParameters {
        dt: narrow(step),
        num_solver_iterations: settings.substeps,
        num_internal_pgs_iterations: settings.iterations,
        num_internal_stabilization_iterations: settings.stabilization,
        warmstart_joints: settings.warmstart,
        max_ccd_substeps: 0,
        normalized_max_linear_velocity: Real::MAX,
        ..IntegrationParameters::default()
    }
}

fn insert_bodies(system: &System, settings: &Settings, physics: &mut PhysicsWorld) -> Vec<RigidBodyHandle> {
    let bodies = system.bodies.iter().zip(&system.initial.bodies);
    bodies
        .map(|(body, state)| {
            let properties = MassProperties::new(vector(&Default::default()), narrow(body.mass), vector(&body.inertia));
            let mut built = RigidBodyBuilder::dynamic()
                .pose(pose(&state.pose()))
                .linvel(vector(&state.velocity))
                .angvel(vector(&state.angular_velocity))
                .additional_mass_properties(properties)
                .gyroscopic_forces_enabled(settings.gyro)
                .allow_fast_rotation(true)
                .can_sleep(false)
                .build();
            // Otherwise the mass reads 0 until the first step.
            built.recompute_mass_properties_from_colliders(&physics.colliders);
            physics.insert_body(built)
        })
        .collect()
}

fn insert_joints(
    system: &System,
    settings: &Settings,
    handles: &[RigidBodyHandle],
    physics: &mut PhysicsWorld,
) -> Result<(), Unsupported> {
    for (i, (Body { joint, .. }, &child)) in system.bodies.iter().zip(handles).enumerate() {
        let data = generic_joint(joint, &system.joint_spring(i), settings);
        if joint.kind.is_free() && joint.damping == 0.0 {
            continue;
        }
        // A ground for each tree, so that two trees are two multibodies.
        let parent = match joint.parent {
            Some(parent) => handles[parent],
            None => physics.insert_body(RigidBodyBuilder::fixed()),
        };
        if settings.joints.are_coordinates() {
            let inserted = physics.multibody_joints.insert(parent, child, data, true);
            inserted.ok_or_else(|| Unsupported {
                engine: settings.spec.clone(),
                what: format!("joint '{}': rapier's multibody does not accept it as part of a tree", joint.name),
            })?;
        } else {
            physics.impulse_joints.insert(parent, child, data, true);
        }
    }
    Ok(())
}

fn insert_point_springs(system: &System, handles: &[RigidBodyHandle], physics: &mut PhysicsWorld) {
    for spring in &system.parts.point_springs {
        let [from, to] = [&spring.from, &spring.to]
            .map(|anchor| anchor.body.map_or_else(|| physics.insert_body(RigidBodyBuilder::fixed()), |b| handles[b]));
        let joint =
            SpringJointBuilder::new(narrow(spring.rest_length), narrow(spring.stiffness), narrow(spring.damping))
                .spring_model(MotorModel::ForceBased)
                .local_anchor1(vector(&spring.from.point))
                .local_anchor2(vector(&spring.to.point));
        physics.impulse_joints.insert(from, to, joint, true);
    }
}

/// The joint as rapier sees it: our joint frames, the components that are not free locked, a motor that is spring and
/// damper on each that is.
fn generic_joint(joint: &Joint, spring: &JointSpring, settings: &Settings) -> GenericJoint {
    let free = joint.kind.free();
    let locked = (0..6).filter(|&i| !free[i]).fold(JointAxesMask::empty(), |mask, i| mask | AXES[i].into());
    let mut data = GenericJoint::new(locked);
    data.local_frame1 = pose(&joint.in_parent);
    data.local_frame2 = pose(&joint.in_child);
    data.softness = SpringCoefficients::new(narrow(settings.softness), narrow(settings.damping_ratio));
    if (spring.stiffness > 0.0 || spring.damping > 0.0) && !settings.joints.are_coordinates() {
        let (rest, stiffness, damping) = (narrow(spring.rest), narrow(spring.stiffness), narrow(spring.damping));
        for axis in (0..6).filter(|&i| free[i]).map(|i| AXES[i]) {
            data.set_motor_model(axis, MotorModel::ForceBased);
            data.set_motor_position(axis, rest, stiffness, damping);
            data.set_motor_max_force(axis, Real::INFINITY);
        }
    }
    data
}

/// Writes joint coordinates, generalized velocities and damping into every multibody, and the poses that follow from
/// them into its bodies. The first call of `forward_kinematics` settles whether the root is fixed and with that the
/// place of each coordinate; it reads the pose of a free root from its body.
fn place_multibodies(system: &System, seats: &[Seat], physics: &mut PhysicsWorld) {
    let mut indices: Vec<MultibodyIndex> = Vec::new();
    for index in seats.iter().filter_map(|seat| seat.link).map(|(index, _)| index) {
        if !indices.contains(&index) {
            indices.push(index);
        }
    }
    for index in indices {
        let Some(multibody) = physics.multibody_joints.get_multibody_mut(index) else { continue };
        multibody.forward_kinematics(&physics.bodies, true);
        let mut positions = vec![narrow(0.0); multibody.ndofs()];
        let mut velocities = positions.clone();
        let mut dampings = positions.clone();
        for (i, seat) in seats.iter().enumerate() {
            let Some((_, id)) = seat.link.filter(|(of, _)| *of == index) else { continue };
            let Some(link) = multibody.link_mut(id) else { continue };
            let (start, count) = (link.assembly_id(), link.joint().ndofs());
            if id == 0 {
                // A free root: world velocities of its centre of mass; its pose has been read above.
                let state = &system.initial.bodies[i];
                let twist = state.velocity.iter().chain(state.angular_velocity.iter());
                for (slot, value) in velocities[start..].iter_mut().zip(twist) {
                    *slot = narrow(*value);
                }
                continue;
            }
            let spring = system.joint_spring(i);
            let free = system.bodies[i].joint.kind.free();
            if let Some(axis) = (0..6).find(|&axis| free[axis]).filter(|_| spring.stiffness > 0.0) {
                link.joint.set_spring(axis, narrow(spring.stiffness), narrow(spring.rest));
            }
            let theta = &system.initial_coordinates[i];
            for k in 0..count {
                positions[start + k] = narrow(theta.position[k]);
                velocities[start + k] = narrow(theta.velocity[k]);
                dampings[start + k] = narrow(spring.damping);
            }
        }
        multibody.damping_mut().copy_from_slice(&dampings);
        multibody.apply_displacements(&positions);
        multibody.forward_kinematics(&physics.bodies, false);
        multibody.generalized_velocity_mut().copy_from_slice(&velocities);
        multibody.update_rigid_bodies(&mut physics.bodies, true);
    }
}
