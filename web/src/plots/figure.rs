//! One figure: the worker's drawing, with the pointer's values and the chosen view over it.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::{ev, html};
use snellius::plot::PlotError;
use wasm_bindgen::JsCast;
use wasm_bindgen_futures::spawn_local;
use web_sys::{Element, KeyboardEvent, MouseEvent};

use super::{Shown, Tall};
use crate::files::save_text;
use crate::run::{Drawn, FigureForm, Figured, MarkAt, Problem};
use crate::state::Workbench;

/// The pointer finds values this near, px of the drawing.
const REACH: f32 = 18.0;

/// A drawing, or why there is none.
type Answer = Result<Arc<Drawn>, PlotError>;

/// A figure with its downloads.
#[component]
pub(super) fn FigureView(figure: Shown, frame: NodeRef<html::Div>) -> impl IntoView {
    let workbench = Workbench::get();
    let answer = RwSignal::new(None::<Answer>);
    let pointed = RwSignal::new(None::<usize>);
    let asked = StoredValue::new(0_u32);
    let (of, tall) = (figure.of, figure.tall);
    Effect::new(move |_| {
        workbench.outcome.track();
        workbench.study.track();
        let width = frame.get().map_or(0, |frame| frame.client_width());
        asked.update_value(|number| *number += 1);
        let number = asked.get_value();
        spawn_local(async move {
            let drawn = workbench
                .figure(of, FigureForm::Drawing(size(width, tall)))
                .await;
            // A newer one is under way, or the figure is gone.
            if asked.try_get_value() != Some(number) {
                return;
            }
            match drawn {
                Ok(Figured::Drawn(drawing)) => {
                    pointed.set(None);
                    answer.set(Some(Ok(Arc::new(*drawing))));
                }
                Ok(Figured::None(why)) => answer.set(Some(Err(why))),
                Ok(Figured::Table(_)) => {}
                Err(problem) => workbench.fail(problem),
            }
        });
    });
    let title = move || {
        answer.with(|answer| match answer {
            Some(Ok(drawing)) => drawing.title.clone(),
            _ => String::new(),
        })
    };
    let name = figure.name.clone();
    let test_id = format!("figure-{name}");
    view! {
        <figure class="plot" data-testid=test_id>
            <figcaption>{title}</figcaption>
            {move || answer.get().map(|answer| match answer {
                Ok(drawing) => view! { <Sheet drawing pointed /> }.into_any(),
                Err(why) => view! { <p class="help">{why_none(&why)}</p> }.into_any(),
            })}
            <Files figure answer />
        </figure>
    }
}

/// How large a figure is drawn in a row of some width: letters keep their size on a telephone.
fn size(row: i32, tall: Tall) -> [u32; 2] {
    const NARROW: i32 = 700;
    let (width, low, square) = if row < NARROW {
        ((row - 8).clamp(280, 520), 230, 340)
    } else {
        (row / 2 - 8, 300, 420)
    };
    let height = match tall {
        Tall::Low => low,
        Tall::Square => square,
    };
    [width.clamp(280, 760) as u32, height]
}

fn why_none(why: &PlotError) -> String {
    match why {
        PlotError::Nothing => {
            "There is nothing to plot: there are no such points, or all values are nothing, as the ray \
             distances of a line laser are."
                .to_owned()
        }
        PlotError::Room(words) => format!("It cannot be drawn: {words}."),
    }
}

