use serde::{Deserialize, Serialize};

use super::{Ghost, Simulation, ghosts};
use crate::camera::Pixel;
use crate::export::OneOrMany;
use crate::geometry::{Camera, Point, Ray, World};
use crate::rig::{Laser, Sheet};

/// What is true of a simulated scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// The scene's name.
    pub scenario: String,
    /// Refractive indices: outside, wall, inside.
    pub n: [f64; 3],
    /// The views.
    pub views: Vec<TruthView>,
}

/// What is true of a view: of a spot laser one value, or `null` where there is no such spot; of a line
/// laser lists along its line, in which places and pixels go together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthView {
    /// Its id.
    pub id: String,
    /// Where the beam meets the wall's outer face, world frame, mm.
    pub vessel: OneOrMany<[f64; 3]>,
    /// Where it lands on the object.
    pub object: OneOrMany<[f64; 3]>,
    /// Where the outer face's spot is seen, px.
    pub vessel_pixel: OneOrMany<[f64; 2]>,
    /// Where the object's spot is seen, px.
    pub object_pixel: OneOrMany<[f64; 2]>,
    /// Where the beam lands on the vessel's back, having passed the object: no point of the object.
    #[serde(default)]
    pub back: Option<[f64; 3]>,
    /// Where that spot is seen, px.
    #[serde(default)]
    pub back_pixel: Option<[f64; 2]>,
    /// The false spots.
    #[serde(default)]
    pub ghosts: Vec<Ghost>,
}

impl Truth {
    /// The truth as a JSON file.
    pub fn to_json(&self) -> String {
        let mut json =
            serde_json::to_string_pretty(self).expect("strings and numbers alone always serialise");
        json.push('\n');
        json
    }
}

pub(super) fn of(simulation: &Simulation) -> Truth {
    let media = &simulation.media;
    Truth {
        scenario: simulation.scene.name.clone(),
        n: [media.outside, media.wall, media.liquid],
        views: (0..simulation.views())
            .map(|view| view_truth(simulation, view))
            .collect(),
    }
}

fn view_truth(simulation: &Simulation, view: usize) -> TruthView {
    match &simulation.scan.rig.laser {
        Laser::Beam(beam) => beam_truth(simulation, view, beam),
        Laser::Sheet(sheet) => sheet_truth(simulation, view, sheet),
    }
}

fn beam_truth(simulation: &Simulation, view: usize, beam: &Ray<Camera>) -> TruthView {
    let landing = simulation.landing(view, beam);
    let false_light = ghosts::of(simulation, view);
    let back_shows = simulation.scene.brightness.back > 0.0;
    let behind = simulation.faces();
    let vessel = seen(simulation, view, landing.faces.first().copied(), 0);
    let object = landing.object.filter(|_| !false_light.object_hidden);
    let object = seen(simulation, view, object, behind);
    let back = seen(
        simulation,
        view,
        landing.back.filter(|_| back_shows),
        behind,
    );
    TruthView {
        id: simulation.manifest().views[view].id.clone(),
        vessel: OneOrMany::One(vessel.map(|(place, _)| place)),
        object: OneOrMany::One(object.map(|(place, _)| place)),
        vessel_pixel: OneOrMany::One(vessel.map(|(_, pixel)| pixel)),
        object_pixel: OneOrMany::One(object.map(|(_, pixel)| pixel)),
        back: back.map(|(place, _)| place),
        back_pixel: back.map(|(_, pixel)| pixel),
        ghosts: false_light.spots(simulation),
    }
}

fn sheet_truth(simulation: &Simulation, view: usize, sheet: &Sheet) -> TruthView {
    let fan = simulation
        .scene
        .beam
        .fan(sheet, &simulation.scan.rig.camera);
    let middles = fan.iter().map(|rays| &rays[rays.len() / 2].0);
    let false_light = ghosts::of(simulation, view);
    let shown = |place: Option<Point<World>>| place.filter(|_| !false_light.object_hidden);
    let landings: Vec<_> = middles.map(|ray| simulation.landing(view, ray)).collect();
    let vessel = landings
        .iter()
        .map(|l| seen(simulation, view, l.outer(), 0));
    let object = landings
        .iter()
        .map(|l| seen(simulation, view, shown(l.object), simulation.faces()));
    let (vessel, vessel_pixel) = vessel.flatten().unzip();
    let (object, object_pixel) = object.flatten().unzip();
    TruthView {
        id: simulation.manifest().views[view].id.clone(),
        vessel: OneOrMany::Many(vessel),
        object: OneOrMany::Many(object),
        vessel_pixel: OneOrMany::Many(vessel_pixel),
        object_pixel: OneOrMany::Many(object_pixel),
        back: None,
        back_pixel: None,
        ghosts: false_light.spots(simulation),
    }
}

/// A place behind the first `faces` faces, and the pixel that shows it.
fn seen(
    simulation: &Simulation,
    view: usize,
    point: Option<Point<World>>,
    faces: usize,
) -> Option<([f64; 3], [f64; 2])> {
    let Pixel { u, v } = simulation.seen(view, point?, faces)?;
    let pixel = [u, v];
    simulation
        .in_picture(pixel)
        .then_some((point?.to_array(), pixel))
}
