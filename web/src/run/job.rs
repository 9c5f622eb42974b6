//! A run: from a file to a measured scan, spread over the machine's cores.

use std::cell::{Cell, RefCell};

use futures::FutureExt;
use futures::future::{try_join, try_join_all};
use snellius::pipeline::Settings;
use snellius::spots::Spots;
use web_sys::Blob;

use super::hand::Hand;
use super::problem::Problem;
use super::report::{Facts, Outcome};

/// How far a run is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Progress {
    /// Views whose spots are found.
    pub(crate) done: usize,
    /// Views in all; 0 until the archive is open.
    pub(crate) views: usize,
    /// Seconds since the first view was begun.
    pub(crate) seconds: f64,
}

/// A scan whose spots are found, and the hand that keeps them.
pub(crate) struct Run {
    pub(crate) facts: Facts,
    /// The scan as it was measured first, or what was missing.
    pub(crate) outcome: Result<Outcome, Problem>,
    pub(crate) hand: Hand,
}

/// Measures an archive. Dropping the future ends its workers.
pub(crate) async fn run(
    file: Blob,
    settings: Settings,
    tell: impl Fn(Progress),
) -> Result<Run, Problem> {
    let hand = Hand::start().await?;
    let facts = hand.open(&file).await?;
    let spots = find_all_spots(&hand, &file, facts.stations.len(), settings, tell).await?;
    hand.keep(spots).await?;
    let outcome = hand.measure(settings).await;
    Ok(Run {
        facts,
        outcome,
        hand,
    })
}

async fn find_all_spots(
    first: &Hand,
    file: &Blob,
    views: usize,
    settings: Settings,
    tell: impl Fn(Progress),
) -> Result<Vec<Spots>, Problem> {
    let list = WorkList::new(views, tell);
    let helpers = (1..cores().min(views)).map(|_| help(&list, file, settings));
    let own = list.work_off(first, settings).map(Ok);
    try_join(own, try_join_all(helpers)).await?;
    list.spots()
}

/// Starts one more worker and has it take its part.
async fn help<T: Fn(Progress)>(
    list: &WorkList<T>,
    file: &Blob,
    settings: Settings,
) -> Result<(), Problem> {
    let helper = Hand::start().await?;
    helper.open(file).await?;
    list.work_off(&helper, settings).await;
    Ok(())
}

/// How many workers: one a core, but no more than memory likes.
fn cores() -> usize {
    const MOST: usize = 16;
    let cores = super::window().navigator().hardware_concurrency() as usize;
    cores.clamp(1, MOST)
}

/// The views still to be looked at, from which every hand takes the next when it is free.
struct WorkList<T> {
    next: Cell<usize>,
    found: RefCell<Vec<Option<Spots>>>,
    /// The first view that cannot be used, and why.
    failed: RefCell<Option<(usize, Problem)>>,
    done: Cell<usize>,
    begun: f64,
    tell: T,
}

impl<T: Fn(Progress)> WorkList<T> {
    fn new(views: usize, tell: T) -> Self {
        let list = Self {
            next: Cell::new(0),
            found: RefCell::new(vec![None; views]),
            failed: RefCell::new(None),
            done: Cell::new(0),
            begun: super::now(),
            tell,
        };
        list.report();
        list
    }

    async fn work_off(&self, hand: &Hand, settings: Settings) {
        while let Some(view) = self.take() {
            match hand.observe(view, settings).await {
                Ok(spots) => self.put(view, spots),
                Err(problem) => self.fail(view, problem),
            }
        }
    }

    /// The next view, in their order; none after a failure.
    fn take(&self) -> Option<usize> {
        let view = self.next.get();
        self.next.set(view + 1);
        let is_left = view < self.found.borrow().len() && self.failed.borrow().is_none();
        is_left.then_some(view)
    }

    fn put(&self, view: usize, spots: Spots) {
        self.found.borrow_mut()[view] = Some(spots);
        self.done.set(self.done.get() + 1);
        self.report();
    }

    /// Every view before a failing one has been taken already and is finished, so of several failures
    /// the same one is told each time, however many hands there are.
    fn fail(&self, view: usize, problem: Problem) {
        let mut failed = self.failed.borrow_mut();
        if failed.as_ref().is_none_or(|(first, _)| view < *first) {
            *failed = Some((view, problem));
        }
    }

    fn report(&self) {
        (self.tell)(Progress {
            done: self.done.get(),
            views: self.found.borrow().len(),
            seconds: (super::now() - self.begun) / 1000.0,
        });
    }

    fn spots(self) -> Result<Vec<Spots>, Problem> {
        match self.failed.into_inner() {
            Some((_, problem)) => Err(problem),
            None => Ok(self.found.into_inner().into_iter().flatten().collect()),
        }
    }
}
