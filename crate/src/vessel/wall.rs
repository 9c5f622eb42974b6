use nalgebra::DMatrix;

use crate::optics::{Interface, Stack, Surface};

/// A vessel's wall: its outer face and how thick it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// The face towards the rig.
    pub outer: Surface,
    /// Millimetres.
    pub thickness: f64,
    /// Covariance of the outer face's parameters, in the order and units of [`Surface::nudged`].
    pub covariance: DMatrix<f64>,
}

impl Wall {
    /// The face towards the liquid: the outer one, a thickness behind along the normal.
    pub fn inner(&self) -> Surface {
        self.outer.behind(self.thickness)
    }

    /// What light from the rig crosses: `outside`, the wall, `inside` (n1, n2, n3 of the paper).
    pub fn stack(&self, outside: f64, wall: f64, inside: f64) -> Stack {
        let face = |surface, index_behind| Interface {
            surface,
            index_behind,
        };
        Stack {
            outside,
            interfaces: vec![face(self.outer, wall), face(self.inner(), inside)],
        }
    }
}
