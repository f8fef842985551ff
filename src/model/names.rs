//! Lists of known names in messages, with the one that was probably meant.

/// Most names that a message lists.
const LISTED: usize = 12;

/// `did you mean 'elbow'? joints are: shoulder, elbow, wrist`, shortened when long.
pub(crate) fn known<S: AsRef<str>>(plural: &str, wanted: &str, names: &[S]) -> String {
    let hint = closest(wanted, names).map(|n| format!("did you mean '{n}'? ")).unwrap_or_default();
    match names.len() {
        0 => format!("there are no {plural}"),
        n if n <= LISTED => format!("{hint}{plural} are: {}", join(names)),
        n => format!("{hint}{plural} are: {}, ... ({n} in all)", join(&names[..LISTED])),
    }
}

fn join<S: AsRef<str>>(names: &[S]) -> String {
    names.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ")
}

/// The name most like the one wanted, by Jaro-Winkler similarity, if any is like it.
fn closest<'a, S: AsRef<str>>(wanted: &str, names: &'a [S]) -> Option<&'a str> {
    names
        .iter()
        .map(|n| (strsim::jaro_winkler(wanted, n.as_ref()), n.as_ref()))
        .filter(|(similarity, _)| *similarity > 0.85)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_miss_is_suggested() {
        assert_eq!(
            known("joints", "elbw", &["shoulder", "elbow"]),
            "did you mean 'elbow'? joints are: shoulder, elbow"
        );
    }

    #[test]
    fn nothing_is_suggested_for_an_unlike_name() {
        assert_eq!(known("joints", "x", &["shoulder", "elbow"]), "joints are: shoulder, elbow");
        assert_eq!(known::<&str>("joints", "x", &[]), "there are no joints");
    }

    #[test]
    fn a_long_list_is_cut_and_counted() {
        let names: Vec<String> = (0..40).map(|i| format!("link_{i}")).collect();
        let text = known("links", "other", &names);
        assert!(text.ends_with("link_11, ... (40 in all)"), "{text}");
    }
}
