//! The findings as JUnit XML: a test suite for each scene, a test case for each bound.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::judge::Finding;

/// The XML of several scenes.
///
/// # Errors
/// Text that XML cannot hold.
pub fn xml(scenes: &[(&str, &[Finding])]) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new("rattlebench check");
    for (scene, findings) in scenes {
        let mut suite = TestSuite::new(*scene);
        suite.add_test_cases(findings.iter().map(|finding| case(scene, finding)));
        report.add_test_suite(suite);
    }
    report.to_string()
}

fn case(scene: &str, finding: &Finding) -> TestCase {
    let r = &finding.requirement;
    let status = if finding.passed {
        TestCaseStatus::success()
    } else {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
        status.set_type("bound");
        status.set_message(finding.sentence());
        status
    };
    let against = r.against.as_ref().map(|spec| format!(" against {spec}")).unwrap_or_default();
    let name = format!(
        "{} {} {} of {}{against}, {} steps of {} s",
        r.key,
        r.metric.name,
        r.limits(),
        r.engine,
        r.horizon.steps,
        r.horizon.step
    );
    let mut case = TestCase::new(name, status);
    case.set_classname(format!("rattlebench.{scene}"));
    case.set_system_out(finding.sentence());
    case
}
