//! The figures of a run that have a name, for bounds and lists.

use super::run::Run;

/// A figure of a run.
#[derive(Debug)]
pub struct Metric {
    /// Its path in a run of `report.json`.
    pub name: &'static str,
    pub unit: &'static str,
    pub summary: &'static str,
    /// Its value; `None` where it could not be had.
    pub value: fn(&Run) -> Option<f64>,
}

/// All figures. A new one is one entry here.
pub const METRICS: [Metric; 26] = [
    Metric {
        name: "energy.max_relative_error",
        unit: "of the energy scale",
        summary: "largest absolute energy error over all steps",
        value: |r| Some(r.energy.as_ref()?.max_relative_error),
    },
    Metric {
        name: "energy.final_relative_error",
        unit: "of the energy scale",
        summary: "energy error at the end, negative where energy was lost",
        value: |r| Some(r.energy.as_ref()?.final_relative_error),
    },
    Metric {
        name: "energy.time_level_corrected.max_relative_error",
        unit: "of the energy scale",
        summary: "largest energy error with positions moved back to the time of the velocities",
        value: |r| Some(r.energy.as_ref()?.time_level_corrected.as_ref()?.max_relative_error),
    },
    Metric {
        name: "energy.time_level_corrected.final_relative_error",
        unit: "of the energy scale",
        summary: "energy error at the end with positions moved back to the time of the velocities",
        value: |r| Some(r.energy.as_ref()?.time_level_corrected.as_ref()?.final_relative_error),
    },
    Metric {
        name: "energy.slope_per_s",
        unit: "1/s",
        summary: "slope of a straight line through the energy error",
        value: |r| r.energy.as_ref()?.slope_per_s,
    },
    Metric {
        name: "energy.growth_exponent",
        unit: "",
        summary: "the energy error grows like this power of time; 0 where no growth was established",
        value: |r| r.energy.as_ref()?.growth_exponent,
    },
    Metric {
        name: "energy.growth_exponent_low",
        unit: "",
        summary: "lower end of the exponent's 95 % interval",
        value: |r| Some(r.energy.as_ref()?.growth_exponent_interval?[0]),
    },
    Metric {
        name: "energy.growth_exponent_high",
        unit: "",
        summary: "upper end of the exponent's 95 % interval",
        value: |r| Some(r.energy.as_ref()?.growth_exponent_interval?[1]),
    },
    Metric {
        name: VERDICT,
        unit: "bounded < random_walk < drift < blow_up",
        summary: "how the energy error grows, as a word",
        value: |r| Some(f64::from(r.energy.as_ref()?.verdict? as u8)),
    },
    Metric {
        name: "constraint.max_position",
        unit: "m or rad",
        summary: "largest displacement or rotation that a joint does not allow",
        value: |r| Some(r.constraint.as_ref()?.max_position),
    },
    Metric {
        name: "constraint.max_velocity",
        unit: "m/s or rad/s",
        summary: "largest relative velocity that a joint does not allow",
        value: |r| Some(r.constraint.as_ref()?.max_velocity),
    },
    Metric {
        name: "momentum.max_relative_error",
        unit: "of its scale",
        summary: "largest error of a conserved component of momentum",
        value: |r| Some(r.momentum.as_ref()?.max_relative_error),
    },
    Metric {
        name: "accuracy.max_joint_error",
        unit: "rad or m",
        summary: "largest error of a joint position against the reference, as long as it is trusted",
        value: |r| Some(r.accuracy.as_ref()?.max_joint_error),
    },
    Metric {
        name: "accuracy.rms_joint_error",
        unit: "rad or m",
        summary: "root mean square of the joint position errors",
        value: |r| Some(r.accuracy.as_ref()?.rms_joint_error),
    },
    Metric {
        name: "accuracy.max_position_error_m",
        unit: "m",
        summary: "largest error of the place of a centre of mass",
        value: |r| Some(r.accuracy.as_ref()?.max_position_error_m),
    },
    Metric {
        name: "accuracy.rms_position_error_m",
        unit: "m",
        summary: "root mean square of these",
        value: |r| Some(r.accuracy.as_ref()?.rms_position_error_m),
    },
    Metric {
        name: "accuracy.max_attitude_error_rad",
        unit: "rad",
        summary: "largest error of an attitude",
        value: |r| Some(r.accuracy.as_ref()?.max_attitude_error_rad),
    },
    Metric {
        name: "accuracy.rms_attitude_error_rad",
        unit: "rad",
        summary: "root mean square of these",
        value: |r| Some(r.accuracy.as_ref()?.rms_attitude_error_rad),
    },
    Metric {
        name: "structure.symplecticity.defect",
        unit: "",
        summary: "largest entry of A^T Omega A - Omega for the derivative A of a few steps (compare --structure)",
        value: |r| Some(r.structure.as_ref()?.symplecticity.as_ref()?.defect),
    },
    Metric {
        name: "structure.symplecticity.differencing_error",
        unit: "",
        summary: "what the differences that give that derivative err by",
        value: |r| Some(r.structure.as_ref()?.symplecticity.as_ref()?.differencing_error),
    },
    Metric {
        name: "structure.reversibility.defect",
        unit: "rad, m, rad/s or m/s",
        summary: "distance from the start after a few steps, a reversal, as many steps and a reversal",
        value: |r| Some(r.structure.as_ref()?.reversibility.as_ref()?.defect),
    },
    Metric {
        name: "structure.momentum_map.defect",
        unit: "of its scale",
        summary: "largest change of a conserved component of momentum over these steps",
        value: |r| Some(r.structure.as_ref()?.momentum_map.as_ref()?.defect),
    },
    Metric {
        name: "start.relative_energy",
        unit: "of the energy scale",
        summary: "difference between the energy of the engine's first state and the scene's",
        value: |r| Some(r.start.as_ref()?.relative_energy),
    },
    Metric {
        name: "time.us_per_step",
        unit: "µs",
        summary: "processor time a step, median of the repeats",
        value: |r| Some(r.time.as_ref()?.us_per_step),
    },
    Metric {
        name: "time.s_per_simulated_s",
        unit: "",
        summary: "processor time for a simulated second",
        value: |r| Some(r.time.as_ref()?.s_per_simulated_s),
    },
    Metric {
        name: TIME_RATIO,
        unit: "",
        summary: "processor time a step, over that of another engine in the same comparison; a bound names it by \
                  \"against\"",
        value: |_| None,
    },
];

/// The figure that is a word: the number of its value is the place in [`Verdict::ALL`].
///
/// [`Verdict::ALL`]: crate::measure::growth::Verdict::ALL
pub(crate) const VERDICT: &str = "energy.verdict";

/// The figure that belongs to two runs.
pub(crate) const TIME_RATIO: &str = "time.us_per_step_ratio";
