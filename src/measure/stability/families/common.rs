//! What several families are made of.

use nalgebra::{Isometry3, Unit, Vector3};

use crate::measure::stability::scan::{FineRun, Length, Scan, seconds};
use crate::model::assemble::{Assembly, Mount};
use crate::model::scene::{FixedFrame, JointInitial, Loop, LoopKind};
use crate::model::{Inertial, Scene};

/// What most scans have in common.
pub(super) const SCAN: Scan = Scan {
    name: "",
    title: "",
    parameter: "",
    full_values: &[],
    quick_values: &[],
    full_steps: &[0.01, 1.0 / 240.0, 0.001, 1e-4],
    quick_steps: &[0.01, 0.001],
    length: Length::Time(4.0),
    clock: seconds,
    clock_name: "",
    scene: rods_of_two,
    truth: Some(FINE),
};

/// Order 8 at 1 ms.
pub(super) const FINE: FineRun = FineRun { engine: "rattle:order=8", step: |_| 1e-3 };

/// The rod that chains are made of: 0.3 m, 1 kg, 2 cm thick.
pub(super) const ROD_LENGTH: f64 = 0.3;

pub(super) const ROD_RADIUS: f64 = 0.01;

fn rods_of_two(_: f64) -> Scene {
    chain(2, |_| 1.0, 0.1)
}

/// A chain of rods along x from the ground, their hinges about y and z in turn, each bent by `bend` rad. Rod `i` of
/// `n`, from 1, has the mass `mass(i)` kg; none is an empty link.
pub(super) fn chain(n: usize, mass: impl Fn(usize) -> f64, bend: f64) -> Scene {
    let mut assembly = Assembly::new("chain");
    for i in 1..=n {
        let axis = if i % 2 == 1 { Vector3::y_axis() } else { Vector3::z_axis() };
        let reach = if i == 1 { 0.0 } else { ROD_LENGTH };
        let rod = Some(Inertial::rod(ROD_LENGTH, ROD_RADIUS, mass(i))).filter(|rod| rod.mass > 0.0);
        assembly.add(i - 1, Mount::hinge(axis, Vector3::new(reach, 0.0, 0.0)), rod);
    }
    let mut scene = assembly.scene();
    for initial in scene.initial.iter_mut().skip(1) {
        initial.position = vec![bend];
    }
    scene
}

/// An initial state that is all given.
pub(super) fn start(position: &[f64], velocity: &[f64]) -> JointInitial {
    JointInitial {
        position: position.to_vec(),
        velocity: velocity.to_vec(),
        position_given: true,
        velocity_given: true,
    }
}

/// A loop between a point of one link and a point of another (`None` is the ground), both frames parallel to those of
/// their links at joint position zero; hinges are about y.
pub(super) fn closure(
    kind: LoopKind,
    parent: (Option<usize>, Vector3<f64>),
    child: (Option<usize>, Vector3<f64>),
) -> Loop {
    let place = |(link, point): (Option<usize>, Vector3<f64>)| FixedFrame {
        link,
        origin: Isometry3::translation(point.x, point.y, point.z),
    };
    let (parent, child) = (place(parent), place(child));
    let number = |place: &FixedFrame| place.link.map_or("ground".to_string(), |link| link.to_string());
    let name = format!("loop_{}_{}", number(&parent), number(&child));
    Loop { name, kind, axis: Unit::new_unchecked(Vector3::y()), parent, child }
}
