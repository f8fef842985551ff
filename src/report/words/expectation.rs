//! What is expected of engines and what the runs say about it, with the reason where it is not so.

use super::number::{duration, plain, power_of_ten, written};
use crate::engines::tolerance;
use crate::measure::cost::expectation::{Expectation as Judged, Known, LEAST_ENERGY_GAIN, LEAST_GAIN};
use crate::measure::run::Run;
use crate::report::record::expectation::Expectation;
use crate::variational::composition;

/// An expectation in words.
pub(in crate::report) fn told(judged: &Judged) -> Expectation {
    let holds = judged.holds();
    let (expected, found) = match judged {
        Judged::Cost { engine, most, target, rival, reached, own } => {
            cost(engine, *most, *target, rival, (*reached, own, holds))
        }
        Judged::Gain { rival, own, enough } => gain(rival, own.as_ref(), enough.as_ref(), holds),
        Judged::Energy { engine, own, rival, cheap } => energy(engine, own, rival, cheap.as_ref(), holds),
    };
    Expectation { expected, holds, found }
}

fn cost(
    engine: &str,
    most: f64,
    target: f64,
    rival: &Known,
    (reached, own, holds): (bool, &Known, bool),
) -> (String, String) {
    let bound = power_of_ten(target.log10().round() as i32);
    let times = if most == 1.0 { String::new() } else { format!("{} times ", plain(most, 2)) };
    let expected = format!("for {bound} {engine} costs at most {times}as much as dop853");
    let seconds = format!("{} needs {} s a simulated second for {bound}", rival.run.engine, plain(rival.cost, 2));
    if !reached {
        let (best, error) = (setting(own.run), written(own.error));
        let none = format!("no setting of {engine} that was tried reaches it, the best, {best}, errs by {error}");
        return (expected, format!("{seconds}; {none}"));
    }
    let mut found = format!("{seconds}, {} {} times that", setting(own.run), plain(own.cost / rival.cost, 2));
    if !holds {
        found += ": ";
        found += &reason(own.run);
    }
    (expected, found)
}

/// Why a method can cost more than an explicit one of variable steps: what it takes a simulated second, as measured,
/// and what the two methods do.
fn reason(run: &Run) -> String {
    let (engine, name) = (run.engine.to_string(), run.engine.entry().name);
    let steps = plain(1.0 / run.horizon.step, 4);
    let micros = |parts: usize| plain(run.timing.map_or(0.0, |t| 1e6 * t.median) / parts as f64, 2);
    let composed = composition::ALL.iter().find(|c| engine.contains(&format!("order={}", c.order)));
    let own = match composed {
        _ if name == "galerkin" => format!(
            "its {steps} steps a simulated second are all as long as the most violent moment allows, and it iterates \
             the stages of each to roundoff in {} µs",
            micros(1)
        ),
        _ if engine.contains("step=adaptive") => {
            "its steps fit the motion too, but are of order 2 and solve the joints to roundoff".to_string()
        }
        Some(c) => format!(
            "each of its {steps} steps a simulated second is {} steps of order 2, which solve the joints to roundoff \
             in {} µs each",
            c.stages(),
            micros(c.stages())
        ),
        None => {
            format!("each of its {steps} steps a simulated second solves the joints to roundoff in {} µs", micros(1))
        }
    };
    own + ", while dop853 fits its steps to the motion and takes 12 evaluations for each"
}

fn gain(rival: &Known, own: Option<&Known>, enough: Option<&Known>, holds: bool) -> (String, String) {
    let expected = format!(
        "at the cost of rapier's most accurate run rattle errs {} times less",
        power_of_ten(LEAST_GAIN.log10() as i32)
    );
    let (error, seconds) = (written(rival.error), plain(rival.cost, 2));
    let run = format!("{} errs by {error} for {seconds} s a simulated second", setting(rival.run));
    let Some(own) = own else {
        return (expected, format!("{run}; no setting of rattle that was tried is as cheap"));
    };
    let mut found = format!("{run}, {}", result(own));
    if !holds {
        found += &format!(": {} times less", written(rival.error / own.error));
        if let Some(next) = enough {
            found += &format!("; {} does for {} s", setting(next.run), plain(next.cost, 2));
        }
    }
    (expected, found)
}

