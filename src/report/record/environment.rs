//! The machine and the versions that a report is from.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sysinfo::{CpuRefreshKind, RefreshKind, System};

use crate::engines::ENGINES;

/// The machine that the timings are from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Machine {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub logical_cores: Option<usize>,
    pub os: String,
    pub architecture: String,
}

/// The programs that the figures are from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Versions {
    pub rattlebench: String,
    /// Versions of the crates that the results depend on, as locked.
    pub crates: BTreeMap<String, String>,
    /// The compiler.
    pub rustc: String,
    /// `release`, or `dev` for a build without full optimisation, whose timings mean little.
    pub profile: String,
}

/// This machine.
pub fn machine() -> Machine {
    let refresh = RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing());
    let cpu = System::new_with_specifics(refresh).ok().and_then(|system| {
        let brand = system.cpus().first()?.brand().trim().to_string();
        (!brand.is_empty()).then_some(brand)
    });
    Machine {
        cpu,
        logical_cores: std::thread::available_parallelism().ok().map(usize::from),
        os: System::long_os_version().unwrap_or_else(|_| std::env::consts::OS.to_string()),
        architecture: std::env::consts::ARCH.to_string(),
    }
}

/// The crates whose versions every result depends on, beside those of its engine.
const CRATES: [&str; 3] = ["nalgebra", "parry3d-f64", "urdf-rs"];

fn crates() -> impl Iterator<Item = &'static str> {
    CRATES.into_iter().chain(ENGINES.iter().flat_map(|entry| entry.crates.iter().copied()))
}

/// The versions of this program and of what it was built from.
pub fn versions() -> Versions {
    let locked = locked_versions(include_str!("../../../Cargo.lock"));
    Versions {
        rattlebench: env!("CARGO_PKG_VERSION").to_string(),
        crates: crates().filter_map(|name| Some((name.to_string(), locked.get(name)?.to_string()))).collect(),
        rustc: rustc_version_runtime::version().to_string(),
        profile: if cfg!(debug_assertions) { "dev" } else { "release" }.to_string(),
    }
}

/// Name and version of every package in a lock file; the last one where a name stands twice.
fn locked_versions(lock: &'static str) -> BTreeMap<&'static str, &'static str> {
    let quoted = |text: &'static str| text.trim_matches('"');
    let mut found = BTreeMap::new();
    let mut name = None;
    for line in lock.lines() {
        if let Some(rest) = line.strip_prefix("name = ") {
            name = Some(quoted(rest));
        } else if let (Some(rest), Some(package)) = (line.strip_prefix("version = "), name.take()) {
            found.insert(package, quoted(rest));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crate_that_matters_has_its_locked_version() {
        let versions = versions();
        assert_eq!(versions.crates.len(), crates().count(), "{versions:?}");
        assert!(versions.crates["rapier3d"].starts_with("0.36."), "{versions:?}");
        assert_eq!(versions.crates["rapier3d"], versions.crates["rapier3d-f64"]);
    }

    #[test]
    fn this_machine_has_cores_and_a_system() {
        let machine = machine();
        assert!(machine.logical_cores.is_some_and(|n| n >= 1));
        assert!(!machine.os.is_empty() && !machine.architecture.is_empty());
    }
}
