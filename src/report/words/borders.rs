//! Where each engine's border lies, in sentences.

use super::number::{compact, duration, plain};
use crate::measure::stability::Class;
use crate::report::record::stability::{CellRecord, ScanRecord, StabilityReport};

/// What an engine does over a scan: everywhere, or over the values at the step nearest to 1 ms (1e-3 of the scan's
/// clock).
pub fn sentence(scan: &ScanRecord, engine: &str) -> String {
    let cells: Vec<&CellRecord> = scan.cells.iter().filter(|cell| cell.engine == engine).collect();
    if let Some(words) = common(cells.iter().copied()) {
        return format!("{words} in every cell");
    }
    let Some(step) = usual_step(scan) else { return "not run".to_string() };
    let row: Vec<&CellRecord> = cells.iter().copied().filter(|cell| cell.step == step).collect();
    let at = format!("at a step of {}", step_words(step, &scan.clock));
    let mut text = match common(row.iter().copied()) {
        Some(words) => format!("{words} at every value {at}"),
        None => format!("{at} {}", stretches(&row)),
    };
    let sound = scan.steps.iter().find(|&&h| cells.iter().all(|c| c.step > h || c.class.is_sound()));
    match sound {
        Some(&h) if h != step => {
            text += &format!("; accurate or bounded everywhere from {} down", step_words(h, &scan.clock))
        }
        Some(_) => {}
        None => text += "; no step serves every value",
    }
    text
}

/// A step in words, in seconds or in the scan's own unit.
pub(crate) fn step_words(step: f64, clock: &str) -> String {
    if clock.is_empty() { duration(step) } else { format!("{} {clock}", plain(step, 3)) }
}

/// The step nearest to a thousandth.
fn usual_step(scan: &ScanRecord) -> Option<f64> {
    let far = |step: &f64| (step / 1e-3).ln().abs();
    scan.steps.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b)))
}

/// The group that a class is counted in where neighbours are put together.
fn group(class: Class) -> &'static str {
    if class.is_sound() { "accurate or bounded" } else { class.words() }
}

/// What all cells have in common, if anything.
fn common<'a>(cells: impl Iterator<Item = &'a CellRecord> + Clone) -> Option<&'static str> {
    let same = |word: &dyn Fn(Class) -> &'static str| {
        let mut words = cells.clone().map(|cell| word(cell.class));
        let first = words.next()?;
        words.all(|other| other == first).then_some(first)
    };
    same(&Class::words).or_else(|| same(&group))
}

/// `accurate or bounded up to 10, joints apart from 1000`
fn stretches(row: &[&CellRecord]) -> String {
    let chunks: Vec<&[&CellRecord]> = row.chunk_by(|a, b| group(a.class) == group(b.class)).collect();
    let last = chunks.len().saturating_sub(1);
    let describe = |(i, chunk): (usize, &&[&CellRecord])| {
        let (from, to) = (compact(chunk[0].value), compact(chunk[chunk.len() - 1].value));
        let words = common(chunk.iter().copied()).unwrap_or_default();
        match i {
            _ if chunk.len() == 1 => format!("{words} at {from}"),
            0 => format!("{words} up to {to}"),
            i if i == last => format!("{words} from {from}"),
            _ => format!("{words} from {from} to {to}"),
        }
    };
    chunks.iter().enumerate().map(describe).collect::<Vec<_>>().join(", ")
}

/// One line a scan and engine, for a terminal.
pub fn text(report: &StabilityReport) -> String {
    let mut text = String::new();
    for family in &report.results {
        text += &format!("{}: {}\n", family.name, family.question);
        for scan in &family.scans {
            text += &format!("  {} ({}; {})\n", scan.name, scan.title, scan.parameter);
            for engine in &family.engines {
                text += &format!("    {engine}: {}\n", sentence(scan, engine));
            }
        }
        text += "\n";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use Class::{Accurate, Bounded, ConstraintBroken, Refused};

    /// A scan of the values 1, 10, 100, ... at the steps 10 ms and 1 ms.
    fn scan(coarse: &[Class], fine: &[Class]) -> ScanRecord {
        let mut cells = Vec::new();
        for (i, classes) in coarse.iter().zip(fine).enumerate() {
            for (step, class) in [(0.01, *classes.0), (0.001, *classes.1)] {
                cells.push(CellRecord {
                    value: 10f64.powi(i as i32),
                    engine: "e".into(),
                    step,
                    step_s: step,
                    class,
                    reason: None,
                    steps_taken: 1,
                    ended_at_s: 1.0,
                    max_energy_error: None,
                    final_energy_error: None,
                    joint_gap: None,
                    pose_error: None,
                    truth_until_s: None,
                    truth: None,
                    turn_per_step: None,
                    warning: None,
                });
            }
        }
        let values = (0..coarse.len()).map(|i| 10f64.powi(i as i32)).collect();
        let text = String::new;
        ScanRecord {
            name: text(),
            title: text(),
            parameter: text(),
            clock: text(),
            values,
            steps: vec![0.01, 0.001],
            cells,
        }
    }

    #[test]
    fn a_border_is_named_by_its_values() {
        let sentence = |coarse: &[Class], fine: &[Class]| sentence(&scan(coarse, fine), "e");
        assert_eq!(sentence(&[Accurate; 3], &[Accurate; 3]), "accurate in every cell");
        assert_eq!(sentence(&[Bounded; 3], &[Accurate; 3]), "accurate or bounded in every cell");
        assert_eq!(sentence(&[ConstraintBroken; 3], &[Accurate; 3]), "accurate at every value at a step of 1 ms");
        assert_eq!(
            sentence(&[ConstraintBroken; 5], &[Accurate, Bounded, ConstraintBroken, Refused, Refused]),
            "at a step of 1 ms accurate or bounded up to 10, joints apart at 100, refused from 1000; no step serves \
             every value"
        );
    }
}
