//! What was set before, so that every change of the result can be taken back.

use serde::{Deserialize, Serialize};

use crate::run::Plan;

/// The plans before and after the present one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct History {
    past: Vec<Plan>,
    future: Vec<Plan>,
    /// What is being turned: a drag through a hundred values is one change.
    #[serde(skip)]
    turning: Option<&'static str>,
}

impl History {
    /// Remembers the plan before a change of `what`.
    pub(crate) fn note(&mut self, what: &'static str, before: Plan) {
        if self.turning != Some(what) {
            self.past.push(before);
        }
        self.turning = Some(what);
        self.future.clear();
    }

    /// Whatever was being turned has been let go.
    pub(crate) fn let_go(&mut self) {
        self.turning = None;
    }

    /// The plan before the last change, in exchange for the present one.
    pub(crate) fn undo(&mut self, now: Plan) -> Option<Plan> {
        self.turning = None;
        let before = self.past.pop()?;
        self.future.push(now);
        Some(before)
    }

    /// The plan before the last undo, in exchange for the present one.
    pub(crate) fn redo(&mut self, now: Plan) -> Option<Plan> {
        self.turning = None;
        let after = self.future.pop()?;
        self.past.push(now);
        Some(after)
    }

    /// Whether there is anything to undo.
    pub(crate) fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is anything to redo.
    pub(crate) fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}
