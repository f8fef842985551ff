//! `stability.json`: the class of every cell of a suite, with the figures and the reason.

use std::collections::HashMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::environment::{self, Versions};
use crate::engines::{Role, Spec, line_up};
use crate::measure::stability::{Cell, Class, FAMILIES, Family, Finding};

/// Name and version of the format.
pub(crate) const SCHEMA: &str = "rattlebench/stability/1";

/// What a suite is: results of two suites go together only where these are equal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SuiteRecord {
    /// Always `rattlebench/stability/1`.
    pub schema: String,
    pub versions: Versions,
    /// Fewer values and steps.
    pub quick: bool,
    /// Engine specs, for every family.
    pub engines: Vec<String>,
    /// Whether families add the explicit methods that they are meant for.
    #[serde(default)]
    pub explicit: bool,
    /// Names of the families.
    pub families: Vec<String>,
}

/// A finished suite. It holds no time, machine or command: the same program writes the same bytes for the same suite,
/// however it was run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StabilityReport {
    #[serde(flatten)]
    pub suite: SuiteRecord,
    pub results: Vec<FamilyRecord>,
}

/// Scans that belong together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FamilyRecord {
    pub name: String,
    pub title: String,
    pub question: String,
    /// Engine specs.
    pub engines: Vec<String>,
    pub scans: Vec<ScanRecord>,
}

/// One scene along one parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScanRecord {
    pub name: String,
    pub title: String,
    /// What the parameter is, with its unit.
    pub parameter: String,
    /// The unit of `steps`, s unless named.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub clock: String,
    pub values: Vec<f64>,
    /// Largest first.
    pub steps: Vec<f64>,
    /// By value, engine and step, in the order of those lists.
    pub cells: Vec<CellRecord>,
}

/// A value of the parameter, an engine, a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellRecord {
    pub value: f64,
    pub engine: String,
    /// In the unit of the scan.
    pub step: f64,
    pub step_s: f64,
    pub class: Class,
    /// Why the run was refused or not begun, or how it was lost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    pub steps_taken: u64,
    pub ended_at_s: f64,
    /// Largest energy error over the energy scale, time-level-corrected where the engine has a lag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_energy_error: Option<f64>,
    /// At the end; negative where energy was lost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub final_energy_error: Option<f64>,
    /// Largest gap of a joint over the length of a link, or rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint_gap: Option<f64>,
    /// Largest error of a centre of mass over the reach of the scene, or of an attitude, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose_error: Option<f64>,
    /// Time up to which the truth is known and poses were compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth_until_s: Option<f64>,
    /// How the truth was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<String>,
    /// Largest turn of a body in a step, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn_per_step: Option<f64>,
    /// Why the figures may mislead although the run went through.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
}

/// A cell with the scan that it belongs to, `family/scan`: what is on disk while a suite runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoredCell {
    pub scan: String,
    pub cell: CellRecord,
}

/// What tells one cell of a suite from another.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    scan: String,
    engine: String,
    value: u64,
    step: u64,
}

impl StoredCell {
    pub fn new(cell: &Cell, finding: Finding) -> StoredCell {
        let digits = |x: Option<f64>| x.map(six_digits);
        StoredCell {
            scan: cell.case.scan.id(cell.case.family),
            cell: CellRecord {
                value: cell.case.value,
                engine: cell.engine.to_string(),
                step: cell.step,
                step_s: finding.step,
                class: finding.class,
                reason: finding.reason,
                steps_taken: finding.steps_taken,
                ended_at_s: finding.ended_at,
                max_energy_error: digits(finding.energy.map(|e| e.max)),
                final_energy_error: digits(finding.energy.map(|e| e.last)),
                joint_gap: digits(finding.joint_gap),
                pose_error: digits(finding.pose_error),
                truth_until_s: digits(finding.truth_until),
                truth: finding.truth,
                turn_per_step: digits(finding.turn_per_step),
                warning: finding.warning,
            },
        }
    }

    pub fn key(&self) -> Key {
        Key::new(&self.scan, self.cell.value, &self.cell.engine, self.cell.step)
    }
}

