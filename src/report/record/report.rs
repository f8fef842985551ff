//! `report.json`: what was compared, on what, and every figure. A figure that could not be had is absent.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::environment::{self, Machine, Versions};
use super::parity::Parity;
use super::reference::Reference;
use super::run::Run;
use super::scene::SceneRecord;
use super::sweep::Sweep;
use super::time::Timing;
use crate::measure::comparison::Results;
use crate::measure::study::Findings;
use crate::mechanics::System;
use crate::model::Scene;

/// Name and version of the format.
pub(crate) const SCHEMA: &str = "rattlebench/report/1";

/// A comparison of engines on one scene. Everything but `machine` and what is measured by the clock (`timing`, the
/// `time` of each run, the `targets` of the sweep) is the same, byte for byte, whenever the same program compares the
/// same scene by the same command and no run goes over its budget.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// Always `rattlebench/report/1`.
    pub schema: String,
    pub scene: SceneRecord,
    pub machine: Machine,
    pub versions: Versions,
    /// The command line that wrote this report.
    pub command: String,
    /// The comparison was interrupted: runs or their timing are missing.
    #[serde(default, skip_serializing_if = "is_false")]
    pub interrupted: bool,
    /// The evidence that all engines were given one mechanical system.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parity: Option<Parity>,
    /// What positions are compared with; absent where no truth could be found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Reference>,
    /// How processor times were measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
    pub runs: Vec<Run>,
    /// Every engine at many settings, over the first part of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Sweep>,
}

impl Report {
    /// The record of a comparison.
    pub fn new(scene: &Scene, system: &System, results: &Results, command: String) -> Report {
        Report {
            schema: SCHEMA.to_string(),
            scene: SceneRecord::new(scene, system),
            machine: environment::machine(),
            versions: environment::versions(),
            command,
            interrupted: results.interrupted,
            parity: None,
            reference: None,
            timing: None,
            sweep: None,
            runs: results.runs.iter().map(|run| Run::new(run, system)).collect(),
        }
    }

    /// The record of a comparison with the evidence for it.
    pub fn of_study(scene: &Scene, system: &System, findings: &Findings, command: String) -> Report {
        let plain = Report::new(scene, system, &findings.results, command);
        Report {
            parity: Parity::new(&findings.parity),
            reference: findings.truth.as_ref().map(Reference::new),
            timing: findings.overhead.map(|_| Timing::new(findings)),
            sweep: findings.sweep.as_ref().map(|sweep| Sweep::new(sweep, system, &findings.results.runs)),
            ..plain
        }
    }

    /// As JSON with a final newline.
    ///
    /// # Errors
    /// None that a report built by this program can meet.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self).map(|text| text + "\n")
    }

    /// Reads a report.
    ///
    /// # Errors
    /// Text that is not JSON, another schema, a missing or misshapen field.
    pub fn from_json(text: &str) -> Result<Report, ReadError> {
        #[derive(Deserialize)]
        struct Head {
            schema: Option<String>,
        }
        let head: Head = serde_json::from_str(text)?;
        match head.schema {
            Some(schema) if schema == SCHEMA => Ok(serde_json::from_str(text)?),
            Some(schema) => Err(ReadError::Schema { schema }),
            None => Err(ReadError::NoSchema),
        }
    }
}

/// Why a report could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("not a report: {0}")]
    Json(#[from] serde_json::Error),
    #[error("not a report: \"schema\" is missing; this program reads \"{SCHEMA}\"")]
    NoSchema,
    #[error("\"schema\" is \"{schema}\"; this program reads \"{SCHEMA}\"")]
    Schema { schema: String },
}

fn is_false(value: &bool) -> bool {
    !value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_schema_is_refused_by_name() {
        let message = |text: &str| Report::from_json(text).expect_err("refused").to_string();
        assert_eq!(
            message(r#"{"schema":"rattlebench/report/2"}"#),
            r#""schema" is "rattlebench/report/2"; this program reads "rattlebench/report/1""#
        );
        assert_eq!(message("{}"), r#"not a report: "schema" is missing; this program reads "rattlebench/report/1""#);
        assert!(message("{").starts_with("not a report: EOF while parsing"));
        assert!(message(r#"{"schema":"rattlebench/report/1"}"#).starts_with("not a report: missing field `scene`"));
    }
}
