//! Parametric models as URDF text, the same bytes for the same options.

use std::fmt::Write as _;

use super::scene::{SceneProblem, not_negative, positive};

/// A chain of equal rods from a base, each along x from its joint, joint `i` at the end of rod `i - 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Number of rods.
    pub links: usize,
    pub axes: ChainAxes,
    /// Of one rod, m.
    pub length: f64,
    /// Of one rod, kg.
    pub mass: f64,
    /// Of one rod, a solid cylinder, m.
    pub radius: f64,
    /// Viscous damping of every joint, N m s/rad.
    pub damping: f64,
}

impl Default for Chain {
    fn default() -> Self {
        Chain { links: 10, axes: ChainAxes::Alternate, length: 0.3, mass: 1.0, radius: 0.02, damping: 0.0 }
    }
}

/// The joints of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainAxes {
    /// Hinges about y, z, y, z, ...
    Alternate,
    /// Hinges about y: a planar chain that swings.
    Y,
    /// Hinges about z: a planar chain that gravity along z does not move.
    Z,
    /// Ball joints.
    Spherical,
}

impl Chain {
    /// The chain as URDF text. A rod is a solid cylinder along x: `Ixx = m r^2 / 2`,
    /// `Iyy = Izz = m (3 r^2 + l^2) / 12`.
    ///
    /// # Errors
    /// No links, a length, mass or radius that is not positive, negative damping.
    pub fn urdf(&self) -> Result<String, SceneProblem> {
        let &Chain { links, axes, length, mass, radius, damping } = self;
        positive("--links", "", links as f64)?;
        positive("--length", "m", length)?;
        positive("--mass", "kg", mass)?;
        positive("--radius", "m", radius)?;
        not_negative("--damping", "N m s/rad", damping)?;
        let along = mass * radius * radius / 2.0;
        let across = mass * (3.0 * radius * radius + length * length) / 12.0;
        let half = length / 2.0;
        let mut out = format!("<?xml version=\"1.0\"?>\n<robot name=\"chain_{links}\">\n  <link name=\"base\"/>\n");
        for i in 1..=links {
            let parent = if i == 1 { "base".to_owned() } else { format!("link_{}", i - 1) };
            let reach = if i == 1 { 0.0 } else { length };
            let kind = if axes == ChainAxes::Spherical { "spherical" } else { "continuous" };
            let axis = match axes {
                ChainAxes::Alternate if i % 2 == 1 => "0 1 0",
                ChainAxes::Y => "0 1 0",
                ChainAxes::Alternate | ChainAxes::Z => "0 0 1",
                ChainAxes::Spherical => "",
            };
            let axis = if axis.is_empty() { String::new() } else { format!("\n    <axis xyz=\"{axis}\"/>") };
            let dynamics =
                if damping > 0.0 { format!("\n    <dynamics damping=\"{damping}\"/>") } else { String::new() };
            // Writing to a String cannot fail.
            let _ = write!(
                out,
                r#"  <joint name="joint_{i}" type="{kind}">
    <parent link="{parent}"/>
    <child link="link_{i}"/>
    <origin xyz="{reach} 0 0"/>{axis}{dynamics}
  </joint>
  <link name="link_{i}">
    <inertial>
      <origin xyz="{half} 0 0"/>
      <mass value="{mass}"/>
      <inertia ixx="{along}" ixy="0" ixz="0" iyy="{across}" iyz="0" izz="{across}"/>
    </inertial>
  </link>
"#
            );
        }
        out.push_str("</robot>\n");
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{JointKind, read_urdf};

    fn read(chain: &Chain) -> crate::model::Model {
        let file = tempfile::NamedTempFile::with_suffix(".urdf").unwrap();
        std::fs::write(file.path(), chain.urdf().unwrap()).unwrap();
        read_urdf(file.path()).unwrap()
    }

    #[test]
    fn a_chain_is_read_back_as_it_was_meant() {
        let model = read(&Chain { links: 3, damping: 0.25, ..Chain::default() });
        assert_eq!((model.links.len(), model.joints.len()), (4, 3));
        assert!(model.links[0].inertial.is_none());
        let rod = model.links[3].inertial.as_ref().unwrap();
        assert_eq!((rod.mass, rod.com.x), (1.0, 0.15));
        assert_eq!(rod.inertia[(1, 1)], (3.0 * 0.02 * 0.02 + 0.3 * 0.3) / 12.0);
        let axes: Vec<_> = model.joints.iter().map(|j| (j.kind, j.axis.y, j.axis.z)).collect();
        let hinge = JointKind::Continuous;
        assert_eq!(axes, [(hinge, 1.0, 0.0), (hinge, 0.0, 1.0), (hinge, 1.0, 0.0)]);
        assert!(model.joints.iter().all(|j| j.damping == 0.25));
        assert_eq!(model.joints[2].origin.translation.x, 0.3);
    }

    #[test]
    fn a_chain_of_ball_joints_has_three_coordinates_a_joint() {
        let model = read(&Chain { links: 2, axes: ChainAxes::Spherical, ..Chain::default() });
        assert!(model.joints.iter().all(|j| j.kind == JointKind::Spherical));
    }

    #[test]
    fn impossible_options_are_named() {
        let message = |chain: Chain| chain.urdf().unwrap_err().to_string();
        assert_eq!(message(Chain { length: -1.0, ..Chain::default() }), "--length must be > 0 m, got -1");
        assert_eq!(message(Chain { mass: f64::NAN, ..Chain::default() }), "--mass must be > 0 kg, got NaN");
        assert_eq!(message(Chain { links: 0, ..Chain::default() }), "--links must be > 0, got 0");
    }
}
