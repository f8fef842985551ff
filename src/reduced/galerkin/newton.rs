//! Room for Newton's method.

use super::krylov::Krylov;

/// Room for Newton's method: velocities and momenta of all stages, one stage after the other.
#[derive(Clone, Debug)]
pub(super) struct Newton {
    pub(super) krylov: Krylov,
    pub(super) u: Vec<f64>,
    /// `u` of the longest part of the step that was solved.
    pub(super) reached: Vec<f64>,
    /// What (3) lacks, as corrections of the velocities and as momenta.
    pub(super) correction: Vec<f64>,
    pub(super) lacking: Vec<f64>,
    pub(super) first: Vec<f64>,
    pub(super) first_lacking: Vec<f64>,
}

impl Newton {
    pub(super) fn new(width: usize) -> Newton {
        let room = || vec![0.0; width];
        Newton {
            krylov: Krylov::new(width),
            u: room(),
            reached: room(),
            correction: room(),
            lacking: room(),
            first: room(),
            first_lacking: room(),
        }
    }
}
