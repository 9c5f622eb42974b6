//! The state of the workbench and what can be done with it. The screens only show it.

use std::pin::pin;
use std::rc::Rc;
use std::sync::Arc;

use futures::future::{AbortHandle, Aborted, Either, abortable, select};
use js_sys::Uint8Array;
use leptos::prelude::*;
use snellius::export::{Format, SpotRole};
use snellius::pipeline::{Correction, Settings, Stage};
use wasm_bindgen_futures::spawn_local;
use web_sys::Blob;

use crate::history::History;
use crate::making::Making;
use crate::measuring::{Measuring, Picked};
use crate::run::{
    About, Facts, FigureForm, FigureOf, Figured, Guest, Hand, LinkMade, Outcome, PageWish,
    PictureSet, Plan, Problem, ProblemKind, Progress, Study, Thumbnail, Workers, sleep,
    start_graphics,
};
use crate::sessions::{Found, HowFar, Keeping, Origin, Record, Session};
use crate::share;

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
    /// A scan is being made of pictures.
    Making,
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

/// Only a slab of the scene is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Section {
    /// Across what; nothing, and everything is shown.
    pub(crate) axis: Option<SectionAxis>,
    /// Where its middle is, from the first point (0) to the last (1).
    pub(crate) middle: f32,
    /// How thick it is, as a part of the whole.
    pub(crate) thickness: f32,
}

/// What a section goes across.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SectionAxis {
    Depth,
    Height,
    Width,
}

impl Default for Section {
    fn default() -> Self {
        Self {
            axis: None,
            middle: 0.5,
            thickness: 0.25,
        }
    }
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
    /// Save what is seen, without a ground if it shall be transparent.
    Picture { transparent: bool },
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
    /// What of the session cannot be kept; empty, and all is.
    pub(crate) unkept: RwSignal<String>,
    /// Its archive is nowhere else, and can be saved.
    pub(crate) offers_archive: RwSignal<bool>,
    /// The scan that is shown.
    pub(crate) facts: RwSignal<Option<Arc<Facts>>>,
    /// What is shown, if it came without its archive.
    pub(crate) guest: RwSignal<Option<About>>,
    /// What it gave last; nothing yet if something is wanted first.
    pub(crate) outcome: RwSignal<Option<Arc<Outcome>>>,
    /// Why the settings give nothing; the outcome is then that of earlier ones.
    pub(crate) stage_problem: RwSignal<Option<Problem>>,
    /// What the scan tells of the liquid's index, or why that cannot be said; nothing before it is asked.
    pub(crate) study: RwSignal<Option<Arc<Result<Study, Problem>>>>,
    /// How it is measured: what is turned,
    pub(crate) settings: RwSignal<Settings>,
    /// and what is said of spots.
    pub(crate) corrections: RwSignal<Vec<Correction>>,
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
    /// What is being measured in the scene.
    pub(crate) measuring: RwSignal<Measuring>,
    /// Points beyond these fractions of the colours are hidden.
    pub(crate) shown_range: RwSignal<[f32; 2]>,
    /// The object is shown where it is (1), where it would be without refraction (0), or between.
    pub(crate) refraction: RwSignal<f32>,
    /// Which slab of the scene is shown.
    pub(crate) section: RwSignal<Section>,
    /// Error ellipsoids are drawn so many times as large as they are; none, and there are none.
    pub(crate) ellipsoids: RwSignal<Option<f32>>,
    /// The scene without perspective.
    pub(crate) orthographic: RwSignal<bool>,
    /// What the scene was told last.
    pub(crate) command: RwSignal<Option<SceneCommand>>,
    /// The sheet of keys is shown.
    pub(crate) help: RwSignal<bool>,
    /// The scan that is being made of pictures.
    pub(crate) making: Making,
    /// The start screen was asked for, though there is a result.
    at_start: RwSignal<bool>,
    workers: StoredValue<Option<Rc<Workers>>, LocalStorage>,
    /// Who keeps what is opened, until it is shown,
    opening: StoredValue<Option<Rc<Keeping>>, LocalStorage>,
    /// and who keeps what is shown.
    kept: StoredValue<Option<Rc<Keeping>>, LocalStorage>,
    /// Whether what is being opened stands in the page's address.
    by_address: StoredValue<bool>,
    /// The worker that has what came without its archive.
    guest_hand: StoredValue<Option<Rc<Hand>>, LocalStorage>,
    cancel: StoredValue<Option<AbortHandle>>,
    /// The plan that was measured last, whatever came of it.
    measured: StoredValue<Plan>,
    /// The plan that gave what is shown.
    shown: StoredValue<Plan>,
    /// The plan of the study that is shown or under way.
    studied: StoredValue<Option<Plan>>,
}

