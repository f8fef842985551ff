//! Initial states at the edge.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::common::{SCAN, chain, closure, start};
use crate::measure::stability::scan::{Family, Length, Scan};
use crate::model::Inertial;
use crate::model::Scene;
use crate::model::assemble::{Assembly, Mount};
use crate::model::scene::LoopKind;

pub(super) static FAMILY: Family = Family {
    name: "start",
    title: "Initial states",
    question: "is a state that is legal but odd taken as it is meant, and one that is impossible refused?",
    explicit: false,
    scans: &[
        Scan {
            name: "angle",
            title: "two rods, the elbow bent by many turns",
            parameter: "initial angle of the elbow, rad",
            full_values: &[-1e6, -PI, -1.0, 1.0, PI, 1e2, 1e4, 1e6],
            quick_values: &[-PI, PI, 1e6],
            scene: |angle| chain(2, |_| 1.0, angle),
            ..SCAN
        },
        Scan {
            name: "open_loop",
            title: "a swing of three rods whose given angles leave its loop open",
            parameter: "how far it is open, m",
            full_values: &[0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3],
            quick_values: &[0.0, 1e-3],
            length: Length::Time(1.0),
            scene: |open| swing(open, 0.0),
            ..SCAN
        },
        Scan {
            name: "velocity",
            title: "a swing of three rods, given velocities that tear it apart",
            parameter: "velocity of the last hinge that does not fit, rad/s",
            full_values: &[0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1.0],
            quick_values: &[0.0, 1.0],
            length: Length::Time(1.0),
            scene: |velocity| swing(0.0, velocity),
            ..SCAN
        },
    ],
};

/// Two ropes of one rod each and a seat of 0.3 m between them, 0.3 m wide at the top: a parallelogram, hanging 1 rad
/// from the vertical. The right rope is fixed to the ground `open` too far to the right; its hinge is given a velocity
/// that the others do not have.
fn swing(open: f64, velocity: f64) -> Scene {
    let mut assembly = Assembly::new("swing");
    let hinge = |x| Mount::hinge(Vector3::y_axis(), Vector3::new(x, 0.0, 0.0));
    let rod = || Some(Inertial::rod(0.3, 0.01, 1.0));
    let left = assembly.add(0, hinge(0.0), rod());
    let seat = assembly.add(left, hinge(0.3), rod());
    let right = assembly.add(seat, hinge(0.3), rod());
    let mut scene = assembly.scene();
    let (end, ground) = (Vector3::new(0.3, 0.0, 0.0), Vector3::new(0.3 + open, 0.0, 0.0));
    scene.loops = vec![closure(LoopKind::Revolute, (Some(right), end), (None, ground))];
    // Down by 1 rad from x, level, up again.
    let angle = PI / 2.0 - 1.0;
    scene.initial = vec![start(&[angle], &[0.0]), start(&[-angle], &[0.0]), start(&[angle - PI], &[velocity])];
    scene
}
