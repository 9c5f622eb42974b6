use crate::geometry::{Direction, Frame, unit};

/// The light cannot leave the denser medium: the sine of its angle would have to exceed 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "total internal reflection: light meets the face at {:.2} degrees, beyond the critical angle of {:.2}",
    self.incidence.to_degrees(),
    self.critical.to_degrees()
)]
pub struct TotalReflection {
    /// Angle of incidence, radians.
    pub incidence: f64,
    /// Critical angle asin(n2/n1), radians.
    pub critical: f64,
}

/// Bends light that crosses a face from a medium of index `n1` into one of `n2`.
///
/// Snell's law, n1 sin a = n2 sin b, in vector form, with the light, the normal and the bent light in
/// one plane (eqs. (1) and (2) of Yamashita et al. state it as a ratio of cross products):
///
/// ```text
/// t = (n1/n2) d + ((n1/n2) cos a - cos b) N,   cos b = sqrt(1 - (n1/n2)^2 (1 - cos^2 a))
/// ```
///
/// The normal's sign does not matter. Fails with [`TotalReflection`] where sin b would exceed 1.
///
/// ```
/// use snellius::geometry::{Direction, World};
/// use snellius::optics::refract;
///
/// let down = Direction::<World>::new([0.5, 0.0, 0.75_f64.sqrt()].into())?; // 30 degrees
/// let normal = Direction::new([0.0, 0.0, -1.0].into())?;
/// let in_water = refract(down, normal, 1.0, 1.333)?;
/// assert!((in_water.vector().x * 1.333 - 0.5).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refract<F: Frame>(
    light: Direction<F>,
    normal: Direction<F>,
    n1: f64,
    n2: f64,
) -> Result<Direction<F>, TotalReflection> {
    let cos_light = light.dot(normal);
    // The normal on the side the light comes from, and the cosine of incidence, both made positive.
    let (facing, cos_a) = if cos_light > 0.0 {
        (-normal, cos_light)
    } else {
        (normal, -cos_light)
    };
    let ratio = n1 / n2;
    let cos_b_squared = 1.0 - ratio * ratio * (1.0 - cos_a * cos_a);
    if cos_b_squared < 0.0 {
        return Err(TotalReflection {
            incidence: libm::acos(cos_a.min(1.0)),
            critical: libm::asin(n2 / n1),
        });
    }
    let bent = light * ratio + facing * (ratio * cos_a - cos_b_squared.sqrt());
    Ok(Direction::assume_unit(unit(bent)))
}
