//! The table of views: choose one with the mouse or the arrow keys, sort by a click on a heading.

use std::cmp::Ordering;
use std::sync::Arc;

use leptos::prelude::*;
use snellius::export::Status;
use wasm_bindgen::JsCast;
use web_sys::{HtmlElement, KeyboardEvent};

use crate::number::fixed;
use crate::run::{Facts, ObjectPoint, Outcome};
use crate::state::Workbench;

/// What the rows are sorted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    View,
    Sweep,
    Status,
    Object(usize),
    Sigma,
    RayDistance,
}

const COLUMNS: [(Column, &str, &str); 8] = [
    (Column::View, "View", "The view's id"),
    (Column::Sweep, "Scan", "The row of stations it belongs to"),
    (Column::Status, "Status", "What became of it"),
    (Column::Object(0), "x", "Object point, mm"),
    (Column::Object(1), "y", "Object point, mm"),
    (Column::Object(2), "z", "Object point, mm"),
    (
        Column::Sigma,
        "\u{b1}",
        "One standard deviation from noise, all axes together, mm",
    ),
    (
        Column::RayDistance,
        "Ray dist.",
        "How far the two light paths pass each other, mm",
    ),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Order {
    column: Column,
    descending: bool,
}

/// The table of views.
#[component]
pub(crate) fn ViewsTable() -> impl IntoView {
    let workbench = Workbench::get();
    let order = RwSignal::new(Order {
        column: Column::View,
        descending: false,
    });
    let rows = Memo::new(move |_| {
        let (Some(facts), Some(outcome)) = (workbench.facts.get(), workbench.outcome.get()) else {
            return Vec::new();
        };
        sorted(&facts, &outcome, order.get())
    });
    keep_chosen_in_sight(workbench);
    view! {
        <section class="views panel" aria-labelledby="views-title">
            <h2 id="views-title">"Views"</h2>
            <div class="table-frame">
                <table
                    role="grid"
                    data-testid="views-table"
                    aria-labelledby="views-title"
                    on:keydown=move |event| move_choice(workbench, &rows.get_untracked(), &event)
                >
                    <thead>
                        <tr>{COLUMNS.map(|column| heading(column, order)).collect_view()}</tr>
                    </thead>
                    <tbody>{move || body(workbench, rows.get())}</tbody>
                </table>
            </div>
        </section>
    }
}

fn heading(
    (column, name, meaning): (Column, &'static str, &'static str),
    order: RwSignal<Order>,
) -> impl IntoView {
    let here = move || Some(order.get()).filter(|order| order.column == column);
    let state = move || match here() {
        Some(order) if order.descending => "descending",
        Some(_) => "ascending",
        None => "none",
    };
    let sort = move |_| {
        order.update(|order| {
            *order = Order {
                column,
                descending: order.column == column && !order.descending,
            };
        });
    };
    view! {
        <th scope="col" aria-sort=state class:number=is_number(column)>
            <button type="button" title=meaning on:click=sort>
                {name}
            </button>
        </th>
    }
}

const fn is_number(column: Column) -> bool {
    matches!(
        column,
        Column::Object(_) | Column::Sigma | Column::RayDistance
    )
}

fn body(workbench: Workbench, rows: Vec<usize>) -> impl IntoView {
    // The numbers may change and the order stay the same, so the rows follow the outcome themselves.
    let Some((facts, outcome)) = workbench.facts.get().zip(workbench.outcome.get()) else {
        return ().into_any();
    };
    let first = rows.first().copied();
    rows.into_iter()
        .map(|view| row(workbench, &facts, &outcome, view, first))
        .collect_view()
        .into_any()
}

fn row(
    workbench: Workbench,
    facts: &Arc<Facts>,
    outcome: &Arc<Outcome>,
    view: usize,
    first: Option<usize>,
) -> impl IntoView + use<> {
    let measured = &outcome.views[view];
    let id = &facts.stations[view].id;
    let is_chosen = move || workbench.chosen.get() == Some(view);
    // Tab stops at the chosen row, or at the first.
    let stop = move || match workbench.chosen.get() {
        Some(chosen) => chosen == view,
        None => first == Some(view),
    };
    let point = outcome.point_of(view);
    let object = |axis: usize| point.map(|point| fixed(point.place[axis].into(), 2));
    let cell = |text: Option<String>| view! { <td class="number">{text}</td> };
    let (word, class) = status(measured.status);
    let count = measured.points.len();
    view! {
        <tr
            id=row_id(view)
            data-testid=format!("view-row-{}", id)
            class=class
            aria-selected=move || is_chosen().to_string()
            tabindex=move || if stop() { "0" } else { "-1" }
            on:click=move |_| workbench.choose(Some(view))
        >
            <th scope="row">{id.clone()}</th>
            <td>{facts.stations[view].sweep + 1}</td>
            <td class="state" title=measured.reason.clone()>
                <span class="dot" aria-hidden="true"></span>
                {word}
                {(count > 1).then(|| view! { <span class="reason">{format!("{count} points")}</span> })}
                {measured.reason.clone().map(|reason| view! { <span class="reason">{reason}</span> })}
            </td>
            {[0, 1, 2].map(|axis| cell(object(axis))).collect_view()}
            {cell(point.map(|point| fixed(point.sigma().into(), 3)))}
            {cell(point.map(|point| fixed(point.ray_distance.into(), 3)))}
        </tr>
    }
}

const fn status(status: Status) -> (&'static str, &'static str) {
    match status {
        Status::Ok => ("ok", "ok"),
        Status::NoVesselSpot => ("no wall spot", "lacking"),
        Status::NoObjectSpot => ("no object spot", "lacking"),
        Status::Rejected => ("refused", "refused"),
    }
}

fn sorted(facts: &Facts, outcome: &Outcome, order: Order) -> Vec<usize> {
    let mut rows: Vec<usize> = (0..outcome.views.len()).collect();
    let compare = |a: &usize, b: &usize| {
        let (one, other) = (&outcome.views[*a], &outcome.views[*b]);
        let by = |value: fn(&ObjectPoint) -> f32| {
            let of = |view: usize| outcome.point_of(view).map(value);
            numbers(of(*a), of(*b), order)
        };
        let turned = |ordering: Ordering| {
            if order.descending {
                ordering.reverse()
            } else {
                ordering
            }
        };
        match order.column {
            Column::View => turned(a.cmp(b)),
            Column::Sweep => turned(facts.stations[*a].sweep.cmp(&facts.stations[*b].sweep)),
            Column::Status => turned(status(one.status).cmp(&status(other.status))),
            Column::Object(0) => by(|point| point.place[0]),
            Column::Object(1) => by(|point| point.place[1]),
            Column::Object(_) => by(|point| point.place[2]),
            Column::Sigma => by(ObjectPoint::sigma),
            Column::RayDistance => by(|point| point.ray_distance),
        }
    };
    rows.sort_by(compare);
    rows
}

/// Views without a value come last, whichever way the others run.
fn numbers(one: Option<f32>, other: Option<f32>, order: Order) -> Ordering {
    match (one, other) {
        (Some(one), Some(other)) if order.descending => other.total_cmp(&one),
        (Some(one), Some(other)) => one.total_cmp(&other),
        (one, other) => other.is_some().cmp(&one.is_some()),
    }
}

/// Up, down, page up, page down, Home and End.
fn move_choice(workbench: Workbench, rows: &[usize], event: &KeyboardEvent) {
    const PAGE: usize = 10;
    let on_row = event.target().is_some_and(|target| {
        target
            .dyn_ref::<web_sys::Element>()
            .is_some_and(|e| e.tag_name() == "TR")
    });
    let Some(last) = rows.len().checked_sub(1).filter(|_| on_row) else {
        return;
    };
    let chosen = workbench.chosen.get_untracked();
    let at = rows
        .iter()
        .position(|view| Some(*view) == chosen)
        .unwrap_or(0);
    let to = match event.key().as_str() {
        "ArrowDown" => (at + 1).min(last),
        "ArrowUp" => at.saturating_sub(1),
        "PageDown" => (at + PAGE).min(last),
        "PageUp" => at.saturating_sub(PAGE),
        "Home" => 0,
        "End" => last,
        "Enter" | " " => at,
        _ => return,
    };
    event.prevent_default();
    workbench.choose(Some(rows[to]));
    if let Some(row) = row_element(rows[to]) {
        let _ = row.focus();
    }
}

/// A view that is chosen in the scene shows up in the table.
fn keep_chosen_in_sight(workbench: Workbench) {
    Effect::new(move |_| {
        let row = workbench.chosen.get().and_then(row_element);
        if let Some((row, frame)) = row.and_then(|row| {
            let frame = row.closest(".table-frame").ok().flatten()?;
            Some((row, frame))
        }) {
            scroll_within(&frame.unchecked_into(), &row);
        }
    });
}

/// Scrolls the frame, and never the page.
fn scroll_within(frame: &HtmlElement, row: &HtmlElement) {
    const HEAD: i32 = 34;
    let (top, bottom) = (
        row.offset_top() - HEAD,
        row.offset_top() + row.offset_height(),
    );
    if top < frame.scroll_top() {
        frame.set_scroll_top(top);
    } else if bottom > frame.scroll_top() + frame.client_height() {
        frame.set_scroll_top(bottom - frame.client_height());
    }
}

fn row_id(view: usize) -> String {
    format!("view-{view}")
}

fn row_element(view: usize) -> Option<HtmlElement> {
    document().get_element_by_id(&row_id(view))?.dyn_into().ok()
}
