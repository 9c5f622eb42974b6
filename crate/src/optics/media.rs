/// Refractive indices: n1, n2 and n3 of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Media {
    /// Around the rig.
    pub outside: f64,
    /// The wall.
    pub wall: f64,
    /// The liquid.
    pub liquid: f64,
}
