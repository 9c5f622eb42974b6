//! How many points a frame may draw: as many as the graphics card draws before the next frame is due. A scene
//! that moves shows so many; one at rest gets so many more with each frame, until all are there.

use std::cell::Cell;

use super::points::BATCH;

/// Keeps count of how fast frames follow one another.
pub(super) struct Pace {
    /// How many points a frame may draw.
    affordable: Cell<usize>,
    /// When the last frame was drawn, ms, and with how many points, if this one follows it at once.
    last: Cell<Option<(f64, usize)>>,
}

impl Default for Pace {
    fn default() -> Self {
        // Any card draws so many; a quick one is found out in some frames.
        const AT_FIRST: usize = 4 * BATCH;
        Self {
            affordable: Cell::new(AT_FIRST),
            last: Cell::new(None),
        }
    }
}

impl Pace {
    /// How many points the frame at a time (ms) may draw.
    pub(super) fn points(&self, time: f64) -> usize {
        if let Some((last, drawn)) = self.last.take()
            && drawn >= self.affordable.get()
        {
            self.learn(time - last);
        }
        self.affordable.get()
    }

    /// The frame at a time (ms) drew so many points, and the next one is asked for.
    pub(super) fn drew(&self, time: f64, points: usize) {
        self.last.set(Some((time, points)));
    }

    /// A frame with the affordable points took so long, ms.
    fn learn(&self, passed: f64) {
        /// So long a frame may take,
        const SLOW: f64 = 40.0;
        /// and so quick ones may have more points.
        const QUICK: f64 = 25.0;
        const MOST: usize = 1 << 24;
        let affordable = self.affordable.get();
        if passed >= SLOW {
            let share = (SLOW / passed).max(0.5);
            let fewer = (affordable as f64 * share) as usize;
            self.affordable.set(fewer.max(BATCH));
        } else if passed < QUICK {
            let more = affordable + affordable / 4;
            self.affordable.set(more.min(MOST));
        }
    }
}
