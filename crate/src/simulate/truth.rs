use serde::{Deserialize, Serialize};

use super::Simulation;
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
    let camera = &simulation.scan.rig.camera;
    let pixel = |point, faces| {
        let pixel = simulation.seen(view, point, faces)?;
        let inside = pixel.u >= 0.0
            && pixel.v >= 0.0
            && pixel.u <= f64::from(camera.width - 1)
            && pixel.v <= f64::from(camera.height - 1);
        inside.then_some([pixel.u, pixel.v])
    };
    let outer = landing.faces.first().copied();
    let vessel_pixel = outer.and_then(|point| pixel(point, 0));
    let object_pixel = landing
        .object
        .and_then(|point| pixel(point, simulation.faces()));
    TruthView {
        id: simulation.manifest().views[view].id.clone(),
        vessel: vessel_pixel.and(outer).map(Point::to_array),
        object: object_pixel.and(landing.object).map(Point::to_array),
        vessel_pixel,
        object_pixel,
    }
}
