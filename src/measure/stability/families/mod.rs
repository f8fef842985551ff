//! The families, one file each: parametric scenes with a physical meaning.

mod common;
mod geometry;
mod length;
mod mass_ratio;
mod spin;
mod start;
mod step;
mod stiffness;

use super::scan::Family;

/// All families, in the order of reports. A new one is one file and one line here.
pub static FAMILIES: [&Family; 7] = [
    &stiffness::FAMILY,
    &mass_ratio::FAMILY,
    &length::FAMILY,
    &spin::FAMILY,
    &geometry::FAMILY,
    &step::FAMILY,
    &start::FAMILY,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scan_is_complete_and_its_quick_part_is_a_part() {
        for family in FAMILIES {
            assert!(!family.scans.is_empty() && !family.question.is_empty(), "{}", family.name);
            for scan in family.scans {
                let id = scan.id(family);
                assert!(!scan.name.is_empty() && !scan.title.is_empty() && !scan.parameter.is_empty(), "{id}");
                assert!(scan.quick_values.iter().all(|v| scan.full_values.contains(v)), "{id}");
                assert!(scan.quick_steps.iter().all(|h| scan.full_steps.contains(h)), "{id}");
                assert!(!scan.quick_values.is_empty() && !scan.quick_steps.is_empty(), "{id}");
                assert!(scan.full_steps.windows(2).all(|pair| pair[0] > pair[1]), "{id}");
                assert!(scan.full_values.windows(2).all(|pair| pair[0] < pair[1]), "{id}");
            }
        }
    }

    #[test]
    fn names_are_unique() {
        let mut names: Vec<String> = FAMILIES.iter().flat_map(|f| f.scans.iter().map(|s| s.id(f))).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
