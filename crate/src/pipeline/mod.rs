//! The stages in order. Each view's spots are found by themselves, so the caller may spread the views
//! over threads or workers; vessel and object follow from all views together.
//!
//! ```no_run
//! use std::{fs::File, io::BufReader};
//! use snellius::pipeline::{Settings, observe, reconstruct};
//! use snellius::scan::Archive;
//!
//! let mut archive = Archive::open(BufReader::new(File::open("scan.zip")?))?;
//! let settings = Settings::default();
//! let views = archive.scan().stations.len();
//! let spots = (0..views).map(|view| observe(&mut archive, view, &settings)).collect::<Result<Vec<_>, _>>()?;
//! let reconstruction = reconstruct(archive.scan(), &spots, &settings)?;
//! println!("{}", reconstruction.result().to_json());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod correction;
mod index;
mod light;
mod parameters;
mod report;
mod stage;
mod summary;
mod warnings;

pub use correction::{Correction, correct};
pub use index::{InsideIndex, study_index};
pub use light::LightPaths;
pub use parameters::{NumberParameter, PARAMETERS, Parameter, ParameterKind, parameters_page};
pub use stage::{Stage, Warning};
pub use summary::Summary;

use std::io::{Read, Seek};

use serde::{Deserialize, Serialize};

use crate::camera::Pixel;
use crate::geometry::{Point, World};
use crate::index::{IndexError, IndexMethod, IndexRange, IndexStudy, Verdict};
use crate::object::{
    Choice, CommonSigma, ObjectSettings, Setup, calibration_sigmas, find_object, index_sigmas,
    meet_unrefracted, propose_media, settle_wall,
};
use crate::optics::Media;
use crate::rig::Laser;
use crate::scan::{Archive, InsideMedium, Scan, ScanError, Station};
use crate::spots::{SpotSettings, Spots, find_line, find_spots};
use crate::vessel::{VesselError, VesselFit, VesselSettings};
use index::Measured;

/// How a scan is measured. The defaults are right for most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Settings {
    /// How spots are found.
    pub spots: SpotSettings,
    /// How the wall is found.
    pub vessel: VesselSettings,
    /// How object points are chosen.
    pub object: ObjectSettings,
    /// The liquid's refractive index, in place of the manifest's.
    pub index: Option<f64>,
    /// Whether views are measured in the medium that the scan itself proposes, where that is not the
    /// manifest's.
    pub accept_media: bool,
    /// How the liquid's refractive index is estimated, in place of taking the manifest's.
    pub index_method: Option<IndexMethod>,
    /// Where an unknown index is looked for.
    pub index_range: IndexRange,
}

/// Why a scan gives no reconstruction.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// The archive is at fault.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// There is no wall.
    #[error(transparent)]
    Vessel(#[from] VesselError),
    /// The index cannot even be tried for.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// The index that was asked for cannot be one.
    #[error("{0} is no refractive index of a liquid; these lie between 1 and 4")]
    IndexImpossible(f64),
    /// No view has any spot.
    #[error(
        "no laser spot in any of the {views} views; check that the laser was on in the \"on\" pictures \
         and that on and off are not exchanged"
    )]
    NoSpots {
        /// How many views there are.
        views: usize,
    },
}

/// A measured scan.
#[derive(Clone, Debug)]
pub struct Reconstruction<'a> {
    /// What was measured.
    pub scan: &'a Scan,
    /// Each view's spots.
    pub spots: &'a [Spots],
    /// The wall.
    pub vessel: VesselFit,
    /// The media that were used. Where the index is not determined, the liquid's is only where the search
    /// for it started.
    pub media: Media,
    /// The scan's stations; where media were accepted, with those.
    pub stations: Vec<Station>,
    /// What each view's beam seems to enter, where that is not what the manifest says.
    pub inside_proposed: Vec<Option<InsideMedium>>,
    /// The liquid's index, and what it is worth.
    pub index: InsideIndex,
    /// What all methods say of it, where it was estimated.
    pub index_study: Option<IndexStudy>,
    /// Each view's object points.
    pub object: Vec<Choice>,
    /// What an error of calibration and index would do to each of them.
    pub common_sigmas: Vec<Vec<CommonSigma>>,
    /// Where each of them would come to lie if refraction were ignored (Fig. 11 b).
    pub unrefracted: Vec<Vec<Option<Point<World>>>>,
}

impl Reconstruction<'_> {
    /// What stood between the spots and the object's points.
    pub fn setup(&self) -> Setup<'_> {
        Setup {
            rig: &self.scan.rig,
            calibration_sigma: &self.scan.calibration_sigma,
            stations: &self.stations,
            vessel: &self.vessel,
            media: self.media,
        }
    }
}

