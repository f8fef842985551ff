//! `inspect`: what was read, what is ignored, what the scene needs.

use std::fmt;
use std::io::Write as _;
use std::path::PathBuf;

use serde::Serialize;

use super::CliError;
use crate::mechanics::System;
use crate::model::{Base, Ignored, Scene};

/// Show what was read from a model or scene, what of it is ignored, and what it needs.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A .urdf file or a scene .json file.
    input: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let inspection = Inspection::of(&Scene::load(&args.input)?);
    let mut out = std::io::stdout().lock();
    if args.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&inspection)?)?;
    } else {
        write!(out, "{inspection}")?;
    }
    Ok(())
}

/// What a scene holds. Lengths m, angles rad, masses kg.
#[derive(Debug, Serialize)]
struct Inspection {
    scene: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    description: String,
    robot: String,
    base: &'static str,
    /// Of the root link's frame, where the base floats.
    #[serde(skip_serializing_if = "Option::is_none")]
    initial_base: Option<BaseRow>,
    gravity: [f64; 3],
    duration_s: f64,
    steps_s: Vec<f64>,
    total_mass_kg: f64,
    degrees_of_freedom: usize,
    moving_bodies: usize,
    welded_links: usize,
    links: Vec<LinkRow>,
    joints: Vec<JointRow>,
    loops: usize,
    /// What loops and mimic joints take away, where the scene can be closed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    closures: Vec<ClosureRow>,
    springs: usize,
    drives: usize,
    bounds: usize,
    needs: Vec<String>,
    remarks: Vec<String>,
    ignored: Vec<Ignored>,
    /// Why the scene cannot be simulated as it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    obstacle: Option<String>,
}

#[derive(Debug, Serialize)]
struct BaseRow {
    position_m: [f64; 3],
    quaternion_wxyz: [f64; 4],
    linear_velocity: [f64; 3],
    angular_velocity: [f64; 3],
}

#[derive(Debug, Serialize)]
struct LinkRow {
    name: String,
    mass_kg: f64,
    /// Centre of mass in the link frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    com_m: Option<[f64; 3]>,
    /// xx, xy, xz, yy, yz, zz about the centre of mass, in axes of the link frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    inertia_kg_m2: Option<[f64; 6]>,
}

#[derive(Debug, Serialize)]
struct ClosureRow {
    name: String,
    /// Constraint rows, and how many of them those before already imply in the initial configuration.
    rows: usize,
    redundant: usize,
}

#[derive(Debug, Serialize)]
struct JointRow {
    name: String,
    #[serde(rename = "type")]
    kind: &'static str,
    parent: String,
    child: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<[f64; 3]>,
    damping: f64,
    initial_position: Vec<f64>,
    initial_velocity: Vec<f64>,
}

impl BaseRow {
    /// `None` for a base that does not move.
    fn of(base: &Base) -> Option<BaseRow> {
        match base {
            Base::Fixed => None,
            Base::Floating { pose, linear_velocity, angular_velocity } => {
                let q = pose.rotation;
                Some(BaseRow {
                    position_m: pose.translation.vector.into(),
                    quaternion_wxyz: [q.w, q.i, q.j, q.k],
                    linear_velocity: (*linear_velocity).into(),
                    angular_velocity: (*angular_velocity).into(),
                })
            }
        }
    }
}

