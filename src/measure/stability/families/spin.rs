//! Bodies that turn far in a step.

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};

use super::common::{SCAN, start};
use crate::measure::stability::scan::{Family, FineRun, Length, Scan};
use crate::model::assemble::{Assembly, Mount};
use crate::model::scene::JointInitial;
use crate::model::{Base, Inertial, Scene};

const SPIN: Scan = Scan {
    parameter: "spin, rad/s",
    full_values: &[1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0],
    quick_values: &[10.0, 300.0, 3000.0],
    full_steps: &[0.01, 1.0 / 240.0, 0.001, 1e-4, 1e-5],
    length: Length::Time(1.0),
    truth: Some(FineRun { engine: "rattle:order=8", step: |spin| (0.3 / spin).min(1e-3) }),
    ..SCAN
};

pub(super) static FAMILY: Family = Family {
    name: "spin",
    title: "Fast spin",
    question: "is a body that turns by a radian and more in a step still right?",
    explicit: true,
    scans: &[
        Scan { name: "top", title: "a heavy disc on a ball joint, spinning about its axis", scene: top, ..SPIN },
        Scan { name: "rod", title: "a slender rod on a ball joint, swept about the vertical", scene: rod, ..SPIN },
        Scan { name: "box", title: "a free box, tumbling about its middle axis", scene: tumbling, ..SPIN },
        Scan {
            name: "needle",
            title: "a free slender rod, spinning about its axis and wobbling",
            scene: needle,
            ..SPIN
        },
    ],
};

/// A disc of 1 kg, 5 cm in radius, 10 cm above its ball joint, tilted by 0.3 rad.
fn top(spin: f64) -> Scene {
    let mut assembly = Assembly::new("top");
    assembly.add(0, Mount::ball(Vector3::zeros()), Some(Inertial::disc(0.05, 0.01, 1.0, 0.1)));
    let mut scene = assembly.scene();
    scene.initial[0] = turning(Vector3::new(0.3, 0.0, 0.0), Vector3::z() * spin);
    scene
}

/// A rod of 1 kg and 0.3 m, 1 cm thick, pointing 0.5 rad above the horizontal and swept about the vertical.
fn rod(spin: f64) -> Scene {
    let mut assembly = Assembly::new("rod");
    assembly.add(0, Mount::ball(Vector3::zeros()), Some(Inertial::rod(0.3, 0.005, 1.0)));
    let mut scene = assembly.scene();
    let tilt = Vector3::new(0.0, -0.5, 0.0);
    let about_vertical = UnitQuaternion::new(tilt).inverse() * Vector3::z();
    scene.initial[0] = turning(tilt, about_vertical * spin);
    scene
}

/// Attitude as a rotation vector and angular velocity in body axes.
fn turning(attitude: Vector3<f64>, velocity: Vector3<f64>) -> JointInitial {
    let world = UnitQuaternion::new(attitude) * velocity;
    start(attitude.as_slice(), world.as_slice())
}

/// A box of 1 kg, 0.3 x 0.2 x 0.1 m, weightless.
fn tumbling(spin: f64) -> Scene {
    let direction = Unit::new_normalize(Vector3::new(0.01, 1.0, 0.01));
    free(Inertial::block(Vector3::new(0.3, 0.2, 0.1), 1.0), spin * *direction)
}

/// A rod of 1 kg and 0.3 m, 1 cm thick, weightless; its wobble is a tenth of its spin.
fn needle(spin: f64) -> Scene {
    let mut rod = Inertial::rod(0.3, 0.005, 1.0);
    rod.com = Vector3::zeros();
    free(rod, spin * Vector3::new(1.0, 0.1, 0.0))
}

/// A weightless body with an angular velocity.
fn free(inertial: Inertial, angular_velocity: Vector3<f64>) -> Scene {
    let mut scene = Assembly::new("free").scene();
    scene.model.links[0].inertial = Some(inertial);
    let linear_velocity = Vector3::zeros();
    Scene {
        gravity: Vector3::zeros(),
        base: Base::Floating { pose: Isometry3::identity(), linear_velocity, angular_velocity },
        ..scene
    }
}
