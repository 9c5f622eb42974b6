//! An open archive and the workers that measure it. They remember what they found, so that changed
//! settings cost only what depends on them.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

use futures::future::try_join_all;
use js_sys::{Array, Uint8Array};
use snellius::export::Format;
use snellius::pipeline::Settings;
use snellius::spots::SpotSettings;
use web_sys::Blob;

use super::figure::{FigureForm, FigureOf, Figured};
use super::hand::Hand;
use super::messages::{PictureSet, Thumbnail, WrittenSpots};
use super::passing::{LinkMade, PageWish};
use super::plan::Plan;
use super::problem::{Problem, ProblemKind};
use super::report::{Facts, Outcome};
use super::study::Study;

/// How far the search for spots is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Progress {
    /// Views whose spots are found.
    pub(crate) done: usize,
    /// Those of them that were found another time.
    pub(crate) at_hand: usize,
    /// Views in all; 0 until the archive is open.
    pub(crate) views: usize,
    /// Seconds since the first view was begun.
    pub(crate) seconds: f64,
}

/// An open archive and its workers.
pub(crate) struct Workers {
    file: Blob,
    facts: Facts,
    /// One a core, each with the archive open; they find spots and develop pictures.
    observers: RefCell<Vec<Rc<Hand>>>,
    /// The spots of all views, and the settings they were found with.
    found: RefCell<Option<(SpotSettings, Rc<Vec<WrittenSpots>>)>>,
    /// Spots of single views, and how they were looked for: those of a search that is not at its end.
    partly: RefCell<(SpotSettings, BTreeMap<usize, WrittenSpots>)>,
    /// The views in it that were found since somebody asked.
    news: RefCell<Vec<usize>>,
    /// Measures vessel and object. It is not here while it does.
    measurer: RefCell<Option<Measurer>>,
}

/// A worker, and what it has on its desk.
struct Measurer {
    hand: Hand,
    spots: Option<SpotSettings>,
    measured: Option<Plan>,
}

impl Workers {
    /// Opens an archive.
    pub(crate) async fn open(file: Blob) -> Result<Self, Problem> {
        let hand = Hand::start().await?;
        let facts = hand.open(&file).await?;
        Ok(Self {
            file,
            facts,
            observers: RefCell::default(),
            found: RefCell::new(None),
            partly: RefCell::default(),
            news: RefCell::default(),
            measurer: RefCell::new(Some(Measurer {
                hand,
                spots: None,
                measured: None,
            })),
        })
    }

    /// What is known before anything is measured.
    pub(crate) const fn facts(&self) -> &Facts {
        &self.facts
    }

    /// Takes over spots that were found another time.
    pub(crate) fn remember(&self, settings: SpotSettings, spots: Vec<(usize, WrittenSpots)>) {
        let views = self.facts.stations.len();
        let spots = spots.into_iter().filter(|(view, _)| *view < views);
        self.partly.replace((settings, spots.collect()));
    }

    /// The spots that were found since this was asked last, if any.
    pub(crate) fn news(&self) -> Option<(SpotSettings, Vec<(usize, WrittenSpots)>)> {
        let (partly, found) = (self.partly.borrow(), self.found.borrow());
        let (with, partly) = &*partly;
        let of = |view: usize| {
            let whole = found.as_ref().filter(|(settings, _)| settings == with);
            let whole = whole.and_then(|(_, spots)| spots.get(view));
            Some((view, partly.get(&view).or(whole)?.clone()))
        };
        let news: Vec<_> = self.news.take().into_iter().filter_map(of).collect();
        (!news.is_empty()).then_some((*with, news))
    }

    fn note(&self, view: usize, spots: &WrittenSpots) {
        self.partly.borrow_mut().1.insert(view, spots.clone());
        self.news.borrow_mut().push(view);
    }

    /// Measures the archive: what a change does not concern is not done again. Dropping the future
    /// ends the work.
    pub(crate) async fn measure(
        &self,
        plan: &Plan,
        tell: impl Fn(Progress),
    ) -> Result<Outcome, Problem> {
        let outcome = self.try_to_measure(plan, tell).await;
        if outcome
            .as_ref()
            .is_err_and(|problem| problem.kind == ProblemKind::Own)
        {
            // A worker that has failed answers no more; others are started when they are needed.
            self.observers.take();
            self.measurer.take();
        }
        outcome
    }

    async fn try_to_measure(
        &self,
        plan: &Plan,
        tell: impl Fn(Progress),
    ) -> Result<Outcome, Problem> {
        let spots = self.spots(plan.settings, tell).await?;
        let mut measurer = self.measurer(plan.settings.spots, &spots).await?;
        // If this future is dropped now, the measurer is dropped with it, which ends its worker.
        let outcome = measurer.hand.measure(plan).await;
        measurer.measured = outcome.is_ok().then(|| plan.clone());
        self.measurer.replace(Some(measurer));
        outcome
    }

