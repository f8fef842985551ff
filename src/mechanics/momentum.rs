//! Linear and angular momentum, and which of them a system conserves.
