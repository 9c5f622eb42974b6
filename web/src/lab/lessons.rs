//! The lessons: their list, the one under way, and the check of an answer.

use leptos::prelude::*;
use snellius::lab::{Answer, Bench, LESSONS, Lesson, Reply, View, link};

use super::state::LabState;

fn address(place: usize) -> String {
    let bench = Lesson::bench(place).unwrap_or_default();
    format!("#{}", link::write(&bench))
}

/// All lessons, each a link to its bench.
#[component]
pub(super) fn List() -> impl IntoView {
    let lessons = LESSONS.iter().enumerate().map(|(place, lesson)| {
        view! {
            <li>
                <a class="lesson-card" href=address(place) data-testid=format!("lesson-{}", place + 1)>
                    <span class="lesson-number">{place + 1}</span>
                    <span class="lesson-title">{lesson.title}</span>
                    <span class="lesson-text">{lesson.question}</span>
                </a>
            </li>
        }
    });
    let sheet = Bench {
        view: View::Sheet,
        ..Bench::default()
    };
    view! {
        <section class="lessons" aria-labelledby="lessons-title">
            <h2 id="lessons-title">"Lessons: one idea, one question, one thing to do"</h2>
            <ol>{lessons.collect_view()}</ol>
            <p>
                <a href=format!("#{}", link::write(&sheet)) data-testid="open-sheet">
                    "Teacher's sheet"
                </a> ": all lessons with their links and answers, to be printed."
            </p>
        </section>
    }
}

/// The lesson under way, above the bench it is about.
#[component]
pub(super) fn Banner() -> impl IntoView {
    let lab = LabState::get();
    let under_way = Memo::new(move |_| {
        let (lesson, view) = lab.bench.with(|bench| (bench.lesson, bench.view));
        lesson.filter(|_| !matches!(view, View::Lessons | View::Sheet))
    });
    move || under_way.get().map(|place| view! { <UnderWay place /> })
}

#[component]
fn UnderWay(place: usize) -> impl IntoView {
    let lab = LabState::get();
    let lesson = &LESSONS[place];
    let next = (place + 1 < LESSONS.len()).then(|| {
        view! {
            <a href=address(place + 1) data-testid="next-lesson">
                "Next lesson"
            </a>
        }
    });
    let all = move || {
        let bench = Bench {
            view: View::Lessons,
            lesson: None,
            ..lab.bench.get()
        };
        format!("#{}", link::write(&bench))
    };
    view! {
        <section class="lesson panel" aria-labelledby="lesson-title" data-testid="lesson">
            <div class="panel-head">
                <h2 id="lesson-title" data-testid="lesson-title">
                    {format!("Lesson {}: {}", place + 1, lesson.title)}
                </h2>
                <div class="lesson-ways">
                    <a href=all>"All lessons"</a>
                    {next}
                    <button
                        type="button"
                        class="quiet"
                        on:click=move |_| lab.change(|bench| bench.lesson = None)
                    >
                        "Leave the lesson"
                    </button>
                </div>
            </div>
            <div class="lesson-parts">
                <p>
                    <strong>"The idea. "</strong>
                    {lesson.idea}
                </p>
                <p>
                    <strong>"To do. "</strong>
                    {lesson.task}
                </p>
                <Question lesson />
            </div>
        </section>
    }
}

#[component]
fn Question(lesson: &'static Lesson) -> impl IntoView {
    let answer = RwSignal::new(String::new());
    let reply = RwSignal::new(None::<Reply>);
    let check = move || reply.set(Some(lesson.judge(&answer.get_untracked())));
    let input = match lesson.answer {
        Answer::Number { unit, .. } => view! {
            <span class="answer-number">
                <input
                    type="text"
                    inputmode="decimal"
                    autocomplete="off"
                    aria-label="Your answer"
                    data-testid="answer"
                    prop:value=move || answer.get()
                    on:input=move |event| {
                        answer.set(event_target_value(&event));
                        reply.set(None);
                    }
                />
                <span class="unit">{unit}</span>
            </span>
        }
        .into_any(),
        Answer::Choice { options, .. } => {
            let options = options.iter().enumerate().map(|(place, option)| {
                view! {
                    <label class="option">
                        <input
                            type="radio"
                            name="answer"
                            data-testid=format!("option-{place}")
                            on:change=move |_| {
                                answer.set(place.to_string());
                                reply.set(None);
                            }
                        />
                        {*option}
                    </label>
                }
            });
            view! { <span class="options">{options.collect_view()}</span> }.into_any()
        }
    };
    let said = move || {
        reply.get().map(|reply| match reply {
            Reply::Right => format!("Right. {}", lesson.because),
            Reply::Wrong => "Not yet. Look at the bench again.".to_owned(),
            Reply::Unreadable => "Give a number, or choose one of the answers.".to_owned(),
        })
    };
    view! {
        <form
            class="question"
            on:submit=move |event| {
                event.prevent_default();
                check();
            }
        >
            <p>
                <strong>"The question. "</strong>
                {lesson.question}
            </p>
            {input}
            <button type="submit" class="primary" data-testid="check-answer">
                "Check"
            </button>
            <p
                class="reply"
                class:right=move || reply.get() == Some(Reply::Right)
                role="status"
                data-testid="reply"
            >
                {said}
            </p>
        </form>
    }
}

/// Whoever has found out a mystery liquid's index can have it checked.
#[component]
pub(super) fn MysteryCheck() -> impl IntoView {
    const WITHIN: f64 = 0.01;
    let lab = LabState::get();
    let answer = RwSignal::new(String::new());
    let said = RwSignal::new(String::new());
    let mystery = Memo::new(move |_| {
        let liquid = lab.bench.with(|bench| bench.liquid);
        liquid.is_mystery().then_some(liquid)
    });
    Effect::new(move |_| {
        mystery.track();
        said.set(String::new());
    });
    let check = move || {
        let Some(liquid) = mystery.get_untracked() else {
            return;
        };
        let text = answer.get_untracked().trim().replace(',', ".");
        said.set(match text.parse::<f64>() {
            Ok(given) if (given - liquid.index()).abs() <= WITHIN => {
                format!("Right: the index is {:.3}.", liquid.index())
            }
            Ok(_) => "Not yet: it is more than 0.01 off.".to_owned(),
            Err(_) => "Give a number, such as 1.42.".to_owned(),
        });
    };
    view! {
        <Show when=move || mystery.with(Option::is_some)>
            <form
                class="mystery"
                on:submit=move |event| {
                    event.prevent_default();
                    check();
                }
            >
                <label for="mystery-answer">
                    "What is the index of the mystery liquid?"
                </label>
                <input
                    id="mystery-answer"
                    type="text"
                    inputmode="decimal"
                    autocomplete="off"
                    data-testid="mystery-answer"
                    prop:value=move || answer.get()
                    on:input=move |event| answer.set(event_target_value(&event))
                />
                <button type="submit" data-testid="mystery-check">
                    "Check"
                </button>
                <p class="reply" role="status" data-testid="mystery-reply">
                    {move || said.get()}
                </p>
            </form>
        </Show>
    }
}
