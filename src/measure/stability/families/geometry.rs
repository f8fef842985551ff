//! Sizes, shapes and positions at the edge.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Vector3};

use super::{Family, Length, ROD_LENGTH, ROD_RADIUS, SCAN, Scan, Truth};
use crate::model::assemble::{Assembly, Mount};
use crate::model::scene::JointInitial;
use crate::model::{Inertial, Scene};

pub(super) static FAMILY: Family = Family {
    name: "geometry",
    title: "Extreme geometry",
    question: "do size, shape and singular positions matter?",
    scans: &[
        Scan {
            name: "size",
            title: "a double pendulum of steel from dust to mountains",
            parameter: "length of a rod, m",
            full_values: &[1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6],
            quick_values: &[1e-6, 1.0, 1e6],
            clock: |length| f64::sqrt(length),
            clock_name: "√(length / 1 m)",
            scene: size,
            ..SCAN
        },
        Scan {
            name: "anisotropy",
            title: "a rod on a ball joint, ever thinner, spinning at 10 rad/s",
            parameter: "largest over smallest moment of inertia",
            full_values: &[1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
            quick_values: &[1e1, 1e6],
            length: Length::Time(1.0),
            scene: anisotropy,
            ..SCAN
        },
        Scan {
            name: "gimbal",
            title: "three hinges in a point, swung past gimbal lock",
            parameter: "angle by which lock is missed, rad",
            full_values: &[1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 1e-1],
            quick_values: &[1e-12, 1e-2],
            length: Length::Time(1.0),
            scene: gimbal,
            ..SCAN
        },
        Scan {
            name: "offset",
            title: "a slider on a turning arm, its centre of mass far from the rail",
            parameter: "offset, m",
            full_values: &[1e-2, 1.0, 1e2, 1e4, 1e6],
            quick_values: &[1.0, 1e6],
            length: Length::Time(1.0),
            truth: Truth::Fine { engine: "rattle:order=8", step: |_| 1e-3 },
            scene: offset,
            ..SCAN
        },
    ],
};

/// Two slender steel rods (7800 kg/m^3, a thirtieth as thick as long) from horizontal, hinges about y and z, elbow bent.
fn size(length: f64) -> Scene {
    let radius = length / 60.0;
    let mass = 7800.0 * std::f64::consts::PI * radius * radius * length;
    let mut assembly = Assembly::new("size");
    let rod = || Some(Inertial::rod(length, radius, mass));
    let first = assembly.add(0, Mount::hinge(Vector3::y_axis(), Vector3::zeros()), rod());
    assembly.add(first, Mount::hinge(Vector3::z_axis(), Vector3::new(length, 0.0, 0.0)), rod());
    let mut scene = assembly.scene();
    scene.initial[1].position = vec![0.1];
    scene
}

/// A rod of 1 kg and 0.3 m with the moment about its axis as far below the others as the ratio says.
fn anisotropy(ratio: f64) -> Scene {
    let mut rod = Inertial::rod(ROD_LENGTH, ROD_RADIUS, 1.0);
    rod.inertia[(0, 0)] = rod.inertia[(1, 1)] / ratio;
    let mut assembly = Assembly::new("anisotropy");
    assembly.add(0, Mount::ball(Vector3::zeros()), Some(rod));
    let mut scene = assembly.scene();
    scene.initial[0] = JointInitial { position: vec![0.0; 3], velocity: vec![10.0, 0.0, 1.0] };
    scene
}

/// Hinges about z, y and x through one point with a gram between them, and a box of 1 kg that swings about y through the
/// position where the outer axes meet, up to the missing angle.
fn gimbal(miss: f64) -> Scene {
    let mut assembly = Assembly::new("gimbal");
    let ring = || Some(Inertial { mass: 1e-3, com: Vector3::zeros(), inertia: Matrix3::identity() * 1e-6 });
    let outer = assembly.add(0, Mount::hinge(Vector3::z_axis(), Vector3::zeros()), ring());
    let middle = assembly.add(outer, Mount::hinge(Vector3::y_axis(), Vector3::zeros()), ring());
    let body = Inertial { com: Vector3::new(0.1, 0.0, 0.0), ..Inertial::block(Vector3::new(0.3, 0.2, 0.1), 1.0) };
    assembly.add(middle, Mount::hinge(Vector3::x_axis(), Vector3::zeros()), Some(body));
    let mut scene = assembly.scene();
    let start = |position, velocity| JointInitial { position: vec![position], velocity: vec![velocity] };
    // Rolled by the miss, so that the outer hinge must turn as fast as the lock is near.
    scene.initial = vec![start(0.0, miss.sqrt()), start(FRAC_PI_2 - 1.0, 2.0), start(miss, 0.0)];
    scene
}

/// A box of 1 kg on a rail along a turning arm of 1 kg; the rail's frame is `offset` away from the box, across the arm.
fn offset(offset: f64) -> Scene {
    let mut assembly = Assembly::new("offset");
    let arm = Some(Inertial::rod(1.0, 0.02, 1.0));
    let arm = assembly.add(0, Mount::hinge(Vector3::z_axis(), Vector3::zeros()), arm);
    let block = Inertial { com: Vector3::new(0.0, offset, 0.0), ..Inertial::block(Vector3::repeat(0.1), 1.0) };
    let rail = Mount::slider(Vector3::x_axis(), Vector3::new(0.5, -offset, 0.0));
    assembly.add(arm, rail, Some(block));
    let mut scene = assembly.scene();
    scene.initial[0].velocity = vec![2.0];
    scene
}
