//! The table of views: choose one with the mouse or the arrow keys, sort by a click on a heading.

use std::cmp::Ordering;
use std::ops::Range;
use std::sync::Arc;

use leptos::html;
use leptos::prelude::*;
use snellius::export::Status;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, KeyboardEvent};

use crate::in_sight::{Sight, letter};
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

/// How high a row is, in the page's letters; `result.css` says the same.
const ROW: f64 = 2.0;
/// How much of the frame the heading covers, CSS px.
const HEAD: i32 = 34;

/// The table of views. Only rows in sight are made.
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
    let count = Memo::new(move |_| rows.with(Vec::len));
    let sight = Sight::new((ROW * letter()).round() as i32);
    let made = Memo::new(move |_| sight.parts(count.get()));
    let stop = Memo::new(move |_| stop(workbench, rows, made.get()));
    let wanted = StoredValue::new(None::<usize>);
    keep_chosen_in_sight(workbench, rows, sight);
    view! {
        <section class="views panel" aria-labelledby="views-title">
            <h2 id="views-title">"Views"</h2>
            <div class="table-frame" node_ref=sight.frame on:scroll=move |_| sight.look()>
                <div
                    class="table-length"
                    style:min-height=move || format!("calc({} + {HEAD}px)", sight.length(count.get()))
                    style:padding-top=move || sight.length(made.get().start)
                >
                    <table
                        role="grid"
                        data-testid="views-table"
                        aria-labelledby="views-title"
                        aria-rowcount=move || (count.get() + 1).to_string()
                        on:keydown=move |event| {
                            if let Some(view) = rows.with_untracked(|rows| move_choice(rows, &event)) {
                                wanted.set_value(Some(view));
                                workbench.choose(Some(view));
                                focus(view);
                            }
                        }
                    >
                        <colgroup>
                            {COLUMNS
                                .map(|(column, ..)| view! { <col class=width(column) /> })
                                .collect_view()}
                        </colgroup>
                        <thead>
                            <tr aria-rowindex="1">
                                {COLUMNS.map(|column| heading(column, order)).collect_view()}
                            </tr>
                        </thead>
                        <tbody>
                            <For each=move || shown(workbench, rows, made.get()) key=Shown::key let:row>
                                <Row row stop wanted />
                            </For>
                        </tbody>
                    </table>
                </div>
            </div>
        </section>
    }
}

const fn width(column: Column) -> &'static str {
    match column {
        Column::View => "wide",
        Column::Status => "rest",
        _ => "number",
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
        Column::Sweep | Column::Object(_) | Column::Sigma | Column::RayDistance
    )
}

/// A row in sight.
#[derive(Clone)]
struct Shown {
    /// Which row it is.
    position: usize,
    view: usize,
    facts: Arc<Facts>,
    outcome: Arc<Outcome>,
}

impl Shown {
    /// What it shows is the same as long as this is.
    fn key(&self) -> (usize, usize, *const Outcome) {
        (self.position, self.view, Arc::as_ptr(&self.outcome))
    }
}

fn shown(workbench: Workbench, rows: Memo<Vec<usize>>, made: Range<usize>) -> Vec<Shown> {
    let Some((facts, outcome)) = workbench.facts.get().zip(workbench.outcome.get()) else {
        return Vec::new();
    };
    let row = |position: usize, view: usize| Shown {
        position,
        view,
        facts: Arc::clone(&facts),
        outcome: Arc::clone(&outcome),
    };
    rows.with(|rows| {
        let made = made.filter_map(|position| Some(row(position, *rows.get(position)?)));
        made.filter(|row| row.view < row.facts.stations.len())
            .collect()
    })
}

/// Tab stops at the chosen view's row, or at the first that there is.
fn stop(workbench: Workbench, rows: Memo<Vec<usize>>, made: Range<usize>) -> Option<usize> {
    let chosen = workbench.chosen.get();
    rows.with(|rows| {
        let made = rows.get(made)?;
        chosen
            .filter(|chosen| made.contains(chosen))
            .or_else(|| made.first().copied())
    })
}

#[component]
fn Row(
    row: Shown,
    /// The view whose row Tab stops at.
    stop: Memo<Option<usize>>,
    /// The row of this view takes the focus when it is made.
    wanted: StoredValue<Option<usize>>,
) -> impl IntoView {
    let workbench = Workbench::get();
    let Shown {
        position,
        view,
        facts,
        outcome,
    } = row;
    let measured = &outcome.views[view];
    let id = &facts.stations[view].id;
    let is_chosen = move || workbench.chosen.get() == Some(view);
    let element = NodeRef::<html::Tr>::new();
    Effect::new(move |_| {
        if let Some(element) = element.get()
            && wanted.get_value() == Some(view)
        {
            wanted.set_value(None);
            let _ = element.focus();
        }
    });
    let point = outcome.point_of(view);
    let object = |axis: usize| point.map(|point| fixed(point.place[axis].into(), 2));
    let cell = |text: Option<String>| view! { <td class="number">{text}</td> };
    let (word, class) = status(measured.status);
    let count = measured.points.len();
    view! {
        <tr
            node_ref=element
            id=row_id(view)
            data-testid=format!("view-row-{}", id)
            data-position=position.to_string()
            class=class
            aria-rowindex=(position + 2).to_string()
            aria-selected=move || is_chosen().to_string()
            tabindex=move || if stop.get() == Some(view) { "0" } else { "-1" }
            on:click=move |_| workbench.choose(Some(view))
        >
            <th scope="row">{id.clone()}</th>
            <td class="number">{facts.stations[view].sweep + 1}</td>
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

/// The view of the row that Up, Down, Page Up, Page Down, Home or End leads to.
fn move_choice(rows: &[usize], event: &KeyboardEvent) -> Option<usize> {
    const PAGE: usize = 10;
    let row: Element = event.target()?.dyn_into().ok()?;
    let at: usize = row.get_attribute("data-position")?.parse().ok()?;
    let last = rows.len().checked_sub(1)?;
    let to = match event.key().as_str() {
        "ArrowDown" => (at + 1).min(last),
        "ArrowUp" => at.saturating_sub(1),
        "PageDown" => (at + PAGE).min(last),
        "PageUp" => at.saturating_sub(PAGE),
        "Home" => 0,
        "End" => last,
        "Enter" | " " => at,
        _ => return None,
    };
    event.prevent_default();
    rows.get(to).copied()
}

/// A row that is not made yet takes the focus as soon as it is.
fn focus(view: usize) {
    if let Some(row) = row_element(view) {
        let _ = row.focus();
    }
}

/// A view that is chosen in the scene shows up in the table.
fn keep_chosen_in_sight(workbench: Workbench, rows: Memo<Vec<usize>>, sight: Sight) {
    Effect::new(move |_| {
        let Some(chosen) = workbench.chosen.get() else {
            return;
        };
        sight.frame.track();
        let position = |rows: &Vec<usize>| rows.iter().position(|view| *view == chosen);
        if let Some(position) = rows.with_untracked(position) {
            sight.reveal(position, HEAD);
        }
    });
}

fn row_id(view: usize) -> String {
    format!("view-{view}")
}

fn row_element(view: usize) -> Option<HtmlElement> {
    document().get_element_by_id(&row_id(view))?.dyn_into().ok()
}
