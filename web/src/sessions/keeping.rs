//! Keeps what is being measured, by itself: twice a second whatever is new is written down.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use leptos::prelude::Set;
use wasm_bindgen::JsValue;
use wasm_bindgen_futures::spawn_local;
use web_sys::Blob;

use super::not_kept::words;
use super::record::{Found, HowFar, Origin, Record, Unkept};
use super::session::Session;
use crate::run::{Workers, sleep};
use crate::state::Workbench;

/// How often it is looked at what is new, ms.
const LOOK: i32 = 500;

/// One scan on its way through the page, and what is kept of it.
pub(crate) struct Keeping {
    archive: Blob,
    record: RefCell<Record>,
    workers: RefCell<Option<Rc<Workers>>>,
    phase: Cell<Phase>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Opening,
    Shown,
    /// Another scan is shown.
    Left,
    /// It was cancelled, or it is no scan.
    GivenUp,
}

impl Keeping {
    pub(crate) const fn new(record: Record, archive: Blob) -> Self {
        Self {
            archive,
            record: RefCell::new(record),
            workers: RefCell::new(None),
            phase: Cell::new(Phase::Opening),
        }
    }

    pub(crate) const fn archive(&self) -> &Blob {
        &self.archive
    }

    pub(crate) fn record(&self) -> Record {
        self.record.borrow().clone()
    }

    /// Goes on as a session that was packed with the scan says. One that cannot be read is passed over.
    pub(crate) fn take_over(&self, packed: &str) {
        if let Some(packed) = Record::from_text(packed) {
            let mut record = self.record.borrow_mut();
            record.plan = packed.plan;
            record.history = packed.history;
            record.chosen = packed.chosen;
        }
    }

    /// The scan is open.
    pub(crate) fn measures(&self, workers: &Rc<Workers>) {
        self.workers.replace(Some(Rc::clone(workers)));
    }

    pub(crate) fn is_shown(&self) {
        self.phase.set(Phase::Shown);
    }

    pub(crate) fn leave(&self) {
        self.phase.set(Phase::Left);
    }

    pub(crate) fn give_up(&self) {
        self.phase.set(Phase::GivenUp);
    }

    /// Keeps it, until another scan is shown. What cannot be kept is said, and the measurement goes on.
    pub(crate) async fn keep(self: Rc<Self>, workbench: Workbench, kept: Option<Session>) {
        if let Err(error) = self.try_to_keep(workbench, kept).await {
            web_sys::console::info_2(&"The session is not kept:".into(), &error);
            self.tell_unkept(workbench, Unkept::News);
        }
    }

    async fn try_to_keep(
        self: &Rc<Self>,
        workbench: Workbench,
        kept: Option<Session>,
    ) -> Result<(), JsValue> {
        let is_new = kept.is_none();
        let session = match kept {
            Some(session) => session,
            None => Session::begin().await?,
        };
        session.write(&self.record()).await?;
        if is_new {
            // It takes its time; what is measured meanwhile is kept all the same.
            let (keeping, id) = (Rc::clone(self), session.id().to_owned());
            spawn_local(async move { keeping.keep_archive(workbench, &id).await });
        }
        let mut written = self.record();
        loop {
            let phase = self.phase.get();
            if phase == Phase::Left {
                return Ok(());
            }
            if phase == Phase::GivenUp {
                return match is_new {
                    true => self.discard(&session).await,
                    false => Ok(()),
                };
            }
            self.write_news(workbench, &session, &mut written).await?;
            sleep(LOOK).await;
        }
    }

    /// Without its archive a session asks for that when it is opened.
    async fn keep_archive(&self, workbench: Workbench, id: &str) {
        if !self.record().lacks_archive() {
            let kept = async { Session::open(id).await?.keep_archive(&self.archive).await };
            let Err(error) = kept.await else { return };
            web_sys::console::info_2(&"The archive is not kept:".into(), &error);
            self.record.borrow_mut().unkept = Some(Unkept::Archive);
        }
        if let Some(what) = self.record().unkept {
            self.tell_unkept(workbench, what);
        }
    }

    fn tell_unkept(&self, workbench: Workbench, what: Unkept) {
        if matches!(self.phase.get(), Phase::Opening | Phase::Shown) {
            let record = self.record();
            workbench.unkept.set(words(what, &record));
            workbench
                .offers_archive
                .set(record.origin == Origin::Pictures);
        }
    }

    async fn write_news(
        &self,
        workbench: Workbench,
        session: &Session,
        written: &mut Record,
    ) -> Result<(), JsValue> {
        let news = self
            .workers
            .borrow()
            .as_ref()
            .and_then(|workers| workers.news());
        if let Some((settings, spots)) = news {
            session.keep_found(&Found { settings, spots }).await?;
        }
        let mut record = self.now(workbench);
        if record.picture.is_none()
            && let HowFar::Measured { views, .. } = record.progress
        {
            record.picture = self
                .picture(session, record.chosen.unwrap_or(views / 2))
                .await;
        }
        if record != *written {
            record.changed = js_sys::Date::now();
            // Its name is changed elsewhere.
            if let Some(on_disk) = session.record().await {
                record.name = on_disk.name;
                record.deleted = on_disk.deleted;
            }
            session.write(&record).await?;
            self.record.replace(record.clone());
            *written = record;
        }
        Ok(())
    }

    /// What cannot be removed yet, because it is still being written, is removed the next time.
    async fn discard(&self, session: &Session) -> Result<(), JsValue> {
        let mut record = self.record();
        record.deleted = true;
        session.write(&record).await?;
        super::session::remove(session.id()).await
    }

    fn now(&self, workbench: Workbench) -> Record {
        let record = self.record();
        match self.phase.get() {
            Phase::Shown => workbench.to_be_kept(&record),
            _ => workbench.on_the_way(record),
        }
    }

    async fn picture(&self, session: &Session, view: usize) -> Option<[u32; 2]> {
        let workers = self.workers.borrow().clone()?;
        let picture = workers.thumbnail(view).await.ok()?;
        session.keep_picture(&picture).await.ok()?;
        Some([picture.width, picture.height])
    }
}
