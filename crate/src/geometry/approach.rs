use super::{Frame, Point, Ray};

/// Where two lines come closest: section II-D and Fig. 7 of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach<F: Frame> {
    /// The foot on the first line.
    pub first: Point<F>,
    /// The foot on the second line.
    pub second: Point<F>,
    /// How far along the first ray its foot lies; negative behind the origin.
    pub along_first: f64,
    /// How far along the second ray its foot lies; negative behind the origin.
    pub along_second: f64,
    /// The distance of the two lines with a sign: positive where the second passes on the side of
    /// `first.direction x second.direction`. Its size is the ray distance l.
    pub gap: f64,
}

impl<F: Frame> Approach<F> {
    /// The middle of the shortest segment between the lines.
    pub fn midpoint(&self) -> Point<F> {
        self.first.midpoint(self.second)
    }
}

/// The rays are parallel: no one point is closest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the two rays are parallel")]
pub struct ParallelRays;

/// The smallest sine of the angle between two rays that still makes a triangle. It has no unit, so
/// it does not depend on the size of the scene; at 350 mm it stands for a depth of 10^8 mm.
const SMALLEST_SINE: f64 = 1e-9;

/// Finds where the lines that carry two rays come closest.
///
/// With w the vector from the first origin to the second and c = d1 x d2, the feet lie at
/// t1 = det(w, d2, c) / |c|^2 and t2 = det(w, d1, c) / |c|^2, and the gap is w . c / |c|.
///
/// ```
/// use snellius::geometry::{Direction, Point, Ray, World, closest_approach};
///
/// let along_x = Ray::<World>::new(Point::origin(), Direction::new([1.0, 0.0, 0.0].into())?);
/// let along_y = Ray::new(Point::new(3.0, -4.0, 0.5), Direction::new([0.0, 1.0, 0.0].into())?);
/// let approach = closest_approach(&along_x, &along_y)?;
/// assert_eq!(approach.midpoint(), Point::new(3.0, 0.0, 0.25));
/// assert_eq!(approach.gap, 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn closest_approach<F: Frame>(
    first: &Ray<F>,
    second: &Ray<F>,
) -> Result<Approach<F>, ParallelRays> {
    let (d1, d2) = (first.direction.vector(), second.direction.vector());
    let cross = d1.cross(&d2);
    let sine_squared = cross.norm_squared();
    if sine_squared.is_nan() || sine_squared <= SMALLEST_SINE * SMALLEST_SINE {
        return Err(ParallelRays);
    }
    let between = second.origin - first.origin;
    let along_first = between.cross(&d2).dot(&cross) / sine_squared;
    let along_second = between.cross(&d1).dot(&cross) / sine_squared;
    Ok(Approach {
        first: first.at(along_first),
        second: second.at(along_second),
        along_first,
        along_second,
        gap: between.dot(&cross) / sine_squared.sqrt(),
    })
}
