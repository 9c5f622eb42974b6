//! Which curves of a line laser's line are the object's: all views together.
//!
//! A false line (a reflection of the object's, or of the wall's) passes every test that its view alone has to
//! offer. What speaks for a curve or against it, each as the logarithm of how much likelier that makes it the
//! object's than a ghost's, is the surface that the other views make, on which its points lie or not
//! ([`super::neighbours`]), its light and its width beside those of the other curves, and how many curves are
//! the object's at all. Curves speak for each other by what they are worth themselves, so this is repeated
//! until nothing changes.

use super::neighbours::{Forecasts, Misfit, Place, around, together, usual_curvature};
use super::select::{Evidence, Look, Looks};
use crate::geometry::{Ray, World};

/// Even a vague forecast tells a ghost that lies centimetres off, mm.
const VAGUEST: f64 = 30.0;
/// At so many points a curve is held against the others' surface.
pub(super) const SAMPLES: usize = 12;
/// A sum of more than this takes a curve for the object's.
const SURE: f64 = 2.0;

/// Whether a curve is rather a ghost than the object's.
pub(super) fn is_ghost(evidence: &Evidence) -> bool {
    evidence.favour <= SURE
}

/// A curve that may be the object's.
#[derive(Clone, Debug)]
pub(super) struct Arc {
    /// Which of the view's line.
    pub(super) curve: usize,
    /// The middle of what its points look like.
    pub(super) look: Look,
    /// Some of its points.
    pub(super) samples: Vec<Sample>,
}

/// A point of a curve: the ray of the sheet that lights it, and where the two meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) beam: Ray<World>,
    pub(super) place: Place,
}

/// What speaks for each curve of each view.
pub(super) fn judge(arcs: &[Vec<Arc>]) -> Vec<Vec<Evidence>> {
    const ROUNDS: usize = 12;
    /// Before anything is known, a curve is rather the object's.
    const START: f64 = 3.0;
    let start = Evidence {
        favour: START,
        misfit: None,
    };
    let scan = Scan::new(arcs);
    let mut evidence = vec![start; scan.arcs.len()];
    for _ in 0..ROUNDS {
        let next = scan.round(&evidence);
        let ghosts = |all: &[Evidence]| -> Vec<bool> { all.iter().map(is_ghost).collect() };
        let settled = ghosts(&next) == ghosts(&evidence);
        evidence = next;
        if settled {
            break;
        }
    }
    let mut evidence = evidence.into_iter();
    let of_view = |arcs: &Vec<Arc>| evidence.by_ref().take(arcs.len()).collect();
    arcs.iter().map(of_view).collect()
}

/// All views' curves in a row, and all their samples in another.
struct Scan<'a> {
    arcs: Vec<&'a Arc>,
    samples: Vec<Sample>,
    /// To which curve each sample belongs,
    arc_of: Vec<usize>,
    /// and among which samples of other views its neighbours are.
    around: Vec<Vec<usize>>,
}

impl<'a> Scan<'a> {
    fn new(views: &'a [Vec<Arc>]) -> Self {
        let arcs: Vec<&Arc> = views.iter().flatten().collect();
        let view_of: Vec<usize> = (views.iter().enumerate())
            .flat_map(|(view, arcs)| vec![view; arcs.len()])
            .collect();
        let arc_of: Vec<usize> = (arcs.iter().enumerate())
            .flat_map(|(index, arc)| vec![index; arc.samples.len()])
            .collect();
        let samples: Vec<Sample> = arcs
            .iter()
            .flat_map(|arc| arc.samples.iter().copied())
            .collect();
        let around = samples.iter().enumerate().map(|(index, sample)| {
            let elsewhere = |other: usize| view_of[arc_of[other]] != view_of[arc_of[index]];
            let places = samples.iter().enumerate();
            let places = places.map(|(other, s)| elsewhere(other).then_some(s.place));
            around(index, &sample.beam, &places.collect::<Vec<_>>())
        });
        Self {
            around: around.collect(),
            arcs,
            samples,
            arc_of,
        }
    }

    /// Each curve in the light of what the others are worth.
    fn round(&self, before: &[Evidence]) -> Vec<Evidence> {
        let likely = self.arcs.iter().zip(before);
        let likely = likely.filter(|(_, evidence)| evidence.favour > 0.0);
        let Some(looks) = Looks::of(likely.map(|(arc, _)| &arc.look)) else {
            return before.to_vec();
        };
        let trust: Vec<f64> = before.iter().map(Evidence::probability).collect();
        let own: f64 = trust.iter().sum();
        // Half a ghost for ten curves of the object, where a scan has few.
        let prior = libm::log((own + 10.0) / (trust.len() as f64 - own + 0.5));
        let misfits = self.misfits(before);
        let mut surface = vec![(0.0, 0.0); self.arcs.len()];
        let mut nearest = vec![None; self.arcs.len()];
        for (arc, misfits) in self.arc_of.iter().zip(&misfits) {
            surface[*arc].0 += together(misfits);
            surface[*arc].1 += 1.0;
            nearest[*arc] = nearer(nearest[*arc], misfits);
        }
        let evidence = |(index, arc): (usize, &&Arc)| {
            // A curve's points share a fate, so that all together say no more than one.
            let (sum, count) = surface[index];
            Evidence {
                favour: prior + looks.favour(&arc.look) + sum / f64::max(count, 1.0),
                misfit: nearest[index],
            }
        };
        self.arcs.iter().enumerate().map(evidence).collect()
    }

    /// How each sample agrees with the surface that the other views make.
    fn misfits(&self, before: &[Evidence]) -> Vec<Vec<Misfit>> {
        let place = |sample: usize| {
            let trust = before[self.arc_of[sample]].probability();
            self.samples[sample].place.trusted(trust)
        };
        let of_sample = |(sample, around): (&Sample, &Vec<usize>)| {
            Some(Forecasts::of(
                &sample.beam,
                around.iter().map(|other| place(*other)),
            ))
        };
        let samples = self.samples.iter().zip(&self.around);
        let forecasts: Vec<Option<Forecasts>> = samples.map(of_sample).collect();
        let trusted =
            |(sample, arc): (&Sample, &usize)| (!is_ghost(&before[*arc])).then_some(sample.place);
        let trusted: Vec<Option<Place>> =
            self.samples.iter().zip(&self.arc_of).map(trusted).collect();
        let curvature = usual_curvature(&forecasts, &trusted, VAGUEST);
        let hold = |(forecasts, sample): (&Option<Forecasts>, &Sample)| {
            let hold = |forecasts: &Forecasts| forecasts.hold(&sample.place, curvature, VAGUEST);
            forecasts.as_ref().map_or_else(Vec::new, hold)
        };
        forecasts.iter().zip(&self.samples).map(hold).collect()
    }
}

/// The best agreement of all.
fn nearer(so_far: Option<Misfit>, more: &[Misfit]) -> Option<Misfit> {
    so_far
        .into_iter()
        .chain(more.iter().copied())
        .max_by(|a, b| a.favour().total_cmp(&b.favour()))
}
