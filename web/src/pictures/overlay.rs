//! What is drawn over a picture.

use leptos::prelude::*;
use snellius::export::SpotRole;

use super::look::Window;
use super::spots::{focus_role, role_class, role_name};
use super::{Found, Sheet};

/// More marks would be a colour over the picture: the points of a line are dots.
const MOST_MARKS: usize = 64;

/// Epipolar line and spots, in the picture's own pixels: `(0, 0)` is the middle of the top left one.
#[component]
pub(super) fn Overlay(sheet: Sheet, of_picture: &'static str) -> impl IntoView {
    let view_box = move || {
        let Window {
            left,
            top,
            width,
            height,
        } = sheet.window.get();
        format!("{} {} {width} {height}", left - 0.5, top - 0.5)
    };
    let line = move || {
        let facts = sheet.workbench.facts.get();
        let line = facts
            .map(|facts| facts.epipolar_line.clone())
            .unwrap_or_default();
        line.iter()
            .map(|[u, v]| format!("{u:.2},{v:.2}"))
            .collect::<Vec<_>>()
            .join(" ")
    };
    view! {
        <svg class="overlay" viewBox=view_box preserveAspectRatio="none" aria-hidden="true">
            <polyline class="epipolar" points=line />
            {move || values(sheet, of_picture)}
            {move || {
                let [u, v] = sheet.marked.get()?;
                Some(view! { <circle class="marked" cx=u cy=v r=move || sheet.reach.get().to_string() /> })
            }}
            {move || {
                let window = sheet.window.get();
                let spots = sheet.spots.get();
                if spots.len() > MOST_MARKS {
                    return dots(&spots, window).into_any();
                }
                let marks = spots.iter().enumerate();
                let marks = marks.map(|(index, spot)| mark(index, spot, window, (sheet, of_picture)));
                marks.collect_view().into_any()
            }}
        </svg>
    }
}

/// The points of a line, small enough that the line shows between them.
fn dots(spots: &[Found], window: Window) -> impl IntoView + use<> {
    let of_role = |role: SpotRole| {
        let own = spots.iter().filter(|spot| spot.role == role);
        let path: String = own
            .map(|spot| format!("M{:.2} {:.2}h0", spot.pixel[0], spot.pixel[1]))
            .collect();
        let class = format!("spot {}", role_class(role));
        let style = format!(
            "stroke-width: {}px; stroke-linecap: round; vector-effect: none",
            0.5 * window.width / 100.0
        );
        view! {
            <g class=class data-testid=format!("line-{}", role_class(role))>
                <path d=path style=style />
            </g>
        }
    };
    [SpotRole::Stray, SpotRole::Vessel, SpotRole::Object]
        .map(of_role)
        .collect_view()
}

fn mark(
    index: usize,
    spot: &Found,
    window: Window,
    (sheet, of_picture): (Sheet, &'static str),
) -> impl IntoView + use<> {
    let [u, v] = spot.pixel;
    // Marks keep their size whatever the zoom.
    let unit = window.width / 100.0;
    let r = 2.2 * unit;
    let shape = match spot.role {
        SpotRole::Vessel => format!("M{} {v}L{u} {}L{} {v}L{u} {}Z", u - r, v - r, u + r, v + r),
        SpotRole::Object => format!(
            "M{} {v}a{r} {r} 0 1 0 {} 0a{r} {r} 0 1 0 {} 0Z",
            u - r,
            2.0 * r,
            -2.0 * r
        ),
        SpotRole::Stray => format!(
            "M{a} {c}L{b} {d}M{a} {d}L{b} {c}",
            a = u - 0.7 * r,
            b = u + 0.7 * r,
            c = v - 0.7 * r,
            d = v + 0.7 * r
        ),
    };
    let (anchor, x, y) = name_place(spot, r, window);
    view! {
        <g
            class=format!("spot {}", role_class(spot.role))
            class:pointed=move || sheet.points_at(index)
            on:pointerenter=move |_| sheet.pointed.set(Some((index, of_picture)))
            on:pointerleave=move |_| sheet.pointed.set(None)
            on:click=move |_| focus_role(index)
        >
            <circle class="reach" cx=u cy=v r=2.0 * r />
            <path d=shape />
            <text x=x y=y text-anchor=anchor font-size=4.6 * unit>
                {role_name(spot.role)}
            </text>
        </g>
    }
}

/// What is to be said of the spot that is pointed at. It stands where the spot is not.
#[component]
pub(super) fn Note(sheet: Sheet, of_picture: &'static str) -> impl IntoView {
    move || {
        let spots = sheet.spots.get();
        let (index, _) = sheet
            .pointed
            .get()
            .filter(|(_, picture)| *picture == of_picture)?;
        let spot = spots.get(index)?.clone();
        let window = sheet.window.get();
        let below = spot.pixel[1] > window.top + window.height / 2.0;
        Some(view! {
            <p class="spot-note" class:above=below data-testid="spot-note">
                <strong>{role_name(spot.role)}</strong>
                {spot.reason.map(|reason| format!(": {reason}"))}
            </p>
        })
    }
}

/// The wall's name stands to the left above its mark, the others' to the right below: the spots are often
/// close. At the picture's edge a name turns inwards.
fn name_place(spot: &Found, r: f64, window: Window) -> (&'static str, f64, f64) {
    const ROOM: f64 = 0.2;
    let [u, v] = spot.pixel;
    let across = (u - window.left) / window.width;
    let is_wall = spot.role == SpotRole::Vessel;
    let leftwards = if is_wall {
        across > ROOM
    } else {
        across > 1.0 - ROOM
    };
    let y = if is_wall { v - 1.1 * r } else { v + 2.4 * r };
    if leftwards {
        ("end", u - 0.9 * r, y)
    } else {
        ("start", u + 0.9 * r, y)
    }
}

/// The grey value in each pixel, once there is room for it.
fn values(sheet: Sheet, of_picture: &'static str) -> Option<impl IntoView> {
    let pixels = sheet.window.get().large_pixels()?;
    let value = |[u, v]: [usize; 2]| {
        let value = sheet.workbench.pictures.with(|set| {
            let grey = set.as_ref()?.grey_at([u, v])?;
            match of_picture {
                "picture-on" => Some(i32::from(grey.on)),
                "picture-off" => grey.off.map(i32::from),
                _ => Some(grey.difference),
            }
        })?;
        let pointed = sheet.pixel.get() == Some([u, v]);
        Some(view! {
            <text class="grey" class:pointed=pointed x=u y=v font-size="0.3">
                {value}
            </text>
        })
    };
    Some(pixels.filter_map(value).collect_view())
}
