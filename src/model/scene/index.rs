//! The names of a model, and the parts of a scene file that are told by them.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::error::{SceneProblem, not_negative};
use super::file::{AnchorFile, DriveFile, LoopFile, LoopKindFile, SpringFile};
use super::parts::{Anchor, Drive, FixedFrame, Loop, LoopKind, Spring};
use crate::model::robot::Model;
use crate::model::urdf::{WORLD, direction, pose_of};

/// The names of a model.
pub(super) struct Names<'a> {
    model: &'a Model,
    links: HashMap<&'a str, usize>,
    joints: HashMap<&'a str, usize>,
}

impl<'a> Names<'a> {
    pub(super) fn of(model: &'a Model) -> Self {
        let links = model.links.iter().enumerate().map(|(i, l)| (l.name.as_str(), i)).collect();
        let joints = model.joints.iter().enumerate().map(|(i, j)| (j.name.as_str(), i)).collect();
        Names { model, links, joints }
    }

    pub(super) fn joint(&self, key: &str, joint: &str) -> Result<usize, SceneProblem> {
        let all = || self.model.joints.iter().map(|j| j.name.clone()).collect();
        let problem = || SceneProblem::UnknownJoint { key: key.to_owned(), joint: joint.to_owned(), joints: all() };
        self.joints.get(joint).copied().ok_or_else(problem)
    }

    /// A joint with exactly one coordinate.
    fn single(&self, key: &str, joint: &str) -> Result<usize, SceneProblem> {
        let index = self.joint(key, joint)?;
        let kind = self.model.joints[index].kind;
        let problem =
            || SceneProblem::NotOneCoordinate { key: key.to_owned(), joint: joint.to_owned(), kind: kind.name() };
        if kind.degrees_of_freedom() == 1 { Ok(index) } else { Err(problem()) }
    }

    /// `None` is the ground: `world`, unless the model defines a link of that name.
    fn link(&self, key: &str, link: &str) -> Result<Option<usize>, SceneProblem> {
        match self.links.get(link) {
            Some(&index) => Ok(Some(index)),
            None if link == WORLD => Ok(None),
            None => {
                let links = self.model.links.iter().map(|l| l.name.clone()).collect();
                Err(SceneProblem::UnknownLink { key: key.to_owned(), link: link.to_owned(), links })
            }
        }
    }

    pub(super) fn closure(&self, key: &str, file: &LoopFile) -> Result<Loop, SceneProblem> {
        let kind = match file.kind {
            LoopKindFile::Revolute => LoopKind::Revolute,
            LoopKindFile::Spherical => LoopKind::Spherical,
            LoopKindFile::Fixed => LoopKind::Fixed,
            LoopKindFile::Prismatic => LoopKind::Prismatic,
        };
        let axis = match file.axis {
            Some(axis) => direction(&Vector3::from(axis)).ok_or(SceneProblem::ZeroAxis { key: key.to_owned() })?,
            None if kind.has_axis() => {
                let why = "a revolute or prismatic loop needs its axis in the parent_origin frame";
                return Err(SceneProblem::MissingKey { key: key.to_owned(), missing: "axis", why });
            }
            None => Vector3::x_axis(),
        };
        let parent = FixedFrame {
            link: self.link(&format!("{key}.parent"), &file.parent)?,
            origin: pose_of(file.parent_origin.xyz, file.parent_origin.rpy),
        };
        let child = FixedFrame {
            link: self.link(&format!("{key}.child"), &file.child)?,
            origin: pose_of(file.child_origin.xyz, file.child_origin.rpy),
        };
        if parent.link == child.link {
            return Err(SceneProblem::SameLink { key: key.to_owned(), link: file.parent.clone() });
        }
        Ok(Loop { name: file.name.clone(), kind, axis, parent, child })
    }

    pub(super) fn spring(&self, key: &str, file: &SpringFile) -> Result<Spring, SceneProblem> {
        let extra = |present: bool, extra, with| {
            let problem = SceneProblem::ExtraKey { key: key.to_owned(), extra, with };
            if present { Err(problem) } else { Ok(()) }
        };
        let stiffness = not_negative(&format!("{key}.stiffness"), "N/m or N m/rad", file.stiffness)?;
        let damping = not_negative(&format!("{key}.damping"), "N s/m or N m s/rad", file.damping)?;
        if let Some(joint) = &file.joint {
            extra(file.from.is_some(), "from", "joint")?;
            extra(file.to.is_some(), "to", "joint")?;
            extra(file.rest_length.is_some(), "rest_length", "joint")?;
            let joint = self.single(&format!("{key}.joint"), joint)?;
            return Ok(Spring::Joint { joint, stiffness, damping, rest: file.rest.unwrap_or(0.0) });
        }
        extra(file.rest.is_some(), "rest", "from and to")?;
        let missing = |missing| {
            let why = "a spring needs \"joint\", or \"from\" and \"to\"";
            SceneProblem::MissingKey { key: key.to_owned(), missing, why }
        };
        let from = self.anchor(&format!("{key}.from"), file.from.as_ref().ok_or_else(|| missing("from"))?)?;
        let to_file = file.to.as_ref().ok_or_else(|| missing("to"))?;
        let to = self.anchor(&format!("{key}.to"), to_file)?;
        if from.link == to.link {
            return Err(SceneProblem::SameLink { key: key.to_owned(), link: to_file.link.clone() });
        }
        let rest_length = not_negative(&format!("{key}.rest_length"), "m", file.rest_length.unwrap_or(0.0))?;
        Ok(Spring::Points { from, to, stiffness, damping, rest_length })
    }

    fn anchor(&self, key: &str, file: &AnchorFile) -> Result<Anchor, SceneProblem> {
        Ok(Anchor { link: self.link(&format!("{key}.link"), &file.link)?, point: Vector3::from(file.point) })
    }

    pub(super) fn drive(&self, key: &str, file: &DriveFile) -> Result<Drive, SceneProblem> {
        let joint = self.single(&format!("{key}.joint"), &file.joint)?;
        let frequency_hz = match file.frequency_hz {
            Some(frequency) => not_negative(&format!("{key}.frequency_hz"), "Hz", frequency)?,
            None if file.amplitude != 0.0 => {
                let why = "an amplitude needs a frequency in Hz";
                return Err(SceneProblem::MissingKey { key: key.to_owned(), missing: "frequency_hz", why });
            }
            None => 0.0,
        };
        Ok(Drive { joint, effort: file.effort, amplitude: file.amplitude, frequency_hz, phase: file.phase })
    }
}
