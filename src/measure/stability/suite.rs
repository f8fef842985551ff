//! A selection of cells, and the threads that run them.

use std::cmp::Reverse;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::cell::{Case, Cell, Finding};
use super::scan::{Family, Scan};
use super::true_samples::TrueSamples;
use crate::engines::Spec;
use crate::measure::threads;

/// What a suite runs.
#[derive(Debug)]
pub(crate) struct Suite {
    pub families: Vec<&'static Family>,
    /// Engines of each family.
    pub engines: Vec<Vec<Spec>>,
    /// Fewer values and steps.
    pub quick: bool,
    /// In the order of reports.
    pub cases: Vec<Case>,
}

/// One of several machines that share a suite; `index` counts from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    pub index: usize,
    pub of: usize,
}

impl Shard {
    pub(crate) const WHOLE: Shard = Shard { index: 1, of: 1 };
}

impl Scan {
    /// Values of the parameter in a full or a quick suite.
    pub fn values(&self, quick: bool) -> &'static [f64] {
        if quick { self.quick_values } else { self.full_values }
    }

    /// Steps in a full or a quick suite, in units of the clock.
    pub fn steps(&self, quick: bool) -> &'static [f64] {
        if quick { self.quick_steps } else { self.full_steps }
    }
}

impl Suite {
    /// `engines` finds those of a family.
    ///
    /// # Errors
    /// Those of `engines`.
    pub fn new<E>(
        families: Vec<&'static Family>,
        engines: impl FnMut(&Family) -> Result<Vec<Spec>, E>,
        quick: bool,
    ) -> Result<Suite, E> {
        let engines = families.iter().copied().map(engines).collect::<Result<_, E>>()?;
        let scans = families.iter().flat_map(|&family| family.scans.iter().map(move |scan| (family, scan)));
        let cases = scans
            .flat_map(|(family, scan)| scan.values(quick).iter().map(move |&value| Case::new(family, scan, value)))
            .collect();
        Ok(Suite { families, engines, quick, cases })
    }

    fn engines_of(&self, family: &Family) -> &[Spec] {
        let place = self.families.iter().position(|known| std::ptr::eq(*known, family));
        place.map_or(&[], |place| &self.engines[place])
    }

    /// The cells of a shard in the order of reports: case, engine, step. Shards take the cases in turn, so that the
    /// truth of a case is found once.
    pub fn cells(&self, shard: Shard) -> Vec<Cell<'_>> {
        let mine = self.cases.iter().skip(shard.index - 1).step_by(shard.of);
        mine.flat_map(|case| {
            let steps = case.scan.steps(self.quick);
            self.engines_of(case.family)
                .iter()
                .flat_map(move |engine| steps.iter().map(move |&step| Cell { case, engine, step }))
        })
        .collect()
    }
}

/// Units of work of cells, nominal microseconds, for a progress bar.
pub fn work(cells: &[Cell]) -> u64 {
    cells.iter().map(work_of).sum()
}

fn work_of(cell: &Cell) -> u64 {
    (1e6 * cell.cost()) as u64 + 1
}

/// Runs cells on `jobs` threads, the dearest cases first, and hands each finding to `done` as soon as it is there, from
/// the thread that found it. `progress` counts towards [`work`]. Stops early where `interrupted`.
pub fn run(
    cells: &[Cell],
    jobs: usize,
    interrupted: &AtomicBool,
    progress: &AtomicU64,
    done: &(dyn Fn(&Cell, Finding) + Sync),
) {
    let groups = groups(cells);
    let truths: Vec<OnceLock<Option<TrueSamples>>> = groups.iter().map(|_| OnceLock::new()).collect();
    let truth = |g: usize| truths[g].get_or_init(|| groups[g][0].case.truth(interrupted)).as_ref();
    let tasks = tasks(&groups);
    threads::each(jobs, &tasks, |task| {
        if interrupted.load(Ordering::Relaxed) {
            return;
        }
        match *task {
            Task::Truth(g) => drop(truth(g)),
            Task::Cell(g, cell) => {
                let finding = truth(g).and_then(|known| cell.run(known, interrupted));
                if let Some(finding) = finding {
                    done(cell, finding);
                    progress.fetch_add(work_of(cell), Ordering::Relaxed);
                }
            }
        }
    });
}

