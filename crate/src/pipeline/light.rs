//! The light of a view, for those who draw it.

use super::Reconstruction;
use crate::geometry::{Point, World};
use crate::object::{laser_ray, line_of_sight};

/// How the light of a view runs, bent at every face.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPaths {
    /// From the laser to where the beam comes closest to the line of sight.
    pub beam: Vec<Point<World>>,
    /// From the camera to where the line of sight comes closest to the beam.
    pub sight: Vec<Point<World>>,
}

impl Reconstruction<'_> {
    /// The two light paths that make an object point of a view; of a line's points the middle one.
    /// `None` if the view has none.
    pub fn light_paths(&self, view: usize) -> Option<LightPaths> {
        let points = &self.object[view].points;
        let object = points.get(points.len() / 2)?;
        let station = &self.stations[view];
        let pose = &station.world_from_camera;
        let pixel = self.spots[view].spots[object.spot].pixel();
        let stack = self.vessel.wall.stack(&self.media, station.inside).ok()?;
        let rig = &self.scan.rig;
        let beam = stack
            .path(&laser_ray(rig, pose, &stack, pixel).ok()?)
            .ok()?;
        let sight = stack.path(&line_of_sight(rig, pose, pixel).ok()?).ok()?;
        let approach = &object.meeting.approach;
        Some(LightPaths {
            beam: [beam.vertices, vec![approach.first]].concat(),
            sight: [sight.vertices, vec![approach.second]].concat(),
        })
    }
}
