//! Parametric models as URDF text.
