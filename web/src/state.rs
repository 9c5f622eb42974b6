//! The state of the workbench and what can be done with it. The screens only show it.

use std::rc::Rc;
use std::sync::Arc;

use futures::future::{AbortHandle, Aborted, abortable};
use leptos::prelude::*;
use snellius::pipeline::Settings;
use wasm_bindgen_futures::spawn_local;
use web_sys::Blob;

use crate::run::{
    Facts, FileKind, Hand, Outcome, PictureSet, Problem, ProblemKind, Progress, Run, run,
};

/// What the colours of the object's points mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColourBy {
    RayDistance,
    Sweep,
    Depth,
}

/// Which screen is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Screen {
    Start,
    Running,
    Result,
}

/// Everything the screens share. A handle: copies mean the same workbench.
#[derive(Clone, Copy)]
pub(crate) struct Workbench {
    /// The run under way.
    pub(crate) progress: RwSignal<Option<Progress>>,
    /// The name of the file under way.
    pub(crate) file_name: RwSignal<String>,
    /// What went wrong last.
    pub(crate) problem: RwSignal<Option<Problem>>,
    /// The scan that is shown.
    pub(crate) facts: RwSignal<Option<Arc<Facts>>>,
    /// What it gave; nothing yet if the liquid's index is wanted.
    pub(crate) outcome: RwSignal<Option<Arc<Outcome>>>,
    /// Why the index that was typed is not used.
    pub(crate) index_problem: RwSignal<Option<Problem>>,
    /// How it is measured.
    pub(crate) settings: RwSignal<Settings>,
    /// The view that is chosen, everywhere.
    pub(crate) chosen: RwSignal<Option<usize>>,
    /// The chosen view's pictures.
    pub(crate) pictures: RwSignal<Option<PictureSet>, LocalStorage>,
    /// What the colours mean.
    pub(crate) colour_by: RwSignal<ColourBy>,
    /// Whether the object is shown where it is, or where it would be without refraction.
    pub(crate) refraction: RwSignal<bool>,
    /// The start screen was asked for, though there is a result.
    at_start: RwSignal<bool>,
    hand: StoredValue<Option<Rc<Hand>>, LocalStorage>,
    cancel: StoredValue<Option<AbortHandle>>,
    remeasure: StoredValue<Remeasure>,
}

/// A newer index waits for the older one's answer, and only the newest.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Remeasure {
    Idle,
    Busy,
    BusyAndStale,
}

impl Workbench {
    pub(crate) fn new() -> Self {
        Self {
            progress: RwSignal::new(None),
            file_name: RwSignal::new(String::new()),
            problem: RwSignal::new(None),
            facts: RwSignal::new(None),
            outcome: RwSignal::new(None),
            index_problem: RwSignal::new(None),
            settings: RwSignal::new(Settings::default()),
            chosen: RwSignal::new(None),
            pictures: RwSignal::new_local(None),
            colour_by: RwSignal::new(ColourBy::RayDistance),
            refraction: RwSignal::new(true),
            at_start: RwSignal::new(false),
            hand: StoredValue::new_local(None),
            cancel: StoredValue::new(None),
            remeasure: StoredValue::new(Remeasure::Idle),
        }
    }

    /// The workbench of the page.
    pub(crate) fn get() -> Self {
        use_context().expect("the page provides its workbench before any screen is made")
    }

    /// Which screen is to be shown.
    pub(crate) fn screen(self) -> Screen {
        if self.progress.with(Option::is_some) {
            Screen::Running
        } else if self.has_result() && !self.at_start.get() {
            Screen::Result
        } else {
            Screen::Start
        }
    }

    /// Whether there is a scan to go back to.
    pub(crate) fn has_result(self) -> bool {
        self.facts.with(Option::is_some)
    }

