//! One row of facts a method: what may take the place of RATTLE's map of one step, and what goes with it.

/// What a step does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// RATTLE itself.
    Rattle,
    /// The constrained midpoint rule, which is RATTLE here ([`super::Method::Rattle`]).
    Midpoint,
    EulerA,
    EulerB,
    Shake,
    Lobatto,
    EnergyMomentum,
}

/// A method, as the refusals, the help and the tests know it.
#[derive(Debug)]
pub struct Facts {
    pub kind: Kind,
    /// As in specs.
    pub name: &'static str,
    /// What it is, as the end of a sentence that begins with its name.
    pub summary: &'static str,
    pub order: Order,
    /// Whether a step of `-h` takes back one of `h`: only such a map is composed to a higher order.
    pub time_reversible: bool,
    /// Whether the rotation rules of RATTLE turn the bodies.
    pub rotation_rules: bool,
    pub steps: Steps,
    pub refuses: Refuses,
    /// What a reader of a run should know who asked for it by this name.
    pub remark: Option<&'static str>,
}

/// Order of the error of a smooth motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    Fixed(u32),
    /// `2 s - 2` with `s` stages, which a key of its own sets.
    OfStages,
}

/// Whose steps a method takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// Those it is given.
    Given,
    /// The same; the reversible adaptive step may give them.
    GivenOrAdaptive,
    /// Its own, from the first one on that it is given: those that hold its discrete energy.
    HoldingEnergy,
}

/// What of a system a method has no means for, beside the joints of a tree of rigid bodies under gravity: the reason as
/// it follows the name of the method; `None` where it has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refuses {
    /// Loops, couplings, springs and drives.
    pub parts: Option<&'static str>,
    pub drives: Option<&'static str>,
    /// In joints and springs.
    pub dampers: Option<&'static str>,
    /// Whether it refuses bodies that move without mass or without moments of inertia.
    pub light_bodies: bool,
}

const NOTHING: Refuses = Refuses { parts: None, drives: None, dampers: None, light_bodies: false };
const TREE_ONLY: Option<&str> = Some(", which knows the joints of a tree and their dampers only");
const BEYOND_THE_TREE: Refuses = Refuses { parts: TREE_ONLY, drives: TREE_ONLY, dampers: None, light_bodies: true };
const KEEPS_ENERGY: Option<&str> = Some(", which keeps the energy");

/// All methods, the default first. A new one is one row here, one variant of [`Kind`] and one file.
pub const METHODS: &[Facts] = &[
    Facts {
        kind: Kind::Rattle,
        name: "rattle",
        summary: "is RATTLE (order 2)",
        order: Order::Fixed(2),
        time_reversible: true,
        rotation_rules: true,
        steps: Steps::GivenOrAdaptive,
        refuses: NOTHING,
        remark: None,
    },
    Facts {
        kind: Kind::Midpoint,
        name: "midpoint",
        summary: "is the constrained midpoint rule, which is the same map as rattle on rigid bodies",
        order: Order::Fixed(2),
        time_reversible: true,
        rotation_rules: true,
        steps: Steps::GivenOrAdaptive,
        refuses: NOTHING,
        remark: Some(
            "method=midpoint is the map of method=rattle: on positions and attitude matrices the kinetic energy does \
             not depend on the position and gravity is constant, so that both discrete Lagrangians are the same",
        ),
    },
    Facts {
        kind: Kind::EulerA,
        name: "euler_a",
        summary: "is the symplectic Euler map with the forces at the start of a step (order 1)",
        order: Order::Fixed(1),
        time_reversible: false,
        rotation_rules: true,
        steps: Steps::Given,
        refuses: BEYOND_THE_TREE,
        remark: None,
    },
    Facts {
        kind: Kind::EulerB,
        name: "euler_b",
        summary: "is its adjoint, with those at the end",
        order: Order::Fixed(1),
        time_reversible: false,
        rotation_rules: true,
        steps: Steps::Given,
        refuses: BEYOND_THE_TREE,
        remark: None,
    },
    Facts {
        kind: Kind::Shake,
        name: "shake",
        summary: "is rattle in positions",
        order: Order::Fixed(2),
        time_reversible: true,
        rotation_rules: true,
        steps: Steps::Given,
        refuses: BEYOND_THE_TREE,
        remark: None,
    },
    Facts {
        kind: Kind::Lobatto,
        name: "lobatto",
        summary: "is Lobatto IIIA-IIIB (order 2 stages - 2)",
        order: Order::OfStages,
        time_reversible: true,
        rotation_rules: false,
        steps: Steps::Given,
        refuses: Refuses { dampers: Some(": its stages hold forces that have a potential only"), ..BEYOND_THE_TREE },
        remark: None,
    },
    Facts {
        kind: Kind::EnergyMomentum,
        name: "energy_momentum",
        summary: "is rattle with steps of its own, from the run's step on, that hold the discrete energy to roundoff; \
                  the run ends, by name, where none does",
        order: Order::Fixed(2),
        time_reversible: true,
        rotation_rules: true,
        steps: Steps::HoldingEnergy,
        refuses: Refuses { drives: KEEPS_ENERGY, dampers: KEEPS_ENERGY, ..NOTHING },
        remark: None,
    },
];

impl Facts {
    /// Names of the methods with a property, for messages.
    pub fn names_of(property: impl Fn(&Facts) -> bool) -> String {
        let names: Vec<&str> = METHODS.iter().filter(|facts| property(facts)).map(|facts| facts.name).collect();
        names.join(" or ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The row of a method in `docs/engines.md`.
    fn row(facts: &Facts) -> String {
        let Refuses { parts, drives, dampers, light_bodies } = facts.refuses;
        let words = [
            (parts.is_some(), "loops, mimic joints, springs"),
            (drives.is_some(), "drives"),
            (dampers.is_some(), "dampers"),
            (light_bodies, "bodies without mass or moments of inertia"),
        ];
        let refused: Vec<&str> = words.into_iter().filter(|(refused, _)| *refused).map(|(_, words)| words).collect();
        let summary = facts.summary.trim_start_matches("is ");
        format!("| `{}` | {summary} | {} |", facts.name, refused.join(", ")).replace("|  |", "| |")
    }

    #[test]
    fn the_table_of_the_documentation_has_the_facts() {
        let page = include_str!("../../../docs/engines.md");
        for facts in METHODS {
            assert!(page.contains(&row(facts)), "docs/engines.md lacks the row\n{}", row(facts));
        }
    }
}