fn energy(engine: &str, own: &Known, rival: &Known, cheap: Option<&Option<Known>>, holds: bool) -> (String, String) {
    let over = plain(own.run.horizon.end, 2);
    let gain = plain(LEAST_ENERGY_GAIN, 2);
    let expected = format!("over {over} s {engine} errs in energy {gain} times less than dop853 at equal cost");
    let (error, seconds) = (written(own.error), plain(own.cost, 2));
    let mut found = format!("{} errs by {error} for {seconds} s a simulated second", setting(own.run));
    found += &format!(", {}", result(rival));
    if !holds {
        found += "; the error of dop853 grows with time, and has not grown so far by then";
    }
    match cheap {
        Some(Some(cheap)) => found += &format!("; in the time of the latter, {}", result(cheap)),
        Some(None) => found += &format!("; no run of {engine} is as cheap as the latter"),
        None => {}
    }
    (expected, found)
}

/// `rattle:order=8 at 20 ms by 3 × 10⁻¹⁰ for 0.001`.
fn result(known: &Known) -> String {
    format!("{} by {} for {}", setting(known.run), written(known.error), plain(known.cost, 2))
}

/// `rattle:order=8 at 20 ms`; the step of an engine with a tolerance says only how often its state was read.
fn setting(run: &Run) -> String {
    let engine = run.engine.to_string();
    match tolerance(&engine) {
        Some(_) => engine,
        None => format!("{engine} at {}", duration(run.horizon.step)),
    }
}

/// `Expected and not so: ...`.
pub fn sentence(expectation: &Expectation) -> String {
    let head = if expectation.holds { "As expected" } else { "Expected and not so" };
    format!("{head}, {}: {}.", expectation.expected, expectation.found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::cost::expectation::tests::{all, long};
    use crate::measure::cost::expectation::{expectations, over_long_times};
    use crate::measure::synthetic::timed_run;

    fn sentences(found: &[Judged]) -> Vec<String> {
        found.iter().map(|judged| sentence(&told(judged))).collect()
    }

    #[test]
    fn the_sentence_has_the_figures_and_the_reason() {
        let found = sentences(&expectations(&all(1.5e-4, 3e-4, 1e-4), 1e-12));
        assert_eq!(
            found[0],
            "Expected and not so, for 10⁻⁹ galerkin costs at most as much as dop853: dop853:tolerance=2e-9 needs \
             0.0001 s a simulated second for 10⁻⁹, galerkin:stages=6 at 0.1 s 1.5 times that: its 10 steps a \
             simulated second are all as long as the most violent moment allows, and it iterates the stages of each to \
             roundoff in 15 µs, while dop853 fits its steps to the motion and takes 12 evaluations for each."
        );
        assert!(found[1].starts_with("As expected, for 10⁻⁹ rattle costs at most 4 times as much as dop853: "));
        let found = &sentences(&expectations(&all(9e-5, 1.7e-3, 1e-4), 1e-12))[1];
        let reason = "rattle:order=8 at 0.1 s 17 times that: each of its 10 steps a simulated second is 17 steps of \
                      order 2, which solve the joints to roundoff in 10 µs each, while dop853 fits";
        assert!(found.starts_with("Expected and not so") && found.contains(reason), "{found}");
        let found = super::reason(&timed_run("rattle:step=adaptive,tol=1e-6", 1.7e-3, 3e-10));
        assert!(found.starts_with("its steps fit the motion too, but are of order 2"), "{found}");
    }

    #[test]
    fn long_runs_are_told_by_their_energy() {
        let told = &sentences(&over_long_times(&long(1e-15, 100.0)))[1];
        assert!(told.contains("rattle errs in energy 10 times less"), "{told}");
        assert!(told.contains("; in the time of the latter, rattle:order=8 at 0.1 s by 5.0 × 10⁻¹⁰"), "{told}");
    }
}
