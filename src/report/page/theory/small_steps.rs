//! The section of topic `small-steps`.

use super::section::Section;
use super::table::Table;
use crate::report::charts::{ChartError, theory::small_steps};
use crate::report::page::document::Picture;
use crate::report::record::theory::small_steps::SmallStepsRecord;
use crate::report::words::number::{short, written};

pub(super) fn section(problems: &[SmallStepsRecord]) -> Result<Section, ChartError> {
    // From here on the position form has nothing but roundoff left.
    let small = || problems.iter().flat_map(|p| &p.steps).filter(|s| s.step_s < 1e-8);
    let worst = small().flat_map(|s| [s.blown_up, s.curved]).fold(0.0, f64::max);
    let position = small().map(|s| s.position_form).fold(f64::INFINITY, f64::min);
    let finding = format!(
        "From steps below 10⁻⁸ s down to 10⁻¹² s the acceleration from a step in (q, v), along straight lines \
         or parabolas, errs by at most {}, that of the position form by at least {}.",
        written(worst),
        written(position)
    );
    let explanation = "One step from the same initial data. In (q, v) the discrete Euler-Lagrange equations are \
                       divided by h before they are put into figures, are regular at h = 0 (the blown-up principle of \
                       Patrick and Cuell), and nothing cancels: for the midpoint rule, whose curves are straight, and \
                       for parabolas that osculate the motion, with two Gauss points. The position form of the \
                       midpoint rule has q₂ − 2q₁ + q₀, whose roundoff is divided by h². All are compared \
                       with the acceleration in the middle of the step, which any of them meets to O(h²)."
        .to_string();
    let caption = "Error of the acceleration from one step against the step size, in (q, v) along straight lines and \
                   parabolas, and in positions";
    let picture = Picture { caption, png: small_steps::draw(problems)? };
    Ok(Section {
        title: "Small steps: the blown-up principle of Patrick and Cuell",
        finding,
        explanation,
        charts: vec![("small-steps.png".to_string(), picture)],
        tables: problems.iter().map(table).collect(),
    })
}

fn table(problem: &SmallStepsRecord) -> Table {
    let whole_decades = problem.steps.iter().skip(1).step_by(2);
    Table {
        caption: format!("Error of the acceleration on the {}.", problem.problem),
        headings: vec!["step, s", "(q, v), straight", "(q, v), parabolas", "positions"],
        rows: whole_decades.map(|s| [s.step_s, s.blown_up, s.curved, s.position_form].map(short).to_vec()).collect(),
    }
}