    /// Says what the scan tells of the liquid's index.
    pub(crate) async fn study(&self, plan: &Plan) -> Result<Study, Problem> {
        let spots = self.spots(plan.settings, |_| {}).await?;
        let measurer = self.measurer(plan.settings.spots, &spots).await?;
        let study = measurer.hand.study(plan).await;
        let own = |problem: &Problem| problem.kind == ProblemKind::Own;
        if !study.as_ref().is_err_and(own) {
            self.measurer.replace(Some(measurer));
        }
        study
    }

    /// Decodes the pictures of a view.
    pub(crate) async fn pictures(&self, view: usize) -> Result<PictureSet, Problem> {
        let hand = self.observer(view).await?;
        hand.pictures(view).await
    }

    /// Decodes a view's picture, small.
    pub(crate) async fn thumbnail(&self, view: usize) -> Result<Thumbnail, Problem> {
        self.observer(view).await?.thumbnail(view).await
    }

    /// Draws a figure of what a plan gives, or writes it as a table.
    pub(crate) async fn figure(
        &self,
        (of, form): (FigureOf, FigureForm),
        plan: &Plan,
    ) -> Result<Figured, Problem> {
        let figure = async |hand: &Hand| hand.figure(of, form).await;
        self.of_measured(plan, figure).await
    }

    /// Writes a file of what a plan gives.
    pub(crate) async fn write(&self, format: Format, plan: &Plan) -> Result<Uint8Array, Problem> {
        let write = async |hand: &Hand| hand.write(format).await;
        self.of_measured(plan, write).await
    }

    /// Makes a link to what a plan gives.
    pub(crate) async fn link(&self, plan: &Plan) -> Result<LinkMade, Problem> {
        let link = async |hand: &Hand| hand.link(plan.settings).await;
        self.of_measured(plan, link).await
    }

    /// Writes a one-file page of what a plan gives.
    pub(crate) async fn page(&self, plan: &Plan, wish: PageWish) -> Result<Uint8Array, Problem> {
        let write = async |hand: &Hand| hand.page(plan.settings, wish).await;
        self.of_measured(plan, write).await
    }

    /// Asks the measurer about what a plan gives.
    async fn of_measured<T>(
        &self,
        plan: &Plan,
        ask: impl AsyncFnOnce(&Hand) -> Result<T, Problem>,
    ) -> Result<T, Problem> {
        let measurer = self.measurer_with(plan).await?;
        let answer = ask(&measurer.hand).await;
        self.measurer.replace(Some(measurer));
        answer
    }

    /// The measurer, with the result of a plan on its desk.
    async fn measurer_with(&self, plan: &Plan) -> Result<Measurer, Problem> {
        // Whoever has it, for a figure or a study, brings it back soon; after a fault nobody does.
        const LOOK: i32 = 20;
        const MOST_LOOKS: usize = 1500;
        for _ in 0..MOST_LOOKS {
            if self.measurer.borrow().is_some() {
                break;
            }
            super::sleep(LOOK).await;
        }
        let is_measured = |measurer: &Measurer| measurer.measured.as_ref() == Some(plan);
        if !self.measurer.borrow().as_ref().is_some_and(is_measured) {
            self.measure(plan, |_| {}).await?;
        }
        self.measurer.take().ok_or_else(busy)
    }

    /// The spots of all views, found now if they are not at hand.
    async fn spots(
        &self,
        settings: Settings,
        tell: impl Fn(Progress),
    ) -> Result<Rc<Vec<WrittenSpots>>, Problem> {
        if let Some((with, spots)) = &*self.found.borrow()
            && *with == settings.spots
        {
            return Ok(Rc::clone(spots));
        }
        let views = self.facts.stations.len();
        if self.partly.borrow().0 != settings.spots {
            self.partly.replace((settings.spots, BTreeMap::new()));
            self.news.take();
        }
        let at_hand = self.partly.borrow().1.clone();
        let hands = cores().min(views);
        let list = WorkList::new(views, hands, at_hand, tell);
        let work = (0..hands).map(|number| {
            let list = &list;
            async move {
                let hand = self.observer(number).await?;
                let note = |view, spots: &WrittenSpots| self.note(view, spots);
                list.work_off(&hand, settings, note).await;
                Ok::<_, Problem>(())
            }
        });
        try_join_all(work).await?;
        let spots = Rc::new(list.spots()?);
        self.found
            .replace(Some((settings.spots, Rc::clone(&spots))));
        self.partly.borrow_mut().1.clear();
        Ok(spots)
    }

    /// One of the observers; started, if it is not there yet.
    async fn observer(&self, number: usize) -> Result<Rc<Hand>, Problem> {
        let number = number % cores();
        if let Some(hand) = self.observers.borrow().get(number) {
            return Ok(Rc::clone(hand));
        }
        let hand = Rc::new(Hand::start().await?);
        hand.open_too(&self.file).await?;
        self.observers.borrow_mut().push(Rc::clone(&hand));
        Ok(hand)
    }

    /// A worker that has these spots.
    async fn measurer(
        &self,
        with: SpotSettings,
        spots: &[WrittenSpots],
    ) -> Result<Measurer, Problem> {
        let at_hand = self.measurer.take();
        let mut measurer = match at_hand {
            Some(measurer) => measurer,
            None => {
                let hand = Hand::start().await?;
                hand.open_too(&self.file).await?;
                Measurer {
                    hand,
                    spots: None,
                    measured: None,
                }
            }
        };
        if measurer.spots != Some(with) {
            measurer.hand.keep(spots).await?;
            measurer.spots = Some(with);
        }
        Ok(measurer)
    }
}

