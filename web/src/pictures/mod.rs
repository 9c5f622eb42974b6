//! The chosen view's pictures, with what was found in them drawn over: look as near as a pixel, read its
//! grey values, and say what a spot is.

mod frame;
mod look;
mod overlay;
mod spots;

use std::sync::Arc;

use leptos::prelude::*;
use snellius::export::SpotRole;

use self::frame::frame;
use self::look::{Look, Window, window};
use self::spots::SpotList;
use crate::number::fixed;
use crate::run::{PictureSet, Spot};
use crate::state::Workbench;

/// A spot, and why it was refused.
#[derive(Clone, Debug, PartialEq)]
struct Found {
    pixel: [f64; 2],
    role: SpotRole,
    reason: Option<String>,
}

/// What the three pictures share.
#[derive(Clone, Copy)]
struct Sheet {
    workbench: Workbench,
    look: RwSignal<Look>,
    window: Memo<Window>,
    spots: Signal<Arc<Vec<Found>>>,
    /// The spot that is pointed at, and the picture in which it is told of.
    pointed: RwSignal<Option<(usize, &'static str)>>,
    /// The pixel that is pointed at.
    pixel: RwSignal<Option<[usize; 2]>>,
    /// Of a line: the pixel about which something is said, and how far about it, px.
    marked: RwSignal<Option<[usize; 2]>>,
    reach: RwSignal<f64>,
}

impl Sheet {
    /// Whether the laser draws a line, whose points are not told of one by one.
    fn is_of_line(self) -> bool {
        self.workbench.facts.with(|facts| {
            facts
                .as_ref()
                .is_some_and(|facts| facts.epipolar_line.is_empty())
        })
    }

    /// Marks the pixel that is pointed at.
    fn mark(self) {
        if self.is_of_line() {
            self.marked.set(self.pixel.get_untracked());
        }
    }

    /// Whether a spot is pointed at.
    fn points_at(self, spot: usize) -> bool {
        self.pointed
            .get()
            .is_some_and(|(pointed, _)| pointed == spot)
    }
}

const ZOOMS: [f64; 5] = [1.0, 2.0, 8.0, 32.0, 64.0];

/// The pictures of the chosen view.
#[component]
pub(crate) fn Pictures() -> impl IntoView {
    let workbench = Workbench::get();
    let look = RwSignal::new(Look {
        zoom: 2.0,
        centre: None,
    });
    let spots = Memo::new(move |_| {
        let (chosen, outcome) = (workbench.chosen.get()?, workbench.outcome.get()?);
        let view = outcome.views.get(chosen)?;
        Some(Arc::new(found(&view.spots, &view.reasons)))
    });
    let spots = Signal::derive(move || spots.get().unwrap_or_default());
    let size = move || {
        let facts = workbench.facts.get();
        facts.map_or([1.0, 1.0], |facts| facts.picture.map(f64::from))
    };
    let sheet = Sheet {
        workbench,
        look,
        window: Memo::new(move |_| window(size(), look.get(), &spots.get())),
        spots,
        pointed: RwSignal::new(None),
        pixel: RwSignal::new(None),
        marked: RwSignal::new(None),
        reach: RwSignal::new(12.0),
    };
    Effect::new(move |_| {
        workbench.chosen.track();
        look.update(|look| look.centre = None);
        sheet.pixel.set(None);
        sheet.marked.set(None);
    });
    Effect::new(move |_| {
        spots.track();
        sheet.pointed.set(None);
    });
    let id = move || {
        let chosen = workbench.chosen.get()?;
        Some(workbench.facts.get()?.stations.get(chosen)?.id.clone())
    };
    view! {
        <section class="pictures panel" aria-labelledby="pictures-title">
            <div class="panel-head">
                <h2 id="pictures-title">
                    {move || id().map_or("Pictures".to_owned(), |id| format!("Pictures of view {id}"))}
                </h2>
                <ZoomButtons look />
            </div>
            <Show
                when=move || workbench.chosen.get().is_some()
                fallback=|| view! { <p class="help">"Choose a view in the table or a point in the scene."</p> }
            >
                <div class="picture-row">
                    {frame(sheet, "Laser on", "picture-on", |set| Some(set.on.clone()))}
                    {frame(sheet, "Laser off", "picture-off", PictureSet::off)}
                    {frame(sheet, "Difference", "picture-difference", |set| Some(set.difference.clone()))}
                </div>
                <GreyValues sheet />
                <Key workbench />
                <SpotList sheet />
            </Show>
        </section>
    }
}

fn found(spots: &[Spot], reasons: &[(usize, String)]) -> Vec<Found> {
    let one = |spot: &Spot| Found {
        pixel: spot.pixel.map(f64::from),
        role: spot.role,
        reason: None,
    };
    let mut found: Vec<Found> = spots.iter().map(one).collect();
    for (index, reason) in reasons {
        if let Some(found) = found.get_mut(*index) {
            found.reason = Some(reason.clone());
        }
    }
    found
}

#[component]
fn ZoomButtons(look: RwSignal<Look>) -> impl IntoView {
    let button = move |zoom: f64| {
        view! {
            <button
                type="button"
                class="chip"
                data-testid=format!("zoom-{zoom}")
                aria-pressed=move || (look.get().zoom == zoom).to_string()
                on:click=move |_| look.update(|look| look.zoom = zoom)
            >
                {format!("{zoom}\u{d7}")}
            </button>
        }
    };
    view! {
        <div class="zooms" role="group" aria-label="Zoom, around the spots">
            {ZOOMS.map(button).collect_view()}
        </div>
    }
}

/// The grey values of the pixel that is pointed at.
#[component]
fn GreyValues(sheet: Sheet) -> impl IntoView {
    let told = move || {
        let [u, v] = sheet.pixel.get()?;
        sheet.workbench.pictures.with(|set| {
            let grey = set.as_ref()?.grey_at([u, v])?;
            let off = grey
                .off
                .map_or("not taken".to_owned(), |off| off.to_string());
            let difference = fixed(grey.difference.into(), 0);
            Some(format!(
                "Pixel {u}, {v}: on {}, off {off}, difference {difference}",
                grey.on
            ))
        })
    };
    view! {
        <p class="grey-values value" role="status" data-testid="grey-values">
            {move || told().unwrap_or_else(|| "Point at a pixel to read its grey values.".to_owned())}
        </p>
    }
}

#[component]
fn Key(workbench: Workbench) -> impl IntoView {
    let limit = move || {
        workbench
            .pictures
            .with(|set| set.as_ref().map(|set| set.difference_limit))
    };
    let has_line = move || {
        workbench.facts.with(|facts| {
            facts
                .as_ref()
                .is_some_and(|facts| !facts.epipolar_line.is_empty())
        })
    };
    view! {
        <p class="picture-key">
            <Show when=has_line>
                <span class="line-key">"epipolar line: where the beam is seen in air"</span>
            </Show>
            <span class="difference-key">
                {move || limit().map(|limit| fixed(-limit, 0))}
                <span class="difference-ramp" aria-hidden="true"></span>
                {move || limit().map(|limit| format!("+{}", fixed(limit, 0)))}
                " grey values, square root"
            </span>
        </p>
    }
}
