//! Each light's crossing of the wall, enlarged, in the plane in which it bends.

use leptos::prelude::*;
use snellius::lab::{Bend, LightPath};

use super::drawing::{At, Drawing, degrees};
use super::state::LabState;

const SIZE: At = [340.0, 200.0];
/// The wall's thickness in the picture, px.
const WALL: f64 = 92.0;

/// The beam's and the line of sight's.
#[component]
pub(super) fn Loupes() -> impl IntoView {
    let lab = LabState::get();
    let of = move |sight: bool| {
        let (hides, thickness) = lab.bench.with(|b| (b.hides_index(), b.thickness));
        lab.light.with(|light| {
            let (path, class) = if sight {
                (&light.sight, "sight")
            } else {
                (&light.beam, "beam")
            };
            draw(path, class, thickness, hides)
        })
    };
    let loupe = move |sight: bool, name: &'static str, id: &'static str| {
        view! {
            <figure class="loupe">
                <figcaption>{name}</figcaption>
                <svg
                    class="lab-svg"
                    viewBox=format!("0 0 {} {}", SIZE[0], SIZE[1])
                    role="img"
                    aria-label=format!("{name} at the wall; the table below gives its angles")
                    data-testid=id
                >
                    <g inner_html=move || of(sight)></g>
                </svg>
                <p class="trouble" role="status">
                    {move || {
                        lab.light.with(|light| {
                            if sight { light.sight.trouble() } else { light.beam.trouble() }
                        })
                    }}
                </p>
            </figure>
        }
    };
    view! {
        {loupe(false, "Laser beam", "loupe-beam")}
        {loupe(true, "Line of sight", "loupe-sight")}
    }
}

/// The plane that holds the light and the first face's normal, as the picture's.
struct Plane {
    inwards: nalgebra::Vector3<f64>,
    aside: nalgebra::Vector3<f64>,
    from: nalgebra::Vector3<f64>,
    origin: At,
    scale: f64,
}

impl Plane {
    fn of(first: &Bend, last: &Bend, thickness: f64) -> Self {
        let inwards = -first.normal.vector();
        let light = first.before.vector();
        let aside = light - inwards * light.dot(&inwards);
        // Squarely in, any direction along the wall will do.
        let aside = aside
            .try_normalize(1e-9)
            .unwrap_or_else(|| first.normal.tangents().0);
        let mut plane = Self {
            inwards,
            aside,
            from: first.at.coords,
            origin: [0.0, 0.0],
            scale: WALL / thickness,
        };
        let shift = plane.place(last.at.coords)[1];
        plane.origin = [0.5 * (SIZE[0] - WALL), 0.5 * (SIZE[1] - shift)];
        plane
    }

    fn place(&self, point: nalgebra::Vector3<f64>) -> At {
        let [right, down] = self.way(point - self.from);
        [
            self.origin[0] + right * self.scale,
            self.origin[1] + down * self.scale,
        ]
    }

    /// A direction in the picture; its length is that of the part within the plane.
    fn way(&self, vector: nalgebra::Vector3<f64>) -> At {
        [vector.dot(&self.inwards), vector.dot(&self.aside)]
    }
}

