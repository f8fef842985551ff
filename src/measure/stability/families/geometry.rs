//! Sizes, shapes and positions at the edge.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Vector3};

use super::common::{ROD_LENGTH, ROD_RADIUS, SCAN, closure, start};
use crate::measure::stability::scan::{Family, FineRun, Length, Scan};
use crate::model::assemble::{Assembly, Mount};
use crate::model::scene::LoopKind;
use crate::model::{Inertial, Scene};

pub(super) static FAMILY: Family = Family {
    name: "geometry",
    title: "Extreme geometry",
    question: "do size, shape and singular positions matter?",
    explicit: false,
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
            length: Length::Time(4.0),
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
            truth: Some(FineRun { engine: "rattle:order=8", step: |_| 1e-3 }),
            scene: offset,
            ..SCAN
        },
        Scan {
            name: "four_bar",
            title: "a parallelogram that turns through its flat position",
            parameter: "length that the coupler is longer than the base by, m",
            full_values: &[0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2],
            quick_values: &[0.0, 1e-4],
            scene: four_bar,
            ..SCAN
        },
        Scan {
            name: "ladder",
            title: "parallelograms in a row, each loop with three redundant constraints",
            parameter: "loops",
            full_values: &[1.0, 2.0, 5.0, 10.0],
            quick_values: &[1.0, 5.0],
            length: Length::Time(1.0),
            scene: ladder,
            ..SCAN
        },
    ],
};

/// Two slender steel rods (7800 kg/m^3, a thirtieth as thick as long) from horizontal, hinges about y and z, elbow
/// bent.
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
    scene.initial[0] = start(&[0.0; 3], &[10.0, 0.0, 1.0]);
    scene
}

/// Hinges about z, y and x through one point with a gram between them, and a box of 1 kg that swings about y through
/// the position where the outer axes meet, up to the missing angle.
fn gimbal(miss: f64) -> Scene {
    let mut assembly = Assembly::new("gimbal");
    let ring = || Some(Inertial { mass: 1e-3, com: Vector3::zeros(), inertia: Matrix3::identity() * 1e-6 });
    let outer = assembly.add(0, Mount::hinge(Vector3::z_axis(), Vector3::zeros()), ring());
    let middle = assembly.add(outer, Mount::hinge(Vector3::y_axis(), Vector3::zeros()), ring());
    let body = Inertial { com: Vector3::new(0.1, 0.0, 0.0), ..Inertial::block(Vector3::new(0.3, 0.2, 0.1), 1.0) };
    assembly.add(middle, Mount::hinge(Vector3::x_axis(), Vector3::zeros()), Some(body));
    let mut scene = assembly.scene();
    // Rolled by the miss, so that the outer hinge must turn as fast as the lock is near.
    scene.initial = vec![start(&[0.0], &[miss.sqrt()]), start(&[FRAC_PI_2 - 1.0], &[2.0]), start(&[miss], &[0.0])];
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

/// Two cranks of 0.2 m on the ground, 0.5 m apart, and a coupler of 0.5 m and a little more between their tips. All
/// bars lie along x when the cranks point along it; the crank starts 1 rad above it, fast enough to go round.
fn four_bar(longer: f64) -> Scene {
    let (crank, base) = (0.2, 0.5);
    let mut scene = parallelograms(1, crank, base, longer, -1.0);
    scene.initial[0] = start(&[-1.0], &[15.0]);
    scene
}

/// Cranks of 0.3 m on the ground, 0.4 m apart, couplers between the tips of neighbours, from 0.5 rad below the
/// horizontal.
fn ladder(loops: f64) -> Scene {
    let mut scene = parallelograms(loops as usize, 0.3, 0.4, 0.0, 0.5);
    scene.initial[0] = start(&[0.5], &[0.0]);
    scene
}

/// `loops + 1` cranks at an angle with `loops` couplers; joints in the order crank, coupler, crank, coupler, ...,
/// crank.
fn parallelograms(loops: usize, crank: f64, base: f64, longer: f64, angle: f64) -> Scene {
    let mut assembly = Assembly::new("parallelograms");
    let hinge = |x| Mount::hinge(Vector3::y_axis(), Vector3::new(x, 0.0, 0.0));
    let bar = |length: f64| Some(Inertial::rod(length, 0.01, length));
    let mut cranks = vec![assembly.add(0, hinge(0.0), bar(crank))];
    let mut couplers = Vec::new();
    for i in 0..loops {
        couplers.push(assembly.add(cranks[i], hinge(crank), bar(base + longer)));
        cranks.push(assembly.add(0, hinge((i + 1) as f64 * base), bar(crank)));
    }
    let mut scene = assembly.scene();
    for (coupler, crank_after) in couplers.into_iter().zip(cranks.into_iter().skip(1)) {
        let tip = (Some(coupler), Vector3::new(base + longer, 0.0, 0.0));
        scene.loops.push(closure(LoopKind::Revolute, tip, (Some(crank_after), Vector3::new(crank, 0.0, 0.0))));
    }
    // Near the parallelogram; what is not given is solved for.
    for (i, initial) in scene.initial.iter_mut().enumerate() {
        initial.position = vec![if i > 0 && i % 2 == 1 { -angle } else { angle }];
    }
    scene
}
