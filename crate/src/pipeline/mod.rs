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

mod index;
mod light;
mod parameters;
mod report;
mod stage;
mod summary;
mod warnings;

pub use index::{InsideIndex, study_index};
pub use light::LightPaths;
pub use parameters::{NumberParameter, PARAMETERS, Parameter, ParameterKind, parameters_page};
pub use stage::{Stage, Warning};
pub use summary::Summary;

use std::io::{Read, Seek};

use serde::{Deserialize, Serialize};

use crate::camera::Pixel;
use crate::geometry::{Point, World};
use crate::index::{IndexError, IndexMethod, IndexRange, IndexStudy};
use crate::object::{
    Choice, CommonSigma, ObjectSettings, Setup, calibration_sigmas, index_sigmas, meet_unrefracted,
};
use crate::optics::Media;
use crate::scan::{Archive, Scan, ScanError, Station};
use crate::spots::{SpotSettings, Spots, find_spots};
use crate::vessel::{VesselError, VesselFit, VesselSettings};
use index::Measured;

/// How a scan is measured. The defaults are right for most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
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
            stations: &self.scan.stations,
            vessel: &self.vessel,
            media: self.media,
        }
    }
}

/// Reads a view's pictures and finds its spots.
pub fn observe<R: Read + Seek>(
    archive: &mut Archive<R>,
    view: usize,
    settings: &Settings,
) -> Result<Spots, ScanError> {
    Ok(find_spots(&archive.pictures(view)?, &settings.spots))
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
        vessel,
        media,
        object,
        index,
        study,
    } = index::measure(scan, spots, settings, wanted)?;
    let setup = Setup {
        rig: &scan.rig,
        calibration_sigma: &scan.calibration_sigma,
        stations: &scan.stations,
        vessel: &vessel,
        media,
    };
    let common_sigmas = common_sigmas(&setup, spots, &object, index.sigma);
    let unrefracted = unrefracted(scan, spots, &object);
    Ok(Reconstruction {
        scan,
        spots,
        vessel,
        media,
        index,
        index_study: study,
        object,
        common_sigmas,
        unrefracted,
    })
}

/// What errors of calibration and of the index would do to each view's points.
fn common_sigmas(
    setup: &Setup,
    spots: &[Spots],
    object: &[Choice],
    index_sigma: Option<f64>,
) -> Vec<Vec<CommonSigma>> {
    let views = object.iter().zip(spots);
    let pixels: Vec<_> = views.map(|(choice, view)| pixels(choice, view)).collect();
    let mut sigmas = calibration_sigmas(setup, &pixels);
    if let Some(index_sigma) = index_sigma {
        let index = index_sigmas(setup, &pixels, index_sigma);
        for (sigma, index) in sigmas.iter_mut().flatten().zip(index.iter().flatten()) {
            *sigma = sigma.and(index);
        }
    }
    sigmas
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
