//! The variational integrators for rigid bodies with joints.
