//! A report to print: one HTML file with its figures, which loads nothing and runs nothing.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::header::{header, in_one_line, index, name_of};
use super::{OneOrMany, ReconstructionResult, ResultFigure, ViewResult, WallResult};
use crate::plot::PlotError;

const STYLE: &str = include_str!("report.css");

/// The report as a page of its own: numbers, what to know before trusting them, the vessel and the object
/// from above with and without refraction (the paper's Fig. 11), the ray distances, the table of views.
///
/// Texts of the scan are escaped, and the page forbids itself scripts and requests.
pub fn report_html(result: &ReconstructionResult) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content=(header(result)[0]);
                title { (title(result)) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title(result)) }
                (warnings(result))
                h2 { "Numbers" }
                (numbers(result))
                h2 { "From above" }
                div.figures {
                    (figure(result, ResultFigure::TopView, [350, 420], "a) with refraction"))
                    (figure(result, ResultFigure::TopViewStraight, [350, 420], "b) without: straight rays"))
                }
                p.note { "The rig is below; grey: the wall and the points on it; colours: the scans." }
                h2 { "From above and aside" }
                (figure(result, ResultFigure::BirdsEye, [700, 480], "Grey: the wall's points; colours: the scans"))
                h2 { "Ray distances" }
                (figure(result, ResultFigure::RayDistances, [700, 200], "Ray distance l of each object point, views in their order"))
                h2 { "The wall" }
                (figure(result, ResultFigure::WallResiduals, [700, 300], "How far the wall's points lie off it: orange towards the rig, purple away from it"))
                h2 { "Views" }
                (views(result))
                footer { @for line in header(result) { p { (line) } } }
            }
        }
    };
    page.into_string()
}

fn figure(
    result: &ReconstructionResult,
    which: ResultFigure,
    size: [u32; 2],
    caption: &str,
) -> Markup {
    match result.figure(which).and_then(|plot| plot.draw(size)) {
        Ok(drawing) => html! { figure { (PreEscaped(drawing.svg)) figcaption { (caption) } } },
        Err(PlotError::Nothing) => html! { p { (caption) ": there is nothing to show." } },
        Err(error) => html! { p { (caption) ": " (error) "." } },
    }
}

/// The report's main figures by themselves, as HTML: vessel and object from above, and the ray distances.
pub fn report_figures(result: &ReconstructionResult) -> String {
    let figures = html! {
        (figure(result, ResultFigure::TopView, [350, 420], "From above"))
        (figure(result, ResultFigure::RayDistances, [700, 200], "Ray distance l of each object point, views in their order"))
    };
    figures.into_string()
}

fn title(result: &ReconstructionResult) -> String {
    match result.scan.trim() {
        "" => "Reconstruction".to_owned(),
        name => in_one_line(name),
    }
}

fn warnings(result: &ReconstructionResult) -> Markup {
    html! {
        @if !result.warnings.is_empty() {
            section.warnings {
                h2 { "What to know before trusting it" }
                ul { @for warning in &result.warnings { li { (warning) } } }
            }
        }
    }
}

fn numbers(result: &ReconstructionResult) -> Markup {
    let media = &result.media;
    let vessel = &result.vessel;
    let measured = result.views.iter().filter(|v| v.object.first().is_some());
    let distances: Vec<f64> = distances(result).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let row = |name: &str, value: String| html! { tr { th { (name) } td { (value) } } };
    html! {
        table.numbers {
            (row("Views with an object point", format!("{} of {}", measured.count(), result.views.len())))
            (row("Object points", distances.len().to_string()))
            @if !distances.is_empty() {
                (row("Ray distance on average", format!("{mean:.3} mm")))
            }
            (row("Refractive index outside", media.outside.to_string()))
            (row("Refractive index of the wall", media.wall.to_string()))
            (row("Refractive index inside", index(&media.inside)))
            (row("Vessel", shape(&vessel.wall)))
            (row("Wall thickness", format!("{} mm", vessel.wall_thickness)))
            (row("Vessel points", format!("{}, RMS {:.3} mm from the wall", vessel.points, vessel.rms)))
            @if let Some(glow) = &vessel.glow {
                (row("Inner face's share of the glow", format!("{:.2} +- {:.2}", glow.inner_share, glow.inner_share_sigma)))
            }
            @if let Some(choice) = &vessel.choice {
                (row("Shape chosen", format!("{} before {}, by {:.1}", name_of(&choice.chosen), name_of(&choice.runner_up), choice.margin)))
            }
        }
    }
}

fn shape(wall: &WallResult) -> String {
    let vector = |[x, y, z]: &[f64; 3]| format!("({x:.3}, {y:.3}, {z:.3})");
    match wall {
        WallResult::Plane { point, normal } => {
            format!(
                "plane through {} mm, normal {}",
                vector(point),
                vector(normal)
            )
        }
        WallResult::Cylinder {
            axis_point,
            axis,
            radius,
        } => format!(
            "cylinder of radius {radius:.3} mm about the axis through {} mm along {}",
            vector(axis_point),
            vector(axis)
        ),
        WallResult::Sphere { center, radius } => {
            format!(
                "sphere of radius {radius:.3} mm about {} mm",
                vector(center)
            )
        }
        WallResult::Freeform { columns, rows, .. } => {
            format!("free form, {columns} x {rows} control points")
        }
    }
}

fn distances(result: &ReconstructionResult) -> impl Iterator<Item = f64> + '_ {
    let views = result.views.iter();
    views.flat_map(|view| view.ray_distance.iter()).copied()
}

fn views(result: &ReconstructionResult) -> Markup {
    html! {
        p.note { "Object points in mm, world frame; one standard deviation of noise (and what calibration adds, common to all points); l is the ray distance. Of a line's points the middle one." }
        table.views {
            thead { tr {
                th { "view" } th { "scan" } th { "x" } th { "y" } th { "z" } th { "l" } th { "points" } th { "remark" }
            } }
            tbody { @for view in &result.views { (view_row(view)) } }
        }
    }
}

fn view_row(view: &ViewResult) -> Markup {
    fn middle<T: Copy>(values: &OneOrMany<T>) -> Option<T> {
        let values = values.as_slice();
        values.get(values.len() / 2).copied()
    }
    let place = middle(&view.object);
    let sigma = middle(&view.object_sigma).unwrap_or_default();
    let common = middle(&view.object_sigma_calibration).unwrap_or_default();
    html! {
        tr {
            th { (view.id) }
            td { (view.sweep) }
            @for axis in 0..3 {
                td { @if let Some(place) = place {
                    (format!("{:.3} \u{b1} {:.3} ({:.2})", place[axis], sigma[axis], common[axis]))
                } }
            }
            td { @if let Some(l) = middle(&view.ray_distance) { (format!("{l:.3}")) } }
            td { (view.object.iter().len()) }
            td { @match &view.reason { Some(reason) => (reason), None => (name_of(&view.status)) } }
        }
    }
}
