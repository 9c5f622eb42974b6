//! What measurements other than its own points say of a wall.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::camera::Pixel;

/// A number that was measured, is 0 if everything is right, and depends on the wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// The view that shows it.
    pub view: usize,
    /// What was seen there.
    pub pixel: Pixel,
    /// How it changes with those of the wall's parameters that matter.
    pub slopes: Vec<(usize, f64)>,
    /// The variance of its own noise.
    pub variance: f64,
    /// How much errors that all such numbers have in common change it, one standard deviation each.
    pub common: Vec<f64>,
}

impl Evidence {
    /// How it follows a step of the wall's parameters.
    pub fn following(&self, step: &DVector<f64>) -> f64 {
        self.slopes
            .iter()
            .map(|(parameter, slope)| slope * step[*parameter])
            .sum()
    }

    /// The variance that common errors and the wall's covariance make.
    pub fn variance_of_others(&self, wall: &DMatrix<f64>) -> f64 {
        let pairs = self
            .slopes
            .iter()
            .flat_map(|a| self.slopes.iter().map(move |b| (a, b)));
        let of_wall = pairs.map(|((i, a), (j, b))| a * b * wall[(*i, *j)]);
        let of_errors = self.common.iter().map(|change| change * change);
        of_wall.sum::<f64>() + of_errors.sum::<f64>()
    }
}

/// A wall that is possible: a step away from one that serves as the middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// By how much it counts beside others; all weights together are 1.
    pub weight: f64,
    /// Its parameters less the middle's.
    pub step: DVector<f64>,
    /// A root L of its parameters' covariance L L^T.
    pub root: DMatrix<f64>,
}

/// The covariance of parameters that are those of one of some alternatives, about their mean.
pub(super) fn covariance(alternatives: &[Alternative]) -> DMatrix<f64> {
    let size = alternatives.first().map_or(0, |one| one.step.len());
    let none = DVector::zeros(size);
    let mean = alternatives
        .iter()
        .fold(none, |sum, one| sum + &one.step * one.weight);
    let none = DMatrix::zeros(size, size);
    alternatives.iter().fold(none, |sum, one| {
        let off = &one.step - &mean;
        sum + (&one.root * one.root.transpose() + &off * off.transpose()) * one.weight
    })
}

/// How a wall follows such numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    seen: Vec<(usize, Pixel)>,
    step: DVector<f64>,
    /// How the wall's parameters follow: minus this times the numbers.
    gain: DMatrix<f64>,
    covariance: DMatrix<f64>,
}

impl Told {
    /// The best linear estimate (R. Kalman, 1960) for each alternative, and their mean, each counted by how
    /// likely it makes the numbers, which are those of the middle.
    ///
    /// With P = L L^T the covariance of an alternative, J the slopes, D the numbers' own variances and C what
    /// common errors do to them,
    ///
    /// ```text
    /// R = D + C C^T,   X = J L,   Q = (1 + X^T R^-1 X)^-1,   P' = L Q L^T,   K = L Q X^T R^-1
    /// ```
    ///
    /// and -2 ln of the likelihood is i^T R^-1 i - (X^T R^-1 i)^T Q (X^T R^-1 i) - ln |Q| for the numbers i that
    /// it would have, less what all have in common. P may leave much open, so it is never inverted. `None` for
    /// numbers that are none.
    pub fn weigh(
        alternatives: &[Alternative],
        evidence: &[Evidence],
        numbers: &DVector<f64>,
    ) -> Option<Self> {
        let weight = Weight::of(evidence)?;
        let one = |one: &Alternative| Estimate::of(one, evidence, &weight, numbers);
        let mut estimates: Vec<Estimate> = alternatives.iter().map(one).collect::<Option<_>>()?;
        let scores = estimates.iter().map(|one| one.unlikeliness);
        let least = scores.fold(f64::INFINITY, f64::min);
        for one in &mut estimates {
            one.after.weight *= libm::exp(0.5 * (least - one.unlikeliness));
        }
        let sum: f64 = estimates.iter().map(|one| one.after.weight).sum();
        let mut step = DVector::zeros(estimates.first()?.after.step.len());
        let mut gain = DMatrix::zeros(step.len(), evidence.len());
        for one in &mut estimates {
            one.after.weight /= sum;
            step += &one.after.step * one.after.weight;
            gain += &one.gain * one.after.weight;
        }
        let after: Vec<Alternative> = estimates.into_iter().map(|one| one.after).collect();
        Some(Self {
            seen: evidence.iter().map(|one| (one.view, one.pixel)).collect(),
            covariance: covariance(&after),
            step,
            gain,
        })
    }

