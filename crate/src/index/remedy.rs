//! What would let a scan tell the index, found by simulating it.

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::model::{Hypothesis, Model, State};
use super::sights::{ObjectSight, Sights, VesselSight};
use crate::camera::Pixel;
use crate::geometry::{Camera, Point, Pose, World};
use crate::object::{Setup, laser_ray, line_of_sight};
use crate::optics::aim_through;
use crate::scan::Station;

/// A way of scanning that would do better.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Remedy {
    /// How the rig is turned.
    pub turn: Turn,
    /// By how much, degrees.
    pub degrees: f64,
    /// The standard deviation of the index that the same number of views would then give.
    pub sigma: f64,
}

/// A way of turning the rig, about the place it looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Turn {
    /// All views, about the baseline from camera to laser.
    Pitch,
    /// Every other sweep (or view) about the baseline one way, the rest the other way.
    PitchBothWays,
    /// Every other sweep (or view) one way across the baseline, the rest the other way.
    YawBothWays,
}

impl std::fmt::Display for Remedy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            turn,
            degrees,
            sigma,
        } = self;
        match turn {
            Turn::Pitch => write!(f, "pitch the rig {degrees:.0} degrees about its baseline"),
            Turn::PitchBothWays => write!(
                f,
                "pitch the rig {degrees:.0} degrees about its baseline for half of the views, and as much \
                 the other way for the rest"
            ),
            Turn::YawBothWays => write!(
                f,
                "turn the rig {degrees:.0} degrees to the left for half of the views, and as much to the \
                 right for the rest"
            ),
        }?;
        write!(f, ": +-{sigma:.3}")
    }
}

impl Model<'_> {
    /// The least turn of the rig that would determine the index; if none would, the one that comes
    /// nearest.
    pub(super) fn remedy(&self, state: &State, enough: f64) -> Option<Remedy> {
        let turns = if self.parts.faces {
            vec![Turn::PitchBothWays, Turn::YawBothWays]
        } else {
            vec![Turn::Pitch]
        };
        let mut best: Option<Remedy> = None;
        for degrees in [10.0, 20.0, 30.0] {
            for turn in &turns {
                let Some(sigma) = self.sigma_if_turned(state, *turn, degrees) else {
                    continue;
                };
                if best.is_none_or(|best| sigma < best.sigma) {
                    best = Some(Remedy {
                        turn: *turn,
                        degrees,
                        sigma,
                    });
                }
            }
            if best.is_some_and(|best| best.sigma <= enough) {
                break;
            }
        }
        best
    }

    /// The Cramer-Rao bound of the index, were each view taken with the rig turned about the object point
    /// that it sees.
    fn sigma_if_turned(&self, state: &State, turn: Turn, degrees: f64) -> Option<f64> {
        let here = Hypothesis::new(self, state.clone())?;
        let mut stations = self.setup.stations.to_vec();
        let mut sights = Sights {
            vessel: Vec::new(),
            object: Vec::new(),
            sweep_of: self.sights.sweep_of.clone(),
        };
        let mut faces = state.faces.clone();
        faces.iter_mut().for_each(|face| face.members.clear());
        for (index, sight) in self.sights.object.iter().enumerate() {
            let face = state.faces.iter().position(|f| f.members.contains(&index));
            let Some((station, vessel, object)) = self.turned(&here, sight, face, turn, degrees)
            else {
                continue;
            };
            if let Some(face) = face {
                faces[face].members.push(sights.object.len());
            }
            stations[sight.view] = station;
            sights.vessel.push(vessel);
            sights.object.push(object);
        }
        let setup = Setup {
            stations: &stations,
            ..*self.setup
        };
        let mut model = Model::clone(self);
        model.setup = &setup;
        model.sights = &sights;
        // Half as many sights are no longer the same scan.
        if 2 * sights.object.len() < self.sights.object.len() {
            return None;
        }
        let mut state = state.clone();
        state.faces = faces;
        model.floor(&state)
    }

    /// A view's station, vessel spot and object spot after a turn.
    fn turned(
        &self,
        here: &Hypothesis,
        sight: &ObjectSight,
        face: Option<usize>,
        turn: Turn,
        degrees: f64,
    ) -> Option<(Station, VesselSight, ObjectSight)> {
        let rig = &here.state.rig;
        let station = self.setup.stations[sight.view];
        let pose = rig.station(&station.world_from_flange);
        let meeting = self.meeting(here, sight, sight.pixel)?;
        let pivot = meeting.point();
        let light = laser_ray(rig, &pose, &here.stack, sight.pixel).ok()?;
        let light = pose.inverse().ray(&light);
        let baseline = pose.rotation() * rig.laser.origin().coords;
        let sight_line = line_of_sight(rig, &pose, sight.pixel).ok()?;
        let upright = sight_line.direction.vector().cross(&baseline);
        let other = self.sights.sweep_of.iter().max().copied().unwrap_or(0) == 0;
        let group = if other {
            sight.view
        } else {
            self.sights.sweep_of[sight.view]
        };
        let sign = if group % 2 == 0 { 1.0 } else { -1.0 };
        let (axis, angle) = match turn {
            Turn::Pitch => (baseline, degrees),
            Turn::PitchBothWays => (baseline, sign * degrees),
            Turn::YawBothWays => (upright, sign * degrees),
        };
        let rotation = axis.try_normalize(0.0)? * angle.to_radians();
        let pose = turned_about(&pose, pivot, rotation);
        let station = Station {
            world_from_flange: pose * rig.flange_from_camera.inverse(),
            world_from_camera: pose,
            ..station
        };
        // Where the turned beam lands.
        let path = here.stack.path(&pose.ray(&light)).ok()?;
        let along = match face {
            Some(face) => here.state.faces[face].surface.hit(&path.last)?.distance,
            None => meeting.approach.along_first,
        };
        let seen = |point: Point<World>, faces: usize| -> Option<Pixel> {
            let mut stack = here.stack.clone();
            stack.interfaces.truncate(faces);
            let eye = pose.point(Point::origin());
            let aim = aim_through(&stack, eye, point).ok()?;
            let ahead = pose.inverse().direction(aim);
            rig.camera.project(Point::from_coords(ahead.vector()))
        };
        let vessel = self.sights.vessel.iter().find(|v| v.view == sight.view)?;
        let vessel = VesselSight {
            pixel: seen(path.vertices[1], 0)?,
            ..*vessel
        };
        let object = ObjectSight {
            pixel: seen(path.last.at(along), here.stack.interfaces.len())?,
            ..*sight
        };
        Some((station, vessel, object))
    }
}

fn turned_about(
    pose: &Pose<World, Camera>,
    pivot: Point<World>,
    rotation: Vector3<f64>,
) -> Pose<World, Camera> {
    let turn = UnitQuaternion::from_scaled_axis(rotation);
    let from_pivot = pose.translation() - pivot.coords;
    Pose::from_parts(turn * pose.rotation(), pivot.coords + turn * from_pivot)
}
