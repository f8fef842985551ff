//! Numbers, one or several side by side, and what is made of them.

pub(super) mod factor;
pub(super) mod linear;
pub(super) mod quaternion;
pub(super) mod real;
pub(super) mod sine;
