//! The keys that an engine takes, and what their values mean.

use std::fmt;

/// A key that an engine takes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Key {
    Choice(&'static dyn Words),
    Number(&'static Number),
}

/// A key whose value is one of a few words; the first is the default.
#[derive(Debug)]
pub(crate) struct Choice<T: 'static> {
    pub name: &'static str,
    pub words: &'static [Word<T>],
    pub summary: &'static str,
}

/// A word and what it stands for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<T> {
    pub word: &'static str,
    /// What it does, after the word; empty where the summary of the key says it.
    pub meaning: &'static str,
    pub value: T,
}

impl<T: Copy> Word<T> {
    pub const fn new(word: &'static str, value: T) -> Word<T> {
        Word { word, meaning: "", value }
    }

    pub const fn meaning(word: &'static str, meaning: &'static str, value: T) -> Word<T> {
        Word { word, meaning, value }
    }
}

/// What a choice says of itself whatever its words stand for.
pub(crate) trait Words: fmt::Debug + Sync {
    fn name(&self) -> &'static str;
    fn words(&self) -> Vec<&'static str>;
    fn summary(&self) -> String;
}

impl<T: fmt::Debug + Sync> Words for Choice<T> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn words(&self) -> Vec<&'static str> {
        self.words.iter().map(|word| word.word).collect()
    }

    fn summary(&self) -> String {
        let explained = self.words.iter().filter(|word| !word.meaning.is_empty());
        let meanings: Vec<String> = explained.map(|word| format!("{} {}", word.word, word.meaning)).collect();
        let parts = [self.summary.to_string(), meanings.join("; ")];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(": ")
    }
}

/// A key whose value is a number in an inclusive range.
#[derive(Debug)]
pub(crate) struct Number {
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
            Key::Choice(key) => key.name(),
            Key::Number(key) => key.name,
        }
    }

    pub fn summary(self) -> String {
        match self {
            Key::Choice(key) => key.summary(),
            Key::Number(key) => key.summary.to_string(),
        }
    }

    /// The values that the key takes, in words.
    pub fn values(self) -> String {
        match self {
            Key::Choice(key) => key.words().join("|"),
            Key::Number(key) if key.whole => format!("a whole number from {} to {}", key.min, key.max),
            Key::Number(key) => format!("a number from {:e} to {:e}", key.min, key.max),
        }
    }

    pub(super) fn accepts(self, value: &str) -> bool {
        match self {
            Key::Choice(key) => key.words().contains(&value),
            Key::Number(key) => {
                value.parse::<f64>().is_ok_and(|x| x >= key.min && x <= key.max && (!key.whole || x.fract() == 0.0))
            }
        }
    }
}