/// Reads a view's pictures and finds its spots, or the points of its line.
pub fn observe<R: Read + Seek>(
    archive: &mut Archive<R>,
    view: usize,
    settings: &Settings,
) -> Result<Spots, ScanError> {
    let pictures = archive.pictures(view)?;
    Ok(match &archive.scan().rig.laser {
        Laser::Beam(_) => find_spots(&pictures, &settings.spots),
        Laser::Sheet(sheet) => find_line(&pictures, sheet.profiles(), &settings.spots),
    })
}

/// Measures vessel and object from the spots of all views, which stand in the manifest's order.
pub fn reconstruct<'a>(
    scan: &'a Scan,
    spots: &'a [Spots],
    settings: &Settings,
) -> Result<Reconstruction<'a>, PipelineError> {
    if spots.iter().all(|view| view.spots.is_empty()) {
        return Err(PipelineError::NoSpots { views: spots.len() });
    }
    let wanted = index::wanted(scan, settings)?;
    let Measured {
        mut vessel,
        media,
        mut object,
        index,
        study,
    } = index::measure(scan, spots, settings, wanted)?;
    let as_said = setup(scan, &scan.stations, &vessel, media);
    // An index that was estimated with views in the wrong medium is no ground to judge them by.
    let inside_proposed = match index.verdict {
        Verdict::Given => propose_media(&as_said, spots, &object, &settings.object),
        _ => vec![None; scan.stations.len()],
    };
    let mut stations = scan.stations.clone();
    if settings.accept_media && inside_proposed.iter().any(Option::is_some) {
        for (station, proposed) in stations.iter_mut().zip(&inside_proposed) {
            station.inside = proposed.unwrap_or(station.inside);
        }
        let as_proposed = setup(scan, &stations, &vessel, media);
        object = find_object(&as_proposed, spots, &settings.object);
    }
    // The ray distances tell of the wall only now: the index was sought with the same ones.
    if let Some(settled) = settle_wall(&setup(scan, &stations, &vessel, media), spots, &object) {
        vessel = settled;
        let settled = setup(scan, &stations, &vessel, media);
        object = find_object(&settled, spots, &settings.object);
    }
    let measured = setup(scan, &stations, &vessel, media);
    let common_sigmas = common_sigmas(&measured, spots, &object, index.sigma);
    let unrefracted = unrefracted(scan, spots, &object);
    Ok(Reconstruction {
        scan,
        spots,
        vessel,
        media,
        stations,
        inside_proposed,
        index,
        index_study: study,
        object,
        common_sigmas,
        unrefracted,
    })
}

fn setup<'a>(
    scan: &'a Scan,
    stations: &'a [Station],
    vessel: &'a VesselFit,
    media: Media,
) -> Setup<'a> {
    Setup {
        rig: &scan.rig,
        calibration_sigma: &scan.calibration_sigma,
        stations,
        vessel,
        media,
    }
}

/// What errors of calibration and of the index would do to each view's points.
fn common_sigmas(
    setup: &Setup,
    spots: &[Spots],
    object: &[Choice],
    index_sigma: Option<f64>,
) -> Vec<Vec<CommonSigma>> {
    // It hardly changes from one point of a line to the next.
    let shared_by = match setup.rig.laser {
        Laser::Beam(_) => 1,
        Laser::Sheet(_) => 8,
    };
    let some = |(choice, view)| {
        let pixels = pixels(choice, view).into_iter();
        pixels.step_by(shared_by).collect()
    };
    let pixels: Vec<_> = object.iter().zip(spots).map(some).collect();
    let mut sigmas = calibration_sigmas(setup, &pixels);
    if let Some(index_sigma) = index_sigma {
        let index = index_sigmas(setup, &pixels, index_sigma);
        for (sigma, index) in sigmas.iter_mut().flatten().zip(index.iter().flatten()) {
            *sigma = sigma.and(index);
        }
    }
    let all = |(choice, sigmas): (&Choice, &Vec<CommonSigma>)| {
        let points = 0..choice.points.len();
        points.map(|point| sigmas[point / shared_by]).collect()
    };
    object.iter().zip(&sigmas).map(all).collect()
}

fn unrefracted(scan: &Scan, spots: &[Spots], object: &[Choice]) -> Vec<Vec<Option<Point<World>>>> {
    let views = object.iter().zip(spots).zip(&scan.stations);
    let of_view = |((choice, view), station): ((&Choice, &Spots), &Station)| {
        let straight = |pixel| meet_unrefracted(&scan.rig, &station.world_from_camera, pixel);
        let points = pixels(choice, view).into_iter();
        points
            .map(|pixel| straight(pixel).ok().map(|m| m.point()))
            .collect()
    };
    views.map(of_view).collect()
}

/// Where the object points of a view are seen.
fn pixels(choice: &Choice, spots: &Spots) -> Vec<Pixel> {
    let points = choice.points.iter();
    points.map(|p| spots.spots[p.spot].pixel()).collect()
}