impl Inspection {
    fn of(scene: &Scene) -> Self {
        let model = &scene.model;
        let initial_base = BaseRow::of(&scene.base);
        let floating = initial_base.is_some();
        let welded_links = model.joints.iter().filter(|j| j.kind.is_weld()).count();
        let link = |link: &crate::model::Link| LinkRow {
            name: link.name.clone(),
            mass_kg: link.inertial.as_ref().map_or(0.0, |i| i.mass),
            com_m: link.inertial.as_ref().map(|i| i.com.into()),
            inertia_kg_m2: link
                .inertial
                .as_ref()
                .map(|i| [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|place| i.inertia[place])),
        };
        let compiled = System::compile(scene);
        let joint = |(joint, initial): (&crate::model::Joint, &crate::model::scene::JointInitial)| JointRow {
            name: joint.name.clone(),
            kind: joint.kind.name(),
            parent: model.links[joint.parent].name.clone(),
            child: model.links[joint.child].name.clone(),
            axis: joint.kind.has_axis().then(|| joint.axis.into_inner().into()),
            damping: joint.damping,
            initial_position: initial.position.clone(),
            initial_velocity: initial.velocity.clone(),
        };
        let links: Vec<LinkRow> = model.links.iter().map(link).collect();
        Inspection {
            scene: scene.name.clone(),
            description: scene.description.clone(),
            robot: model.name.clone(),
            base: if floating { "floating" } else { "fixed" },
            initial_base,
            gravity: scene.gravity.into(),
            duration_s: scene.duration,
            steps_s: scene.steps.clone(),
            total_mass_kg: links.iter().map(|l| l.mass_kg).sum(),
            degrees_of_freedom: compiled.as_ref().map_or(scene.tree_degrees_of_freedom(), System::degrees_of_freedom),
            moving_bodies: model.joints.len() - welded_links + usize::from(floating),
            welded_links,
            links,
            joints: model.joints.iter().zip(&scene.initial).map(joint).collect(),
            loops: scene.loops.len(),
            closures: compiled.as_ref().map_or_else(|_| Vec::new(), closures),
            springs: scene.springs.len(),
            drives: scene.drives.len(),
            bounds: scene.bounds.len(),
            needs: scene.needs(),
            remarks: model.remarks.clone(),
            ignored: model.ignored.clone(),
            obstacle: compiled.err().map(|e| e.to_string()),
        }
    }
}

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "scene    {} (robot '{}')", self.scene, self.robot)?;
        if !self.description.is_empty() {
            writeln!(f, "         {}", self.description)?;
        }
        writeln!(f, "base     {}, gravity ({}) m/s^2", self.base, spaced(&self.gravity))?;
        if let Some(base) = &self.initial_base {
            writeln!(
                f,
                "         from ({}) m, attitude ({}) wxyz, velocity ({}) m/s, ({}) rad/s",
                spaced(&base.position_m),
                spaced(&base.quaternion_wxyz),
                spaced(&base.linear_velocity),
                spaced(&base.angular_velocity)
            )?;
        }
        writeln!(f, "run      {} s, steps {} s", self.duration_s, spaced(&self.steps_s))?;
        let size = [
            counted(self.links.len(), "link"),
            counted(self.joints.len(), "joint"),
            format!("{} moving", counted(self.moving_bodies, "body")),
            format!("{} welded", self.welded_links),
            counted(self.degrees_of_freedom, "degree of freedom"),
            format!("{} kg", rounded(self.total_mass_kg)),
        ];
        writeln!(f, "size     {}", size.join(", "))?;
        let extras = [(self.loops, "loop"), (self.springs, "spring"), (self.drives, "drive"), (self.bounds, "bound")];
        let extras: Vec<_> = extras.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| counted(n, what)).collect();
        if !extras.is_empty() {
            writeln!(f, "also     {}", extras.join(", "))?;
        }
        writeln!(f, "needs    {}", if self.needs.is_empty() { "nothing".to_owned() } else { self.needs.join(", ") })?;
        self.links_table(f)?;
        self.joints_table(f)?;
        self.closures_table(f)?;
        if !self.remarks.is_empty() {
            writeln!(f, "\nremarks")?;
            self.remarks.iter().try_for_each(|remark| writeln!(f, "  {remark}"))?;
        }
        if !self.ignored.is_empty() {
            writeln!(f, "\nread but not simulated")?;
            self.ignored.iter().try_for_each(|i| writeln!(f, "  {}: {} ({})", i.element, i.what, i.value))?;
        }
        if let Some(obstacle) = &self.obstacle {
            writeln!(f, "\ncannot be simulated as it is\n  {obstacle}")?;
        }
        Ok(())
    }
}

impl Inspection {
    fn links_table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.links.iter().map(|l| l.name.chars().count()).max().unwrap_or(0);
        writeln!(f, "\nlinks")?;
        for link in &self.links {
            let Some(com) = link.com_m else {
                writeln!(f, "  {:width$}  no mass", link.name)?;
                continue;
            };
            let mass = format!("{} kg", rounded(link.mass_kg));
            writeln!(f, "  {:width$}  {mass:>12}  centre of mass ({}) m", link.name, spaced(&com))?;
        }
        Ok(())
    }

    fn closures_table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.closures.is_empty() {
            return Ok(());
        }
        writeln!(f, "\nclosed")?;
        for ClosureRow { name, rows, redundant } in &self.closures {
            let implied = if *redundant > 0 { format!(", {redundant} of them redundant") } else { String::new() };
            writeln!(f, "  {name}: {}{implied}", counted(*rows, "row"))?;
        }
        Ok(())
    }

    fn joints_table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.joints.is_empty() {
            return Ok(());
        }
        let width = self.joints.iter().map(|j| j.name.chars().count()).max().unwrap_or(0);
        writeln!(f, "\njoints")?;
        for joint in &self.joints {
            write!(f, "  {:width$}  {:10}  {} -> {}", joint.name, joint.kind, joint.parent, joint.child)?;
            if let Some(axis) = joint.axis {
                write!(f, ", axis ({})", spaced(&axis))?;
            }
            if joint.damping > 0.0 {
                write!(f, ", damping {}", joint.damping)?;
            }
            for (what, values) in [("from", &joint.initial_position), ("velocity", &joint.initial_velocity)] {
                if values.iter().any(|x| *x != 0.0) {
                    write!(f, ", {what} ({})", spaced(values))?;
                }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Loops, then mimic joints.
fn closures(system: &System) -> Vec<ClosureRow> {
    let parts = &system.parts;
    let loops = parts
        .loops
        .iter()
        .map(|closure| (format!("loop '{}'", closure.name), closure.locked().iter().filter(|locked| **locked).count()));
    let mimics = parts.couplings.iter().map(|coupling| {
        let name = |body: usize| &system.bodies[body].joint.name;
        (format!("'{}' mimics '{}'", name(coupling.follower), name(coupling.source)), 1)
    });
    let redundant = system.mobility.redundant.iter();
    loops.chain(mimics).zip(redundant).map(|((name, rows), n)| ClosureRow { name, rows, redundant: *n }).collect()
}

fn counted(n: usize, noun: &str) -> String {
    match (n, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "body") => format!("{n} bodies"),
        (_, "degree of freedom") => format!("{n} degrees of freedom"),
        _ => format!("{n} {noun}s"),
    }
}

fn spaced(values: &[f64]) -> String {
    values.iter().map(|x| rounded(*x)).collect::<Vec<_>>().join(" ")
}

/// Six significant digits, without trailing zeros.
fn rounded(value: f64) -> String {
    let short: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    // Adding zero turns -0 into 0.
    format!("{}", short + 0.0)
}