    /// The state in a word, for style sheets and tests.
    pub(crate) fn word(self) -> &'static str {
        match self.screen() {
            Screen::Running => "running",
            _ if self.problem.with(Option::is_some) => "failed",
            Screen::Result => "done",
            Screen::Start => "start",
        }
    }

    /// Measures a file. What is shown stays until the new scan is measured.
    pub(crate) fn open(self, file: Blob, name: String) {
        self.cancel();
        self.problem.set(None);
        self.file_name.set(name);
        self.progress.set(Some(Progress::default()));
        let tell = move |progress| self.progress.set(Some(progress));
        let (running, handle) = abortable(run(file, Settings::default(), tell));
        self.cancel.set_value(Some(handle));
        spawn_local(async move {
            match running.await {
                Ok(Ok(run)) => self.show(run),
                Ok(Err(problem)) => self.fail(problem),
                // Whoever cancelled has put the page in order.
                Err(Aborted) => {}
            }
        });
    }

    /// Gives up the run under way.
    pub(crate) fn cancel(self) {
        if let Some(handle) = self.cancel.try_update_value(Option::take).flatten() {
            handle.abort();
        }
        self.progress.set(None);
    }

    /// Says what went wrong.
    pub(crate) fn fail(self, problem: Problem) {
        self.progress.set(None);
        self.problem.set(Some(problem));
    }

    /// Back to the start screen; the result is kept.
    pub(crate) fn go_to_start(self) {
        self.problem.set(None);
        self.at_start.set(true);
    }

    /// Back to the result.
    pub(crate) fn go_to_result(self) {
        self.problem.set(None);
        self.at_start.set(false);
    }

    fn show(self, run: Run) {
        let outcome = match run.outcome {
            Ok(outcome) => Some(Arc::new(outcome)),
            Err(problem) if problem.kind == ProblemKind::IndexWanted => None,
            Err(problem) => return self.fail(problem),
        };
        self.hand.set_value(Some(Rc::new(run.hand)));
        self.settings.set(Settings::default());
        self.index_problem.set(None);
        self.pictures.set(None);
        self.chosen.set(None);
        self.facts.set(Some(Arc::new(run.facts)));
        self.outcome.set(outcome);
        self.at_start.set(false);
        self.progress.set(None);
        self.choose_first();
    }

    /// The view in the middle of the scan that has an object point: there is something to see at once.
    fn choose_first(self) {
        let view = self.outcome.with_untracked(|outcome| {
            let views = &outcome.as_ref()?.views;
            let good = |view: &usize| views[*view].result.object.first().is_some();
            let middle = views.len() / 2;
            (middle..views.len())
                .find(good)
                .or_else(|| (0..middle).rev().find(good))
        });
        self.choose(view);
    }

    /// Chooses a view, everywhere, and fetches its pictures.
    pub(crate) fn choose(self, view: Option<usize>) {
        if self.chosen.get_untracked() == view {
            return;
        }
        self.chosen.set(view);
        let (Some(view), Some(hand)) = (view, self.hand.get_value()) else {
            self.pictures.set(None);
            return;
        };
        spawn_local(async move {
            let pictures = hand.pictures(view).await;
            if !self.is_current(&hand) || self.chosen.get_untracked() != Some(view) {
                return;
            }
            match pictures {
                Ok(pictures) => self.pictures.set(Some(pictures)),
                Err(problem) => self.fail(problem),
            }
        });
    }

    /// Sets the liquid's index (`None`: the manifest's) and measures again, live.
    pub(crate) fn set_index(self, index: Option<f64>) {
        self.settings.update(|settings| settings.index = index);
        match self.remeasure.get_value() {
            Remeasure::Idle => spawn_local(self.measure_again()),
            _ => self.remeasure.set_value(Remeasure::BusyAndStale),
        }
    }

    async fn measure_again(self) {
        loop {
            self.remeasure.set_value(Remeasure::Busy);
            let Some(hand) = self.hand.get_value() else {
                break;
            };
            let outcome = hand.measure(self.settings.get_untracked()).await;
            if self.is_current(&hand) {
                self.take_measured(outcome);
            }
            if self.remeasure.get_value() == Remeasure::Busy {
                break;
            }
        }
        self.remeasure.set_value(Remeasure::Idle);
    }

    fn take_measured(self, outcome: Result<Outcome, Problem>) {
        match outcome {
            Ok(outcome) => {
                self.index_problem.set(None);
                self.outcome.set(Some(Arc::new(outcome)));
                if self.chosen.get_untracked().is_none() {
                    self.choose_first();
                }
            }
            Err(problem) if problem.kind == ProblemKind::Own => self.fail(problem),
            Err(problem) => self.index_problem.set(Some(problem)),
        }
    }

    /// Writes a file from the result that is shown.
    pub(crate) async fn write(self, kind: FileKind) -> Result<String, Problem> {
        let hand = self.hand.get_value();
        let hand = hand.ok_or_else(|| Problem::own("There is no result to save."))?;
        if self.remeasure.get_value() != Remeasure::Idle {
            // An index that was typed just now is still to be measured: the file shall have it.
            let _ = hand.measure(self.settings.get_untracked()).await;
        }
        hand.write(kind).await
    }

    fn is_current(self, hand: &Rc<Hand>) -> bool {
        self.hand.with_value(|current| {
            current
                .as_ref()
                .is_some_and(|current| Rc::ptr_eq(current, hand))
        })
    }
}
