//! `simulate`: one run, as CSV.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::{CliError, input, interrupt, progress};
use crate::engines::{self, Engine, Spec, StepFailure};
use crate::measure::Horizon;
use crate::measure::trace::turn_per_step::TurnPerStep;
use crate::mechanics::coordinates::CoordinateTracker;
use crate::mechanics::{State, System, constraint, energy};
use crate::model::Scene;
use crate::report::folder::files::WholeFile;

/// Run one engine and write its states as CSV.
///
/// One row a sample; the first is t = 0 and the last t = T. Positions m and rad (hinges unwrapped), velocities m/s and
/// rad/s, energies J, joint residuals m or rad and m/s or rad/s.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A .urdf file or a scene .json file.
    input: PathBuf,
    /// Engine, such as rattle or rapier:joints=multibody,precision=f64.
    #[arg(long, value_name = "SPEC")]
    engine: String,
    /// Step size, s.
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: f64,
    /// Simulated time, s; a whole number of steps.
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: f64,
    /// Time between rows, s; a whole number of steps [default: every step].
    #[arg(long, value_name = "DT", allow_negative_numbers = true)]
    sample: Option<f64>,
    /// Initial position and velocity of a joint; commas between the coordinates of a joint that has several.
    #[arg(long, value_name = "JOINT=POS[:VEL]")]
    set: Vec<String>,
    /// Say on stderr what the constraint solver took: solves, rounds, refactorisations, restarts, and which rule ended
    /// them.
    #[arg(long)]
    solver: bool,
    /// File to write; - is stdout.
    #[arg(long, value_name = "FILE", default_value = "-")]
    output: PathBuf,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let horizon = Horizon::exact(args.step, args.duration)?;
    let every = sampling(args)?;
    let spec = Spec::parse(&args.engine)?;
    let mut scene = input::scene(&args.input)?;
    for text in &args.set {
        set(&mut scene, text).map_err(|problem| CliError::Set { text: text.clone(), problem })?;
    }
    let system = input::system(&args.input, &scene)?;
    let mut engine = engines::build(&spec, &system, args.step)?;
    let mut output = Output::open(&args.output)?;
    let run = Run { system: &system, horizon, every };
    let mut turn = TurnPerStep::new(&system, engine.as_ref(), args.step);
    let (taken, interrupted) = (AtomicU64::new(0), interrupt::flag());
    let stages = [progress::Stage::new("simulating", horizon.steps, &taken)];
    // Rows on a terminal show by themselves how far the run is.
    let ended = if output.is_terminal() {
        run.write(engine.as_mut(), &mut turn, &mut output, &taken, interrupted)
    } else {
        progress::during(&scene.name, &stages, || {
            run.write(engine.as_mut(), &mut turn, &mut output, &taken, interrupted)
        })
    };
    let ended = match ended {
        Err(error) => return Err(output.failed(error)),
        Ok(ended) => ended,
    };
    output.close()?;
    for remark in engine.remarks() {
        eprintln!("remark: {spec}: {remark}");
    }
    if args.solver {
        eprintln!("solver: {spec}: {}", solver(engine.as_ref()));
    }
    let failed = matches!(ended, Ended::Failed(_));
    if let Some(warning) = turn.warning(&system).filter(|_| !failed) {
        eprintln!("warning: {spec}: {warning}");
    }
    match ended {
        Ended::Completed => Ok(()),
        Ended::Interrupted => Err(CliError::Interrupted),
        Ended::Failed(failure) => Err(CliError::RunFailed { engine: spec.to_string(), detail: failure.to_string() }),
    }
}

/// What the constraint solver took.
fn solver(engine: &dyn Engine) -> String {
    let Some(counters) = engine.solver() else { return "not counted".to_string() };
    let per_solve = |count: u64| count as f64 / counters.solves.max(1) as f64;
    let endings = counters.endings.iter().filter(|(_, count)| *count > 0);
    let endings: Vec<String> = endings.map(|(rule, count)| format!("{count} {rule}")).collect();
    format!(
        "{} solves of {:.2} rounds; {} refactorisations, {} restarts, {} steps in halves; ended: {}",
        counters.solves,
        per_solve(counters.rounds),
        counters.refactorisations,
        counters.restarts,
        counters.steps_in_halves,
        endings.join(", ")
    )
}

