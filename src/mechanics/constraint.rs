//! How far joints are from holding, in position and velocity.
