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
mod light;
mod parameters;
mod report;
mod stage;
mod summary;
mod warnings;

pub use correction::{Correction, correct};
pub use light::LightPaths;
pub use parameters::{NumberParameter, PARAMETERS, Parameter, ParameterKind, parameters_page};
pub use stage::{Stage, Warning};
pub use summary::Summary;

use std::io::{Read, Seek};

use serde::{Deserialize, Serialize};

use crate::camera::Pixel;
use crate::geometry::{Point, World};
use crate::object::{
    Choice, CommonSigma, ObjectSettings, Setup, calibration_sigmas, find_object, meet_unrefracted,
};
use crate::optics::Media;
use crate::scan::{Archive, InsideMedium, Scan, ScanError, Station};
use crate::spots::{SpotSettings, Spots, find_spots};
use crate::vessel::{VesselError, VesselFit, VesselSettings, find_vessel};

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
    /// Nobody said what the liquid's index is.
    #[error(
        "media.inside: the liquid's refractive index is not given, and this version does not estimate \
         it; say it (water 1.333, ethanol 1.36, glycerol 1.47)"
    )]
    IndexUnknown,
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
    /// The media that were used.
    pub media: Media,
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
    let media = media(scan, settings)?;
    let vessel = find_vessel(scan, spots, &media, &settings.vessel)?;
    let setup = Setup {
        rig: &scan.rig,
        calibration_sigma: &scan.calibration_sigma,
        stations: &scan.stations,
        vessel: &vessel,
        media,
    };
    let object = find_object(&setup, spots, &settings.object);
    let common_sigmas = common_sigmas(&setup, spots, &object);
    let unrefracted = unrefracted(scan, spots, &object);
    Ok(Reconstruction {
        scan,
        spots,
        vessel,
        media,
        object,
        common_sigmas,
        unrefracted,
    })
}

fn media(scan: &Scan, settings: &Settings) -> Result<Media, PipelineError> {
    let entry = &scan.manifest.media;
    if let Some(impossible) = settings.index.filter(|n| !(1.0..=4.0).contains(n)) {
        return Err(PipelineError::IndexImpossible(impossible));
    }
    let all_in_air = scan.stations.iter().all(|s| s.inside == InsideMedium::Air);
    let liquid = settings
        .index
        .or(entry.inside)
        .or(all_in_air.then_some(entry.outside))
        .ok_or(PipelineError::IndexUnknown)?;
    Ok(Media {
        outside: entry.outside,
        wall: entry.wall,
        liquid,
    })
}

/// The liquid's index is given, so what calibration does is all there is, until an index has a sigma.
fn common_sigmas(setup: &Setup, spots: &[Spots], object: &[Choice]) -> Vec<Vec<CommonSigma>> {
    let views = object.iter().zip(spots);
    let pixels: Vec<_> = views.map(|(choice, view)| pixels(choice, view)).collect();
    calibration_sigmas(setup, &pixels)
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
