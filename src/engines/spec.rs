//! Engine specs: `name` or `name:key=value,key=value`.

use std::fmt;

use super::{ENGINES, Entry};

/// A key that an engine takes.
#[derive(Clone, Copy, Debug)]
pub enum Key {
    Choice(&'static Choice),
    Number(&'static Number),
}

/// A key whose value is one of a few words; the first is the default.
#[derive(Debug)]
pub struct Choice {
    pub name: &'static str,
    pub words: &'static [&'static str],
    pub summary: &'static str,
}

/// A key whose value is a number in an inclusive range.
#[derive(Debug)]
pub struct Number {
    pub name: &'static str,
    pub min: f64,
    pub max: f64,
    pub default: f64,
    /// Whether only whole numbers make sense.
    pub whole: bool,
    pub summary: &'static str,
}

impl Key {
    pub fn name(self) -> &'static str {
        match self {
            Key::Choice(key) => key.name,
            Key::Number(key) => key.name,
        }
    }

    pub fn summary(self) -> &'static str {
        match self {
            Key::Choice(key) => key.summary,
            Key::Number(key) => key.summary,
        }
    }

    /// The values that the key takes, in words.
    pub fn values(self) -> String {
        match self {
            Key::Choice(key) => key.words.join("|"),
            Key::Number(key) if key.whole => format!("a whole number from {} to {}", key.min, key.max),
            Key::Number(key) => format!("a number from {:e} to {:e}", key.min, key.max),
        }
    }

    fn accepts(self, value: &str) -> bool {
        match self {
            Key::Choice(key) => key.words.contains(&value),
            Key::Number(key) => {
                value.parse::<f64>().is_ok_and(|x| x >= key.min && x <= key.max && (!key.whole || x.fract() == 0.0))
            }
        }
    }
}

/// A spec that has been checked against the engine's keys. Settings stand in the order given; none stands twice.
#[derive(Clone, Debug)]
pub struct Spec {
    entry: &'static Entry,
    settings: Vec<(String, String)>,
}

impl Spec {
    /// Reads `name:key=value,...` and checks name, keys and values.
    ///
    /// # Errors
    /// An unknown engine, key or value, and a key given twice; the message lists what is known.
    pub fn parse(text: &str) -> Result<Spec, SpecError> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let entry = ENGINES.iter().find(|e| e.name == name).ok_or_else(|| SpecError::UnknownEngine {
            name: name.to_string(),
            known: ENGINES.iter().map(|e| e.name).collect::<Vec<_>>().join(", "),
        })?;
        let mut settings: Vec<(String, String)> = Vec::new();
        for setting in rest.split(',').filter(|_| text.contains(':')) {
            let (key_name, value) = setting
                .split_once('=')
                .ok_or_else(|| SpecError::NotASetting { spec: text.to_string(), setting: setting.to_string() })?;
            let key = entry.keys.iter().find(|k| k.name() == key_name).ok_or_else(|| SpecError::UnknownKey {
                engine: name.to_string(),
                key: key_name.to_string(),
                known: entry.keys.iter().map(|k| k.name()).collect::<Vec<_>>().join(", "),
            })?;
            if !key.accepts(value) {
                return Err(SpecError::BadValue {
                    engine: name.to_string(),
                    key: key_name.to_string(),
                    value: value.to_string(),
                    values: key.values(),
                });
            }
            if settings.iter().any(|(k, _)| k == key_name) {
                return Err(SpecError::Twice { spec: text.to_string(), key: key_name.to_string() });
            }
            settings.push((key_name.to_string(), value.to_string()));
        }
        Ok(Spec { entry, settings })
    }

    pub fn entry(&self) -> &'static Entry {
        self.entry
    }

    /// The value that was given for a key, if any.
    pub fn given(&self, name: &str) -> Option<&str> {
        self.settings.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The word given for a key, or its default.
    pub fn word(&self, key: &'static Choice) -> &'static str {
        let given = self.given(key.name);
        key.words.iter().find(|w| Some(**w) == given).or(key.words.first()).copied().unwrap_or("")
    }

    /// The number given for a key, or `default`.
    pub fn number_or(&self, key: &'static Number, default: f64) -> f64 {
        self.given(key.name).and_then(|value| value.parse().ok()).unwrap_or(default)
    }

    /// The number given for a key, or its default.
    pub fn number(&self, key: &'static Number) -> f64 {
        self.number_or(key, key.default)
    }
}

impl fmt::Display for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.entry.name)?;
        for (i, (key, value)) in self.settings.iter().enumerate() {
            write!(f, "{}{key}={value}", if i == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}

/// Why a spec could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SpecError {
    #[error("engine '{name}' is not known; engines are: {known}")]
    UnknownEngine { name: String, known: String },
    #[error("engine spec '{spec}': '{setting}' is not of the form key=value")]
    NotASetting { spec: String, setting: String },
    #[error("engine '{engine}' has no key '{key}'; keys are: {known}")]
    UnknownKey { engine: String, key: String, known: String },
    #[error("engine '{engine}': {key}={value} is not possible; {key} takes {values}")]
    BadValue { engine: String, key: String, value: String, values: String },
    #[error("engine spec '{spec}': key '{key}' is given twice")]
    Twice { spec: String, key: String },
}
