//! The viewer's boundary to its page: a document goes in as JSON, numbers come out in flat lists.
//!
//! The page (`page/`) draws and listens; everything that is measured is measured here, by the core.
#![allow(missing_docs, reason = "the page beside it is the only caller")]

mod facts;
mod measuring;
mod sides;

use snellius::export::{Format, ReconstructionResult, report_figures};
use snellius::geometry::{Point, World};
use snellius::share::{Document, Sightlines};
use wasm_bindgen::prelude::*;

/// A document, and what it gives with the index that is chosen.
#[wasm_bindgen]
pub struct Viewer {
    document: Document,
    lines: Option<Sightlines>,
    /// Why the points cannot follow the index.
    fixed: Option<String>,
    /// The result that is shown.
    shown: ReconstructionResult,
}

#[wasm_bindgen]
impl Viewer {
    #[wasm_bindgen(constructor)]
    pub fn new(json: &str) -> Result<Viewer, JsError> {
        let document = Document::from_json(json.as_bytes())?;
        let (lines, fixed) = match Sightlines::of(&document) {
            Ok(Some(lines)) => (Some(lines), None),
            Ok(None) => (None, Some("it came without its scan's manifest".to_owned())),
            Err(error) => (None, Some(error.to_string())),
        };
        Ok(Self {
            shown: document.result.clone(),
            document,
            lines,
            fixed,
        })
    }

    /// Title, notes, media and so on, as JSON.
    pub fn facts(&self) -> String {
        facts::facts(&self.document, &self.shown, self.fixed.as_deref()).to_string()
    }

    /// Measures again with another index of the liquid.
    #[wasm_bindgen(js_name = setIndex)]
    pub fn set_index(&mut self, index: f64) {
        if let Some(lines) = &self.lines {
            self.shown = lines.result_at(&self.document.result, index);
        }
    }

    /// Back to what was measured.
    pub fn reset(&mut self) {
        self.shown = self.document.result.clone();
    }

    /// The views' ids.
    #[wasm_bindgen(js_name = viewIds)]
    pub fn view_ids(&self) -> Vec<String> {
        self.shown
            .views
            .iter()
            .map(|view| view.id.clone())
            .collect()
    }

    /// What became of each view.
    pub fn remarks(&self) -> Vec<String> {
        self.shown.views.iter().map(facts::remark).collect()
    }

    /// The object's points, `COLUMNS` numbers each: view, index in the view, sweep, place, standard
    /// deviations along the axes, ray distance, place without refraction (not a number where there is none).
    pub fn points(&self) -> Vec<f64> {
        let views = self.shown.views.iter().enumerate();
        let rows = views.flat_map(|(number, view)| {
            view.object
                .iter()
                .enumerate()
                .flat_map(move |(index, place)| {
                    let sigma = view.object_sigma.as_slice().get(index).copied();
                    let straight = view.object_unrefracted.as_slice().get(index).copied();
                    let distance = view.ray_distance.as_slice().get(index).copied();
                    let head = [number as f64, index as f64, f64::from(view.sweep)];
                    head.into_iter()
                        .chain(*place)
                        .chain(sigma.unwrap_or([f64::NAN; 3]))
                        .chain([distance.unwrap_or(f64::NAN)])
                        .chain(straight.flatten().unwrap_or([f64::NAN; 3]))
                })
        });
        rows.collect()
    }

    /// The wall's points, x y z each.
    #[wasm_bindgen(js_name = vesselPoints)]
    pub fn vessel_points(&self) -> Vec<f64> {
        self.shown.vessel_points().flatten().collect()
    }

    /// The wall as a grid: columns, rows, then each node's place on the outer face, and on the inner one (not
    /// a number where the wall does not reach). Empty if there is no wall to draw.
    pub fn wall(&self) -> Vec<f64> {
        let Some(mesh) = self.document.result.wall_mesh() else {
            return Vec::new();
        };
        let none = [f64::NAN; 6];
        let nodes = mesh.nodes.iter().flat_map(|node| {
            node.as_ref().map_or(none, |node| {
                let ([a, b, c], [d, e, f]) = (node.outer.to_array(), node.inner.to_array());
                [a, b, c, d, e, f]
            })
        });
        [mesh.columns as f64, mesh.rows as f64]
            .into_iter()
            .chain(nodes)
            .collect()
    }

    /// How to look at it: up, and from the scene towards the rig; unit vectors.
    pub fn sides(&self) -> Vec<f64> {
        sides::sides(&self.document)
    }

    /// The light of a point: how many places the beam has, the beam's places, the line of sight's.
    pub fn light(&self, view: usize, point: usize) -> Vec<f64> {
        let index = self.shown.media.inside.value;
        let light = self
            .lines
            .as_ref()
            .zip(index)
            .and_then(|(lines, index)| lines.light(view, point, index));
        let Some(light) = light else {
            return Vec::new();
        };
        let places = |path: &[Point<World>]| -> Vec<f64> {
            path.iter().flat_map(|place| place.to_array()).collect()
        };
        let count = light.beam.len() as f64;
        [vec![count], places(&light.beam), places(&light.sight)].concat()
    }

    /// The mean ray distance at some indices; not a number where the light of a point does not get through.
    #[wasm_bindgen(js_name = meanRayDistances)]
    pub fn mean_ray_distances(&self, indices: &[f64]) -> Vec<f64> {
        let Some(lines) = &self.lines else {
            return Vec::new();
        };
        let means = lines.mean_ray_distances(indices).into_iter();
        means.map(|mean| mean.unwrap_or(f64::NAN)).collect()
    }

    /// From above with and without refraction, and the ray distances: HTML of the core's own making.
    pub fn figures(&self) -> String {
        report_figures(&self.shown)
    }

    /// Measures between points, given as pairs of view and index: a JSON of text, or of why not.
    pub fn measure(&self, what: &str, points: &[u32]) -> String {
        measuring::measure(&self.shown, what, points)
    }

    /// A file of what is shown: `csv`, `ply`, `json`, `las`, `e57`.
    pub fn write(&self, format: &str) -> Result<Vec<u8>, JsError> {
        let mut known = Format::ALL.iter().filter(|known| known.name() == format);
        let format = known.next().ok_or_else(|| JsError::new("no such format"))?;
        Ok(self.shown.write(*format)?)
    }
}
