//! The entry in the list of engines.

use super::build::build;
use super::settings::{KEYS, Settings};
use crate::engines::entry::{Entry, is_converged};
use crate::engines::group::{Group, Origin};
use crate::engines::line_up::{Colour, Contestant, Look, Marker, Role};
use crate::engines::swept::{
    COMPOSED_STEPS, LONG_STEPS, QUICK_COMPOSED_STEPS, QUICK_LONG_STEPS, QUICK_SHORT_STEPS, STEPS, Swept,
};
use crate::engines::values::Values;
use crate::mechanics::Part;

static GROUP: Group = Group { name: "rattle", origin: Origin::Own };

pub(in crate::engines) const ENTRY: Entry = Entry {
    name: "rattle",
    summary: "variational RATTLE with holonomic joint constraints: symplectic, time-reversible",
    keys: KEYS,
    parts: &[Part::Loops, Part::Mimics, Part::JointSprings, Part::PointSprings, Part::Drives],
    group: &GROUP,
    contestants: &[
        Contestant {
            spec: "rattle",
            roles: &[Role::Compare, Role::Cost, Role::Stability],
            look: Some(Look { colour: Colour::Blue, marker: Marker::Circle }),
        },
        Contestant {
            spec: "rattle:order=8",
            roles: &[Role::Compare, Role::Cost],
            look: Some(Look { colour: Colour::Green, marker: Marker::TriangleDown }),
        },
    ],
    tuned: None,
    sweep: &[
        Swept::both("rattle", STEPS, QUICK_SHORT_STEPS),
        Swept::both("rattle:order=4", LONG_STEPS, QUICK_LONG_STEPS),
        Swept::full("rattle:order=6", COMPOSED_STEPS),
        Swept::both("rattle:order=8", COMPOSED_STEPS, QUICK_COMPOSED_STEPS),
    ],
    tolerance: None,
    nominal_cost,
    hold: None,
    converged: is_converged,
    crates: &[],
    build,
};

/// Fitted by eye to the figures in `benches/README.md`.
fn nominal_cost(spec: &Values, bodies: f64) -> f64 {
    1.5 * Settings::new(spec).composition.stages() as f64 * bodies
}
