//! The bench's numbers: every face's angles, and what the measurement makes of the light.

use leptos::prelude::*;
use snellius::lab::{Bench, Bend, Light, LightPath};

use super::lessons::MysteryCheck;
use super::state::LabState;
use crate::number::fixed;

/// A table: each light at each face.
#[component]
pub(super) fn Faces() -> impl IntoView {
    let lab = LabState::get();
    let row = move |sight: bool, face: usize, name: &'static str| {
        let id = format!(
            "{}-{}",
            if sight { "sight" } else { "beam" },
            ["outer", "inner"][face]
        );
        let bend = move || {
            lab.light.with(|light| {
                let path: &LightPath = if sight { &light.sight } else { &light.beam };
                path.bends.get(face).copied()
            })
        };
        let shown = move |of: fn(&Bend) -> Option<f64>| {
            let angle = bend().and_then(|bend| of(&bend));
            angle.map_or("\u{2013}".to_owned(), |angle| {
                format!("{}\u{b0}", fixed(angle.to_degrees(), 2))
            })
        };
        // The inner face's critical angle would give a mystery liquid away.
        let critical = move || {
            if face == 1 && lab.bench.with(Bench::hides_index) {
                return "?".to_owned();
            }
            shown(Bend::critical)
        };
        let goes_on = move || {
            if bend().is_some_and(|bend| bend.thrown_back.is_some()) {
                return "thrown back".to_owned();
            }
            shown(|bend| Some(bend.angle_after()))
        };
        view! {
            <tr>
                <th scope="row">{name}</th>
                <td class="number" data-testid=format!("{id}-before")>
                    {move || shown(|bend| Some(bend.angle_before()))}
                </td>
                <td class="number" data-testid=format!("{id}-after")>
                    {goes_on}
                </td>
                <td class="number" data-testid=format!("{id}-critical")>
                    {critical}
                </td>
            </tr>
        }
    };
    view! {
        <table class="faces">
            <thead>
                <tr>
                    <th scope="col">"Face"</th>
                    <th scope="col" class="number">"Comes at"</th>
                    <th scope="col" class="number">"Goes on at"</th>
                    <th scope="col" class="number">"Critical angle"</th>
                </tr>
            </thead>
            <tbody>
                {row(false, 0, "Beam, outer")}
                {row(false, 1, "Beam, inner")}
                {row(true, 0, "Sight, outer")}
                {row(true, 1, "Sight, inner")}
            </tbody>
        </table>
    }
}

/// What the range finder measures.
#[component]
pub(super) fn Measured() -> impl IntoView {
    let lab = LabState::get();
    let place = |coords: [f64; 3]| coords.map(|c| fixed(c, 2)).join(", ") + " mm";
    let row = |name: &'static str, id: &'static str, of: Signal<Option<String>>| {
        view! {
            <div>
                <dt>{name}</dt>
                <dd data-testid=id>{move || of.get().unwrap_or_else(|| "\u{2013}".to_owned())}</dd>
            </div>
        }
    };
    let from_light =
        move |of: fn(&Light) -> Option<String>| Signal::derive(move || lab.light.with(of));
    let millimetres = |value: f64| format!("{} mm", fixed(value, 3));
    let truth = Signal::derive(move || {
        lab.light
            .with(|light| light.spot.map(|p| place(p.to_array())))
    });
    let measured = Signal::derive(move || {
        lab.light.with(|light| {
            let measurement = light.measurement.as_ref().ok()?;
            Some(place(measurement.meeting.point().to_array()))
        })
    });
    let apparent = Signal::derive(move || {
        lab.light.with(|light| {
            let measurement = light.measurement.as_ref().ok()?;
            measurement.apparent.map(|p| place(p.to_array()))
        })
    });
    let l = Signal::derive(move || {
        lab.light
            .with(|light| light.ray_distance().map(millimetres))
    });
    let error = Signal::derive(move || lab.light.with(|light| light.error().map(millimetres)));
    let pixel = from_light(|light| {
        let pixel = light.measurement.as_ref().ok()?.pixel;
        Some(format!("{}, {} px", fixed(pixel.u, 2), fixed(pixel.v, 2)))
    });
    view! {
        <section class="panel summary measured-panel" aria-labelledby="measured">
            <h2 id="measured">"What the range finder measures"</h2>
            <dl>
                {row("True point P", "true-point", truth)}
                {row("Measured point", "measured-point", measured)}
                {row("Off by", "measured-error", error)}
                {row("Ray distance l", "ray-distance", l)}
                {row("Apparent point", "apparent-point", apparent)}
                {row("Spot in the picture", "spot-pixel", pixel)}
            </dl>
            <p class="trouble" role="status" data-testid="no-measurement">
                {move || lab.light.with(|light| light.measurement.as_ref().err().map(ToString::to_string))}
            </p>
            <MysteryCheck />
        </section>
    }
}
