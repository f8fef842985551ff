//! What a kind of joint is in joint coordinates: one file a kind, and one line in `for_kind`.

mod floating;
mod mobilizer;
mod planar;
mod prismatic;
mod revolute;
mod spherical;
mod subtree;

pub(super) use floating::Floating;
pub(super) use mobilizer::Mobilizer;
pub(super) use planar::Planar;
pub(super) use prismatic::Prismatic;
pub(super) use revolute::Revolute;
pub(super) use spherical::Spherical;
pub(super) use subtree::Subtree;

/// The value of an expression in which `$Joint` stands for the [`Mobilizer`] of a kind of joint.
macro_rules! for_kind {
    ($kind:expr, $Joint:ident => $value:expr) => {{
        use $crate::mechanics::JointKind;
        use $crate::reduced::joint::{self, Mobilizer};
        match $kind {
            JointKind::Revolute => {
                type $Joint = joint::Revolute;
                $value
            }
            JointKind::Prismatic => {
                type $Joint = joint::Prismatic;
                $value
            }
            JointKind::Planar => {
                type $Joint = joint::Planar;
                $value
            }
            JointKind::Spherical => {
                type $Joint = joint::Spherical;
                $value
            }
            JointKind::Floating => {
                type $Joint = joint::Floating;
                $value
            }
        }
    }};
}

pub(super) use for_kind;
