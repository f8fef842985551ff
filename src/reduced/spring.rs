//! Springs between points of links, with dampers beside them.
//!
//! With the distance `d` of the points, the force `k (d - rest_length) + c d(d)/dt` pulls each towards the other. Where
//! the points coincide the line between them has no direction, and there is no force.

use nalgebra::Vector3 as Constant;

use super::link::Link;
use super::number::linear::{Matrix3, Vector3};
use super::number::real::Real;
use super::spatial::Spatial;
use crate::mechanics::{Anchor, PointSpring};

/// A point fixed in a link; `None` is the ground.
#[derive(Clone, Debug)]
pub struct End {
    pub link: Option<usize>,
    /// In the link frame (in the world for the ground), m.
    pub point: Constant<f64>,
}

/// A spring between two points of different links.
#[derive(Clone, Debug)]
pub struct Spring {
    pub from: End,
    pub to: End,
    /// N/m
    stiffness: f64,
    /// N s/m
    damping: f64,
    /// m
    rest_length: f64,
}

/// A link in world axes: its axes, its joint point and its twist there.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkMotion<T: Real> {
    pub r: Matrix3<T>,
    pub origin: Vector3<T>,
    pub twist: Spatial<T>,
}

impl<T: Real> LinkMotion<T> {
    fn ground() -> LinkMotion<T> {
        LinkMotion { r: Matrix3::identity(), origin: Vector3::zeros(), twist: Spatial::zero() }
    }
}

impl Spring {
    pub(super) fn new(spring: &PointSpring, links: &[Link]) -> Spring {
        let end = |anchor: &Anchor| End {
            link: anchor.body,
            point: anchor
                .body
                .map_or(anchor.point, |b| links[b].body.rotation * anchor.point + links[b].body.translation.vector),
        };
        Spring {
            from: end(&spring.from),
            to: end(&spring.to),
            stiffness: spring.stiffness,
            damping: spring.damping,
            rest_length: spring.rest_length,
        }
    }

    /// Force on the first point, N, with the line from there to the second, m, and its rate of change, m/s.
    pub(super) fn pull<T: Real>(&self, line: &Vector3<T>, rate: &Vector3<T>) -> Vector3<T> {
        let squared = line.dot(line);
        let over_length = squared.map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
        let direction = *line * over_length;
        let stretch = squared * over_length - T::of(self.rest_length);
        direction * (T::of(self.stiffness) * stretch + T::of(self.damping) * direction.dot(rate))
    }

    /// The wrenches on the links at its ends, about their joint points.
    pub(super) fn wrenches<T: Real>(
        &self,
        motion: impl Fn(usize) -> LinkMotion<T>,
    ) -> [(Option<usize>, Spatial<T>); 2] {
        let place = |end: &End| {
            let link = end.link.map_or(LinkMotion::ground(), &motion);
            let arm = link.r.times(&Vector3::of(&end.point));
            (arm, link.origin + arm, link.twist.twist_at(&arm).lin)
        };
        let ((arm, from, from_rate), (to_arm, to, to_rate)) = (place(&self.from), place(&self.to));
        let force = self.pull(&(to - from), &(to_rate - from_rate));
        [
            (self.from.link, Spatial::new(force, arm.cross(&force))),
            (self.to.link, Spatial::new(-force, -to_arm.cross(&force))),
        ]
    }
}
