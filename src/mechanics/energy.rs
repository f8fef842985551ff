//! Kinetic and potential energy, and the scale that errors are divided by.
