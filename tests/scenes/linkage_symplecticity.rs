//! One step of a linkage is a symplectic map of independent joint angles and the momenta conjugate to them through the
//! restricted kinetic energy (Marsden and West 2001, section 3.4). With one degree of freedom that is the preservation of
//! area.

use rattlebench::engines::{self, Spec};
use rattlebench::measure::structure::{Failure, symplecticity};
use rattlebench::mechanics::{State, System, energy};

use crate::common::shipped;

/// s
const STEP: f64 = 5e-3;

/// Steps of a new engine from the system's initial state.
fn steps(method: &str, system: &System, count: usize) -> Result<State, Failure> {
    let mut engine = engines::build(&Spec::parse(method).unwrap(), system, STEP).unwrap();
    (0..count).try_for_each(|_| engine.step()).map_err(|failure| Failure::Step(failure.to_string()))?;
    let mut out = system.initial.clone();
    engine.write_state(&mut out);
    Ok(out)
}

/// One step that is not symplectic: RATTLE's with all velocities, which stay on the manifold, slowed by `1e-4`.
fn slowed(system: &System) -> Result<State, Failure> {
    let mut state = steps("rattle", system, 1)?;
    for body in &mut state.bodies {
        body.velocity *= 1.0 - 1e-4;
        body.angular_velocity *= 1.0 - 1e-4;
    }
    Ok(state)
}

#[test]
fn one_step_of_a_linkage_is_symplectic() {
    let all = ["rattle", "rattle:order=4", "rattle:order=6", "rattle:order=8"];
    // The ladder has ten degrees of freedom and is costly.
    let cases =
        [("four_bar", &all[..]), ("slider_crank", &all), ("bricard", &all), ("gripper", &all), ("ladder", &all[..1])];
    for (name, methods) in cases {
        let system = shipped(name);
        let state = steps("rattle:order=8", &system, 60).unwrap();
        assert!(energy::energy(&system, &state).kinetic > 1e-3 * system.energy_scale, "{name} moves");
        for method in methods {
            let found = symplecticity(&system, &state, 0.0, &|from| steps(method, from, 1)).unwrap();
            println!("{name} {method}: {found:?}");
            // measured at most 1.0 times the error, which is at most 1.9e-11, and 1.6e-10 on the ladder
            assert!(found.defect <= 2.0 * found.error && found.error < 5e-10, "{name} {method}: {found:?}");
        }
        let control = symplecticity(&system, &state, 0.0, &slowed).unwrap();
        println!("{name}, slowed: {control:?}");
        assert!((5e-5..2e-4).contains(&control.defect), "{name}: {control:?}");
    }
}
