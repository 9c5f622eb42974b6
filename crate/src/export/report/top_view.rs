//! Vessel and object from above, with refraction and without: the paper's Fig. 11.

use maud::{Markup, html};
use nalgebra::Vector3;

use super::super::{ReconstructionResult, WallResult};
use super::svg::{colour, label, px, ticks};
use crate::geometry::{Direction, Point, Ray};
use crate::optics::Surface;

/// Which way one looks, and where what one sees is drawn: across, and behind the wall, mm.
struct View {
    origin: Vector3<f64>,
    across: Vector3<f64>,
    behind: Vector3<f64>,
}

impl View {
    /// Down along the scan lines' common perpendicular; down the axis of a round vessel.
    fn of(result: &ReconstructionResult) -> Option<Self> {
        let points: Vec<Vector3<f64>> = result.vessel_points().map(Vector3::from).collect();
        let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
        let surface = result.vessel.surface()?;
        let towards_rig = surface.normal_at(Point::from_coords(middle));
        let towards_rig = towards_rig.map_or(Vector3::z(), Direction::vector);
        let (origin, behind, along) = match surface {
            Surface::Cylinder(cylinder) => {
                let axis = cylinder.axis.vector();
                let flat = towards_rig - axis * towards_rig.dot(&axis);
                (cylinder.point.coords, -flat, axis.cross(&flat))
            }
            Surface::Sphere(sphere) => (sphere.centre.coords, -towards_rig, along(result)),
            _ => (middle, -towards_rig, along(result)),
        };
        let behind = behind.try_normalize(1e-9)?;
        let across = along - behind * along.dot(&behind);
        let fallback = || {
            Some(
                Direction::<crate::geometry::World>::new(behind)
                    .ok()?
                    .tangents()
                    .0,
            )
        };
        Some(Self {
            origin,
            across: across.try_normalize(1e-9).or_else(fallback)?,
            behind,
        })
    }

    fn place(&self, point: [f64; 3]) -> [f64; 2] {
        let d = Vector3::from(point) - self.origin;
        [d.dot(&self.across), d.dot(&self.behind)]
    }
}

/// The direction in which a sweep goes from view to view along the wall.
fn along(result: &ReconstructionResult) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for pair in result.views.windows(2) {
        let places = (pair[0].vessel.first(), pair[1].vessel.first());
        if let (Some(from), Some(to), true) = (places.0, places.1, pair[0].sweep == pair[1].sweep) {
            let step = Vector3::from(to) - Vector3::from(from);
            // A rig that sweeps there and back counts both ways.
            sum += if step.dot(&sum) < 0.0 { -step } else { step };
        }
    }
    sum
}

/// A dot: the place, and the sweep it belongs to.
type Dot = ([f64; 2], u32);

/// Two drawings at one scale.
pub(super) fn figure(result: &ReconstructionResult) -> Markup {
    let Some(view) = View::of(result) else {
        return html! { p { "The vessel's wall is not known." } };
    };
    let refracted = dots(
        result,
        |v| v.object.iter().copied().map(Some).collect(),
        &view,
    );
    let straight = dots(result, |v| v.object_unrefracted.as_slice().to_vec(), &view);
    let vessel: Vec<[f64; 2]> = result.vessel_points().map(|p| view.place(p)).collect();
    let all = refracted.iter().chain(&straight).map(|dot| dot.0);
    let Some(frame) = Frame::around(all.chain(vessel.iter().copied())) else {
        return html! { p { "There are no points." } };
    };
    html! {
        div.figures {
            (panel(&frame, &view, result, &vessel, &refracted, "a) with refraction"))
            (panel(&frame, &view, result, &vessel, &straight, "b) without: straight rays"))
        }
        p.note { "The rig is below; grey: the wall and the points on it; colours: the scans. Along the scan and behind the wall, mm." }
    }
}

fn dots(
    result: &ReconstructionResult,
    points: fn(&super::ViewResult) -> Vec<Option<[f64; 3]>>,
    view: &View,
) -> Vec<Dot> {
    let of_view = |v| {
        points(v)
            .into_iter()
            .flatten()
            .map(|p| (view.place(p), v.sweep))
    };
    result.views.iter().flat_map(of_view).collect()
}

/// What part of the plane is drawn, and how large.
struct Frame {
    low: [f64; 2],
    high: [f64; 2],
    scale: f64,
}

impl Frame {
    const WIDTH: f64 = 300.0;
    const HEIGHT: f64 = 380.0;

