//! A plane through points of which some may be wrong.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::{Direction, Frame, Plane, Point};
use crate::robust::{self, Choice, median, robust_scale};

/// A measured point and the standard deviation of its distance from the surface, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedPoint<F: Frame> {
    /// Where it was measured.
    pub point: Point<F>,
    /// One standard deviation across the surface, mm.
    pub sigma: f64,
}

/// A plane fitted to points, with what the points say of it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneFit<F: Frame> {
    /// The plane; its point is the weighted centroid.
    pub plane: Plane<F>,
    /// The final weight of each point, 1/mm^2; 0 for those that do not support the plane.
    pub weights: Vec<f64>,
    /// Covariance of the tilts (radians) towards the normal's two tangents and of the offset along
    /// the normal (mm), in that order, about the plane's point.
    pub covariance: Matrix3<f64>,
    /// Root mean square distance of the supporting points, mm.
    pub rms: f64,
    /// Robust standard deviation of all points' distances, mm: 1.4826 times their median size.
    pub scale: f64,
}

/// Why no plane could be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Three points make a plane.
    #[error("{found} usable points, and a plane needs at least 3")]
    TooFewPoints {
        /// How many there are.
        found: usize,
    },
    /// The points lie on a line (or in one place), so the plane can turn about it.
    #[error(
        "the points lie on a straight line, all but for their noise (extent across it {across:.3} mm), \
         so the wall can turn about that line; measure at another height as well"
    )]
    Collinear {
        /// Standard deviation of the points across their main direction within the plane, mm.
        across: f64,
    },
    /// No plane is near more than half of the points.
    #[error("only {inliers} of {points} points agree on a plane; more than half must")]
    NoConsensus {
        /// How many agree on the best plane.
        inliers: usize,
        /// How many there are.
        points: usize,
    },
}

/// Points that reach across their main direction by less than this part of what they reach along it lie on a
/// line.
const LEAST_ACROSS: f64 = 0.01;

/// Refuses points that lie on a straight line, all but for their noise: no surface follows from them.
pub(crate) fn spread_out<F: Frame>(points: &[WeightedPoint<F>]) -> Result<(), FitError> {
    let (_, scatter, total) = weighted_scatter(points, &vec![1.0; points.len()]);
    let mut variances = (scatter / total).symmetric_eigenvalues();
    variances.as_mut_slice().sort_by(f64::total_cmp);
    let [_, across, along] = variances.map(|v| v.max(0.0).sqrt()).into();
    if across > LEAST_ACROSS * along {
        Ok(())
    } else {
        Err(FitError::Collinear { across })
    }
}

const SAMPLES: usize = 400;
const REWEIGHTINGS: usize = 30;

/// Fits a plane to points of which fewer than half may be outliers.
///
/// A least-median-of-squares search over triples gives a start that no minority can pull away; it is
/// then refined by iteratively reweighted total least squares with Tukey's biweight. The covariance is
/// that of the final weighted fit, scaled up where the residuals are larger than the points' sigmas.
/// The normal points to the side on which `front` lies.
pub fn fit_plane<F: Frame>(
    points: &[WeightedPoint<F>],
    front: Point<F>,
) -> Result<PlaneFit<F>, FitError> {
    if points.len() < 3 {
        return Err(FitError::TooFewPoints {
            found: points.len(),
        });
    }
    let mut plane = least_median_start(points)?;
    let mut weights = Vec::new();
    for _ in 0..REWEIGHTINGS {
        weights = biweights(points, &plane);
        let next = weighted_plane(points, &weights, front)?;
        let moved = turned_or_shifted(&plane, &next, points);
        plane = next;
        if moved < 1e-10 {
            break;
        }
    }
    summarise(points, plane, weights)
}

/// Refits a plane to the same points with weights that stay as they are (0 leaves a point out).
pub(crate) fn weighted_plane<F: Frame>(
    points: &[WeightedPoint<F>],
    weights: &[f64],
    front: Point<F>,
) -> Result<Plane<F>, FitError> {
    let (centroid, scatter, total) = weighted_scatter(points, weights);
    let used = weights.iter().filter(|w| **w > 0.0).count();
    if used < 3 {
        return Err(FitError::TooFewPoints { found: used });
    }
    let axes = SymmetricEigen::new(scatter / total);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| axes.eigenvalues[a].total_cmp(&axes.eigenvalues[b]));
    let spread = |i: usize| axes.eigenvalues[order[i]].max(0.0).sqrt();
    // Across the main direction the points must reach well beyond what they scatter off the plane; and of
    // a few points, whose scatter shows little, no less than a part of what they reach along it.
    if !(spread(1) > 3.0 * spread(0) && spread(1) > LEAST_ACROSS * spread(2)) {
        return Err(FitError::Collinear { across: spread(1) });
    }
    let normal = axes.eigenvectors.column(order[0]).into_owned();
    let normal = Direction::new(normal).map_err(|_| FitError::Collinear { across: 0.0 })?;
    let plane = Plane::new(Point::from_coords(centroid), normal);
    Ok(if plane.signed_distance(front) < 0.0 {
        Plane::new(plane.point, -plane.normal)
    } else {
        plane
    })
}

