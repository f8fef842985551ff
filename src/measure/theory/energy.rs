//! Topics `figure1` and `figure2`: the energy of a variational method against that of RK4 (MW figures 1 and 2).

use std::sync::atomic::{AtomicU64, Ordering};

use super::topic::{Computed, Topic};
use crate::discrete::figures::{EnergyFigure, conservative_particle, dissipative_particle};
use crate::discrete::solve::SolveError;

pub(crate) const FIGURE_1: Topic = Topic {
    name: "figure1",
    summary: "Marsden and West, figure 1: energy of a conservative particle, Newmark against RK4",
    work: || 1,
    compute: |done| computed(conservative_particle, done),
};

pub(crate) const FIGURE_2: Topic = Topic {
    name: "figure2",
    summary: "Marsden and West, figure 2: energy of a particle with weak drag, midpoint rule against RK4",
    work: || 1,
    compute: |done| computed(dissipative_particle, done),
};

fn computed(figure: fn() -> Result<EnergyFigure, SolveError>, done: &AtomicU64) -> Result<Computed, SolveError> {
    let figure = figure()?;
    done.fetch_add(1, Ordering::Relaxed);
    Ok(Computed::Energy(figure))
}
