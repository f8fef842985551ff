//! Annotations of GitHub Actions: `::error file=...,title=...::message` on stdout.

use super::judge::Finding;

/// Set by GitHub Actions to `true`, and to the file that the summary of a job is added to.
pub(crate) const ACTIONS: &str = "GITHUB_ACTIONS";
pub(crate) const STEP_SUMMARY: &str = "GITHUB_STEP_SUMMARY";

/// One line for a broken bound; `file` is where the bound stands.
pub fn annotation(file: &str, scene: &str, finding: &Finding) -> String {
    let title = format!("{scene}: {}", finding.requirement.metric.name);
    error(file, &title, &finding.sentence())
}

/// An error message that is shown beside a file.
pub fn error(file: &str, title: &str, message: &str) -> String {
    format!("::error file={},title={}::{}", property(file), property(title), data(message))
}

fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_a_workflow_command_reserves_is_escaped() {
        assert_eq!(
            super::error("a,b.json", "arm: 100 %", "one\ntwo: three, 5 %"),
            "::error file=a%2Cb.json,title=arm%3A 100 %25::one%0Atwo: three, 5 %25"
        );
    }
}
