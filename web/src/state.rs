//! The state of the workbench and what can be done with it. The screens only show it.

use std::pin::pin;
use std::rc::Rc;
use std::sync::Arc;

use futures::future::{AbortHandle, Aborted, Either, abortable, select};
use leptos::prelude::*;
use snellius::pipeline::{Settings, Stage};
use wasm_bindgen_futures::spawn_local;
use web_sys::Blob;

use crate::history::History;
use crate::run::{
    Facts, FileKind, Lab, Outcome, PictureSet, Problem, ProblemKind, Progress, sleep,
};

/// What the colours in the scene mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColourBy {
    RayDistance,
    Sigma,
    Depth,
    Sweep,
    /// The wall's points by how far they lie off it.
    Residual,
}

/// Which screen is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Screen {
    Start,
    Running,
    Result,
}

/// How it stands with a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StageState {
    Waiting,
    Running,
    Done,
    Warning,
    Failed,
}

/// Where the scene is looked at from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    Front,
    Side,
    Above,
}

/// What the scene is told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SceneCommand {
    /// Wall and object shall fill the picture.
    Fit,
    /// The rig's stations shall be in the picture too.
    FitAll,
    /// Turn the camera.
    Look(Look),
}

/// Changed settings that are being measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rerun {
    /// The stage that is at work; those after it wait.
    pub(crate) stage: Stage,
    pub(crate) progress: Progress,
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
    /// What it gave last; nothing yet if something is wanted first.
    pub(crate) outcome: RwSignal<Option<Arc<Outcome>>>,
    /// Why the settings give nothing; the outcome is then that of earlier ones.
    pub(crate) stage_problem: RwSignal<Option<Problem>>,
    /// How it is measured.
    pub(crate) settings: RwSignal<Settings>,
    /// Changed settings that are being measured.
    pub(crate) rerun: RwSignal<Option<Rerun>>,
    /// The settings before these.
    pub(crate) history: RwSignal<History>,
    /// The view that is chosen, everywhere.
    pub(crate) chosen: RwSignal<Option<usize>>,
    /// The chosen view's pictures.
    pub(crate) pictures: RwSignal<Option<PictureSet>, LocalStorage>,
    /// What the colours mean.
    pub(crate) colour_by: RwSignal<ColourBy>,
    /// The object is shown where it is (1), where it would be without refraction (0), or between.
    pub(crate) refraction: RwSignal<f32>,
    /// The scene without perspective.
    pub(crate) orthographic: RwSignal<bool>,
    /// What the scene was told last.
    pub(crate) command: RwSignal<Option<SceneCommand>>,
    /// The sheet of keys is shown.
    pub(crate) help: RwSignal<bool>,
    /// The start screen was asked for, though there is a result.
    at_start: RwSignal<bool>,
    lab: StoredValue<Option<Rc<Lab>>, LocalStorage>,
    cancel: StoredValue<Option<AbortHandle>>,
    /// The settings that were measured last, whatever came of it.
    measured: StoredValue<Settings>,
}

