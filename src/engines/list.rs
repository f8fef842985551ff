//! The list of engines, and what it answers for all of them.

use super::entry::Entry;
use super::group::{Group, OTHERS, Origin};
use super::line_up::{Look, Role, Tuned};
use super::swept::Swept;

/// All engines, of each group the most accurate first. A new one is one file, which `mod.rs` declares, and one line
/// here.
pub static ENGINES: &[Entry] = &[
    super::rattle::ENTRY,
    super::galerkin::ENTRY,
    super::rapier::ENTRY,
    super::dop853::ENTRY,
    super::rk4::ENTRY,
    super::semi_implicit_euler::ENTRY,
    super::explicit_euler::ENTRY,
    super::reference::ENTRY,
];

/// The engine that a spec names, whatever its settings; `None` where this version has no such engine.
pub(crate) fn named(spec: &str) -> Option<&'static Entry> {
    let name = spec.split(':').next();
    ENGINES.iter().find(|entry| Some(entry.name) == name)
}

/// The specs with a role: group by group, those of other programs last, and controls from the worst.
pub fn line_up(role: Role) -> Vec<&'static str> {
    let all = by_group().into_iter().flat_map(|entry| entry.contestants);
    let mut found: Vec<&'static str> = all.filter(|c| c.roles.contains(&role)).map(|c| c.spec).collect();
    match role {
        Role::Control => found.reverse(),
        Role::Compare | Role::Cost | Role::Stability | Role::Explicit => {}
    }
    found
}

/// The settings that a sweep tries, in the same order.
pub(crate) fn sweep() -> impl Iterator<Item = &'static Swept> {
    by_group().into_iter().flat_map(|entry| entry.sweep)
}

/// The engines group by group, those of other programs last.
fn by_group() -> Vec<&'static Entry> {
    let mut entries: Vec<&Entry> = ENGINES.iter().collect();
    let place = |group: &Group| ENGINES.iter().position(|entry| entry.group == group);
    entries.sort_by_key(|entry| (entry.group.origin == Origin::Foreign, place(entry.group)));
    entries
}

/// What an engine is shown with, by its spec.
pub(crate) fn group_of(spec: &str) -> &'static Group {
    named(spec).map_or(&OTHERS, |entry| entry.group)
}

/// All groups in the order of panels: those of other programs, then our own, then engines that this version does not
/// have.
pub(crate) fn groups() -> Vec<&'static Group> {
    let mut groups: Vec<&Group> = Vec::new();
    for group in ENGINES.iter().map(|entry| entry.group).chain([&OTHERS]) {
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups.sort_by_key(|group| match group.origin {
        Origin::Foreign => 0,
        Origin::Own => 1,
        Origin::Unknown => 2,
    });
    groups
}

/// How the settings of an engine are shown by their best, by its spec.
pub(crate) fn tuned(spec: &str) -> Option<&'static Tuned> {
    named(spec).and_then(|entry| entry.tuned.as_ref())
}

/// The look that a spec, or the line of the best settings of an engine, has as its own.
pub(crate) fn look_of(name: &str) -> Option<Look> {
    let contestants = ENGINES.iter().flat_map(|entry| entry.contestants);
    let own = contestants.filter(|contestant| contestant.spec == name).find_map(|contestant| contestant.look);
    let mut best = ENGINES.iter().filter_map(|entry| entry.tuned.as_ref());
    own.or_else(|| best.find(|tuned| tuned.best == name).map(|tuned| tuned.look))
}

/// The tolerance that a spec sets, for engines whose error it controls: the key, and the value as written.
pub(crate) fn tolerance(spec: &str) -> Option<(&'static str, &str)> {
    let key = named(spec)?.tolerance?.name;
    let settings = spec.split_once(':')?.1;
    let mut pairs = settings.split(',').filter_map(|setting| setting.split_once('='));
    pairs.find(|(name, _)| *name == key).map(|(_, value)| (key, value))
}

#[cfg(test)]
mod tests {
    use super::super::spec::Spec;
    use super::super::values::Values;
    use super::*;

    #[test]
    fn every_engine_is_complete_and_its_specs_are_its_own() {
        for entry in ENGINES {
            assert!(!entry.name.is_empty() && !entry.summary.is_empty() && !entry.group.name.is_empty(), "{entry:?}");
            let specs = entry.contestants.iter().map(|c| c.spec).chain(entry.sweep.iter().map(|swept| swept.spec));
            for text in specs {
                let spec = Spec::parse(text).unwrap_or_else(|error| panic!("{error}"));
                assert!(std::ptr::eq(spec.entry(), entry), "{text}");
            }
            assert!(entry.contestants.iter().all(|c| !c.roles.is_empty() || c.look.is_some()), "{entry:?}");
            let values = Values::none(entry.name);
            assert!((entry.nominal_cost)(&values, 10.0) > 0.0, "{entry:?}");
            let converged = (entry.converged)(&values).map(|text| Spec::parse(&text));
            assert!(converged.is_none_or(|spec| spec.is_ok_and(|spec| std::ptr::eq(spec.entry(), entry))), "{entry:?}");
            assert!(entry.tolerance.is_none_or(|key| entry.keys.iter().any(|k| k.name() == key.name)), "{entry:?}");
        }
    }

    #[test]
    fn names_specs_and_looks_are_unique() {
        let once = |mut list: Vec<String>| {
            let count = list.len();
            list.sort();
            list.dedup();
            assert_eq!(list.len(), count, "{list:?}");
        };
        once(ENGINES.iter().map(|entry| entry.name.to_string()).collect());
        once(ENGINES.iter().flat_map(|entry| entry.contestants).map(|c| c.spec.to_string()).collect());
        once(sweep().map(|swept| swept.spec.to_string()).collect());
        let looks = ENGINES.iter().flat_map(|entry| entry.contestants).filter_map(|c| c.look);
        once(looks.map(|look| format!("{look:?}")).collect());
    }

    #[test]
    fn line_ups_go_group_by_group_and_end_with_other_programs() {
        let compared = ["rattle", "rattle:order=8", "galerkin", "dop853"];
        let rivals = ["rapier", "rapier:preset=strong", "rapier:joints=multibody,precision=f64"];
        assert_eq!(line_up(Role::Compare), [&compared[..], &rivals[..]].concat());
        assert_eq!(line_up(Role::Control), ["explicit_euler", "semi_implicit_euler", "rk4"]);
        let panels: Vec<&str> = groups().iter().map(|group| group.name).collect();
        assert_eq!(panels, ["rapier", "rattle", "joint coordinates", "other engines"]);
    }

    #[test]
    fn an_engine_of_another_version_is_filed_under_none_of_ours() {
        assert_eq!((group_of("pendula:order=9"), look_of("pendula")), (&OTHERS, None));
        assert_eq!(tolerance("pendula:tolerance=1e-3"), None);
        assert_eq!(tolerance("dop853:tolerance=1e-3"), Some(("tolerance", "1e-3")));
        assert_eq!(tolerance("dop853"), None);
    }
}
