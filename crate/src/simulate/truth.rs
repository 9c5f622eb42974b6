use serde::{Deserialize, Serialize};

use super::{Ghost, Simulation, ghosts};
use crate::camera::Pixel;
use crate::geometry::Point;

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

/// What is true of a view; `null` where there is no such spot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthView {
    /// Its id.
    pub id: String,
    /// Where the beam meets the wall's outer face, world frame, mm.
    pub vessel: Option<[f64; 3]>,
    /// Where it lands on the object.
    pub object: Option<[f64; 3]>,
    /// Where the outer face's spot is seen, px.
    pub vessel_pixel: Option<[f64; 2]>,
    /// Where the object's spot is seen, px.
    pub object_pixel: Option<[f64; 2]>,
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
    let landing = simulation.landing(view, &simulation.scan.rig.laser.axis());
    let false_light = ghosts::of(simulation, view);
    let pixel = |point, faces| {
        let Pixel { u, v } = simulation.seen(view, point, faces)?;
        simulation.in_picture([u, v]).then_some([u, v])
    };
    let back_shows = simulation.scene.brightness.back > 0.0;
    let vessel_pixel = landing.outer.and_then(|point| pixel(point, 0));
    let object = landing.object.filter(|_| !false_light.object_hidden);
    let object_pixel = object.and_then(|point| pixel(point, 2));
    let back = landing.back.filter(|_| back_shows);
    let back_pixel = back.and_then(|point| pixel(point, 2));
    TruthView {
        id: simulation.manifest().views[view].id.clone(),
        vessel: vessel_pixel.and(landing.outer).map(Point::to_array),
        object: object_pixel.and(object).map(Point::to_array),
        vessel_pixel,
        object_pixel,
        back: back_pixel.and(back).map(Point::to_array),
        back_pixel,
        ghosts: false_light.spots,
    }
}