impl Workbench {
    pub(crate) fn new() -> Self {
        Self {
            progress: RwSignal::new(None),
            file_name: RwSignal::new(String::new()),
            problem: RwSignal::new(None),
            facts: RwSignal::new(None),
            outcome: RwSignal::new(None),
            stage_problem: RwSignal::new(None),
            settings: RwSignal::new(Settings::default()),
            rerun: RwSignal::new(None),
            history: RwSignal::new(History::default()),
            chosen: RwSignal::new(None),
            pictures: RwSignal::new_local(None),
            colour_by: RwSignal::new(ColourBy::RayDistance),
            refraction: RwSignal::new(1.0),
            orthographic: RwSignal::new(false),
            command: RwSignal::new(None),
            help: RwSignal::new(false),
            at_start: RwSignal::new(false),
            lab: StoredValue::new_local(None),
            cancel: StoredValue::new(None),
            measured: StoredValue::new(Settings::default()),
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

    /// How it stands with a stage.
    pub(crate) fn stage_state(self, stage: Stage) -> StageState {
        if let Some(Rerun { stage: at_work, .. }) = self.rerun.get() {
            if stage == at_work {
                return StageState::Running;
            }
            if stage > at_work {
                return StageState::Waiting;
            }
        }
        let failed = self.stage_problem.with(|problem| {
            let problem = problem.as_ref().filter(|p| p.stage == Some(stage))?;
            Some(problem.kind)
        });
        match failed {
            Some(ProblemKind::IndexWanted) => return StageState::Warning,
            Some(_) => return StageState::Failed,
            None => {}
        }
        let has_outcome = self.outcome.with(Option::is_some);
        if !has_outcome && stage > Stage::Spots {
            return StageState::Waiting;
        }
        let warned = self.outcome.with(|outcome| {
            let warnings = outcome.iter().flat_map(|outcome| &outcome.warnings);
            warnings.into_iter().any(|warning| warning.stage == stage)
        });
        if warned {
            StageState::Warning
        } else {
            StageState::Done
        }
    }

    /// Measures a file. What is shown stays until the new scan is measured.
    pub(crate) fn open(self, file: Blob, name: String) {
        self.cancel();
        self.problem.set(None);
        self.file_name.set(name);
        self.progress.set(Some(Progress::default()));
        let tell = move |progress| self.progress.set(Some(progress));
        let first_run = async move {
            let lab = Lab::open(file).await?;
            let outcome = lab.measure(Settings::default(), tell).await;
            Ok((lab, outcome))
        };
        let (running, handle) = abortable(first_run);
        self.cancel.set_value(Some(handle));
        spawn_local(async move {
            match running.await {
                Ok(Ok((lab, outcome))) => self.show(lab, outcome),
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

    /// Shows a scan: what it gave, or which stage failed.
    fn show(self, lab: Lab, outcome: Result<Outcome, Problem>) {
        if let Err(problem) = &outcome
            && problem.stage.is_none_or(|stage| stage < Stage::Spots)
        {
            return self.fail(problem.clone());
        }
        self.facts.set(Some(Arc::new(lab.facts().clone())));
        self.lab.set_value(Some(Rc::new(lab)));
        self.settings.set(Settings::default());
        self.history.set(History::default());
        self.measured.set_value(Settings::default());
        self.stage_problem.set(None);
        self.pictures.set(None);
        self.chosen.set(None);
        self.outcome.set(None);
        self.at_start.set(false);
        self.progress.set(None);
        if let Err(problem) = &outcome
            && problem.kind != ProblemKind::IndexWanted
        {
            self.problem.set(Some(problem.clone()));
        }
        self.take(outcome);
    }

    /// The view in the middle of the scan that has an object point: there is something to see at once.
    fn choose_first(self) {
        let view = self.outcome.with_untracked(|outcome| {
            let views = &outcome.as_ref()?.views;
            let good = |view: &usize| !views[*view].points.is_empty();
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
        let (Some(view), Some(lab)) = (view, self.lab.get_value()) else {
            self.pictures.set(None);
            return;
        };
        spawn_local(async move {
            let pictures = lab.pictures(view).await;
            if !self.is_current(&lab) || self.chosen.get_untracked() != Some(view) {
                return;
            }
            match pictures {
                Ok(pictures) => self.pictures.set(Some(pictures)),
                Err(problem) => self.fail(problem),
            }
        });
    }

    /// Chooses the next view, or the one before.
    pub(crate) fn step(self, by: isize) {
        let views = self
            .facts
            .with_untracked(|f| f.as_ref().map_or(0, |f| f.stations.len()));
        let next = match self.chosen.get_untracked() {
            Some(view) => view.saturating_add_signed(by),
            None => 0,
        };
        if next < views {
            self.choose(Some(next));
        }
    }

    /// Changes the settings and measures again, live. `what` names the change: as long as the same thing
    /// is being turned, it is one step of the history.
    pub(crate) fn change(self, what: &'static str, change: impl FnOnce(&mut Settings)) {
        let before = self.settings.get_untracked();
        let mut settings = before;
        change(&mut settings);
        if settings != before {
            self.history.update(|history| history.note(what, before));
            self.apply(settings);
        }
    }

    /// Whatever was being turned has been let go.
    pub(crate) fn let_go(self) {
        self.history.update(History::let_go);
    }

    /// Takes the last change back.
    pub(crate) fn undo(self) {
        let now = self.settings.get_untracked();
        if let Some(Some(before)) = self.history.try_update(|history| history.undo(now)) {
            self.apply(before);
        }
    }

    /// Makes the change again that was taken back.
    pub(crate) fn redo(self) {
        let now = self.settings.get_untracked();
        if let Some(Some(after)) = self.history.try_update(|history| history.redo(now)) {
            self.apply(after);
        }
    }

    fn apply(self, settings: Settings) {
        self.settings.set(settings);
        if self.rerun.get_untracked().is_none() {
            spawn_local(self.keep_up());
        }
    }

    /// Measures until what was measured is what is set.
    async fn keep_up(self) {
        while let Some((lab, settings, stage)) = self.open_change() {
            self.rerun.set(Some(Rerun {
                stage,
                progress: Progress::default(),
            }));
            let tell = move |progress: Progress| {
                let found = progress.done == progress.views;
                let stage = if found { Stage::Vessel } else { Stage::Spots };
                self.rerun.set(Some(Rerun { stage, progress }));
            };
            let run = pin!(lab.measure(settings, tell));
            let newer = pin!(self.newer_settings(settings));
            // A run that is dropped here ends.
            if let Either::Left((outcome, _)) = select(run, newer).await
                && self.is_current(&lab)
            {
                self.measured.set_value(settings);
                self.take(outcome);
            }
        }
        self.rerun.set(None);
    }

    /// Settings that are not measured yet, and the first stage they concern.
    fn open_change(self) -> Option<(Rc<Lab>, Settings, Stage)> {
        let lab = self.lab.get_value()?;
        let settings = self.settings.get_untracked();
        let stage = self.measured.get_value().first_changed(&settings)?;
        Some((lab, settings, stage))
    }

    /// Ends when the settings are no longer these. A quick run has the time to end before: its result is
    /// seen while a slider moves.
    async fn newer_settings(self, than: Settings) {
        const QUICK: i32 = 300;
        const LOOK: i32 = 40;
        sleep(QUICK).await;
        while self.settings.get_untracked() == than {
            sleep(LOOK).await;
        }
    }

    /// Shows what was measured. If that failed, what was there before stays.
    fn take(self, outcome: Result<Outcome, Problem>) {
        match outcome {
            Ok(outcome) => {
                self.stage_problem.set(None);
                self.outcome.set(Some(Arc::new(outcome)));
                if self.chosen.get_untracked().is_none() {
                    self.choose_first();
                }
            }
            Err(problem) if problem.stage.is_none() => self.fail(problem),
            Err(problem) => self.stage_problem.set(Some(problem)),
        }
    }

    /// Writes a file of what is set. Settings that were changed just now are measured first.
    pub(crate) async fn write(self, kind: FileKind) -> Result<String, Problem> {
        const LOOK: i32 = 20;
        while self.rerun.get_untracked().is_some() {
            sleep(LOOK).await;
        }
        let lab = self.lab.get_value();
        let lab = lab.ok_or_else(|| Problem::own("There is no result to save."))?;
        lab.write(kind, self.settings.get_untracked()).await
    }

    fn is_current(self, lab: &Rc<Lab>) -> bool {
        self.lab.with_value(|current| {
            current
                .as_ref()
                .is_some_and(|current| Rc::ptr_eq(current, lab))
        })
    }
}
