//! Engine specs: `name` or `name:key=value,key=value`.

/// A key that an engine takes, with the values that it may have.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    pub name: &'static str,
    pub values: Values,
    pub summary: &'static str,
}

/// The values that a key may have. The first choice, or the number given, is the default.
#[derive(Clone, Copy, Debug)]
pub enum Values {
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A whole number in an inclusive range.
    Integer { min: i64, max: i64, default: i64 },
    /// A number in an inclusive range.
    Number { min: f64, max: f64, default: f64 },
}

/// A parsed engine spec. Keys stand in the order in which they were given; none stands twice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spec {
    pub engine: String,
    pub settings: Vec<(String, String)>,
}

/// Why a spec could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpecError {
    #[error("engine '{0}' is not known")]
    UnknownEngine(String),
}
