//! How many points are drawn while the scene is in motion: as many as the graphics card draws before the next
//! frame is due. At rest all are drawn.

use std::cell::Cell;

use super::points::BATCH;
use crate::run::now;

/// Keeps count of how fast frames follow one another.
pub(super) struct Pace {
    /// How many points a frame in motion may have.
    affordable: Cell<usize>,
    /// When something moved last, ms.
    moved: Cell<f64>,
    /// When something moved first since the last frame, ms; nothing, and nothing has.
    first: Cell<Option<f64>>,
    /// When the last frame in motion was drawn, ms.
    last: Cell<f64>,
    /// How many points the last frame had.
    drawn: Cell<usize>,
}

impl Default for Pace {
    fn default() -> Self {
        // Any card draws so many; a quick one is found out in some frames.
        const AT_FIRST: usize = 8 * BATCH;
        Self {
            affordable: Cell::new(AT_FIRST),
            moved: Cell::new(f64::MIN),
            first: Cell::new(None),
            last: Cell::new(f64::MIN),
            drawn: Cell::new(0),
        }
    }
}

impl Pace {
    /// Something moves.
    pub(super) fn moves(&self) {
        let now = now();
        self.moved.set(now);
        self.first.set(self.first.get().or(Some(now)));
    }

    /// How many of all points the frame at a time (ms) may have.
    pub(super) fn points(&self, time: f64, all: usize) -> usize {
        const REST: f64 = 180.0;
        let first = self.first.take();
        // A slow card draws a frame long after the hand has moved: it is one in motion all the same.
        let is_in_motion = first.is_some() || now() - self.moved.get() < REST;
        if !is_in_motion {
            self.last.set(f64::MIN);
            self.drawn.set(all);
            return all;
        }
        let last = self.last.replace(time);
        if !is_pause(last, first) {
            self.learn(time - last);
        }
        let points = self.affordable.get().min(all);
        self.drawn.set(points);
        points
    }

    /// A frame with the affordable points took so long, ms.
    fn learn(&self, passed: f64) {
        /// So long a frame may take,
        const SLOW: f64 = 34.0;
        /// and so quick ones may have more points.
        const QUICK: f64 = 20.0;
        const MOST: usize = 1 << 24;
        let affordable = self.affordable.get();
        if passed >= SLOW {
            let share = (SLOW / passed).max(0.5);
            let fewer = (affordable as f64 * share) as usize;
            self.affordable.set(fewer.max(BATCH));
        } else if passed > 0.0 && passed < QUICK {
            self.affordable.set((affordable + BATCH).min(MOST));
        }
    }

    /// Whether the last frame had fewer points than there are.
    pub(super) fn is_behind(&self, all: usize) -> bool {
        self.drawn.get() < all
    }
}

/// Whether the hand, not the card, was what took its time between two frames.
fn is_pause(last: f64, first: Option<f64>) -> bool {
    const LONG: f64 = 60.0;
    last == f64::MIN || first.is_some_and(|first| first - last > LONG)
}
