//! Models put together in code, link by link.

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};

use super::joint::{Joint, JointKind};
use super::link::{Inertial, Link};
use super::robot::Model;
use super::scene::Scene;

/// A model in the making. Its root is a massless link `base`.
#[derive(Clone, Debug)]
pub struct Assembly {
    model: Model,
}

/// How a link hangs on its parent.
#[derive(Clone, Copy, Debug)]
pub struct Mount {
    pub kind: JointKind,
    /// In the child's frame; x where the kind has no axis.
    pub axis: Unit<Vector3<f64>>,
    /// Pose of the child's frame in the parent's at joint position zero.
    pub origin: Isometry3<f64>,
    /// N m s/rad or N s/m
    pub damping: f64,
}

impl Mount {
    /// A hinge about an axis through a point of the parent, m.
    pub fn hinge(axis: Unit<Vector3<f64>>, at: Vector3<f64>) -> Mount {
        Mount::of(JointKind::Continuous, axis, at)
    }

    /// A slider along an axis.
    pub fn slider(axis: Unit<Vector3<f64>>, at: Vector3<f64>) -> Mount {
        Mount::of(JointKind::Prismatic, axis, at)
    }

    /// A ball joint.
    pub fn ball(at: Vector3<f64>) -> Mount {
        Mount::of(JointKind::Spherical, Vector3::x_axis(), at)
    }

    /// No joint at all.
    pub fn free() -> Mount {
        Mount::of(JointKind::Floating, Vector3::x_axis(), Vector3::zeros())
    }

    fn of(kind: JointKind, axis: Unit<Vector3<f64>>, at: Vector3<f64>) -> Mount {
        let origin = Isometry3::from_parts(Translation3::from(at), UnitQuaternion::identity());
        Mount { kind, axis, origin, damping: 0.0 }
    }
}

impl Assembly {
    pub fn new(name: &str) -> Assembly {
        let base = Link { name: "base".to_owned(), inertial: None, collisions: Vec::new() };
        Assembly {
            model: Model {
                name: name.to_owned(),
                links: vec![base],
                joints: Vec::new(),
                ignored: Vec::new(),
                remarks: Vec::new(),
            },
        }
    }

    /// Adds a link on a parent, by its index (0 is the base), and returns the index of the new one. Joint `i` carries
    /// link `i + 1`; they are named `joint_<i + 1>` and `link_<i + 1>`.
    pub fn add(&mut self, parent: usize, mount: Mount, inertial: Option<Inertial>) -> usize {
        let child = self.model.links.len();
        let Mount { kind, axis, origin, damping } = mount;
        self.model.links.push(Link { name: format!("link_{child}"), inertial, collisions: Vec::new() });
        self.model.joints.push(Joint {
            name: format!("joint_{child}"),
            kind,
            parent,
            child,
            origin,
            axis,
            damping,
            friction: 0.0,
            mimic: None,
        });
        child
    }

    /// A scene of the model with defaults: gravity along -z, everything at rest at zero.
    pub fn scene(self) -> Scene {
        let name = self.model.name.clone();
        Scene::of_model(&name, self.model)
    }
}

impl Inertial {
    /// A solid cylinder along x from the link's origin: `Ixx = m r^2 / 2`, `Iyy = Izz = m (3 r^2 + l^2) / 12`. Lengths
    /// m, mass kg.
    pub fn rod(length: f64, radius: f64, mass: f64) -> Inertial {
        let across = mass * (3.0 * radius * radius + length * length) / 12.0;
        let moments = Vector3::new(0.5 * mass * radius * radius, across, across);
        Inertial { mass, com: Vector3::new(0.5 * length, 0.0, 0.0), inertia: Matrix3::from_diagonal(&moments) }
    }

    /// A solid disc across z, its centre at `height` (m) above the link's origin.
    pub(crate) fn disc(radius: f64, thickness: f64, mass: f64, height: f64) -> Inertial {
        let across = mass * (3.0 * radius * radius + thickness * thickness) / 12.0;
        let moments = Vector3::new(across, across, 0.5 * mass * radius * radius);
        Inertial { mass, com: Vector3::new(0.0, 0.0, height), inertia: Matrix3::from_diagonal(&moments) }
    }

    /// A solid box of the given sides, centred on the link's origin.
    pub fn block(sides: Vector3<f64>, mass: f64) -> Inertial {
        let squares = sides.component_mul(&sides);
        let moments = squares.map(|square| mass / 12.0 * (squares.sum() - square));
        Inertial { mass, com: Vector3::zeros(), inertia: Matrix3::from_diagonal(&moments) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::System;

    #[test]
    fn a_rod_on_a_slider_on_a_hinge_has_the_masses_that_were_given() {
        let mut assembly = Assembly::new("crane");
        let arm =
            assembly.add(0, Mount::hinge(Vector3::z_axis(), Vector3::zeros()), Some(Inertial::rod(2.0, 0.1, 3.0)));
        assembly.add(
            arm,
            Mount::slider(Vector3::x_axis(), Vector3::x()),
            Some(Inertial::block(Vector3::repeat(0.6), 5.0)),
        );
        let system = System::compile(&assembly.scene()).expect("compiles");
        assert_eq!(system.degrees_of_freedom(), 2);
        assert_eq!((system.bodies[0].mass, system.bodies[1].mass), (3.0, 5.0));
        let rod = Vector3::new(0.015, 3.0 * 4.03 / 12.0, 3.0 * 4.03 / 12.0);
        approx::assert_relative_eq!(system.bodies[0].inertia, rod, epsilon = 1e-15);
        // A cube: m a^2 / 6.
        approx::assert_relative_eq!(system.bodies[1].inertia, Vector3::repeat(0.3), epsilon = 1e-15);
        assert_eq!(system.initial.bodies[1].position, Vector3::x());
    }
}
