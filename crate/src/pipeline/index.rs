//! The liquid's index: given, or estimated from the scan itself.

use super::{PipelineError, Settings, setup};
use crate::index::{IndexEstimate, IndexMethod, IndexStudy, Known, Verdict, study};
use crate::object::{Choice, find_object};
use crate::optics::Media;
use crate::scan::{InsideMedium, Scan};
use crate::spots::Spots;
use crate::vessel::{VesselFit, find_vessel};

/// The liquid's index, and what it is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct InsideIndex {
    /// The index; `None` where the scan cannot tell.
    pub value: Option<f64>,
    /// One standard deviation, where it was estimated.
    pub sigma: Option<f64>,
    /// Within it the index lies 95 times in 100, where it was estimated.
    pub interval: Option<[f64; 2]>,
    /// Where it comes from.
    pub method: IndexMethod,
    /// What it is worth.
    pub verdict: Verdict,
    /// Why it is not determined, and what would determine it.
    pub reason: Option<String>,
}

impl InsideIndex {
    const fn given(value: f64) -> Self {
        Self {
            value: Some(value),
            sigma: None,
            interval: None,
            method: IndexMethod::Given,
            verdict: Verdict::Given,
            reason: None,
        }
    }

    fn estimated(study: &IndexStudy, estimate: &IndexEstimate) -> Self {
        let remedy = study.remedy(estimate.method);
        let reason = estimate.reason.as_ref().map(|reason| match remedy {
            Some(remedy) => format!("{reason}. Remedy: {remedy}"),
            None => reason.clone(),
        });
        Self {
            value: estimate.value,
            sigma: Some(estimate.sigma),
            interval: Some(estimate.interval),
            method: estimate.method,
            verdict: estimate.verdict,
            reason,
        }
    }

    fn not_applicable(method: IndexMethod, reason: String) -> Self {
        Self {
            value: None,
            sigma: None,
            interval: None,
            method,
            verdict: Verdict::NotDetermined,
            reason: Some(reason),
        }
    }
}

/// What is to be used, before the scan is asked.
pub(super) enum Wanted {
    Given(f64),
    Estimated(IndexMethod),
}

pub(super) fn wanted(scan: &Scan, settings: &Settings) -> Result<Wanted, PipelineError> {
    if let Some(impossible) = settings.index.filter(|n| !(1.0..=4.0).contains(n)) {
        return Err(PipelineError::IndexImpossible(impossible));
    }
    let entry = &scan.manifest.media;
    let all_in_air = scan.stations.iter().all(|s| s.inside == InsideMedium::Air);
    let estimated = settings.index_method.map(Wanted::Estimated);
    let given = settings.index.map(Wanted::Given).or(estimated);
    let in_manifest = entry.inside.or(all_in_air.then_some(entry.outside));
    Ok(given
        .or(in_manifest.map(Wanted::Given))
        .unwrap_or(Wanted::Estimated(IndexMethod::Joint)))
}

/// Wall and object for the index that is wanted.
pub(super) struct Measured {
    pub(super) vessel: VesselFit,
    pub(super) media: Media,
    pub(super) object: Vec<Choice>,
    pub(super) index: InsideIndex,
    pub(super) study: Option<IndexStudy>,
}

/// Liquids have about this one: where the search for an unknown index starts.
const USUAL: f64 = 1.37;

pub(super) fn measure(
    scan: &Scan,
    spots: &[Spots],
    settings: &Settings,
    wanted: Wanted,
) -> Result<Measured, PipelineError> {
    let entry = &scan.manifest.media;
    let mut media = Media {
        outside: entry.outside,
        wall: entry.wall,
        liquid: match wanted {
            Wanted::Given(value) => value,
            Wanted::Estimated(_) => USUAL,
        },
    };
    let vessel = find_vessel(scan, spots, &media, &settings.vessel)?;
    let through = |media: Media| setup(scan, &scan.stations, &vessel, media);
    let find = |media: Media| find_object(&through(media), spots, &settings.object);
    let mut object = find(media);
    let method = match wanted {
        Wanted::Given(value) => {
            return Ok(Measured {
                index: InsideIndex::given(value),
                vessel,
                media,
                object,
                study: None,
            });
        }
        Wanted::Estimated(method) => method,
    };
    let known = Known::of(&scan.manifest)?;
    let range = settings.index_range;
    let look =
        |media: Media, object: &[Choice]| study(&through(media), spots, object, &known, &range);
    let mut found = look(media, &object)?;
    // Which spots are the object's depends a little on the index.
    if let Some(value) = found.best().and_then(|best| best.value) {
        media.liquid = value;
        object = find(media);
        found = look(media, &object)?;
    }
    let index = inside_index(&found, method)?;
    match index.value {
        Some(value) => {
            media.liquid = value;
            object = find(media);
        }
        None => without_index(scan, &mut object),
    }
    Ok(Measured {
        vessel,
        media,
        object,
        index,
        study: Some(found),
    })
}

fn inside_index(study: &IndexStudy, method: IndexMethod) -> Result<InsideIndex, PipelineError> {
    if let Some(estimate) = study.estimate(method) {
        return Ok(InsideIndex::estimated(study, estimate));
    }
    let why = study.not_applicable.iter().find(|(m, _)| *m == method);
    let why = why.map_or_else(|| "it was not tried".to_owned(), |(_, why)| why.clone());
    Ok(InsideIndex::not_applicable(method, why))
}

/// Without an index there are no object points, but where the beam stays in air.
fn without_index(scan: &Scan, object: &mut [Choice]) {
    for (choice, station) in object.iter_mut().zip(&scan.stations) {
        if station.inside == InsideMedium::Liquid {
            choice.points.clear();
        }
    }
}

/// As [`measure`], for the sake of the study alone.
pub fn study_index(
    scan: &Scan,
    spots: &[Spots],
    settings: &Settings,
) -> Result<IndexStudy, PipelineError> {
    let wanted = Wanted::Estimated(IndexMethod::Joint);
    let measured = measure(scan, spots, settings, wanted)?;
    measured
        .study
        .ok_or(PipelineError::Index(crate::index::IndexError::NoSights))
}
