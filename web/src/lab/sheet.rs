//! The teacher's sheet: every lesson with its link and answer, and every parameter of links.

use leptos::prelude::*;
use snellius::lab::{Answer, CHOICES, LESSONS, Lesson, MEDIA, QUANTITIES, SUBSTANCES, link};

use super::state::page_address;

/// The sheet, to be printed.
#[component]
pub(super) fn Sheet() -> impl IntoView {
    view! {
        <article class="sheet" data-testid="sheet">
            <div class="sheet-head">
                <h2>"Refraction lab: teacher's sheet"</h2>
                <button type="button" class="primary no-print" on:click=move |_| print()>
                    "Print"
                </button>
            </div>
            <p>
                "Each link opens the lab in the state that the lesson needs. Nothing is installed and nothing is \
                 sent anywhere: the lab runs in the pupils' browsers. Put "
                <code>"?embed"</code> " before the " <code>"#"</code>
                " of any link to show the bench alone within a page of your own."
            </p>
            {LESSONS.iter().enumerate().map(lesson).collect_view()}
            <h3>"What a link may say"</h3>
            <p>
                "A link is " <code>"#lab/1?"</code> " and " <code>"key=value"</code> ", joined by "
                <code>"&"</code>
                ". What is left out is as at first. Lengths are millimetres: x to the right, z into the vessel, z = \
                 0 at the wall's front. Angles are degrees."
            </p>
            <Parameters />
            <h3>"Refractive indices (20 \u{b0}C, 635 nm)"</h3>
            <table class="parameters">
                <tbody>
                    {SUBSTANCES
                        .map(|substance| {
                            view! {
                                <tr>
                                    <th scope="row">{substance.name}</th>
                                    <td class="number">{format!("{:.4}", substance.index)}</td>
                                    <td>
                                        <code>{substance.key}</code>
                                    </td>
                                    <td class="source">{substance.source}</td>
                                </tr>
                            }
                        })
                        .collect_view()}
                </tbody>
            </table>
        </article>
    }
}

fn lesson((place, lesson): (usize, &'static Lesson)) -> impl IntoView {
    let bench = Lesson::bench(place).unwrap_or_default();
    let parameters = link::parameters(&bench)
        .into_iter()
        .map(|(key, value)| format!("{key}={value}"))
        .collect::<Vec<_>>()
        .join("  ");
    let fragment = link::write(&bench);
    let answer = match lesson.answer {
        Answer::Number {
            value,
            within,
            unit,
        } => format!("{value} {unit} (to {within})"),
        Answer::Choice { options, right } => options[right].to_owned(),
    };
    view! {
        <section class="sheet-lesson">
            <h3>{format!("{}. {}", place + 1, lesson.title)}</h3>
            <p>{lesson.idea}</p>
            <p>
                <strong>"To do: "</strong>
                {lesson.task}
            </p>
            <p>
                <strong>"Question: "</strong>
                {lesson.question}
            </p>
            <p>
                <strong>"Answer: "</strong>
                {answer}
                ". "
                {lesson.because}
            </p>
            <p class="sheet-link">
                <a href=format!("#{fragment}")>{page_address(&fragment)}</a>
            </p>
            <p class="sheet-parameters">
                <code>{parameters}</code>
            </p>
        </section>
    }
}

#[component]
fn Parameters() -> impl IntoView {
    let words = |words: Vec<&str>| words.join(", ");
    let choices = CHOICES.iter().map(|choice| {
        let options = words(choice.options.iter().map(|option| option.0).collect());
        (choice.key, choice.name, options)
    });
    let media = MEDIA.iter().map(|role| {
        let hidden = if role.may_be_hidden {
            ", or mystery1 to mystery5"
        } else {
            ""
        };
        (
            role.key,
            role.name,
            format!("a substance of the list below, or an index from 0.9 to 2.5{hidden}"),
        )
    });
    let quantities = QUANTITIES.iter().map(|quantity| {
        let range = format!("{} to {} {}", quantity.low, quantity.high, quantity.unit);
        let range = range.replace('-', "\u{2212}");
        (quantity.key, quantity.name, range)
    });
    let rows = choices
        .chain(media)
        .chain(quantities)
        .map(|(key, name, values)| {
            view! {
                <tr>
                    <th scope="row">
                        <code>{key}</code>
                    </th>
                    <td>{name}</td>
                    <td>{values}</td>
                </tr>
            }
        });
    view! {
        <table class="parameters">
            <tbody>{rows.collect_view()}</tbody>
        </table>
    }
}

fn print() {
    // Some embedded browsers know no printing; then nothing happens.
    let _ = window().print();
}
