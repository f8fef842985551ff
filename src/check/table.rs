//! The findings as text.

use super::judge::Finding;
use crate::report::words::number::duration;

/// A heading and a line for each bound.
pub fn text(scene: &str, findings: &[Finding]) -> String {
    let rows: Vec<[String; 6]> =
        std::iter::once(["engine", "step", "steps", "figure", "measured", "bound"].map(String::from))
            .chain(findings.iter().map(cells))
            .collect();
    let widths: Vec<usize> = (0..6).map(|c| rows.iter().map(|row| row[c].chars().count()).max().unwrap_or(0)).collect();
    let mut text = format!("{scene}\n");
    for (i, row) in rows.iter().enumerate() {
        let verdict = match i.checked_sub(1).map(|i| findings[i].passed) {
            None => "",
            Some(true) => "ok",
            Some(false) => "BROKEN",
        };
        let [engine, step, steps, figure, measured, bound] = row;
        let [a, b, c, d, e, f] = widths[..] else { continue };
        let line =
            format!("  {engine:a$}  {step:>b$}  {steps:>c$}  {figure:d$}  {measured:>e$}  {bound:f$}  {verdict}");
        text += line.trim_end();
        text.push('\n');
        let detail = i.checked_sub(1).and_then(|i| findings[i].detail.as_ref());
        text += &detail.map(|d| format!("      {d}\n")).unwrap_or_default();
    }
    text
}

fn cells(finding: &Finding) -> [String; 6] {
    let r = &finding.requirement;
    let against = r.against.as_ref().map(|spec| format!(" / {spec}")).unwrap_or_default();
    [
        format!("{}{against}", r.engine),
        duration(r.horizon.step),
        r.horizon.steps.to_string(),
        r.metric.name.to_string(),
        finding.measured_text(),
        r.limits(),
    ]
}