impl Workbench {
    pub(crate) fn new() -> Self {
        let problem = RwSignal::new(None);
        Self {
            progress: RwSignal::new(None),
            file_name: RwSignal::new(String::new()),
            problem,
            unkept: RwSignal::new(String::new()),
            offers_archive: RwSignal::new(false),
            facts: RwSignal::new(None),
            guest: RwSignal::new(None),
            outcome: RwSignal::new(None),
            stage_problem: RwSignal::new(None),
            study: RwSignal::new(None),
            settings: RwSignal::new(Settings::default()),
            corrections: RwSignal::new(Vec::new()),
            rerun: RwSignal::new(None),
            history: RwSignal::new(History::default()),
            chosen: RwSignal::new(None),
            pictures: RwSignal::new_local(None),
            colour_by: RwSignal::new(ColourBy::RayDistance),
            measuring: RwSignal::new(Measuring::default()),
            shown_range: RwSignal::new([0.0, 1.0]),
            refraction: RwSignal::new(1.0),
            section: RwSignal::new(Section::default()),
            ellipsoids: RwSignal::new(None),
            orthographic: RwSignal::new(false),
            command: RwSignal::new(None),
            help: RwSignal::new(false),
            making: Making::new(problem),
            at_start: RwSignal::new(false),
            workers: StoredValue::new_local(None),
            opening: StoredValue::new_local(None),
            kept: StoredValue::new_local(None),
            by_address: StoredValue::new(false),
            guest_hand: StoredValue::new_local(None),
            cancel: StoredValue::new(None),
            measured: StoredValue::new(Plan::default()),
            shown: StoredValue::new(Plan::default()),
            studied: StoredValue::new(None),
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
        } else if self.making.shown.get() {
            Screen::Making
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
            Screen::Start | Screen::Making => "start",
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

    /// Says whether what is opened next stands in the page's address.
    pub(crate) fn comes_by_address(self, by_address: bool) {
        self.by_address.set_value(by_address);
    }

    /// Measures a file. What is shown stays until the new scan is measured.
    pub(crate) fn open(self, file: Blob, name: String, origin: Origin) {
        let record = Record::new(&name, file.size(), origin);
        self.go_on(file, record, Vec::new(), None);
    }

    /// Goes on with a session: its scan, how that was measured, and the spots that were found.
    pub(crate) fn go_on(
        self,
        file: Blob,
        record: Record,
        found: Vec<Found>,
        session: Option<Session>,
    ) {
        let keeping = Rc::new(Keeping::new(record, file.clone()));
        let kept = Rc::clone(&keeping);
        let tell = move |progress| self.progress.set(Some(progress));
        let first_run = async move {
            let workers = Rc::new(Workers::open(file).await?);
            if let Some(packed) = workers.facts().session.as_deref() {
                keeping.take_over(packed);
            }
            let plan = keeping.record().plan;
            for found in found {
                if found.settings == plan.settings.spots {
                    workers.remember(found.settings, found.spots);
                }
            }
            keeping.measures(&workers);
            let outcome = workers.measure(&plan, tell).await;
            // To show it is a task of its own.
            sleep(0).await;
            Ok((workers, keeping, outcome))
        };
        let name = kept.record().file_name;
        self.wait_for(name, first_run, move |(workers, keeping, outcome)| {
            self.show(workers, keeping, outcome);
        });
        self.opening.set_value(Some(Rc::clone(&kept)));
        spawn_local(kept.keep(self, session));
    }

    /// Shows a reconstruction that comes without its archive: in a link, or in a file. What is shown stays
    /// until it has come.
    pub(crate) fn receive(
        self,
        name: String,
        open: impl AsyncFnOnce(&Hand) -> Result<Guest, Problem> + 'static,
    ) {
        let opened = async move {
            let hand = Hand::start().await?;
            let guest = open(&hand).await?;
            Ok((hand, guest))
        };
        self.wait_for(name, opened, move |(hand, guest)| {
            let plan = Plan {
                settings: guest.settings,
                ..Plan::default()
            };
            self.clear(guest.facts, plan.clone());
            self.guest_hand.set_value(Some(Rc::new(hand)));
            self.guest.set(Some(guest.about));
            self.take(plan, Ok(guest.outcome));
        });
    }

    /// Waits for something, saying so meanwhile, and then does something with it; gives up when cancelled.
    pub(crate) fn wait_for<T: 'static>(
        self,
        saying: String,
        what: impl Future<Output = Result<T, Problem>> + 'static,
        then: impl FnOnce(T) + 'static,
    ) {
        self.cancel();
        // What comes is shown in 3-D.
        start_graphics();
        self.problem.set(None);
        self.unkept.set(String::new());
        self.file_name.set(saying);
        self.progress.set(Some(Progress::default()));
        let (waiting, handle) = abortable(what);
        self.cancel.set_value(Some(handle));
        spawn_local(async move {
            match waiting.await {
                Ok(Ok(come)) => then(come),
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
        self.give_up();
    }

    /// What was being opened is not shown any more.
    fn give_up(self) {
        if let Some(opening) = self.opening.try_update_value(Option::take).flatten() {
            opening.give_up();
        }
        self.progress.set(None);
    }

    /// Says what went wrong.
    pub(crate) fn fail(self, problem: Problem) {
        self.give_up();
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
    fn show(self, workers: Rc<Workers>, keeping: Rc<Keeping>, outcome: Result<Outcome, Problem>) {
        if let Err(problem) = &outcome
            && problem.stage.is_none_or(|stage| stage < Stage::Spots)
        {
            return self.fail(problem.clone());
        }
        let record = keeping.record();
        self.opening.set_value(None);
        self.clear(workers.facts().clone(), record.plan.clone());
        self.history.set(record.history);
        self.workers.set_value(Some(workers));
        self.kept.set_value(Some(Rc::clone(&keeping)));
        if let Err(problem) = &outcome
            && problem.kind != ProblemKind::IndexWanted
        {
            self.problem.set(Some(problem.clone()));
        }
        self.take(record.plan, outcome);
        if record.chosen.is_some() {
            self.choose(record.chosen);
        }
        // From now on what is shown is what is kept.
        keeping.is_shown();
    }

    /// Makes room for another scan.
    fn clear(self, facts: Facts, plan: Plan) {
        if let Some(kept) = self.kept.try_update_value(Option::take).flatten() {
            kept.leave();
        }
        if !self.by_address.get_value() {
            share::forget_address();
        }
        self.workers.set_value(None);
        self.guest_hand.set_value(None);
        self.guest.set(None);
        self.facts.set(Some(Arc::new(facts)));
        self.settings.set(plan.settings);
        self.corrections.set(plan.corrections.clone());
        self.history.set(History::default());
        self.measuring.set(Measuring::default());
        self.measured.set_value(plan);
        self.stage_problem.set(None);
        self.study.set(None);
        self.studied.set_value(None);
        self.pictures.set(None);
        self.chosen.set(None);
        self.outcome.set(None);
        self.at_start.set(false);
        self.making.shown.set(false);
        self.progress.set(None);
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
        let (Some(view), Some(workers)) = (view, self.workers.get_value()) else {
            self.pictures.set(None);
            return;
        };
        spawn_local(async move {
            let pictures = workers.pictures(view).await;
            if !self.is_current(&workers) || self.chosen.get_untracked() != Some(view) {
                return;
            }
            match pictures {
                Ok(pictures) => self.pictures.set(Some(pictures)),
                Err(problem) => self.fail(problem),
            }
        });
    }

    /// Picks a point to measure with, or lets go of it.
    pub(crate) fn pick(self, point: Picked) {
        if self.measuring.with_untracked(Measuring::is_on) {
            self.measuring.update(|measuring| measuring.toggle(point));
        }
    }

    /// Picks the points of the chosen view.
    pub(crate) fn pick_chosen(self) {
        let Some(view) = self.chosen.get_untracked() else {
            return;
        };
        let points = self.outcome.with_untracked(|outcome| {
            outcome
                .as_ref()
                .map_or(0, |outcome| outcome.points_of(view).len())
        });
        if points == 1 {
            self.pick((view, 0));
        } else if self.measuring.with_untracked(Measuring::is_on) {
            let points = (0..points).map(|index| (view, index));
            self.measuring.update(|measuring| measuring.add(points));
        }
    }

    /// A view's picture, small; `None` if the scan is gone by then.
    pub(crate) async fn thumbnail(self, view: usize) -> Option<Result<Thumbnail, Problem>> {
        let workers = self.workers.get_value()?;
        let thumbnail = workers.thumbnail(view).await;
        self.is_current(&workers).then_some(thumbnail)
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

    /// How the scan is to be measured.
    fn plan(self) -> Plan {
        Plan {
            settings: self.settings.get_untracked(),
            corrections: self.corrections.get_untracked(),
        }
    }

    /// Changes the settings and measures again, live. `what` names the change: as long as the same thing
    /// is being turned, it is one step of the history.
    pub(crate) fn change(self, what: &'static str, change: impl FnOnce(&mut Settings)) {
        let mut plan = self.plan();
        change(&mut plan.settings);
        self.follow(what, plan);
    }

    /// Has it found out what the scan tells of the liquid's index, unless that is known already.
    pub(crate) fn ask_for_study(self) {
        let plan = self.plan().without_index();
        let Some(workers) = self.workers.get_value() else {
            return;
        };
        if self.studied.get_value().as_ref() == Some(&plan) {
            return;
        }
        self.studied.set_value(Some(plan.clone()));
        spawn_local(async move {
            let study = workers.study(&plan).await;
            let still_wanted = self.studied.get_value().as_ref() == Some(&plan);
            if self.is_current(&workers) && still_wanted {
                self.study.set(Some(Arc::new(study)));
            }
        });
    }

    /// Says what a spot of a view is, or (`None`) leaves it to the program, and measures again.
    pub(crate) fn say(self, view: usize, pixel: [f64; 2], role: Option<SpotRole>) {
        let mut plan = self.plan();
        plan.corrections.retain(|said| !is_about(said, view, pixel));
        plan.corrections
            .extend(role.map(|role| Correction::of_spot(view, pixel, role)));
        self.follow("spot", plan);
        self.let_go();
    }

    /// Says what the points of a line are that lie no farther than `reach` px from a pixel, or (`None`) leaves
    /// them to the program, and measures again.
    pub(crate) fn say_within(
        self,
        view: usize,
        pixel: [f64; 2],
        reach: f64,
        role: Option<SpotRole>,
    ) {
        let mut plan = self.plan();
        let covered = |said: &Correction| {
            let [du, dv] = [0, 1].map(|axis| said.pixel[axis] - pixel[axis]);
            said.view == view && (du * du + dv * dv).sqrt() <= reach
        };
        plan.corrections.retain(|said| !covered(said));
        plan.corrections.extend(role.map(|role| Correction {
            view,
            pixel,
            reach,
            role,
        }));
        self.follow("spot", plan);
        self.let_go();
    }

    /// What was said of a spot of a view.
    pub(crate) fn said_of(self, view: usize, pixel: [f64; 2]) -> Option<SpotRole> {
        self.corrections.with(|corrections| {
            let said = corrections
                .iter()
                .find(|said| is_about(said, view, pixel))?;
            Some(said.role)
        })
    }

    fn follow(self, what: &'static str, plan: Plan) {
        let before = self.plan();
        if plan != before {
            self.history.update(|history| history.note(what, before));
            self.apply(plan);
        }
    }

    /// Whatever was being turned has been let go.
    pub(crate) fn let_go(self) {
        self.history.update(History::let_go);
    }

    /// Takes the last change back.
    pub(crate) fn undo(self) {
        let now = self.plan();
        if let Some(Some(before)) = self.history.try_update(|history| history.undo(now)) {
            self.apply(before);
        }
    }

    /// Makes the change again that was taken back.
    pub(crate) fn redo(self) {
        let now = self.plan();
        if let Some(Some(after)) = self.history.try_update(|history| history.redo(now)) {
            self.apply(after);
        }
    }

    fn apply(self, plan: Plan) {
        self.settings.set(plan.settings);
        self.corrections.set(plan.corrections);
        if self.rerun.get_untracked().is_none() {
            spawn_local(self.keep_up());
        }
    }

    /// Measures until what was measured is what is set.
    async fn keep_up(self) {
        while let Some((workers, plan, stage)) = self.open_change() {
            self.rerun.set(Some(Rerun {
                stage,
                progress: Progress::default(),
            }));
            let tell = move |progress: Progress| {
                let found = progress.done == progress.views;
                let stage = if found { Stage::Vessel } else { Stage::Spots };
                self.rerun.set(Some(Rerun { stage, progress }));
            };
            let run = pin!(workers.measure(&plan, tell));
            let newer = pin!(self.newer_plan(&plan));
            // A run that is dropped here ends.
            if let Either::Left((outcome, _)) = select(run, newer).await
                && self.is_current(&workers)
            {
                self.measured.set_value(plan.clone());
                self.take(plan.clone(), outcome);
            }
        }
        self.rerun.set(None);
    }

    /// A plan that is not measured yet, and the first stage it concerns.
    fn open_change(self) -> Option<(Rc<Workers>, Plan, Stage)> {
        let workers = self.workers.get_value()?;
        let plan = self.plan();
        let stage = self
            .measured
            .with_value(|measured| measured.first_changed(&plan))?;
        Some((workers, plan, stage))
    }

    /// Ends when the plan is no longer this one. A quick run has the time to end before: its result is
    /// seen while a slider moves.
    async fn newer_plan(self, than: &Plan) {
        const QUICK: i32 = 300;
        const LOOK: i32 = 40;
        sleep(QUICK).await;
        while self.plan() == *than {
            sleep(LOOK).await;
        }
    }

    /// Shows what was measured. If that failed, what was there before stays.
    fn take(self, plan: Plan, outcome: Result<Outcome, Problem>) {
        match outcome {
            Ok(outcome) => {
                self.shown.set_value(plan);
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

    /// Writes a file of what is shown. Settings that were changed just now are measured first.
    pub(crate) async fn write(self, format: Format) -> Result<Uint8Array, Problem> {
        if let Some(hand) = self.guest_hand.get_value() {
            return hand.write(format).await;
        }
        self.settled_workers()
            .await?
            .write(format, &self.shown.get_value())
            .await
    }

    /// Makes a link to what is shown.
    pub(crate) async fn link(self) -> Result<LinkMade, Problem> {
        if let Some(hand) = self.guest_hand.get_value() {
            return hand.link(self.settings.get_untracked()).await;
        }
        let workers = self.settled_workers().await?;
        workers.link(&self.shown.get_value()).await
    }

    /// Writes a one-file page of what is shown.
    pub(crate) async fn page(self, wish: PageWish) -> Result<Uint8Array, Problem> {
        if let Some(hand) = self.guest_hand.get_value() {
            return hand.page(self.settings.get_untracked(), wish).await;
        }
        let workers = self.settled_workers().await?;
        workers.page(&self.shown.get_value(), wish).await
    }

    /// Draws a figure of what is shown, or writes it as a table. Settings that were changed just now are
    /// measured first.
    pub(crate) async fn figure(self, of: FigureOf, form: FigureForm) -> Result<Figured, Problem> {
        if let Some(hand) = self.guest_hand.get_value() {
            return hand.figure(of, form).await;
        }
        let workers = self.settled_workers().await?;
        workers.figure((of, form), &self.shown.get_value()).await
    }

    /// The workers once they are at rest.
    async fn settled_workers(self) -> Result<Rc<Workers>, Problem> {
        const LOOK: i32 = 20;
        while self.rerun.get_untracked().is_some() {
            sleep(LOOK).await;
        }
        let workers = self.workers.get_value();
        workers.ok_or_else(|| Problem::own("There is no result to save."))
    }

    /// What is to be kept of what is being opened.
    pub(crate) fn on_the_way(self, mut record: Record) -> Record {
        if let Some(Progress { done, views, .. }) = self.progress.get_untracked() {
            record.progress = HowFar::Looking { done, views };
        }
        record
    }

    /// What is to be kept of what is shown.
    pub(crate) fn to_be_kept(self, before: &Record) -> Record {
        let mut record = before.clone();
        record.plan = self.plan();
        record.history = self.history.get_untracked();
        record.chosen = self.chosen.get_untracked();
        let views = self
            .facts
            .with_untracked(|facts| facts.as_ref().map_or(0, |facts| facts.stations.len()));
        record.progress = self.outcome.with_untracked(|outcome| match outcome {
            Some(outcome) => HowFar::Measured {
                points: outcome.views.iter().map(|view| view.points.len()).sum(),
                views,
            },
            None => HowFar::Stopped { views },
        });
        record
    }

    /// Who keeps what is being opened, or is shown.
    pub(crate) fn keeping(self) -> Option<Rc<Keeping>> {
        self.opening.get_value().or(self.kept.get_value())
    }

    fn is_current(self, workers: &Rc<Workers>) -> bool {
        self.workers.with_value(|current| {
            current
                .as_ref()
                .is_some_and(|current| Rc::ptr_eq(current, workers))
        })
    }
}

/// Whether something was said of the spot at a pixel.
fn is_about(said: &Correction, view: usize, pixel: [f64; 2]) -> bool {
    const SAME: f64 = 3.0;
    let off = [0, 1].map(|axis| (said.pixel[axis] - pixel[axis]).abs());
    said.view == view && off[0].max(off[1]) <= SAME
}