    /// Covariance of the wall's parameters with what the numbers say.
    pub const fn covariance(&self) -> &DMatrix<f64> {
        &self.covariance
    }

    /// The step of the wall's parameters that the numbers ask for.
    pub const fn step(&self) -> &DVector<f64> {
        &self.step
    }

    /// The step of the wall's parameters that follows when the numbers change.
    pub fn following(&self, changes: &DVector<f64>) -> DVector<f64> {
        -(&self.gain * changes)
    }

    /// What was seen, and in which view.
    pub fn seen(&self) -> &[(usize, Pixel)] {
        &self.seen
    }

    /// How the parameters follow the number that was seen in a place.
    pub fn gain_of(
        &self,
        is_it: impl Fn(usize, Pixel) -> bool,
    ) -> Option<impl Fn(usize) -> f64 + '_> {
        let mut seen = self.seen.iter();
        let column = seen.position(|(view, pixel)| is_it(*view, *pixel))?;
        Some(move |parameter| self.gain[(parameter, column)])
    }
}

/// What the numbers make of one alternative.
struct Estimate {
    after: Alternative,
    gain: DMatrix<f64>,
    /// -2 ln of the likelihood.
    unlikeliness: f64,
}

impl Estimate {
    fn of(
        before: &Alternative,
        evidence: &[Evidence],
        weight: &Weight,
        numbers: &DVector<f64>,
    ) -> Option<Self> {
        let numbers = DMatrix::from_columns(&[numbers + product(evidence, &before.step)]);
        let through = through(evidence, &before.root);
        let weighed = weight.times(&through);
        let unit = DMatrix::identity(through.ncols(), through.ncols());
        let factor = (unit + through.tr_mul(&weighed)).cholesky()?;
        let left = factor.inverse();
        let asked = weighed.tr_mul(&numbers);
        let solved = &left * &asked;
        let diagonal = factor.l_dirty().diagonal();
        let volume: f64 = diagonal.iter().map(|d| 2.0 * libm::log(*d)).sum();
        let misfit = numbers.dot(&weight.times(&numbers)) - asked.dot(&solved);
        Some(Self {
            gain: &before.root * &left * weighed.transpose(),
            after: Alternative {
                weight: before.weight,
                step: &before.step - (&before.root * solved).column(0),
                root: &before.root * left.cholesky()?.unpack(),
            },
            unlikeliness: misfit + volume,
        })
    }
}

/// J times a step of the parameters.
fn product(evidence: &[Evidence], step: &DVector<f64>) -> DVector<f64> {
    DVector::from_iterator(
        evidence.len(),
        evidence.iter().map(|one| one.following(step)),
    )
}

/// J L.
fn through(evidence: &[Evidence], root: &DMatrix<f64>) -> DMatrix<f64> {
    let columns: Vec<_> = root
        .column_iter()
        .map(|column| product(evidence, &column.into_owned()))
        .collect();
    DMatrix::from_columns(&columns)
}

/// R^-1, which is as large as there are views and is never written down:
/// R^-1 = D^-1 - D^-1 C (1 + C^T D^-1 C)^-1 C^T D^-1 (M. Woodbury, 1950).
struct Weight {
    alone: DVector<f64>,
    /// D^-1 C.
    common: DMatrix<f64>,
    inner: Cholesky<f64, Dyn>,
}

impl Weight {
    fn of(evidence: &[Evidence]) -> Option<Self> {
        let errors = evidence.first()?.common.len();
        let one = |row: usize, error: usize| evidence[row].common[error];
        let change = DMatrix::from_fn(evidence.len(), errors, one);
        let over = evidence.iter().map(|one| 1.0 / one.variance);
        let alone = DVector::from_iterator(evidence.len(), over);
        let common = scaled(&alone, &change);
        let inner = DMatrix::identity(errors, errors) + change.tr_mul(&common);
        Some(Self {
            alone,
            common,
            inner: inner.cholesky()?,
        })
    }

