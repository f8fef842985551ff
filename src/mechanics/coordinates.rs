//! Joint coordinates: forward kinematics and its inverse.
