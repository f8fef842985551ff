//! The findings as Markdown.

use super::judge::Finding;

/// A scene's part of a summary.
#[derive(Debug)]
pub(crate) struct Part<'a> {
    pub scene: &'a str,
    pub findings: &'a [Finding],
    /// Paths of charts of broken bounds.
    pub charts: &'a [String],
    /// Further lines, such as what worsened against a baseline.
    pub notes: &'a [String],
}

/// A table for each scene, the broken bounds first.
pub(crate) fn markdown(parts: &[Part]) -> String {
    let all = || parts.iter().flat_map(|p| p.findings);
    let broken = all().filter(|f| !f.passed).count();
    let mut text = format!("## rattlebench check\n\n{} of {} bounds broken.\n", broken, all().count());
    for part in parts {
        text += &format!("\n### {}\n\n", part.scene);
        if !part.findings.is_empty() {
            text += "| | engine | step, s | steps | figure | measured | bound |\n|---|---|---|---|---|---|---|\n";
        }
        let (good, bad): (Vec<&Finding>, Vec<&Finding>) = part.findings.iter().partition(|f| f.passed);
        bad.into_iter().chain(good).for_each(|finding| text += &row(finding));
        for note in part.notes {
            text += &format!("\n- {note}");
        }
        for chart in part.charts {
            text += &format!("\n- chart: `{chart}`");
        }
        if !part.notes.is_empty() || !part.charts.is_empty() {
            text.push('\n');
        }
    }
    text
}

fn row(finding: &Finding) -> String {
    let r = &finding.requirement;
    let against = r.against.as_ref().map(|spec| format!(" / `{spec}`")).unwrap_or_default();
    let detail = finding.detail.as_ref().map(|d| format!(" ({})", d.replace('|', "\\|"))).unwrap_or_default();
    format!(
        "| {} | `{}`{against} | {} | {} | `{}` | {}{detail} | {} |\n",
        if finding.passed { "✅" } else { "❌" },
        r.engine,
        r.horizon.step,
        r.horizon.steps,
        r.metric.name,
        finding.measured_text(),
        r.limits()
    )
}
