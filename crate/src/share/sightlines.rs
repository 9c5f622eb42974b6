//! A reconstruction measured again with another index, without its pictures.

use super::document::{Document, DocumentError};
use crate::camera::Pixel;
use crate::export::{InsideResult, OneOrMany, ReconstructionResult, SpotRole, Status, ViewResult};
use crate::index::{IndexMethod, Verdict};
use crate::object::{Meeting, laser_ray, line_of_sight, meet};
use crate::optics::{Media, Stack};
use crate::pipeline::LightPaths;
use crate::rig::Rig;
use crate::scan::{InsideMedium, Station};
use crate::vessel::{FarWall, Wall};

/// The light of a reconstruction's object points: where the spots were seen, and what their light crosses.
/// With it the points follow the liquid's index.
///
/// Which spot is the object's stays as it was found, and so do the standard deviations, which change with the
/// index far less than the points do.
#[derive(Clone, Debug)]
pub struct Sightlines {
    rig: Rig,
    stations: Vec<Station>,
    wall: Wall,
    media: Media,
    /// Each view's object spots, in the order of its points.
    pixels: Vec<Vec<Pixel>>,
}

impl Sightlines {
    /// The light of a document's points; `None` if the document has no manifest.
    pub fn of(document: &Document) -> Result<Option<Self>, DocumentError> {
        let Some(scan) = document.checked_scan()? else {
            return Ok(None);
        };
        let result = &document.result;
        let outer = result
            .vessel
            .surface()
            .ok_or_else(|| DocumentError::format("result.vessel", "these numbers are no wall's"))?;
        let far = scan.manifest.vessel.far_wall.as_ref().map(|far| FarWall {
            distance: far.distance,
            thickness: far.thickness,
        });
        let mut stations = scan.stations;
        for (station, view) in stations.iter_mut().zip(&result.views) {
            station.inside = view.inside.unwrap_or(station.inside);
        }
        let pixels = result.views.iter().enumerate();
        let pixels = pixels.map(|(index, view)| object_pixels(index, view));
        Ok(Some(Self {
            rig: scan.rig,
            stations,
            wall: Wall::exact(outer, result.vessel.wall_thickness, far),
            media: Media {
                outside: result.media.outside,
                wall: result.media.wall,
                // Where the index is not known, any serves until one is chosen.
                liquid: result.media.inside.value.unwrap_or(result.media.outside),
            },
            pixels: pixels.collect::<Result<_, _>>()?,
        }))
    }

    /// The result as it would be with this index of the liquid. A point whose light does not get through is
    /// none.
    pub fn result_at(&self, measured: &ReconstructionResult, index: f64) -> ReconstructionResult {
        if measured.media.inside.value == Some(index) {
            return measured.clone();
        }
        let mut result = measured.clone();
        result.media.inside = InsideResult {
            value: Some(index),
            sigma: None,
            method: IndexMethod::Given,
            verdict: Verdict::Given,
            interval: None,
            reason: None,
        };
        for (number, view) in result.views.iter_mut().enumerate() {
            self.move_points(number, view, index);
        }
        result
    }

    /// The mean ray distance over all points in the liquid, mm, for each of some indices (eq. (3)); `None`
    /// where the light of one of them does not get through.
    pub fn mean_ray_distances(&self, indices: &[f64]) -> Vec<Option<f64>> {
        let mean = |index: &f64| {
            let in_liquid = (0..self.stations.len())
                .filter(|view| self.stations[*view].inside == InsideMedium::Liquid);
            let gaps: Option<Vec<f64>> = in_liquid
                .flat_map(|view| self.meetings(view, *index))
                .map(|meeting| Some(meeting?.gap().abs()))
                .collect();
            let gaps = gaps.filter(|gaps| !gaps.is_empty())?;
            Some(gaps.iter().sum::<f64>() / gaps.len() as f64)
        };
        indices.iter().map(mean).collect()
    }

    /// The two light paths that make a point of a view; `None` where they do not get through.
    pub fn light(&self, view: usize, point: usize, index: f64) -> Option<LightPaths> {
        let pixel = *self.pixels.get(view)?.get(point)?;
        let stack = self.stack(view, index)?;
        let pose = &self.stations[view].world_from_camera;
        let approach = meet(&self.rig, pose, &stack, pixel).ok()?.approach;
        let beam = laser_ray(&self.rig, pose, &stack, pixel).ok()?;
        let sight = line_of_sight(&self.rig, pose, pixel).ok()?;
        let vertices = |ray| Some(stack.path(&ray).ok()?.vertices);
        Some(LightPaths {
            beam: [vertices(beam)?, vec![approach.first]].concat(),
            sight: [vertices(sight)?, vec![approach.second]].concat(),
        })
    }

    fn stack(&self, view: usize, index: f64) -> Option<Stack> {
        let media = Media {
            liquid: index,
            ..self.media
        };
        self.wall.stack(&media, self.stations[view].inside).ok()
    }

    fn meetings(&self, view: usize, index: f64) -> Vec<Option<Meeting>> {
        let stack = self.stack(view, index);
        let pose = &self.stations[view].world_from_camera;
        let behind_wall = |pixel: &Pixel| {
            let meeting = meet(&self.rig, pose, stack.as_ref()?, *pixel).ok()?;
            (meeting.depth() >= 0.0).then_some(meeting)
        };
        self.pixels[view].iter().map(behind_wall).collect()
    }

    fn move_points(&self, number: usize, view: &mut ViewResult, index: f64) {
        let meetings = self.meetings(number, index);
        if meetings.is_empty() || self.stations[number].inside == InsideMedium::Air {
            return;
        }
        let there: Vec<bool> = meetings.iter().map(Option::is_some).collect();
        let met = || meetings.iter().flatten();
        refill(&mut view.object, met().map(|m| m.point().to_array()));
        refill(&mut view.ray_distance, met().map(|m| m.gap().abs()));
        keep(&mut view.object_sigma, &there);
        keep(&mut view.object_sigma_calibration, &there);
        keep(&mut view.object_unrefracted, &there);
        if !there.contains(&true) {
            view.status = Status::Rejected;
            view.reason = Some("with this index its light does not get through".to_owned());
        }
    }
}

/// Where a view's object points are seen.
fn object_pixels(index: usize, view: &ViewResult) -> Result<Vec<Pixel>, DocumentError> {
    let pixels: Vec<[f64; 2]> = match &view.line {
        Some(line) => line.object.clone(),
        None => {
            let spots = view.spots.iter();
            let objects = spots.filter(|spot| spot.role == SpotRole::Object);
            objects.map(|spot| spot.pixel).collect()
        }
    };
    let points = view.object.as_slice().len();
    if pixels.len() != points {
        return Err(DocumentError::format(
            format!("result.views[{index}]"),
            format!(
                "{points} object points, and {} places where they are seen",
                pixels.len()
            ),
        ));
    }
    Ok(pixels.into_iter().map(|[u, v]| Pixel::new(u, v)).collect())
}

fn refill<T>(values: &mut OneOrMany<T>, mut with: impl Iterator<Item = T>) {
    *values = match values {
        OneOrMany::One(_) => OneOrMany::One(with.next()),
        OneOrMany::Many(_) => OneOrMany::Many(with.collect()),
    };
}

/// Keeps the values of those points that are still there.
fn keep<T: Copy>(values: &mut OneOrMany<T>, there: &[bool]) {
    let kept: Vec<T> = values
        .iter()
        .zip(there)
        .filter(|(_, there)| **there)
        .map(|(value, _)| *value)
        .collect();
    refill(values, kept.into_iter());
}
