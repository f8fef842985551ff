//! Points of phase space as vectors, of independent joints and at the time of the velocities.

use nalgebra::{DMatrix, DVector};

use super::failure::Failure;
use super::independent::Independent;
use super::phase_chart::PhaseChart;
use crate::mechanics::{State, System};

/// Points of phase space as vectors `y`, about a state. `theta` and `p` are those of independent joints.
pub(super) struct Phase<'a> {
    pub(super) chart: PhaseChart<'a>,
    /// Where joints depend on one another.
    independent: Option<Independent>,
    /// Diagonal of the mass matrix at the start, kg or kg m^2.
    scale: DVector<f64>,
    /// s
    lag: f64,
}

impl<'a> Phase<'a> {
    pub(super) fn about(
        system: &'a System,
        state: &State,
        scale: &DVector<f64>,
        lag: f64,
    ) -> Result<Phase<'a>, Failure> {
        let chart = PhaseChart::about(system, state);
        Ok(Phase { independent: Independent::about(&chart, state)?, chart, scale: scale.clone(), lag })
    }

    /// `y` of a state.
    pub(super) fn point(&self, state: &State) -> Result<DVector<f64>, Failure> {
        let all = self.chart.coordinates(state);
        let mut p = self.restricted(&all, self.chart.momenta(&all, state))?;
        let mut theta = self.independent.as_ref().map_or(all.clone(), |independent| independent.free(&all));
        if self.lag != 0.0 {
            let mass = self.mass_matrix(&all)?;
            let rate = mass.cholesky().ok_or(Failure::Singular)?.solve(&p);
            theta.axpy(-self.lag, &rate, 1.0);
            p = self.mass_matrix(&self.all(theta.clone())?)? * rate;
        }
        p.component_div_assign(&self.scale);
        Ok(stack(&theta, &p))
    }

    /// The system that starts at `y`.
    pub(super) fn system(&self, y: &DVector<f64>) -> Result<System, Failure> {
        let d = self.scale.len();
        let (mut theta, p) = (y.rows(0, d).into_owned(), y.rows(d, d).component_mul(&self.scale));
        let mass = self.mass_matrix(&self.all(theta.clone())?)?;
        let rate = mass.cholesky().ok_or(Failure::Singular)?.solve(&p);
        theta.axpy(self.lag, &rate, 1.0);
        let all = self.all(theta)?;
        let rates = match &self.independent {
            Some(independent) => independent.rates(&self.chart, &all)? * rate,
            None => rate,
        };
        Ok(self.chart.system_at(&all, &rates))
    }

    /// The coordinates of all joints at those of the independent ones.
    fn all(&self, theta: DVector<f64>) -> Result<DVector<f64>, Failure> {
        match &self.independent {
            Some(independent) => independent.close(&self.chart, &theta),
            None => Ok(theta),
        }
    }

    /// The momenta of the independent joints, `B^T p`, from those of all at the coordinates of all.
    fn restricted(&self, all: &DVector<f64>, p: DVector<f64>) -> Result<DVector<f64>, Failure> {
        match &self.independent {
            Some(independent) => Ok(independent.rates(&self.chart, all)?.tr_mul(&p)),
            None => Ok(p),
        }
    }

    /// The mass matrix of the independent joints, `B^T M B`, at the coordinates of all.
    pub(super) fn mass_matrix(&self, all: &DVector<f64>) -> Result<DMatrix<f64>, Failure> {
        let mass = self.chart.mass_matrix(all);
        match &self.independent {
            Some(independent) => {
                let b = independent.rates(&self.chart, all)?;
                Ok(b.tr_mul(&(mass * &b)))
            }
            None => Ok(mass),
        }
    }
}

fn stack(a: &DVector<f64>, b: &DVector<f64>) -> DVector<f64> {
    DVector::from_iterator(a.len() + b.len(), a.iter().chain(b.iter()).copied())
}

/// `R y`: the same coordinates, the momenta turned round.
pub(super) fn turned(y: &DVector<f64>) -> DVector<f64> {
    let d = y.len() / 2;
    let mut out = y.clone();
    out.rows_mut(d, d).neg_mut();
    out
}

/// Diagonal of the mass matrix at a state.
pub(super) fn scale_at(system: &System, state: &State) -> Result<DVector<f64>, Failure> {
    let phase = Phase::about(system, state, &DVector::zeros(0), 0.0)?;
    Ok(phase.mass_matrix(&phase.chart.coordinates(state))?.diagonal())
}
