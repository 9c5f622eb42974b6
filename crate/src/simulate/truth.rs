use serde::{Deserialize, Serialize};

use super::Simulation;
use crate::export::OneOrMany;
use crate::geometry::{Camera, Point, Ray, World};
use crate::rig::Laser;

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
    let rig = &simulation.scan.rig;
    let id = simulation.manifest().views[view].id.clone();
    match &rig.laser {
        Laser::Beam(beam) => {
            let Lit { vessel, object } = lit(simulation, view, beam);
            TruthView {
                id,
                vessel: OneOrMany::One(vessel.map(|(place, _)| place)),
                object: OneOrMany::One(object.map(|(place, _)| place)),
                vessel_pixel: OneOrMany::One(vessel.map(|(_, pixel)| pixel)),
                object_pixel: OneOrMany::One(object.map(|(_, pixel)| pixel)),
            }
        }
        Laser::Sheet(sheet) => {
            let middle = |rays: &Vec<(Ray<Camera>, f64)>| rays[rays.len() / 2].0;
            let fan = simulation.scene.beam.fan(sheet, &rig.camera);
            let lit: Vec<Lit> = fan
                .iter()
                .map(|rays| lit(simulation, view, &middle(rays)))
                .collect();
            let vessel = || lit.iter().filter_map(|lit| lit.vessel);
            let object = || lit.iter().filter_map(|lit| lit.object);
            TruthView {
                id,
                vessel: OneOrMany::Many(vessel().map(|(place, _)| place).collect()),
                object: OneOrMany::Many(object().map(|(place, _)| place).collect()),
                vessel_pixel: OneOrMany::Many(vessel().map(|(_, pixel)| pixel).collect()),
                object_pixel: OneOrMany::Many(object().map(|(_, pixel)| pixel).collect()),
            }
        }
    }
}

/// A place in the world and where it is seen.
type Seen = ([f64; 3], [f64; 2]);

/// What a ray lights that the picture shows.
struct Lit {
    vessel: Option<Seen>,
    object: Option<Seen>,
}

fn lit(simulation: &Simulation, view: usize, ray: &Ray<Camera>) -> Lit {
    let landing = simulation.landing(view, ray);
    let camera = &simulation.scan.rig.camera;
    let seen = |point: Option<Point<World>>, faces| {
        let pixel = simulation.seen(view, point?, faces)?;
        let inside = pixel.u >= 0.0
            && pixel.v >= 0.0
            && pixel.u <= f64::from(camera.width - 1)
            && pixel.v <= f64::from(camera.height - 1);
        inside.then_some((point?.to_array(), [pixel.u, pixel.v]))
    };
    Lit {
        vessel: seen(landing.outer, 0),
        object: seen(landing.object, 2),
    }
}
