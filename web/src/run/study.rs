//! What a worker tells the page of the liquid's index: every method's estimate, and the curves.

use serde::{Deserialize, Serialize};
use snellius::index::{
    IndexCurve, IndexEstimate, IndexMethod, IndexStudy, KnownCurve, Observability, Verdict,
};
use snellius::scan::KnownKind;

/// All methods on one scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    /// What the ray distance can tell; missing for a line laser, whose rays always meet.
    pub(crate) observability: Option<Observability>,
    /// The methods that apply.
    pub(crate) methods: Vec<MethodReport>,
    /// The methods that do not, and why.
    pub(crate) not_applicable: Vec<(IndexMethod, String)>,
    /// Over the index: the ray distance, and each known shape.
    pub(crate) curves: Vec<StudyCurve>,
}

/// What a method makes of the scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MethodReport {
    pub(crate) method: IndexMethod,
    pub(crate) verdict: Verdict,
    /// Missing where the scan cannot tell.
    pub(crate) value: Option<f64>,
    /// One standard deviation, and what it is made of.
    pub(crate) sigma: f64,
    pub(crate) sampling_sigma: f64,
    pub(crate) model_sigma: Option<f64>,
    /// Why it is not determined.
    pub(crate) reason: Option<String>,
    /// What would determine it.
    pub(crate) remedy: Option<String>,
}

/// What a curve shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum CurveKind {
    /// Eq. (3): the mean ray distance, mm.
    RayDistance,
    /// Eq. (3), robust and weighted: no unit.
    WeightedRayDistance,
    /// Eq. (4): the measure of a known shape, degrees or mm.
    Known(KnownKind),
}

/// A quantity over the index.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StudyCurve {
    pub(crate) kind: CurveKind,
    /// Index and quantity.
    pub(crate) points: Vec<(f64, f64)>,
    /// Where the curve is lowest, unless that is an end of it.
    pub(crate) minimum: Option<(f64, f64)>,
    /// What the quantity is known to be.
    pub(crate) known: Option<f64>,
    /// Where the index lies 95 times in 100 by this quantity.
    pub(crate) interval: Option<[f64; 2]>,
}

impl Study {
    pub(crate) fn of(study: &IndexStudy) -> Self {
        let methods = study.estimates.iter();
        Self {
            observability: study.observability.clone(),
            methods: methods.map(|e| MethodReport::of(study, e)).collect(),
            not_applicable: study.not_applicable.clone(),
            curves: curves(study),
        }
    }

    /// The estimate of the most evidence.
    pub(crate) fn best(&self) -> Option<&MethodReport> {
        let joint = self.methods.iter().find(|m| m.method == IndexMethod::Joint);
        joint.or_else(|| self.methods.first())
    }
}

impl MethodReport {
    fn of(study: &IndexStudy, estimate: &IndexEstimate) -> Self {
        Self {
            method: estimate.method,
            verdict: estimate.verdict,
            value: estimate.value,
            sigma: estimate.sigma,
            sampling_sigma: estimate.sampling_sigma,
            model_sigma: estimate.model_sigma,
            reason: estimate.reason.clone(),
            remedy: study.remedy(estimate.method).map(ToString::to_string),
        }
    }
}

impl StudyCurve {
    /// The quantity at an index, between the curve's points.
    pub(crate) fn at(&self, index: f64) -> Option<f64> {
        let pairs = self.points.windows(2);
        let mut around = pairs.filter(|pair| (pair[0].0..=pair[1].0).contains(&index));
        let [a, b] = around.next()? else { return None };
        Some(a.1 + (b.1 - a.1) * (index - a.0) / (b.0 - a.0))
    }
}

fn curves(study: &IndexStudy) -> Vec<StudyCurve> {
    let interval = |method| study.estimate(method).map(|e| e.interval);
    let mut curves = Vec::new();
    // A line laser's rays meet whatever the index is.
    if study.observability.is_some() {
        let plain = curve(CurveKind::RayDistance, &study.plain_curve);
        curves.push(StudyCurve {
            minimum: minimum(&study.plain_curve),
            ..plain
        });
        let weighted = curve(CurveKind::WeightedRayDistance, &study.ray_distance_curve);
        curves.push(StudyCurve {
            minimum: minimum(&study.ray_distance_curve),
            interval: interval(IndexMethod::RayDistance),
            ..weighted
        });
    }
    let known = |known: &KnownCurve| {
        let flatness = known.kind == KnownKind::Flatness;
        StudyCurve {
            minimum: flatness.then(|| minimum(&known.measured)).flatten(),
            known: Some(known.known),
            interval: interval(IndexMethod::KnownShape),
            ..curve(CurveKind::Known(known.kind), &known.measured)
        }
    };
    curves.extend(study.known_curves.iter().map(known));
    curves
}

fn curve(kind: CurveKind, curve: &IndexCurve) -> StudyCurve {
    let values = curve.index.iter().zip(&curve.value);
    StudyCurve {
        kind,
        points: values
            .filter_map(|(n, value)| Some((*n, (*value)?)))
            .collect(),
        minimum: None,
        known: None,
        interval: None,
    }
}

fn minimum(curve: &IndexCurve) -> Option<(f64, f64)> {
    let minimum = curve.minimum().filter(|minimum| !minimum.at_bound)?;
    Some((minimum.index, minimum.value))
}
