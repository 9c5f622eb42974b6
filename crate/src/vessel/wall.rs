use nalgebra::{DMatrix, DVector};

use crate::optics::{Interface, Media, Stack, Surface};
use crate::scan::InsideMedium;

/// A vessel's wall: its outer face and how thick it is, and a far wall if there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// The face towards the rig.
    pub outer: Surface,
    /// Millimetres.
    pub thickness: f64,
    /// The wall behind the liquid, where the object stands behind the vessel.
    pub far: Option<FarWall>,
    /// Covariance of the outer face's parameters, in the order and units of [`Surface::nudged`].
    pub covariance: DMatrix<f64>,
}

/// A wall behind the liquid, parallel to the front one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarWall {
    /// From the front wall's inner face to this one's, mm.
    pub distance: f64,
    /// Millimetres.
    pub thickness: f64,
}

/// The wall is thicker than the vessel's radius.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "vessel.wall_thickness: {depth} mm do not fit into a round vessel whose wall was measured with a \
     smaller radius; check the thickness, or give the vessel's shape"
)]
pub struct NoRoom {
    /// How deep the face would have to lie behind the outer one, mm.
    pub depth: f64,
}

impl Wall {
    /// A wall whose outer face is known exactly.
    pub fn exact(outer: Surface, thickness: f64, far: Option<FarWall>) -> Self {
        let freedom = outer.freedom();
        Self {
            outer,
            thickness,
            far,
            covariance: DMatrix::zeros(freedom, freedom),
        }
    }

    /// What light from the rig crosses on its way to the object of a view: n1, n2, n3; and, where there
    /// is a far wall, that one out into n1 again (section III-B).
    pub fn stack(&self, media: &Media, inside: InsideMedium) -> Result<Stack, NoRoom> {
        let &Media {
            outside,
            wall,
            liquid,
        } = media;
        let inside = match inside {
            InsideMedium::Liquid => liquid,
            InsideMedium::Air => outside,
        };
        let mut depth = 0.0;
        let mut interfaces = Vec::with_capacity(4);
        let mut add_face = |further: f64, index_behind: f64| {
            depth += further;
            let surface = self.outer.behind(depth).ok_or(NoRoom { depth })?;
            interfaces.push(Interface {
                surface,
                index_behind,
            });
            Ok(())
        };
        add_face(0.0, wall)?;
        add_face(self.thickness, inside)?;
        if let Some(far) = self.far {
            add_face(far.distance, wall)?;
            add_face(far.thickness, outside)?;
        }
        Ok(Stack {
            outside,
            interfaces,
        })
    }

    /// The wall with its outer face moved by a small step in its parameters.
    pub fn nudged(&self, step: &DVector<f64>) -> Self {
        Self {
            outer: self.outer.nudged(step),
            ..self.clone()
        }
    }
}