/// What a thread takes up next, by the index of a group.
enum Task<'a> {
    Truth(usize),
    Cell(usize, &'a Cell<'a>),
}

/// Cells by their case, the dearest case first.
fn groups<'a>(cells: &'a [Cell<'a>]) -> Vec<&'a [Cell<'a>]> {
    let mut groups: Vec<&[Cell]> = cells.chunk_by(|a, b| std::ptr::eq(a.case, b.case)).collect();
    groups.sort_by_key(|group| Reverse(work(group)));
    groups
}

/// The truth of each case is found one case ahead, so that few threads wait for it.
fn tasks<'a>(groups: &[&'a [Cell<'a>]]) -> Vec<Task<'a>> {
    let mut tasks = Vec::new();
    for (g, group) in groups.iter().enumerate() {
        tasks.extend((g == 0).then_some(Task::Truth(0)));
        tasks.extend((g + 1 < groups.len()).then_some(Task::Truth(g + 1)));
        tasks.extend(group.iter().map(|cell| Task::Cell(g, cell)));
    }
    tasks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engines::{Role, line_up};
    use crate::measure::stability::FAMILIES;

    fn suite(quick: bool) -> Suite {
        let engines = |family: &Family| {
            let explicit = if family.explicit { line_up(Role::Explicit) } else { Vec::new() };
            line_up(Role::Stability).into_iter().chain(explicit).map(Spec::parse).collect()
        };
        Suite::new(FAMILIES.to_vec(), engines, quick).expect("specs")
    }

    /// Nominal seconds on one core, by family.
    fn costs(suite: &Suite) -> Vec<(&'static str, f64)> {
        let cells = suite.cells(Shard::WHOLE);
        let of = |name: &str| {
            let cells: f64 = cells.iter().filter(|c| c.case.family.name == name).map(Cell::cost).sum();
            let truths: f64 = suite.cases.iter().filter(|c| c.family.name == name).map(Case::truth_cost).sum();
            cells + truths
        };
        suite.families.iter().map(|family| (family.name, of(family.name))).collect()
    }

    #[test]
    fn a_suite_fits_its_budget_of_nominal_time() {
        let total = |costs: &[(&str, f64)]| costs.iter().map(|(_, cost)| cost).sum::<f64>();
        let (whole, quick) = (costs(&suite(false)), costs(&suite(true)));
        println!("whole {:.0} s: {whole:?}\nquick {:.0} s: {quick:?}", total(&whole), total(&quick));
        // 30 and 2 minutes on two cores, with a third and a sixth to spare; most cases need either the reference or the
        // fine runs, and both are counted: the quick suite takes 50 s of processor time.
        assert!(total(&whole) < 2400.0, "{whole:?}");
        assert!(total(&quick) < 200.0, "{quick:?}");
    }

    #[test]
    fn shards_are_the_whole_and_share_no_cell() {
        let suite = suite(true);
        let name = |cell: &Cell| {
            format!("{} {} {} {}", cell.case.scan.id(cell.case.family), cell.case.value, cell.engine, cell.step)
        };
        let mut parts: Vec<String> = (1..=5)
            .flat_map(|index| suite.cells(Shard { index, of: 5 }).iter().map(name).collect::<Vec<_>>())
            .collect();
        let mut whole: Vec<String> = suite.cells(Shard::WHOLE).iter().map(name).collect();
        parts.sort();
        whole.sort();
        assert_eq!(parts, whole);
        whole.dedup();
        assert_eq!(parts.len(), whole.len());
    }
}
