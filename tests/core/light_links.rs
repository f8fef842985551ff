//! Links without mass or without moments of inertia that move, and extreme ratios: right, or refused by name.

use nalgebra::{Matrix3, Vector3};
use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::{State, System, constraint, energy};
use rattlebench::model::JointKind::*;
use rattlebench::model::{Inertial, Scene};
use rattlebench::variational::composition::{self, Composition};
use rattlebench::variational::{Failure, Rattle};

use crate::common::*;

/// The state at the end, and the largest relative energy error and joint residual.
fn run(system: &System, composition: &Composition, h: f64, duration: f64) -> Result<(State, f64, f64), Failure> {
    let mut rattle = Rattle::new(system)?;
    let mut state = system.initial.clone();
    let start = energy::energy(system, &state).total();
    let (mut worst, mut open) = (0.0_f64, 0.0_f64);
    for _ in 0..(duration / h).round() as usize {
        composition.step(&mut rattle, h)?;
        rattle.write_state(&mut state);
        let error = (energy::energy(system, &state).total() - start) / system.energy_scale;
        let residual = constraint::residual(system, &state);
        assert!(error.is_finite());
        worst = worst.max(error.abs());
        open = open.max(residual.position).max(residual.velocity);
    }
    Ok((state, worst, open))
}

fn point(mass: f64, at: Vector3<f64>) -> Option<Inertial> {
    Some(Inertial { mass, com: at, inertia: Matrix3::zeros() })
}

/// A rod on a ball joint, or on three hinges through one point with two empty links between, and a second rod on a hinge.
fn ball(of_hinges: bool) -> System {
    let joints = if of_hinges {
        vec![(Revolute, Vector3::x()), (Revolute, Vector3::y()), (Revolute, Vector3::z()), (Revolute, Vector3::y())]
    } else {
        vec![(Spherical, Vector3::x()), (Revolute, Vector3::y())]
    };
    let mut scene = chain(&joints);
    let last = joints.len() - 1;
    if of_hinges {
        for k in [1, 2] {
            scene.model.links[k].inertial = None;
            scene.model.joints[k].origin = nalgebra::Isometry3::identity();
        }
        scene.initial[0].velocity = vec![0.8];
        scene.initial[1].velocity = vec![-0.5];
        scene.initial[2].velocity = vec![1.2];
    } else {
        scene.initial[0].velocity = vec![0.8, -0.5, 1.2];
    }
    scene.initial[last].position = vec![0.6];
    compile(&scene)
}

/// Distance of the two rods in two runs, of the ball joint and of the hinges.
fn apart(a: &State, b: &State) -> f64 {
    let pairs = a.bodies.iter().rev().zip(b.bodies.iter().rev()).take(2);
    pairs.map(|(a, b)| (a.position - b.position).norm().max(a.attitude.angle_to(&b.attitude))).fold(0.0, f64::max)
}

/// RATTLE sees no difference: impulses on empty links balance, so the hinges together transmit what the ball joint does.
#[test]
fn three_hinges_with_empty_links_are_a_ball_joint() {
    for (composition, h, duration) in [(composition::ORDER_2, 1e-3, 0.4), (composition::ORDER_8, 1e-2, 0.4)] {
        let (one, energy, _) = run(&ball(false), &composition, h, duration).unwrap();
        let (other, energy_of_hinges, open) = run(&ball(true), &composition, h, duration).unwrap();
        let difference = apart(&one, &other);
        println!(
            "order {}: {difference:.1e}, energy {energy:.2e} {energy_of_hinges:.2e}, open {open:.1e}",
            composition.order
        );
        assert!(energy > 1e-10 && (energy / energy_of_hinges - 1.0).abs() < 1e-6);
        // measured 4.2e-12 and 7.6e-15
        assert!(difference <= 1e-11 && open <= 2e-14);
    }
}

/// A bob of 2 kg without moments of inertia on a hinge is the pendulum whose body has tiny ones.
#[test]
fn a_point_mass_is_the_limit_of_a_small_ball() {
    let mut scene =
        chain(&[(Revolute, Vector3::y()), (Spherical, Vector3::x()), (Revolute, Vector3::new(0.0, 1.0, 1.0))]);
    scene.model.links[3].inertial = point(2.0, Vector3::new(0.3, 0.0, 0.0));
    scene.initial[2].velocity = vec![1.0];
    let (exact, energy, open) = run(&compile(&scene), &composition::ORDER_2, 1e-3, 1.0).unwrap();
    let small = |moment: f64| {
        let mut scene = scene.clone();
        scene.model.links[3].inertial.as_mut().unwrap().inertia = Matrix3::identity() * moment;
        let (state, _, _) = run(&compile(&scene), &composition::ORDER_2, 1e-3, 1.0).unwrap();
        apart(&exact, &state)
    };
    let (coarse, fine) = (small(1e-8), small(1e-10));
    println!("energy {energy:.1e} open {open:.1e}, to the limit {coarse:.1e} {fine:.1e}");
    // measured 4.8e-5 and 7.8e-15
    assert!(energy > 1e-6 && energy < 1e-4 && open < 2e-14);
    // measured 2.5e-4 and 2.5e-6
    assert!(fine < 8e-6 && (coarse / fine / 100.0 - 1.0).abs() < 0.1);
}

