//! `cost`: processor time a step against the number of links, on generated chains.

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::atomic::AtomicU64;

use super::{CliError, input, interrupt, progress};
use crate::engines::{self, Role, Spec};
use crate::measure::cost::scaling::Scaling;
use crate::mechanics::System;
use crate::model::generate::Chain;
use crate::model::{Scene, read_urdf};
use crate::report::folder;
use crate::report::folder::files;
use crate::report::record::cost::Cost;
use crate::report::words::cost as cost_words;

const LINKS: [usize; 7] = [1, 2, 5, 10, 20, 50, 100];

/// Every hinge about z starts at this angle, rad, so that the chain leaves its plane, and that single precision does
/// not compute with subnormal numbers.
const BEND: f64 = 0.3;

/// Simulated time that is stepped through, s: before a long chain whips.
const TIMED: f64 = 0.2;

/// Time a step of each engine on generated chains of several lengths.
///
/// The chains are those of `generate chain`, released from horizontal with every second hinge bent.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[arg(long, value_name = "SPEC", help = input::engine_help(Role::Cost))]
    engine: Vec<String>,
    /// Number of links; may be given several times [default: 1, 2, 5, 10, 20, 50, 100].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    links: Vec<u16>,
    /// Step size, s.
    #[arg(long, value_name = "H", default_value_t = 1e-3, allow_negative_numbers = true)]
    step: f64,
    /// Folder for the files and the page.
    #[arg(long, value_name = "DIR", default_value = "reports/cost")]
    out: PathBuf,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let step = input::positive("--step", args.step)?;
    let named: Vec<&str> = args.engine.iter().map(String::as_str).collect();
    let named = if named.is_empty() { engines::line_up(Role::Cost) } else { named };
    let engines = named.iter().map(|text| Spec::parse(text)).collect::<Result<Vec<Spec>, _>>()?;
    files::prepare(&args.out)?;
    let mut links: Vec<usize> = args.links.iter().map(|n| usize::from(*n)).collect();
    if links.is_empty() {
        links = LINKS.to_vec();
    }
    links.sort_unstable();
    links.dedup();
    let systems = links.iter().map(|&n| Ok((n, chain(n)?))).collect::<Result<Vec<(usize, System)>, CliError>>()?;
    let steps = (TIMED / step).round().max(1.0) as u64;
    let scaling = Scaling { engines: &engines, systems: &systems, step, steps };
    let taken = AtomicU64::new(0);
    let stages = [progress::Stage::new("timing", scaling.turns(), &taken)];
    let points = progress::during("cost", &stages, || scaling.run(interrupt::flag(), &taken));
    let points = points.ok_or(CliError::Interrupted)?;
    let rods = Chain::default();
    let model = format!(
        "Chains of {} m, {} kg rods with hinges about y and z in turn, those about z bent by {BEND} rad, released at \
         rest",
        rods.length, rods.mass
    );
    let cost = Cost::new(&points, model, step, steps as f64 * step, input::command_line());
    let page = folder::cost::write(&cost, &args.out)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}\n{}", cost_words::table(&cost).text(), page.display())?;
    Ok(())
}

/// The generated chain as a system.
fn chain(links: usize) -> Result<System, CliError> {
    let urdf = Chain { links, ..Chain::default() }.urdf()?;
    let mut file = tempfile::Builder::new().suffix(".urdf").tempfile()?;
    file.write_all(urdf.as_bytes())?;
    let model = read_urdf(file.path())?;
    let mut scene = Scene::of_model(&format!("chain_{links}"), model);
    for (joint, initial) in scene.model.joints.iter().zip(&mut scene.initial) {
        if joint.axis.z > 0.5 {
            initial.position.fill(BEND);
        }
    }
    let path = file.path().to_path_buf();
    System::compile(&scene).map_err(|error| CliError::Compile { input: path, error })
}
