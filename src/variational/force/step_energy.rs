//! The energies of a step, which tell a false solution.

/// Energies of a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::variational) struct StepEnergy {
    /// Kinetic energy of the momenta between the half kicks.
    pub kinetic: f64,
    /// Work of gravity over the step.
    pub work: f64,
    /// Kinetic energy that gravity alone gives in the step from rest.
    pub fall: f64,
}
