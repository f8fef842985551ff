//! What positions are compared with, and how far a run is from it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::measure::truth::accuracy::Accuracy as MeasuredAccuracy;
use crate::measure::truth::trusted::Truth;

/// The trajectory that positions are compared with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    pub method: String,
    /// Largest estimated error up to `trusted_until_s`: of positions over the reach of the system, of attitudes in rad.
    pub error_estimate: f64,
    /// Where the estimate passes 1e-8, or the end of the run.
    pub trusted_until_s: f64,
}

/// Position errors against the reference, at common times up to `until_s`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Accuracy {
    /// Largest difference of a joint position, rad or m, and when it was met.
    pub max_joint_error: f64,
    pub at_s: f64,
    /// Over all joints and times.
    pub rms_joint_error: f64,
    /// Of the bodies' centres of mass.
    pub max_position_error_m: f64,
    pub rms_position_error_m: f64,
    /// Of the bodies' attitudes.
    pub max_attitude_error_rad: f64,
    pub rms_attitude_error_rad: f64,
    pub until_s: f64,
    pub samples: usize,
}

impl Reference {
    pub(super) fn new(truth: &Truth) -> Reference {
        Reference {
            method: truth.method.clone(),
            error_estimate: truth.error_estimate(),
            trusted_until_s: truth.trusted_until,
        }
    }
}

impl Accuracy {
    pub(super) fn new(found: MeasuredAccuracy) -> Accuracy {
        Accuracy {
            max_joint_error: found.joint.max,
            at_s: found.joint.at,
            rms_joint_error: found.joint.rms,
            max_position_error_m: found.position.max,
            rms_position_error_m: found.position.rms,
            max_attitude_error_rad: found.attitude.max,
            rms_attitude_error_rad: found.attitude.rms,
            until_s: found.until,
            samples: found.samples,
        }
    }
}
