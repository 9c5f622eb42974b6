//! Measuring in the scene: points are picked, and what they give stands above it with its plus and minus.

use leptos::prelude::*;
use snellius::measure::{
    MeasureError, Measured, Sample, cylinder_radius, distance, flatness, plane_angle, sphere_radius,
};

use crate::number::fixed;
use crate::run::{ObjectPoint, Outcome};
use crate::state::Workbench;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Distance,
    Angle,
    Radius,
    RodRadius,
    Flatness,
}

/// A point of a view: the view, and which of its points.
pub(crate) type Picked = (usize, usize);

/// What is being measured, and with which points.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Measuring {
    /// Nothing, if nothing is measured.
    quantity: Option<Quantity>,
    /// The points of the first and of the second face; only an angle has two.
    faces: [Vec<Picked>; 2],
    /// The face that is being picked.
    active: usize,
}

/// The quantities with their words.
const QUANTITIES: [(Option<Quantity>, &str, &str, &str); 6] = [
    (None, "off", "Off", ""),
    (
        Some(Quantity::Distance),
        "distance",
        "Distance",
        "Pick two points.",
    ),
    (
        Some(Quantity::Angle),
        "angle",
        "Angle of two faces",
        "Pick three or more points of each face.",
    ),
    (
        Some(Quantity::Radius),
        "radius",
        "Radius of a ball",
        "Pick four or more points of the ball.",
    ),
    (
        Some(Quantity::RodRadius),
        "rod-radius",
        "Radius of a cylinder",
        "Pick six or more points of the cylinder's side.",
    ),
    (
        Some(Quantity::Flatness),
        "flatness",
        "Flatness of a face",
        "Pick four or more points of the face.",
    ),
];

impl Measuring {
    /// Whether picking is on.
    pub(crate) const fn is_on(&self) -> bool {
        self.quantity.is_some()
    }

    /// The picked points, face by face.
    pub(crate) const fn faces(&self) -> &[Vec<Picked>; 2] {
        &self.faces
    }

    /// Picks a point, or lets go of it.
    pub(crate) fn toggle(&mut self, point: Picked) {
        let face = &mut self.faces[self.active];
        match face.iter().position(|picked| *picked == point) {
            Some(at) => {
                face.remove(at);
            }
            None => face.push(point),
        }
        // Of a third point only the last two make a distance.
        if self.quantity == Some(Quantity::Distance) && face.len() > 2 {
            face.remove(0);
        }
    }

    /// Picks points in addition.
    pub(crate) fn add(&mut self, points: impl IntoIterator<Item = Picked>) {
        for point in points {
            if !self.faces[self.active].contains(&point) {
                self.toggle(point);
            }
        }
    }

    /// What the points give: in mm, or in degrees for an angle. `None` while there are too few.
    fn result(&self, outcome: &Outcome) -> Option<Result<Measured, MeasureError>> {
        let [one, other] = [0, 1].map(|face: usize| samples(outcome, &self.faces[face]));
        match self.quantity? {
            Quantity::Distance => match one.as_slice() {
                [a, b] => Some(Ok(distance(a, b))),
                _ => None,
            },
            Quantity::Angle => {
                let enough = one.len() >= 3 && other.len() >= 3;
                enough.then(|| plane_angle(&one, &other).map(in_degrees))
            }
            Quantity::Radius => (one.len() >= 4).then(|| sphere_radius(&one)),
            Quantity::RodRadius => (one.len() >= 6).then(|| cylinder_radius(&one)),
            Quantity::Flatness => (one.len() >= 4).then(|| flatness(&one)),
        }
    }
}

fn samples(outcome: &Outcome, picked: &[Picked]) -> Vec<Sample> {
    let points = picked
        .iter()
        .filter_map(|(view, index)| outcome.points_of(*view).get(*index));
    points.map(sample).collect()
}

fn sample(point: &ObjectPoint) -> Sample {
    Sample::new(point.place.map(f64::from), point.covariance.map(f64::from))
}

fn in_degrees(angle: Measured) -> Measured {
    Measured {
        value: angle.value.to_degrees(),
        sigma: angle.sigma.to_degrees(),
    }
}

/// What is measured, what to pick, and what came out.
#[component]
pub(crate) fn MeasuringBar() -> impl IntoView {
    let workbench = Workbench::get();
    let measuring = workbench.measuring;
    let quantity = Memo::new(move |_| measuring.with(|m| m.quantity));
    let choose = move |event| {
        let word = event_target_value(&event);
        let chosen = QUANTITIES.iter().find(|(_, known, ..)| *known == word);
        measuring.set(Measuring {
            quantity: chosen.and_then(|(quantity, ..)| *quantity),
            ..Measuring::default()
        });
    };
    let option = move |(of, word, name, _): (Option<Quantity>, &'static str, &'static str, _)| {
        view! {
            <option value=word selected=move || quantity.get() == of>
                {name}
            </option>
        }
    };
    let face = move |(index, name): (usize, &'static str)| {
        let count = move || measuring.with(|m| m.faces[index].len());
        view! {
            <button
                type="button"
                class="chip"
                data-testid=format!("face-{}", index + 1)
                aria-pressed=move || measuring.with(|m| m.active == index).to_string()
                on:click=move |_| measuring.update(|m| m.active = index)
            >
                {move || format!("{name}: {} points", count())}
            </button>
        }
    };
    view! {
        <div class="measuring">
            <label class="field">
                <span>"Measure"</span>
                <select data-testid="measure" on:change=choose>
                    {QUANTITIES.map(option).collect_view()}
                </select>
            </label>
            <Show when=move || quantity.get().is_some()>
                {move || match quantity.get() {
                    Some(Quantity::Angle) => {
                        [(0, "First face"), (1, "Second face")].map(face).collect_view().into_any()
                    }
                    _ => face((0, "Picked")).into_any(),
                }}
                <button
                    type="button"
                    class="chip"
                    on:click=move |_| measuring.update(|m| m.faces = Default::default())
                >
                    "Clear"
                </button>
                <p class="measured value" role="status" data-testid="measured">
                    {move || told(workbench)}
                </p>
            </Show>
        </div>
    }
}

/// What came out, or what to pick.
fn told(workbench: Workbench) -> String {
    let Some(outcome) = workbench.outcome.get() else {
        return String::new();
    };
    workbench.measuring.with(|measuring| {
        let hint = || {
            let known = QUANTITIES.iter().find(|(of, ..)| *of == measuring.quantity);
            let hint = known.map_or("", |(.., hint)| hint);
            format!("{hint} Click, Ctrl and drag, or M for the chosen view.")
        };
        let unit = if measuring.quantity == Some(Quantity::Angle) {
            "\u{b0}"
        } else {
            " mm"
        };
        match measuring.result(&outcome) {
            Some(Ok(Measured { value, sigma })) => {
                format!("{} \u{b1} {}{unit}", fixed(value, 3), fixed(sigma, 3))
            }
            Some(Err(error)) => error.to_string(),
            None => hint(),
        }
    })
}
