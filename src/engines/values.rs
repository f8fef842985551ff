//! The values that a spec gives to the keys of its engine.

use std::fmt;

use super::key::{Choice, Number};

/// Values that the engine's keys accept, in the order given; no key stands twice.
#[derive(Clone, Debug)]
pub(crate) struct Values {
    engine: &'static str,
    given: Vec<(String, String)>,
}

impl Values {
    pub(super) fn none(engine: &'static str) -> Values {
        Values { engine, given: Vec::new() }
    }

    /// Adds a value that the key of this name accepts.
    pub(super) fn add(&mut self, key: &str, value: &str) {
        self.given.push((key.to_string(), value.to_string()));
    }

    /// The value that was given for a key, if any.
    pub fn given(&self, name: &str) -> Option<&str> {
        self.given.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// What the word given for a key stands for, or its default.
    pub(super) fn choice<T: Copy>(&self, key: &Choice<T>) -> T {
        let given = self.given(key.name);
        key.words.iter().find(|word| Some(word.word) == given).unwrap_or(&key.words[0]).value
    }

    /// The number given for a key, or `default`.
    pub(super) fn number_or(&self, key: &Number, default: f64) -> f64 {
        self.given(key.name).and_then(|value| value.parse().ok()).unwrap_or(default)
    }

    /// The number given for a key, or its default.
    pub(super) fn number(&self, key: &Number) -> f64 {
        self.number_or(key, key.default)
    }
}

/// The spec.
impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.engine)?;
        for (i, (key, value)) in self.given.iter().enumerate() {
            write!(f, "{}{key}={value}", if i == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}
