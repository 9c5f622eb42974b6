//! Error ellipsoids: where a point lies with two standard deviations of its noise.

use nalgebra::{Matrix3, SymmetricEigen};
use three_d::{Vec3, vec3};

use super::lines::{Line, chain};

/// Standard deviations from the middle to the surface.
const SIGMAS: f32 = 2.0;

/// The three ellipses through the axes of the ellipsoid of a covariance (xx, xy, xz, yy, yz, zz, mm^2)
/// about a place, so many times as large as it is.
pub(super) fn ellipsoid(
    place: Vec3,
    covariance: [f32; 6],
    magnified: f32,
    colour: [f32; 4],
) -> impl Iterator<Item = Line> {
    const STEPS: u32 = 20;
    let axes = half_axes(covariance).map(|axis| axis * magnified);
    let pairs = [(0, 1), (1, 2), (2, 0)];
    pairs.into_iter().flat_map(move |(one, other)| {
        let at = |step: u32| {
            let (sine, cosine) = (std::f32::consts::TAU * step as f32 / STEPS as f32).sin_cos();
            place + axes[one] * cosine + axes[other] * sine
        };
        let ring: Vec<Vec3> = (0..=STEPS).map(at).collect();
        chain(&ring, colour).collect::<Vec<_>>()
    })
}

fn half_axes([xx, xy, xz, yy, yz, zz]: [f32; 6]) -> [Vec3; 3] {
    let covariance = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let eigen = SymmetricEigen::new(covariance);
    std::array::from_fn(|i| {
        let length = SIGMAS * eigen.eigenvalues[i].max(0.0).sqrt();
        let axis = eigen.eigenvectors.column(i) * length;
        vec3(axis[0], axis[1], axis[2])
    })
}