/// Steps between two rows.
fn sampling(args: &Args) -> Result<u64, CliError> {
    let Some(sample) = args.sample else { return Ok(1) };
    let steps = input::positive("--sample", sample)? / args.step;
    if (steps.round() - steps).abs() <= 1e-9 * steps {
        return Ok(steps.round() as u64);
    }
    let (below, above) = (steps.floor().max(1.0) * args.step, (steps.floor() + 1.0) * args.step);
    Err(CliError::Sample { sample, step: args.step, below, above })
}

/// Puts `JOINT=POS[:VEL]` into the scene's initial state.
fn set(scene: &mut Scene, text: &str) -> Result<(), String> {
    let (name, values) = text.split_once('=').ok_or("is not of the form JOINT=POS[:VEL]")?;
    let moving = || scene.model.joints.iter().enumerate().filter(|(_, j)| j.kind.degrees_of_freedom() > 0);
    let (index, joint) = moving().find(|(_, j)| j.name == name).ok_or_else(|| {
        let known: Vec<&str> = moving().map(|(_, j)| j.name.as_str()).collect();
        format!("joint '{name}' is not a joint that moves; joints are: {}", known.join(", "))
    })?;
    let count = joint.kind.degrees_of_freedom();
    let numbers = |list: &str| -> Result<Vec<f64>, String> {
        let numbers: Option<Vec<f64>> =
            list.split(',').map(|x| x.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
        match numbers {
            Some(numbers) if numbers.len() == count => Ok(numbers),
            Some(numbers) => Err(format!(
                "joint '{name}' has {count} coordinate{}, got {}",
                if count == 1 { "" } else { "s" },
                numbers.len()
            )),
            None => Err(format!("'{list}' is not a number")),
        }
    };
    let (position, velocity) = values.split_once(':').map_or((values, None), |(p, v)| (p, Some(v)));
    let (position, velocity) = (numbers(position)?, velocity.map(numbers).transpose()?);
    let initial = &mut scene.initial[index];
    (initial.position, initial.position_given) = (position, true);
    if let Some(velocity) = velocity {
        (initial.velocity, initial.velocity_given) = (velocity, true);
    }
    Ok(())
}

/// Where rows go.
enum Output {
    Stdout(BufWriter<io::Stdout>),
    File { rows: BufWriter<WholeFile>, path: PathBuf },
}

impl Output {
    fn open(path: &Path) -> Result<Output, CliError> {
        if path == Path::new("-") {
            return Ok(Output::Stdout(BufWriter::new(io::stdout())));
        }
        let file = WholeFile::create(path).map_err(|error| CliError::Output { path: path.to_path_buf(), error })?;
        Ok(Output::File { rows: BufWriter::new(file), path: path.to_path_buf() })
    }

    fn is_terminal(&self) -> bool {
        matches!(self, Output::Stdout(_)) && io::IsTerminal::is_terminal(&io::stdout())
    }

    fn rows(&mut self) -> &mut dyn Write {
        match self {
            Output::Stdout(rows) => rows,
            Output::File { rows, .. } => rows,
        }
    }

    fn failed(&self, error: io::Error) -> CliError {
        match self {
            Output::Stdout(_) => CliError::Stdout(error),
            Output::File { path, .. } => CliError::Output { path: path.clone(), error },
        }
    }

    fn close(mut self) -> Result<(), CliError> {
        if let Err(error) = self.rows().flush() {
            return Err(self.failed(error));
        }
        match self {
            Output::Stdout(_) => Ok(()),
            Output::File { rows, path } => {
                let closed = rows.into_inner().map_err(io::IntoInnerError::into_error).and_then(WholeFile::close);
                closed.map_err(|error| CliError::Output { path, error })
            }
        }
    }
}

/// How a run ended.
enum Ended {
    Completed,
    Interrupted,
    Failed(StepFailure),
}

/// A run and its rows.
struct Run<'a> {
    system: &'a System,
    horizon: Horizon,
    /// Steps between two rows.
    every: u64,
}