fn weighted_scatter<F: Frame>(
    points: &[WeightedPoint<F>],
    weights: &[f64],
) -> (Vector3<f64>, Matrix3<f64>, f64) {
    let mut total = 0.0;
    let mut centroid = Vector3::zeros();
    for (p, w) in points.iter().zip(weights) {
        total += w;
        centroid += p.point.coords * *w;
    }
    centroid /= total;
    let mut scatter = Matrix3::zeros();
    for (p, w) in points.iter().zip(weights) {
        let d = p.point.coords - centroid;
        scatter += d * d.transpose() * *w;
    }
    (centroid, scatter, total)
}

/// The plane through three of the points whose median squared residual is least.
fn least_median_start<F: Frame>(points: &[WeightedPoint<F>]) -> Result<Plane<F>, FitError> {
    let mut best: Option<(f64, Plane<F>)> = None;
    for [a, b, c] in triples(points.len()) {
        let [a, b, c] = [points[a].point, points[b].point, points[c].point];
        let Ok(normal) = Direction::new((b - a).cross(&(c - a))) else {
            continue;
        };
        let plane = Plane::new(a, normal);
        let score = median(points.iter().map(|p| residual(p, &plane).abs()).collect());
        if best.as_ref().is_none_or(|(least, _)| score < *least) {
            best = Some((score, plane));
        }
    }
    best.map(|(_, plane)| plane)
        .ok_or(FitError::Collinear { across: 0.0 })
}

/// Every triple of a small set; a fixed pseudo-random choice of a large one, so that the same points
/// give the same plane everywhere.
fn triples(n: usize) -> Vec<[usize; 3]> {
    /// The largest set with no more triples than samples.
    const SMALL: usize = 14;
    if n <= SMALL {
        let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b)));
        return pairs
            .flat_map(|(a, b)| (b + 1..n).map(move |c| [a, b, c]))
            .collect();
    }
    let mut choice = Choice::new();
    (0..SAMPLES).filter_map(|_| choice.distinct(n)).collect()
}

fn residual<F: Frame>(p: &WeightedPoint<F>, plane: &Plane<F>) -> f64 {
    plane.signed_distance(p.point) / p.sigma
}

fn biweights<F: Frame>(points: &[WeightedPoint<F>], plane: &Plane<F>) -> Vec<f64> {
    let normalised: Vec<f64> = points.iter().map(|p| residual(p, plane)).collect();
    let weights = robust::biweights(&normalised).zip(points);
    weights
        .map(|(weight, p)| weight / (p.sigma * p.sigma))
        .collect()
}

/// How far the plane moved at the points, mm, at most.
fn turned_or_shifted<F: Frame>(
    before: &Plane<F>,
    after: &Plane<F>,
    points: &[WeightedPoint<F>],
) -> f64 {
    let sign = before.normal.dot(after.normal).signum();
    points
        .iter()
        .map(|p| (before.signed_distance(p.point) - sign * after.signed_distance(p.point)).abs())
        .fold(0.0, f64::max)
}

fn summarise<F: Frame>(
    points: &[WeightedPoint<F>],
    plane: Plane<F>,
    weights: Vec<f64>,
) -> Result<PlaneFit<F>, FitError> {
    let count = weights.iter().filter(|w| **w > 0.0).count();
    if 2 * count <= points.len() {
        return Err(FitError::NoConsensus {
            inliers: count,
            points: points.len(),
        });
    }
    let (u, v) = plane.normal.tangents();
    let mut information = Matrix3::zeros();
    let (mut squares, mut chi) = (0.0, 0.0);
    for (p, _) in points.iter().zip(&weights).filter(|(_, w)| **w > 0.0) {
        let d = p.point - plane.point;
        // How tilts and offset change the point's distance from the plane.
        let row = Vector3::new(d.dot(&u), d.dot(&v), -1.0) / p.sigma;
        information += row * row.transpose();
        squares += plane.signed_distance(p.point) * plane.signed_distance(p.point);
        chi += residual(p, &plane) * residual(p, &plane);
    }
    let distances: Vec<f64> = points
        .iter()
        .map(|p| plane.signed_distance(p.point))
        .collect();
    let freedom = count.saturating_sub(3).max(1) as f64;
    let inflation = (chi / freedom).max(1.0);
    let covariance = information
        .try_inverse()
        .ok_or(FitError::Collinear { across: 0.0 })?
        * inflation;
    Ok(PlaneFit {
        plane,
        weights,
        covariance,
        rms: (squares / count as f64).sqrt(),
        scale: robust_scale(&distances),
    })
}