fn draw(path: &LightPath, class: &str, thickness: f64, hides: bool) -> String {
    let mut drawing = Drawing::default();
    let (Some(first), Some(last)) = (path.bends.first(), path.bends.last()) else {
        drawing.text("label", [16.0, 28.0], "The light does not meet the wall.");
        return drawing.text_of();
    };
    let plane = Plane::of(first, last, thickness);
    let [left, right] = [plane.origin[0], plane.origin[0] + WALL];
    drawing.rect("glass", [left, 0.0], [WALL, SIZE[1]]);
    drawing.rect("liquid", [right, 0.0], [SIZE[0] - right, SIZE[1]]);
    drawing.line("face", [left, 0.0], [left, SIZE[1]]);
    drawing.line("face", [right, 0.0], [right, SIZE[1]]);

    let step = |at: At, way: At, length: f64| [at[0] + way[0] * length, at[1] + way[1] * length];
    let corner = plane.place(first.at.coords);
    let start = step(corner, plane.way(-first.before.vector()), 400.0);
    let end = plane.place(last.at.coords);
    let goes_on = step(end, plane.way(last.after.vector()), 400.0);
    for bend in &path.bends {
        let at = plane.place(bend.at.coords);
        let normal = plane.way(bend.normal.vector());
        drawing.line("normal", step(at, normal, 76.0), step(at, normal, -76.0));
        // A mystery liquid's would give it away.
        if !hides || bend.at == first.at {
            critical(&mut drawing, bend, at, &plane);
        }
    }
    // The light of a line of sight comes back along it.
    let outwards = class == "beam";
    let mut piece = |class: &str, from: At, to: At, share: f64| {
        drawing.line(class, from, to);
        let (from, to, share) = if outwards {
            (from, to, share)
        } else {
            (to, from, 1.0 - share)
        };
        drawing.arrowhead(class, from, to, share);
    };
    piece(class, start, corner, 0.81);
    if path.bends.len() > 1 {
        piece(class, corner, end, 0.5);
    }
    let thrown = last.thrown_back.is_some();
    let class = format!("{class}{}", if thrown { " thrown-back" } else { "" });
    piece(&class, end, goes_on, 0.19);
    for (place, bend) in path.bends.iter().enumerate() {
        numbers(
            &mut drawing,
            bend,
            plane.place(bend.at.coords),
            &plane,
            place,
        );
    }
    let index = |n: f64| format!("n = {n:.4}");
    drawing.text("medium", [10.0, SIZE[1] - 10.0], &index(first.index_before));
    drawing.text(
        "medium middle",
        [0.5 * (left + right), SIZE[1] - 10.0],
        &index(first.index_behind),
    );
    if path.bends.len() > 1 {
        let inside = if hides {
            "n = ?".to_owned()
        } else {
            index(last.index_behind)
        };
        drawing.text("medium end", [SIZE[0] - 10.0, SIZE[1] - 10.0], &inside);
    }
    drawing.text_of()
}

/// The direction from which on the face throws light back.
fn critical(drawing: &mut Drawing, bend: &Bend, at: At, plane: &Plane) {
    let Some(angle) = bend.critical() else { return };
    // Only where it matters: a line for each face would hide the light.
    if bend.angle_before() < 0.6 * angle {
        return;
    }
    let normal = bend.normal.vector();
    let before = bend.before.vector();
    let aside = before - normal * before.dot(&normal);
    let Some(aside) = aside.try_normalize(1e-9) else {
        return;
    };
    let way = plane.way(normal * angle.cos() - aside * angle.sin());
    let end = [at[0] + way[0] * 84.0, at[1] + way[1] * 84.0];
    drawing.line("critical", at, end);
    let text = format!("critical {}", degrees(angle));
    let down = if way[1] < 0.0 { -6.0 } else { 14.0 };
    drawing.text(
        "critical-text",
        [(end[0] - 30.0).max(4.0), end[1] + down],
        &text,
    );
}

/// The angles at a face, on both sides of it.
fn numbers(drawing: &mut Drawing, bend: &Bend, at: At, plane: &Plane, place: usize) {
    let normal = bend.normal.vector();
    let came = plane.way(-bend.before.vector());
    drawing.angle(
        at,
        plane.way(normal),
        came,
        34.0,
        &degrees(bend.angle_before()),
    );
    let goes = bend.after.vector();
    let side = if bend.thrown_back.is_some() {
        normal
    } else {
        -normal
    };
    // In the wall one of the two equal angles is enough, unless light is thrown back.
    if place > 0 || bend.thrown_back.is_some() {
        drawing.angle(
            at,
            plane.way(side),
            plane.way(goes),
            34.0,
            &degrees(bend.angle_after()),
        );
    } else {
        drawing.angle(at, plane.way(side), plane.way(goes), 26.0, "");
    }
}