impl Key {
    pub fn of(cell: &Cell) -> Key {
        let case = cell.case;
        Key::new(&case.scan.id(case.family), case.value, &cell.engine.to_string(), cell.step)
    }

    fn new(scan: &str, value: f64, engine: &str, step: f64) -> Key {
        Key { scan: scan.to_string(), engine: engine.to_string(), value: value.to_bits(), step: step.to_bits() }
    }

    /// For messages.
    pub fn words(&self) -> String {
        let (value, step) = (f64::from_bits(self.value), f64::from_bits(self.step));
        format!("{} at {value}, {} at a step of {step}", self.scan, self.engine)
    }
}

/// Why cells make no report.
#[derive(Debug, thiserror::Error)]
pub enum IncompleteError {
    #[error("family '{name}' is not known; families are: {known}")]
    UnknownFamily { name: String, known: String },
    #[error("{missing} of {all} cells are missing, the first is {first}")]
    Missing { missing: usize, all: usize, first: String },
}

impl SuiteRecord {
    pub fn new(families: &[&Family], engines: &[Spec], explicit: bool, quick: bool) -> SuiteRecord {
        SuiteRecord {
            schema: SCHEMA.to_string(),
            versions: environment::versions(),
            quick,
            engines: engines.iter().map(Spec::to_string).collect(),
            explicit,
            families: families.iter().map(|family| family.name.to_string()).collect(),
        }
    }

    /// Engine specs of a family.
    pub fn engines_of(&self, family: &Family) -> Vec<String> {
        let more = if self.explicit && family.explicit { line_up(Role::Explicit) } else { Vec::new() };
        self.engines.iter().cloned().chain(more.into_iter().map(str::to_string)).collect()
    }

    fn family(&self, name: &str) -> Result<&'static Family, IncompleteError> {
        let known = || FAMILIES.iter().map(|f| f.name).collect::<Vec<_>>().join(", ");
        let found = FAMILIES.into_iter().find(|family| family.name == name);
        found.ok_or_else(|| IncompleteError::UnknownFamily { name: name.to_string(), known: known() })
    }
}

impl StabilityReport {
    /// Puts the cells of a whole suite into the order of the suite.
    ///
    /// # Errors
    /// A family that this program does not have, a cell that is missing.
    pub fn assemble(suite: &SuiteRecord, cells: &HashMap<Key, CellRecord>) -> Result<StabilityReport, IncompleteError> {
        let (mut results, mut all, mut missing) = (Vec::new(), 0, Vec::new());
        for name in &suite.families {
            let family = suite.family(name)?;
            let engines = suite.engines_of(family);
            let mut scans = Vec::new();
            for scan in family.scans {
                let (values, steps) = (scan.values(suite.quick), scan.steps(suite.quick));
                let mut found = Vec::new();
                for (value, engine, step) in product(values, &engines, steps) {
                    let key = Key::new(&scan.id(family), value, engine, step);
                    all += 1;
                    match cells.get(&key) {
                        Some(cell) => found.push(cell.clone()),
                        None => missing.push(key),
                    }
                }
                scans.push(ScanRecord {
                    name: scan.name.to_string(),
                    title: scan.title.to_string(),
                    parameter: scan.parameter.to_string(),
                    clock: scan.clock_name.to_string(),
                    values: values.to_vec(),
                    steps: steps.to_vec(),
                    cells: found,
                });
            }
            let (title, question) = (family.title.to_string(), family.question.to_string());
            results.push(FamilyRecord { name: name.clone(), title, question, engines, scans });
        }
        match missing.first() {
            Some(first) => Err(IncompleteError::Missing { missing: missing.len(), all, first: first.words() }),
            None => Ok(StabilityReport { suite: suite.clone(), results }),
        }
    }

    /// As JSON with a final newline.
    ///
    /// # Errors
    /// None that a report built by this program can meet.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self).map(|text| text + "\n")
    }
}

fn product<'a>(
    values: &'a [f64],
    engines: &'a [String],
    steps: &'a [f64],
) -> impl Iterator<Item = (f64, &'a str, f64)> {
    values.iter().flat_map(move |&value| {
        engines.iter().flat_map(move |engine| steps.iter().map(move |&step| (value, engine.as_str(), step)))
    })
}

fn six_digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}