    fn around(points: impl Iterator<Item = [f64; 2]>) -> Option<Self> {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let size = (high[0] - low[0]).max(high[1] - low[1]);
        if !size.is_finite() {
            return None;
        }
        let margin = 0.08 * size.max(1.0);
        let (low, high) = (low.map(|x| x - margin), high.map(|x| x + margin));
        let fitting = (Self::WIDTH / (high[0] - low[0])).min(Self::HEIGHT / (high[1] - low[1]));
        Some(Self {
            low,
            high,
            scale: fitting,
        })
    }

    fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| (self.high[axis] - self.low[axis]) * self.scale)
    }

    /// In pixels; what is behind the wall is above.
    fn at(&self, [across, behind]: [f64; 2]) -> [f64; 2] {
        [
            (across - self.low[0]) * self.scale,
            (self.high[1] - behind) * self.scale,
        ]
    }
}

fn panel(
    frame: &Frame,
    view: &View,
    result: &ReconstructionResult,
    vessel: &[[f64; 2]],
    dots: &[Dot],
    caption: &str,
) -> Markup {
    let [width, height] = frame.size();
    html! {
        figure {
            svg viewBox=(format!("-34 -4 {} {}", px(width + 40.0), px(height + 26.0)))
                width=(px(width + 40.0)) height=(px(height + 26.0)) role="img" aria-label=(caption) {
                (grid(frame))
                svg x="0" y="0" width=(px(width)) height=(px(height)) {
                    (wall(frame, view, result))
                    @for point in vessel { (dot(frame, *point, "#888888", 1.5)) }
                    @for (point, sweep) in dots { (dot(frame, *point, colour(*sweep), 2.5)) }
                }
            }
            figcaption { (caption) }
        }
    }
}

fn dot(frame: &Frame, point: [f64; 2], colour: &str, radius: f64) -> Markup {
    let [x, y] = frame.at(point);
    html! { circle cx=(px(x)) cy=(px(y)) r=(radius) fill=(colour) {} }
}

fn grid(frame: &Frame) -> Markup {
    let [width, height] = frame.size();
    // About one tick every 55 pixels.
    let lines = |axis: usize| ticks(frame.low[axis], frame.high[axis], frame.size()[axis] / 55.0);
    html! {
        g.grid {
            @for tick in lines(0) {
                @let x = px(frame.at([tick, 0.0])[0]);
                line x1=(x) x2=(x) y1="0" y2=(px(height)) {}
                text x=(x) y=(px(height + 14.0)) text-anchor="middle" { (label(tick)) }
            }
            @for tick in lines(1) {
                @let y = frame.at([0.0, tick])[1];
                line x1="0" x2=(px(width)) y1=(px(y)) y2=(px(y)) {}
                text x="-5" y=(px(y + 3.5)) text-anchor="end" { (label(tick)) }
            }
            rect x="0" y="0" width=(px(width)) height=(px(height)) {}
        }
    }
}

/// Both faces of the wall: circles of a round vessel, else a section through the middle.
fn wall(frame: &Frame, view: &View, result: &ReconstructionResult) -> Markup {
    let thickness = result.vessel.wall_thickness;
    match &result.vessel.wall {
        WallResult::Cylinder { radius, .. } | WallResult::Sphere { radius, .. } => {
            let [x, y] = frame.at([0.0, 0.0]);
            html! { g.wall { @for r in [*radius, radius - thickness] {
                circle cx=(px(x)) cy=(px(y)) r=(px(r.max(0.0) * frame.scale)) {}
            } } }
        }
        _ => html! { g.wall { @for depth in [0.0, thickness] {
            polyline points=(section(frame, view, result, depth)) {}
        } } },
    }
}

/// A face of the wall as light from the rig meets it, all along the drawing.
fn section(frame: &Frame, view: &View, result: &ReconstructionResult, depth: f64) -> String {
    const STEPS: u32 = 60;
    let Some(face) = result.vessel.surface().and_then(|s| s.behind(depth)) else {
        return String::new();
    };
    let Ok(into) = Direction::new(view.behind) else {
        return String::new();
    };
    let before = frame.high[1] - frame.low[1] + 1000.0;
    let places = (0..=STEPS).filter_map(|k| {
        let part = f64::from(k) / f64::from(STEPS);
        let across = frame.low[0] + part * (frame.high[0] - frame.low[0]);
        let start = view.origin + view.across * across - view.behind * before;
        let hit = face.hit(&Ray::new(Point::from_coords(start), into))?;
        let [x, y] = frame.at(view.place(hit.point.to_array()));
        Some(format!("{},{}", px(x), px(y)))
    });
    places.collect::<Vec<_>>().join(" ")
}
