//! `generate`: parametric models as URDF on stdout.

use std::io::Write as _;

use clap::{Subcommand, ValueEnum};

use super::CliError;
use crate::model::generate::{Chain, ChainAxes};

/// Print a parametric URDF on stdout.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    family: Family,
}

#[derive(Debug, Subcommand)]
enum Family {
    /// A chain of equal rods, lying along x from a fixed base.
    Chain(ChainArgs),
}

#[derive(Debug, clap::Args)]
struct ChainArgs {
    /// Number of rods.
    #[arg(long, default_value_t = 10, value_name = "N")]
    links: usize,
    /// The joints.
    #[arg(long, value_enum, default_value_t = Axes::Alternate)]
    axes: Axes,
    /// Length of a rod, m.
    #[arg(long, default_value_t = 0.3, value_name = "M", allow_negative_numbers = true)]
    length: f64,
    /// Mass of a rod, kg.
    #[arg(long, default_value_t = 1.0, value_name = "KG", allow_negative_numbers = true)]
    mass: f64,
    /// Radius of a rod, m.
    #[arg(long, default_value_t = 0.02, value_name = "M", allow_negative_numbers = true)]
    radius: f64,
    /// Viscous damping of every joint, N m s/rad.
    #[arg(long, default_value_t = 0.0, value_name = "C", allow_negative_numbers = true)]
    damping: f64,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Axes {
    /// Hinges about y and z in turn.
    Alternate,
    /// Hinges about y: swings in a vertical plane.
    Y,
    /// Hinges about z: moves in the horizontal plane, where gravity does nothing.
    Z,
    /// Ball joints.
    Spherical,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let Family::Chain(chain) = &args.family;
    let &ChainArgs { links, axes, length, mass, radius, damping } = chain;
    let axes = match axes {
        Axes::Alternate => ChainAxes::Alternate,
        Axes::Y => ChainAxes::Y,
        Axes::Z => ChainAxes::Z,
        Axes::Spherical => ChainAxes::Spherical,
    };
    let urdf = Chain { links, axes, length, mass, radius, damping }.urdf()?;
    std::io::stdout().lock().write_all(urdf.as_bytes())?;
    Ok(())
}
