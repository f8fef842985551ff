//! What a suite consists of: families of scans, a scan being one scene along one parameter.

use crate::model::Scene;

/// Scans that belong together and share a map.
#[derive(Debug)]
pub struct Family {
    /// As on the command line and in names of files.
    pub name: &'static str,
    pub title: &'static str,
    /// What is asked of an engine here, one sentence.
    pub question: &'static str,
    /// Whether it shows the borders of explicit methods, which it then runs beside the engines of every family where
    /// none is named.
    pub explicit: bool,
    pub scans: &'static [Scan],
}

/// One scene along one parameter, at several steps.
#[derive(Debug)]
pub struct Scan {
    pub name: &'static str,
    /// What is simulated.
    pub title: &'static str,
    /// What the parameter is, with its unit.
    pub parameter: &'static str,
    pub full_values: &'static [f64],
    /// Those of the values that a quick suite takes.
    pub quick_values: &'static [f64],
    /// In units of `clock`, largest first.
    pub full_steps: &'static [f64],
    /// Those of the steps that a quick suite takes.
    pub quick_steps: &'static [f64],
    pub length: Length,
    /// The unit of steps and durations, s, for a value: 1 s unless the scene has a time scale of its own.
    pub clock: fn(f64) -> f64,
    /// What the unit is in words, empty for a second.
    pub clock_name: &'static str,
    /// The scene at a value.
    pub scene: fn(f64) -> Scene,
    /// `None` where no truth is looked for: the motion is too long, or its phase is no concern.
    pub truth: Option<FineRun>,
}

/// How long the runs of a scan are.
#[derive(Clone, Copy, Debug)]
pub enum Length {
    /// In units of the clock.
    Time(f64),
    /// The parameter is the number of steps.
    Steps,
}

/// The run that the truth of a scene is taken from where the reference does not come far: an engine at a fine step, in
/// units of the clock, which is halved to see how far the two agree.
#[derive(Clone, Copy, Debug)]
pub struct FineRun {
    pub engine: &'static str,
    pub step: fn(f64) -> f64,
}

/// The clock of most scans.
pub(crate) fn seconds(_value: f64) -> f64 {
    1.0
}

impl Scan {
    /// Duration of a run at a value and a step (units of the clock), s.
    pub fn duration(&self, value: f64, step: f64) -> f64 {
        match self.length {
            Length::Time(time) => time * (self.clock)(value),
            Length::Steps => value * step * (self.clock)(value),
        }
    }

    /// What `reports` call the scan: `family/scan`.
    pub fn id(&self, family: &Family) -> String {
        format!("{}/{}", family.name, self.name)
    }
}
