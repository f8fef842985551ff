//! Why a scene cannot be simulated.

/// Why a scene cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompileError {
    #[error(
        "scene '{scene}': link '{link}' moves on joint '{joint}' but has no mass, nor has anything that hangs on it; \
         give it an <inertial>, weld it by a fixed joint to a link that has one, or set \"density\" in the scene"
    )]
    Massless { scene: String, link: String, joint: String },
    #[error(
        "scene '{scene}': link '{link}' moves on joint '{joint}' but its smallest principal moment of inertia is \
         {moment:e} kg m^2 and the others are not; give it an <inertia> with three positive principal moments, or with \
         none for a point mass"
    )]
    NoInertia { scene: String, link: String, joint: String, moment: f64 },
    #[error("scene '{scene}': joint '{joint}': damping {damping} on a floating joint is not simulated; set it to 0")]
    FloatingDamping { scene: String, joint: String, damping: f64 },
    #[error("scene '{scene}': nothing moves; every link is fixed to the ground")]
    NothingMoves { scene: String },
    #[error(
        "scene '{scene}': {what} connects two places of one rigid body ('{body}'); remove it, or free a joint \
         between them"
    )]
    WithinOneBody { scene: String, what: String, body: String },
    #[error(
        "scene '{scene}': joint '{joint}' mimics joint '{source_joint}'; both must have one coordinate (revolute, \
         continuous or prismatic)"
    )]
    MimicCoordinates { scene: String, joint: String, source_joint: String },
    #[error(
        "scene '{scene}': {what} cannot be closed: {by:.3e} m or rad stay open at the nearest positions that were \
         found; leave a joint of the loop out of \"initial\", or check its geometry"
    )]
    StaysOpen { scene: String, what: String, by: f64 },
    #[error(
        "scene '{scene}': the initial velocities open {what} at {by:.3e} m/s or rad/s; leave the velocity of a joint \
         of the loop out of \"initial\""
    )]
    Opens { scene: String, what: String, by: f64 },
    #[error(
        "scene '{scene}': nothing can move: its loops take away {rank} of the tree's {tree} degrees of freedom where \
         it starts"
    )]
    NoMobility { scene: String, tree: usize, rank: usize },
}