/// The drawing, what the pointer is at, and rings around the chosen view's values.
#[component]
fn Sheet(drawing: Arc<Drawn>, pointed: RwSignal<Option<usize>>) -> impl IntoView {
    let workbench = Workbench::get();
    let sheet = NodeRef::<html::Div>::new();
    let [width, height] = drawing.size;
    let (svg, title) = (drawing.svg.clone(), drawing.title.clone());
    let drawn = StoredValue::new(drawing);
    let at_pointer = move |event: &MouseEvent| {
        let sheet: Element = sheet.get_untracked()?.unchecked_into();
        let area = sheet.get_bounding_client_rect();
        let scale = width as f32 / (area.width() as f32).max(1.0);
        let place = [
            (event.client_x() as f32 - area.x() as f32) * scale,
            (event.client_y() as f32 - area.y() as f32) * scale,
        ];
        drawn.with_value(|drawn| nearest(&drawn.marks, place))
    };
    let choose = move || {
        let view = pointed
            .get_untracked()
            .and_then(|at| drawn.with_value(|drawn| drawn.marks.get(at)?.view));
        if view.is_some() {
            workbench.choose(view);
        }
    };
    let keys = move |event: KeyboardEvent| {
        let step = match event.key().as_str() {
            "ArrowRight" | "ArrowDown" => 1,
            "ArrowLeft" | "ArrowUp" => -1,
            "Enter" | " " => {
                event.prevent_default();
                return choose();
            }
            _ => return,
        };
        event.prevent_default();
        let count = drawn.with_value(|drawn| drawn.marks.len());
        pointed.update(|at| *at = stepped(*at, step, count));
    };
    let rings = move || {
        let chosen = workbench.chosen.get();
        drawn.with_value(|drawn| {
            let of_view = drawn
                .marks
                .iter()
                .filter(|m| m.view.is_some() && m.view == chosen);
            // A line's hundreds of points are marked one beside the other.
            const MANY: usize = 8;
            let of_view: Vec<&MarkAt> = of_view.collect();
            let radius = if of_view.len() > MANY { "2.5" } else { "6" };
            let ring = |mark: &&MarkAt| {
                view! { <circle class="chosen" cx=mark.at[0] cy=mark.at[1] r=radius /> }
            };
            of_view.iter().map(ring).collect_view()
        })
    };
    let pointer = move || {
        let at = pointed.get()?;
        drawn.with_value(|drawn| {
            let mark = drawn.marks.get(at)?;
            Some(view! { <circle class="pointed" cx=mark.at[0] cy=mark.at[1] r="7" /> })
        })
    };
    let told = move || {
        let at = pointed.get();
        let words =
            at.and_then(|at| drawn.with_value(|drawn| Some(drawn.words_of(at)?.to_owned())));
        words.unwrap_or_else(|| "Point at a value, or use the arrow keys.".to_owned())
    };
    view! {
        <div
            class="plot-sheet"
            node_ref=sheet
            tabindex="0"
            role="group"
            aria-label=format!("{title}. Arrow keys go from value to value, Enter chooses its view.")
            on:mousemove=move |event| pointed.set(at_pointer(&event))
            on:mouseleave=move |_| pointed.set(None)
            on:click=move |event: ev::MouseEvent| {
                pointed.set(at_pointer(&event));
                choose();
            }
            on:keydown=keys
        >
            <div
                class="plot-drawing"
                style:aspect-ratio=format!("{width} / {height}")
                inner_html=svg
            ></div>
            <svg class="plot-marks" viewBox=format!("0 0 {width} {height}") aria-hidden="true">
                {rings}
                {pointer}
            </svg>
        </div>
        <p class="plot-value" role="status">
            {told}
        </p>
    }
}

/// The value that is nearest to a place, if one is near.
fn nearest(marks: &[MarkAt], [x, y]: [f32; 2]) -> Option<usize> {
    let distances = marks.iter().map(|mark| {
        let [dx, dy] = [mark.at[0] - x, mark.at[1] - y];
        dx * dx + dy * dy
    });
    let near = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (near.1 <= REACH * REACH).then_some(near.0)
}

/// The next value, or the one before; the first, if there is none yet.
fn stepped(at: Option<usize>, step: isize, count: usize) -> Option<usize> {
    let last = count.checked_sub(1)?;
    Some(match at {
        Some(at) => at.saturating_add_signed(step).min(last),
        None => 0,
    })
}

/// The figure as files.
#[component]
fn Files(figure: Shown, answer: RwSignal<Option<Answer>>) -> impl IntoView {
    let workbench = Workbench::get();
    let save = move |text: &str, name: &str, kind: &str| {
        if let Err(error) = save_text(text, name, kind) {
            workbench.fail(Problem::own(format!(
                "The browser does not save: {error:?}"
            )));
        }
    };
    let svg_name = format!("{}.svg", figure.name);
    let csv_name = format!("{}.csv", figure.name);
    let (svg_id, csv_id) = (format!("save-{svg_name}"), format!("save-{csv_name}"));
    let (svg_label, csv_label) = (format!("Save {svg_name}"), format!("Save {csv_name}"));
    let save_drawing = move |_| {
        answer.with_untracked(|answer| {
            if let Some(Ok(drawing)) = answer {
                save(&drawing.svg, &svg_name, "image/svg+xml");
            }
        });
    };
    let save_table = move |_| {
        let csv_name = csv_name.clone();
        spawn_local(async move {
            match workbench.figure(figure.of, FigureForm::Table).await {
                Ok(Figured::Table(table)) => save(&table, &csv_name, "text/csv"),
                Ok(_) => {}
                Err(problem) => workbench.fail(problem),
            }
        });
    };
    let missing = move || answer.with(|answer| !matches!(answer, Some(Ok(_))));
    view! {
        <div class="plot-files">
            <button
                type="button"
                class="chip"
                data-testid=svg_id
                aria-label=svg_label
                disabled=missing
                on:click=save_drawing
            >
                "SVG"
            </button>
            <button
                type="button"
                class="chip"
                data-testid=csv_id
                aria-label=csv_label
                disabled=missing
                on:click=save_table
            >
                "CSV"
            </button>
        </div>
    }
}