impl Run<'_> {
    /// Steps the engine and writes a row for every sample and for the last step. The rows before a failure are kept.
    fn write(
        &self,
        engine: &mut dyn Engine,
        turn: &mut TurnPerStep,
        output: &mut Output,
        taken: &AtomicU64,
        interrupted: &AtomicBool,
    ) -> io::Result<Ended> {
        let mut state = self.system.initial.clone();
        let mut tracker = CoordinateTracker::new(self.system);
        let rows = output.rows();
        writeln!(rows, "{}", self.header())?;
        engine.write_state(&mut state);
        tracker.update(self.system, &state, 0.0);
        self.row(rows, 0.0, &state, &tracker)?;
        for n in 1..=self.horizon.steps {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(Ended::Interrupted);
            }
            if let Err(failure) = engine.step() {
                return Ok(Ended::Failed(failure));
            }
            engine.write_state(&mut state);
            let time = self.horizon.time(n);
            if !state.is_finite() {
                let detail = format!("t = {time:.6} s: the state is not a number");
                return Ok(Ended::Failed(StepFailure::Diverged { detail }));
            }
            turn.add(&state);
            tracker.update(self.system, &state, self.horizon.step);
            if n % self.every == 0 || n == self.horizon.steps {
                self.row(rows, time, &state, &tracker)?;
            }
            taken.store(n, Ordering::Relaxed);
        }
        Ok(Ended::Completed)
    }

    fn header(&self) -> String {
        let mut names = vec!["time_s".to_string()];
        for (i, body) in self.system.bodies.iter().enumerate() {
            if self.is_base(i) {
                names.extend(["x", "y", "z", "qw", "qx", "qy", "qz"].map(|c| format!("position:base:{c}")));
                names.extend(["vx", "vy", "vz", "wx", "wy", "wz"].map(|c| format!("velocity:base:{c}")));
                continue;
            }
            let count = body.joint.kind.degrees_of_freedom();
            for what in ["position", "velocity"] {
                let name = format!("{what}:{}", body.joint.name);
                match count {
                    1 => names.push(name),
                    _ => names.extend((0..count).map(|k| format!("{name}:{k}"))),
                }
            }
        }
        let figures =
            ["kinetic_energy_J", "potential_energy_J", "energy_J", "constraint_position", "constraint_velocity"];
        names.extend(figures.map(String::from));
        names.iter().map(|name| field(name)).collect::<Vec<_>>().join(",")
    }

    fn row(&self, rows: &mut dyn Write, time: f64, state: &State, tracker: &CoordinateTracker) -> io::Result<()> {
        number(rows, time, "")?;
        for (i, body) in self.system.bodies.iter().enumerate() {
            if self.is_base(i) {
                for x in self.base(state) {
                    number(rows, x, ",")?;
                }
                continue;
            }
            let count = body.joint.kind.degrees_of_freedom();
            let joint = &tracker.joints[i];
            for x in joint.position[..count].iter().chain(&joint.velocity[..count]) {
                number(rows, *x, ",")?;
            }
        }
        let energy = energy::energy_at_coordinates(self.system, state, &tracker.joints);
        let residual = constraint::residual_with_couplings(self.system, state, &tracker.joints);
        for x in [energy.kinetic, energy.potential, energy.total(), residual.position, residual.velocity] {
            number(rows, x, ",")?;
        }
        writeln!(rows)
    }

    fn is_base(&self, body: usize) -> bool {
        self.system.floating_base.as_ref().is_some_and(|base| base.body == body)
    }

    /// Pose and velocity of the root link's frame, in world axes.
    fn base(&self, state: &State) -> Vec<f64> {
        let Some(base) = &self.system.floating_base else { return Vec::new() };
        let body = &state.bodies[base.body];
        let pose = body.pose() * base.link_in_body;
        let arm = pose.translation.vector - body.position;
        let velocity = body.velocity + body.angular_velocity.cross(&arm);
        let (x, q, w) = (pose.translation.vector, pose.rotation, body.angular_velocity);
        vec![x.x, x.y, x.z, q.w, q.i, q.j, q.k, velocity.x, velocity.y, velocity.z, w.x, w.y, w.z]
    }
}

/// A number in the fewest digits that read back to the same one.
fn number(rows: &mut dyn Write, x: f64, before: &str) -> io::Result<()> {
    write!(rows, "{before}{x:?}")
}

/// A CSV field, quoted where it must be (RFC 4180).
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}
