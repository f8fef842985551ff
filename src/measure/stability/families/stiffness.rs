//! Dampers whose time constant is far below the step.

use super::{Family, SCAN, Scan, Truth, chain};
use crate::model::Scene;

pub(super) static FAMILY: Family = Family {
    name: "stiffness",
    title: "Stiff springs and dampers",
    question: "does a force that is far faster than the step stay harmless?",
    scans: &[Scan {
        name: "joint_damper",
        title: "two rods, a viscous damper in the elbow",
        parameter: "damping, N m s/rad",
        full_values: &[1e-2, 1.0, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12],
        quick_values: &[1.0, 1e6, 1e12],
        scene: joint_damper,
        truth: Truth::Fine { engine: "rattle", step: |_| 2e-5 },
        ..SCAN
    }],
};

/// Two rods from horizontal, the elbow bent by 0.5 rad and damped.
fn joint_damper(damping: f64) -> Scene {
    let mut scene = chain(2, |_| 1.0, 0.5);
    scene.model.joints[1].damping = damping;
    scene
}