/// An archive with a note in it; nothing of it is copied.
pub(crate) async fn with_note(archive: &Blob, note: String) -> Result<Blob, Problem> {
    let hand = Hand::start().await?;
    hand.open_too(archive).await?;
    let (keep, tail) = hand.note(note).await?;
    let own = |_| Problem::own("The browser could not join the parts of the file.");
    let kept = archive.slice_with_f64_and_f64(0.0, keep).map_err(own)?;
    let tail = Blob::new_with_u8_array_sequence(&Array::of1(&tail)).map_err(own)?;
    let parts = Array::of2(&kept, &tail);
    Blob::new_with_blob_sequence(&parts).map_err(own)
}

fn busy() -> Problem {
    Problem::own("The scan is being measured anew.")
}

/// How many workers: one a core, but no more than memory likes.
fn cores() -> usize {
    const MOST: usize = 16;
    let cores = super::window().navigator().hardware_concurrency() as usize;
    cores.clamp(1, MOST)
}

/// The views still to be looked at, from which every hand takes the next when it is free.
struct WorkList<T> {
    open: RefCell<VecDeque<usize>>,
    hands: usize,
    found: RefCell<Vec<Option<WrittenSpots>>>,
    /// The first view that cannot be used, and why.
    failed: RefCell<Option<(usize, Problem)>>,
    done: Cell<usize>,
    at_hand: usize,
    begun: f64,
    /// When it was told last how far this is, ms.
    told: Cell<f64>,
    tell: T,
}

impl<T: Fn(Progress)> WorkList<T> {
    fn new(views: usize, hands: usize, at_hand: BTreeMap<usize, WrittenSpots>, tell: T) -> Self {
        let done = at_hand.len();
        let mut found = vec![None; views];
        for (view, spots) in at_hand {
            found[view] = Some(spots);
        }
        let open = (0..views).filter(|view| found[*view].is_none());
        let list = Self {
            open: RefCell::new(open.collect()),
            hands,
            found: RefCell::new(found),
            failed: RefCell::new(None),
            done: Cell::new(done),
            at_hand: done,
            begun: super::now(),
            told: Cell::new(f64::MIN),
            tell,
        };
        list.report();
        list
    }

    async fn work_off(&self, hand: &Hand, settings: Settings, note: impl Fn(usize, &WrittenSpots)) {
        loop {
            let views = self.take();
            if views.is_empty() {
                return;
            }
            for view in views.into_iter().take_while(|view| self.is_wanted(*view)) {
                match hand.observe(view, settings).await {
                    Ok(spots) => {
                        note(view, &spots);
                        self.put(view, spots);
                    }
                    Err(problem) => self.fail(view, problem),
                }
            }
        }
    }

    /// The next views, in their order; none after a failure. There are some at a time: they lie one after the
    /// other in the archive, and what was read ahead for one serves the next. Towards the end there are fewer,
    /// so that every hand has something to do.
    fn take(&self) -> Vec<usize> {
        const MOST: usize = 8;
        let mut open = self.open.borrow_mut();
        if self.failed.borrow().is_some() {
            return Vec::new();
        }
        let count = (open.len() / (2 * self.hands)).clamp(1, MOST);
        let count = count.min(open.len());
        open.drain(..count).collect()
    }

    /// Whether no view before it has failed.
    fn is_wanted(&self, view: usize) -> bool {
        let failed = self.failed.borrow();
        failed.as_ref().is_none_or(|(first, _)| view < *first)
    }

    fn put(&self, view: usize, spots: WrittenSpots) {
        self.found.borrow_mut()[view] = Some(spots);
        self.done.set(self.done.get() + 1);
        self.report();
    }

    /// Every view before a failing one has been taken already and will be finished, so of several failures
    /// the same one is told each time, however many hands there are.
    fn fail(&self, view: usize, problem: Problem) {
        let mut failed = self.failed.borrow_mut();
        if failed.as_ref().is_none_or(|(first, _)| view < *first) {
            *failed = Some((view, problem));
        }
    }

    /// Tells how far this is, a few times a second: whatever is told is drawn, and to draw at every view takes
    /// as long as to find its spots.
    fn report(&self) {
        const PAUSE: f64 = 250.0;
        let (now, views) = (super::now(), self.found.borrow().len());
        let done = self.done.get();
        if done < views && now - self.told.get() < PAUSE {
            return;
        }
        self.told.set(now);
        (self.tell)(Progress {
            done,
            at_hand: self.at_hand,
            views,
            seconds: (now - self.begun) / 1000.0,
        });
    }

    fn spots(self) -> Result<Vec<WrittenSpots>, Problem> {
        match self.failed.into_inner() {
            Some((_, problem)) => Err(problem),
            None => Ok(self.found.into_inner().into_iter().flatten().collect()),
        }
    }
}
