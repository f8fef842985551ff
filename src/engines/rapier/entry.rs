//! The entry in the list of engines.

use super::settings::{Joints, KEYS, Precision, Settings};
use super::{double, single};
use crate::engines::engine::{Engine, Unsupported};
use crate::engines::entry::Entry;
use crate::engines::group::{Group, Origin};
use crate::engines::held::Held;
use crate::engines::line_up::{Colour, Contestant, Look, Marker, Role, Tuned};
use crate::engines::swept::{QUICK_SHORT_STEPS, SHORT_STEPS, SHORTEST_STEPS, Swept};
use crate::engines::values::Values;
use crate::mechanics::{Part, System};

static GROUP: Group = Group { name: "rapier", origin: Origin::Foreign };

pub(in crate::engines) const ENTRY: Entry = Entry {
    name: "rapier",
    summary: "rapier 0.36: impulse or multibody joints, f32 or f64; bare, what a rapier user gets by default",
    keys: KEYS,
    parts: &[Part::JointSprings, Part::PointSprings, Part::Drives],
    group: &GROUP,
    contestants: CONTESTANTS,
    tuned: Some(Tuned {
        best: "rapier, best of its settings",
        look: Look { colour: Colour::Orange, marker: Marker::Triangle },
        default: "its default settings, in single precision",
    }),
    sweep: SWEEP,
    tolerance: None,
    nominal_cost,
    hold: Some(hold),
    converged,
    crates: &["rapier3d", "rapier3d-f64"],
    build,
};

const CONTESTANTS: &[Contestant] = &[
    Contestant {
        spec: "rapier",
        roles: &[Role::Compare, Role::Cost, Role::Stability],
        look: Some(Look { colour: Colour::Vermillion, marker: Marker::Square }),
    },
    Contestant { spec: "rapier:precision=f64", roles: &[Role::Cost], look: None },
    Contestant {
        spec: "rapier:preset=strong",
        roles: &[Role::Compare, Role::Cost, Role::Stability],
        look: Some(Look { colour: Colour::Orange, marker: Marker::Triangle }),
    },
    Contestant {
        spec: "rapier:joints=multibody,precision=f64",
        roles: &[Role::Compare, Role::Cost, Role::Stability],
        look: Some(Look { colour: Colour::Purple, marker: Marker::Diamond }),
    },
];

/// Single precision as it comes, then double precision over substeps, Gauss-Seidel iterations and stabilisation, then
/// reduced coordinates.
const SWEEP: &[Swept] = &[
    Swept::both("rapier", SHORTEST_STEPS, QUICK_SHORT_STEPS),
    Swept::full("rapier:substeps=1,iterations=4,stabilization=0", SHORT_STEPS),
    Swept::full("rapier:joints=multibody", SHORTEST_STEPS),
    Swept::full("rapier:precision=f64", SHORTEST_STEPS),
    Swept::full("rapier:precision=f64,stabilization=0", SHORT_STEPS),
    Swept::full("rapier:precision=f64,iterations=4", SHORT_STEPS),
    Swept::full("rapier:precision=f64,iterations=4,stabilization=0", SHORT_STEPS),
    Swept::full("rapier:precision=f64,iterations=16,stabilization=0", SHORT_STEPS),
    Swept::full("rapier:precision=f64,substeps=1", SHORT_STEPS),
    Swept::full("rapier:precision=f64,substeps=1,stabilization=0", SHORT_STEPS),
    Swept::full("rapier:precision=f64,substeps=1,iterations=4", SHORT_STEPS),
    Swept::both("rapier:preset=strong", SHORTEST_STEPS, QUICK_SHORT_STEPS),
    Swept::full("rapier:preset=strong,iterations=16", SHORTEST_STEPS),
    Swept::full("rapier:preset=strong,iterations=64", SHORT_STEPS),
    Swept::full("rapier:precision=f64,substeps=16", SHORT_STEPS),
    Swept::full("rapier:precision=f64,substeps=16,iterations=4,stabilization=0", SHORT_STEPS),
    Swept::both("rapier:joints=multibody,precision=f64", SHORT_STEPS, QUICK_SHORT_STEPS),
    Swept::full("rapier:joints=multibody,precision=f64,substeps=1", SHORTEST_STEPS),
];

/// Fitted by eye to the figures in `benches/README.md`.
fn nominal_cost(spec: &Values, bodies: f64) -> f64 {
    match Settings::new(spec).joints {
        Joints::Multibody => 5.0 * bodies + 0.06 * bodies.powi(3),
        Joints::Impulse => 4.0 + 3.0 * bodies,
    }
}

fn build(spec: &Values, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let settings = Settings::new(spec);
    Ok(match settings.precision {
        Precision::Single => Box::new(single::World::new(system, &settings, step)?),
        Precision::Double => Box::new(double::World::new(system, &settings, step)?),
    })
}

/// What rapier's own bodies say before the first step.
fn hold(spec: &Values, system: &System, step: f64) -> Result<Held, Unsupported> {
    let settings = Settings::new(spec);
    Ok(match settings.precision {
        Precision::Single => single::World::new(system, &settings, step)?.held(),
        Precision::Double => double::World::new(system, &settings, step)?.held(),
    })
}

/// Impulse joints that do not yield and that are solved to the end in one substep, in the precision of a spec: how
/// rapier moves then is how the system moves that it holds. Multibody joints leave nothing to solve.
fn converged(spec: &Values) -> Option<String> {
    let settings = Settings::new(spec);
    let precision = match settings.precision {
        Precision::Single => "f32",
        Precision::Double => "f64",
    };
    match settings.joints {
        Joints::Multibody => None,
        Joints::Impulse => {
            Some(format!("rapier:precision={precision},substeps=1,iterations=3000,stabilization=0,softness_hz=1e12"))
        }
    }
}
