//! Error and cost of runs, and which of them no other run beats in both.

use super::run::{Outcome, Run};

/// The engine of a spec without its settings.
pub fn family(engine: &str) -> &str {
    engine.split(':').next().unwrap_or_default()
}

/// Largest joint position error of a completed run, rad or m.
pub fn error(run: &Run) -> Option<f64> {
    run.accuracy.as_ref().filter(|_| run.outcome == Outcome::Completed).map(|a| a.max_joint_error)
}

/// Processor seconds a simulated second of a completed run, from the lower decile over the rounds.
pub fn cost(run: &Run) -> Option<f64> {
    let time = run.time.as_ref().filter(|_| run.outcome == Outcome::Completed)?;
    Some(1e-6 * time.us_per_step_low.unwrap_or(time.us_per_step) / run.step_s)
}

/// The runs that no other is both as cheap as and more accurate than, the cheapest first.
pub fn front<'a>(runs: &[&'a Run]) -> Vec<&'a Run> {
    let mut known: Vec<(&Run, f64, f64)> = runs.iter().filter_map(|r| Some((*r, cost(r)?, error(r)?))).collect();
    known.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.total_cmp(&b.2)));
    let mut best = f64::INFINITY;
    known
        .into_iter()
        .filter(|(_, _, error)| {
            let better = *error < best;
            best = best.min(*error);
            better
        })
        .map(|(run, ..)| run)
        .collect()
}

#[cfg(test)]
pub(in crate::report) mod tests {
    use super::*;
    use crate::report::record::reference::Accuracy;
    use crate::report::record::time::Time;

    pub(in crate::report) fn run(engine: &str, cost: f64, error: f64) -> Run {
        let time = Time {
            us_per_step: 1e5 * cost,
            us_per_step_low: Some(1e5 * cost),
            us_per_step_min: 1e5 * cost,
            us_per_step_max: 1e5 * cost,
            s_per_simulated_s: cost,
            repeats: 5,
            steps: 1,
        };
        let accuracy = Accuracy {
            max_joint_error: error,
            at_s: 1.0,
            rms_joint_error: error,
            max_position_error_m: error,
            rms_position_error_m: error,
            max_attitude_error_rad: error,
            rms_attitude_error_rad: error,
            until_s: 1.0,
            samples: 1,
        };
        Run {
            engine: engine.to_string(),
            step_s: 0.1,
            duration_s: 1.0,
            steps: 10,
            outcome: Outcome::Completed,
            outcome_detail: None,
            ended_at_s: None,
            start: None,
            energy: None,
            constraint: None,
            momentum: None,
            turn_per_step: None,
            warning: None,
            structure: None,
            accuracy: Some(accuracy),
            time: Some(time),
            series: None,
        }
    }

    #[test]
    fn a_front_has_what_no_other_beats() {
        let mut runs =
            vec![run("a", 2.0, 1e-2), run("a:k=1", 1.0, 1e-1), run("a:k=2", 3.0, 2e-2), run("a:k=3", 4.0, 1e-4)];
        let lost = Run { outcome: Outcome::Diverged, ..run("a:k=4", 0.1, 1e-9) };
        runs.push(lost);
        let all: Vec<&Run> = runs.iter().collect();
        let names: Vec<&str> = front(&all).iter().map(|r| r.engine.as_str()).collect();
        assert_eq!(names, ["a:k=1", "a", "a:k=3"]);
    }
}
