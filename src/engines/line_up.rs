//! Which settings run where the user names none, and how they look in charts.

/// A setting of an engine with a place of its own.
#[derive(Debug)]
pub(crate) struct Contestant {
    pub spec: &'static str,
    /// Where it runs unless the user names engines.
    pub roles: &'static [Role],
    /// How it looks in every chart; others get what is free.
    pub look: Option<Look>,
}

/// Where engines run unless the user names some.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// In `compare`.
    Compare,
    /// In `cost`.
    Cost,
    /// In all families of `stability`.
    Stability,
    /// In the families of `stability` that show the borders of explicit methods.
    Explicit,
    /// In `check --controls`, in the place of the engine that a bound is about: does not conserve energy over long
    /// times, or not to high order.
    Control,
}

/// An engine with a line of its own for its default settings, which are what a user gets who sets nothing.
#[derive(Debug)]
pub(crate) struct Tuned {
    /// Name of the line of the best of all settings, and its look.
    pub best: &'static str,
    pub look: Look,
    /// What its default settings are, for a note.
    pub default: &'static str,
}

/// A colour and a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Look {
    pub colour: Colour,
    pub marker: Marker,
}

/// Colours that a setting may have as its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Colour {
    Blue,
    Sky,
    Green,
    Vermillion,
    Orange,
    Purple,
    Black,
    Olive,
    Stone,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
}