    fn times(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        let shared = self.inner.solve(&self.common.tr_mul(of));
        scaled(&self.alone, of) - &self.common * shared
    }
}

/// Each row of a matrix times a number of its own.
fn scaled(by: &DVector<f64>, of: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(of.nrows(), of.ncols(), |row, column| {
        by[row] * of[(row, column)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence() -> Vec<Evidence> {
        let row = |slopes: [f64; 3], variance: f64, common: [f64; 2]| Evidence {
            view: 0,
            pixel: Pixel::new(0.0, 0.0),
            slopes: slopes.into_iter().enumerate().collect(),
            variance,
            common: common.to_vec(),
        };
        vec![
            row([1.0, 0.2, -0.4], 0.04, [0.3, 0.1]),
            row([-0.5, 0.9, 0.1], 0.09, [0.2, -0.2]),
            row([0.3, -0.7, 0.6], 0.01, [0.1, 0.4]),
            row([0.8, 0.1, 0.2], 0.02, [-0.3, 0.2]),
        ]
    }

    fn alternative(weight: f64, step: [f64; 3]) -> Alternative {
        let root = [0.5, 0.0, 0.0, 0.2, 0.4, 0.0, -0.1, 0.3, 0.6];
        Alternative {
            weight,
            step: DVector::from_column_slice(&step),
            root: DMatrix::from_row_slice(3, 3, &root),
        }
    }

    /// The information form of the same estimate, with every matrix written down.
    #[test]
    fn it_is_the_estimate_of_least_variance() {
        let evidence = evidence();
        let prior = alternative(1.0, [0.0; 3]);
        let numbers = DVector::from_column_slice(&[0.1, -0.3, 0.2, 0.4]);
        let told = Told::weigh(std::slice::from_ref(&prior), &evidence, &numbers).unwrap();
        let slopes = DMatrix::from_fn(4, 3, |row, parameter| evidence[row].slopes[parameter].1);
        let noise = DMatrix::from_fn(4, 4, |i, j| {
            let common = evidence[i].common.iter().zip(&evidence[j].common);
            let shared: f64 = common.map(|(a, b)| a * b).sum();
            shared + if i == j { evidence[i].variance } else { 0.0 }
        });
        let weight = noise.try_inverse().unwrap();
        let before = (&prior.root * prior.root.transpose())
            .try_inverse()
            .unwrap();
        let covariance = (before + slopes.transpose() * &weight * &slopes)
            .try_inverse()
            .unwrap();
        let step = -(&covariance * slopes.transpose() * weight * &numbers);
        assert!((told.covariance() - covariance).amax() < 1e-12);
        assert!((told.step() - &step).amax() < 1e-12);
        assert!((told.following(&numbers) - step).amax() < 1e-12);
    }

    /// Of two walls that were thought alike likely, the one that predicts the numbers is taken; where both
    /// do, their difference stays in the covariance.
    #[test]
    fn alternatives_count_by_what_they_predict() {
        let evidence = evidence();
        let (here, there) = ([0.0; 3], [8.0, -6.0, 7.0]);
        let both = [alternative(0.5, here), alternative(0.5, there)];
        let alone = Told::weigh(&both[..1], &evidence, &DVector::zeros(4)).unwrap();
        let told = Told::weigh(&both, &evidence, &DVector::zeros(4)).unwrap();
        assert!(
            (told.step() - alone.step()).amax() < 1e-3,
            "{}",
            told.step()
        );
        let blind: Vec<Evidence> = evidence
            .into_iter()
            .map(|one| Evidence {
                variance: 1e12,
                ..one
            })
            .collect();
        let told = Told::weigh(&both, &blind, &DVector::zeros(4)).unwrap();
        assert!(
            (told.step() - &both[1].step * 0.5).amax() < 1e-6,
            "{}",
            told.step()
        );
        assert!((told.covariance() - covariance(&both)).amax() < 1e-6);
    }
}
