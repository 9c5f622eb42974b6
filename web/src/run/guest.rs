//! A reconstruction that came without its archive: what of it the page can show.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use snellius::export::{ReconstructionResult, Status, ViewResult};
use snellius::geometry::Point;
use snellius::pipeline::{Settings, Stage, Summary, Warning};
use snellius::scan::{Scan, VesselShape};
use snellius::share::{Document, Sightlines};

use super::problem::Problem;
use super::report::{
    Facts, Index, ObjectPoint, Outcome, Spot, StationFacts, VesselPoint, ViewOutcome, Wall, face,
    line_spots, places, shown,
};

/// What a worker tells the page of such a reconstruction.
#[derive(Serialize, Deserialize)]
pub(crate) struct Guest {
    pub(crate) facts: Facts,
    pub(crate) outcome: Outcome,
    pub(crate) settings: Settings,
    pub(crate) about: About,
}

/// What there is to say of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct About {
    /// What its maker says.
    pub(crate) notes: String,
    /// How far off its points may be along an axis, mm, if it came in a link.
    pub(crate) rounding: Option<f64>,
}

impl Guest {
    pub(super) fn of(document: &Document, rounding: Option<f64>) -> Result<Self, Problem> {
        let (facts, outcome) = shown_of(document)?;
        Ok(Self {
            facts,
            outcome,
            settings: document.settings,
            about: About {
                notes: document.notes.clone(),
                rounding,
            },
        })
    }
}

/// What the screens show of a document.
fn shown_of(document: &Document) -> Result<(Facts, Outcome), Problem> {
    let result = &document.result;
    let outer = result.vessel.surface().ok_or_else(|| {
        Problem::input(
            "result.vessel: these numbers are no wall's.",
            "Ask whoever made it for a whole one.",
        )
    })?;
    let wall = snellius::vessel::Wall::exact(outer, result.vessel.wall_thickness, None);
    // Without its light a reconstruction is still worth seeing.
    let lines = Sightlines::of(document).ok().flatten();
    let scan = document.scan.clone().and_then(|scan| Scan::new(scan).ok());
    let facts = match &scan {
        Some(scan) => Facts {
            name: document.title.clone(),
            ..Facts::of(scan)
        },
        None => facts_of(document),
    };
    let mut object = Vec::new();
    let views = result.views.iter().enumerate().map(|(number, view)| {
        let first = object.len();
        object.extend(object_points(&wall, number, view));
        let light = lines
            .as_ref()
            .zip(result.media.inside.value)
            .and_then(|(lines, index)| lines.light(number, middle(view), index));
        let (beam, sight) = light.map_or_else(Default::default, |light| {
            (places(&light.beam), places(&light.sight))
        });
        ViewOutcome {
            beam,
            sight,
            ..view_outcome(view, first..object.len())
        }
    });
    let views = views.collect();
    let outcome = Outcome {
        index: Index {
            value: result.media.inside.value.unwrap_or(f64::NAN),
            sigma: result.media.inside.sigma,
            method: result.media.inside.method,
        },
        wall: Wall {
            face: face(&wall),
            choice: result.vessel.choice.clone(),
            known: scan.is_some_and(|scan| scan.known_wall.is_some()),
            thickness: wall.thickness,
            thickness_of_glows: result.vessel.glow.as_ref().and_then(|glow| glow.thickness),
            rms: result.vessel.rms,
            points: result.vessel.points,
        },
        summary: summary(result),
        views,
        object,
        vessel: vessel_points(&wall, result),
        warnings: warnings(result),
    };
    Ok((facts, outcome))
}

/// What a result alone says of its scan: nothing of the rig.
fn facts_of(document: &Document) -> Facts {
    let views = &document.result.views;
    let last = views.iter().map(|view| view.sweep).max();
    let station = |view: &ViewResult| StationFacts {
        id: view.id.clone(),
        sweep: view.sweep as usize,
        stand: None,
    };
    Facts {
        session: None,
        name: document.title.clone(),
        given_index: document.result.media.inside.value,
        declared_shape: VesselShape::Auto,
        picture: [0, 0],
        epipolar_line: Vec::new(),
        sweeps: last.map_or(0, |last| (last as usize).saturating_add(1)),
        stations: views.iter().map(station).collect(),
    }
}

fn middle(view: &ViewResult) -> usize {
    view.object.as_slice().len() / 2
}

fn view_outcome(view: &ViewResult, points: Range<usize>) -> ViewOutcome {
    let spot = |spot: &snellius::export::SpotResult| Spot::of(spot);
    ViewOutcome {
        status: view.status,
        reason: view.reason.clone(),
        spots: match &view.line {
            Some(line) => line_spots(line),
            None => view.spots.iter().map(spot).collect(),
        },
        reasons: Vec::new(),
        points,
        beam: Vec::new(),
        sight: Vec::new(),
    }
}

fn object_points<'a>(
    wall: &'a snellius::vessel::Wall,
    number: usize,
    view: &'a ViewResult,
) -> impl Iterator<Item = ObjectPoint> + 'a {
    let points = view.object.iter().enumerate();
    points.map(move |(index, place)| {
        let sigma = view.object_sigma.as_slice().get(index);
        let [x, y, z] = sigma.copied().unwrap_or_default().map(|s| s as f32);
        let straight = view.object_unrefracted.as_slice().get(index);
        let distance = view.ray_distance.as_slice().get(index);
        ObjectPoint {
            view: number,
            place: shown(*place),
            unrefracted: shown(straight.copied().flatten().unwrap_or(*place)),
            // How the axes' deviations go together is not in a result.
            covariance: [x * x, 0.0, 0.0, y * y, 0.0, z * z],
            ray_distance: distance.copied().unwrap_or_default() as f32,
            depth: (-wall.outer.signed_distance(Point::from(*place)) - wall.thickness) as f32,
        }
    })
}

fn vessel_points(wall: &snellius::vessel::Wall, result: &ReconstructionResult) -> Vec<VesselPoint> {
    let views = result.views.iter().enumerate();
    let points = views.flat_map(|(view, one)| one.vessel.iter().map(move |place| (view, *place)));
    points
        .map(|(view, place)| VesselPoint {
            view,
            place: shown(place),
            residual: wall.outer.signed_distance(Point::from(place)) as f32,
        })
        .collect()
}

fn summary(result: &ReconstructionResult) -> Summary {
    let distances = || {
        result
            .views
            .iter()
            .flat_map(|view| view.ray_distance.iter())
    };
    let count = distances().count();
    let is_line = result.views.iter().any(|view| view.line.is_some());
    let mean = || distances().sum::<f64>() / count as f64;
    Summary {
        used: result
            .views
            .iter()
            .filter(|v| v.status == Status::Ok)
            .count(),
        mean_ray_distance: (count > 0 && !is_line).then(mean),
        median_off_line: None,
    }
}

/// A result says what to know, and not of which stage: it stands where the points are.
fn warnings(result: &ReconstructionResult) -> Vec<Warning> {
    let texts = result.warnings.iter().cloned();
    texts
        .map(|text| Warning {
            stage: Stage::Object,
            text,
        })
        .collect()
}