fn refusal(scene: &Scene) -> String {
    match System::compile(scene) {
        Err(error) => error.to_string(),
        Ok(system) => {
            engines::build(&Spec::parse("rattle").unwrap(), &system, 1e-3).err().expect("refused").to_string()
        }
    }
}

#[test]
fn what_moves_without_moving_mass_is_refused_by_name() {
    let mut leaf = alternating(3);
    leaf.model.links[3].inertial = None;
    assert!(refusal(&leaf).contains("link 'link_3' moves on joint 'joint_3' but has no mass, nor has anything"));

    // Two hinges about one line around an empty link: it may turn as it likes.
    let mut parallel = chain(&[(Revolute, Vector3::y()), (Revolute, Vector3::y()), (Revolute, Vector3::y())]);
    parallel.model.links[2].inertial = None;
    parallel.model.joints[2].origin = nalgebra::Isometry3::identity();
    assert!(refusal(&parallel).contains("joint 'joint_2' can move without moving any mass"), "{}", refusal(&parallel));

    // A point mass on its own joint's axis, and at the centre of a ball joint's reach.
    for (kind, at) in [(Revolute, Vector3::new(0.0, 0.2, 0.0)), (Spherical, Vector3::new(0.3, 0.1, 0.2))] {
        let mut spin = chain(&[(Revolute, Vector3::y()), (kind, Vector3::y())]);
        spin.model.links[2].inertial = point(1.0, at);
        assert!(refusal(&spin).contains("joint 'joint_2' can move without moving any mass"), "{}", refusal(&spin));
    }

    let mut needle = alternating(2);
    needle.model.links[2].inertial.as_mut().unwrap().inertia.m11 = 0.0;
    assert!(refusal(&needle).contains("its smallest principal moment of inertia is 0e0"), "{}", refusal(&needle));
}

#[test]
fn rapier_says_that_it_cannot_move_light_links() {
    for spec in ["rapier", "rapier:joints=multibody,precision=f64"] {
        let error = engines::build(&Spec::parse(spec).unwrap(), &ball(true), 1e-3).err().expect("refused").to_string();
        assert!(error.contains("the mass 0e0 of body 'link_1'"), "{error}");
    }
}

/// Three hinges lock where the first and the third axis meet: then the second link moves without moving any mass.
#[test]
fn a_gimbal_that_locks_ends_with_a_name() {
    let mut scene = chain(&[(Revolute, Vector3::x()), (Revolute, Vector3::y()), (Revolute, Vector3::x())]);
    for k in [1, 2] {
        scene.model.links[k].inertial = None;
        scene.model.joints[k].origin = nalgebra::Isometry3::identity();
    }
    scene.initial[1].position = vec![0.0];
    assert!(matches!(Rattle::new(&compile(&scene)), Err(Failure::Singular { .. })));
}

/// Masses of 1e-7 to 1e7 kg along a chain, moments of 1e-12 beside 1e3 kg m^2.
#[test]
fn extreme_ratios_keep_their_energy_and_their_joints() {
    let scaled = |factors: &[f64]| {
        let mut scene = alternating(factors.len());
        for (link, factor) in scene.model.links.iter_mut().skip(1).zip(factors) {
            let body = link.inertial.as_mut().unwrap();
            body.mass *= factor;
            body.inertia *= *factor;
            if *factor == 0.0 {
                link.inertial = None;
            }
        }
        scene.initial[1].position = vec![0.3];
        compile(&scene)
    };
    let cases = [
        [1e-7, 1.0, 1e7],
        [1e7, 1.0, 1e-7],
        [1e7, 1e-7, 1e7],
        [1e-7, 1e7, 1e-7],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [0.0, 0.0, 1.0],
    ];
    for factors in cases {
        let [coarse, fine] = [1e-3, 1e-4].map(|h| {
            let (_, energy, open) = run(&scaled(&factors), &composition::ORDER_2, h, 1.0).unwrap();
            // measured 1.4e-14
            assert!(open <= 3e-14, "{factors:?}: {open:e}");
            energy
        });
        println!("{factors:?}: energy {coarse:.2e} {fine:.2e}");
        // measured 5.5e-6 to 1.8e-5, of order two
        assert!(coarse <= 4e-5 && (coarse / fine / 100.0 - 1.0).abs() < 0.01, "{factors:?}: {coarse:e} {fine:e}");
    }
    let mut scene = alternating(3);
    for (link, moment) in scene.model.links.iter_mut().skip(1).zip([1e3, 1e-12, 1e3]) {
        link.inertial.as_mut().unwrap().inertia = Matrix3::identity() * moment;
    }
    scene.initial[1].velocity = vec![0.5];
    let (_, energy, open) = run(&compile(&scene), &composition::ORDER_2, 1e-3, 5.0).unwrap();
    println!("moments: energy {energy:.1e} open {open:.1e}");
    // measured 1.4e-10 and 5.6e-16
    assert!(energy > 1e-11 && energy <= 4e-10 && open <= 1.5e-15);
}
