//! Light links beside heavy ones.

use nalgebra::{Matrix3, Vector3};

use super::common::{ROD_LENGTH, ROD_RADIUS, SCAN, chain};
use crate::measure::stability::scan::{Family, FineRun, Length, Scan};
use crate::model::assemble::{Assembly, Mount};
use crate::model::{Inertial, Scene};

const RATIOS: &[f64] = &[1e-7, 1e-5, 1e-3, 1e-1, 1e1, 1e3, 1e5, 1e7];
const QUICK_RATIOS: &[f64] = &[1e-7, 1e1, 1e7];

const TIP: Scan = Scan {
    parameter: "mass of the last rod over that of the others",
    full_values: RATIOS,
    quick_values: QUICK_RATIOS,
    length: Length::Time(3.0),
    truth: Some(FineRun { engine: "rattle:order=8", step: |ratio| if ratio > 10.0 { 1e-4 } else { 1e-3 } }),
    ..SCAN
};

pub(super) static FAMILY: Family = Family {
    name: "mass_ratio",
    title: "Mass ratios",
    question: "does a light link keep a heavy one?",
    explicit: false,
    scans: &[
        Scan { name: "tip_of_2", title: "two rods, the last light or heavy", scene: |r| tip(2, r), ..TIP },
        Scan { name: "tip_of_5", title: "five rods, the last light or heavy", scene: |r| tip(5, r), ..TIP },
        Scan {
            name: "tip_of_20",
            title: "twenty rods, the last light or heavy",
            scene: |r| tip(20, r),
            truth: Some(FineRun { engine: "rattle:order=4", step: |ratio| if ratio > 10.0 { 5e-4 } else { 1e-3 } }),
            ..TIP
        },
        Scan {
            name: "snap",
            title: "five rods, slack by 0.1 rad at each hinge, pulled taut by the last",
            full_values: &[1.0, 1e1, 1e2, 1e3, 1e5, 1e7],
            quick_values: &[1e1, 1e3],
            length: Length::Time(0.2),
            scene: |ratio| chain(5, |i| if i == 5 { ratio } else { 1.0 }, 0.1),
            ..TIP
        },
        Scan {
            name: "middle_of_3",
            title: "three rods, the middle one light or without mass",
            parameter: "mass of the middle rod over that of the others",
            full_values: &[0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 1e-1],
            quick_values: &[0.0, 1e-3],
            scene: |ratio| chain(3, |i| if i == 2 { ratio } else { 1.0 }, 0.1),
            ..TIP
        },
        Scan {
            name: "point_mass",
            title: "two rods, the last ever closer to a point mass, and one",
            parameter: "radius of gyration, m",
            full_values: &[0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1],
            quick_values: &[0.0, 1e-2],
            scene: point_mass,
            ..TIP
        },
        Scan {
            name: "cart",
            title: "a pole of 1 kg on a cart, light or without mass",
            parameter: "mass of the cart, kg",
            full_values: &[0.0, 1e-6, 1e-4, 1e-2, 1.0, 1e2],
            quick_values: &[1e-6, 1.0],
            scene: cart,
            ..TIP
        },
    ],
};

/// Rods from horizontal in a straight line, all hinges about y.
fn tip(n: usize, ratio: f64) -> Scene {
    let mut scene = chain(n, |i| if i == n { ratio } else { 1.0 }, 0.0);
    for joint in &mut scene.model.joints {
        joint.axis = Vector3::y_axis();
    }
    scene
}

/// A rod that carries 1 kg of the given radius of gyration on a hinge 0.3 m away from it.
fn point_mass(gyration: f64) -> Scene {
    let mut assembly = Assembly::new("point_mass");
    let hinge = |x| Mount::hinge(Vector3::y_axis(), Vector3::new(x, 0.0, 0.0));
    let rod = assembly.add(0, hinge(0.0), Some(Inertial::rod(ROD_LENGTH, ROD_RADIUS, 1.0)));
    let inertia = Matrix3::from_diagonal_element(gyration * gyration);
    let point = Inertial { mass: 1.0, com: Vector3::new(ROD_LENGTH, 0.0, 0.0), inertia };
    assembly.add(rod, hinge(ROD_LENGTH), Some(point));
    assembly.scene()
}

/// A cart on a rail along x; its pole of 1 m starts 1 rad from upright.
fn cart(mass: f64) -> Scene {
    let mut assembly = Assembly::new("cart");
    let block = Some(Inertial::block(Vector3::new(0.4, 0.2, 0.2), mass)).filter(|block| block.mass > 0.0);
    let cart = assembly.add(0, Mount::slider(Vector3::x_axis(), Vector3::zeros()), block);
    assembly.add(cart, Mount::hinge(Vector3::y_axis(), Vector3::zeros()), Some(Inertial::rod(1.0, 0.02, 1.0)));
    let mut scene = assembly.scene();
    scene.initial[1].position = vec![1.0 - std::f64::consts::FRAC_PI_2];
    scene
}
