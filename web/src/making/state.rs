//! A scan that is being made: its files, what was typed, and what is missing. It stays as it is while
//! something else is shown, and when something goes wrong.

use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use js_sys::Array;
use leptos::prelude::*;
use snellius::compose::is_picture;
use wasm_bindgen::JsValue;
use wasm_bindgen_futures::spawn_local;
use web_sys::{Blob, File};

use super::arrival::Arrived;
use crate::run::{
    Drafted, Hand, MakeReply, MakeRequest, Problem, Thumbnail, ViewShown, sleep, unexpected,
};

/// A scan that is being made. A handle: copies mean the same.
#[derive(Clone, Copy)]
pub(crate) struct Making {
    /// Its form is shown.
    pub(crate) shown: RwSignal<bool>,
    pub(super) pictures: RwSignal<BTreeMap<String, File>, LocalStorage>,
    pub(super) calibration: RwSignal<Option<File>, LocalStorage>,
    pub(super) poses: RwSignal<Option<File>, LocalStorage>,
    /// What was typed, by the questions' ids.
    pub(super) answers: RwSignal<BTreeMap<String, String>>,
    /// What that comes to; nothing until a worker has said it.
    pub(super) drafted: RwSignal<Option<Arc<Drafted>>>,
    /// How many pictures are packed, of how many, while the archive is saved.
    pub(super) saving: RwSignal<Option<[usize; 2]>>,
    /// What went wrong last, in the whole page.
    problem: RwSignal<Option<Problem>>,
    hand: StoredValue<Option<Rc<Hand>>, LocalStorage>,
    /// Files, or answers, changed since the worker was told.
    news: StoredValue<News>,
    /// The worker is at somebody's pictures.
    developing: StoredValue<bool>,
}

#[derive(Clone, Copy, Default)]
struct News {
    files: bool,
    answers: bool,
    /// Somebody is telling the worker.
    on_the_way: bool,
}

impl Making {
    /// Nothing yet; what goes wrong is told there.
    pub(crate) fn new(problem: RwSignal<Option<Problem>>) -> Self {
        Self {
            shown: RwSignal::new(false),
            pictures: RwSignal::new_local(BTreeMap::new()),
            calibration: RwSignal::new_local(None),
            poses: RwSignal::new_local(None),
            answers: RwSignal::new(BTreeMap::new()),
            drafted: RwSignal::new(None),
            saving: RwSignal::new(None),
            problem,
            hand: StoredValue::new_local(None),
            news: StoredValue::new(News::default()),
            developing: StoredValue::new(false),
        }
    }

    /// Shows the form.
    pub(crate) fn show(self) {
        self.shown.set(true);
        self.tell(|news| news.answers = true);
    }

    /// Sorts files in: pictures, a calibration, poses. What is none of these is passed over.
    pub(super) fn take(self, files: Vec<Arrived>) {
        for arrived in files {
            match Kind::of(arrived.name()) {
                Kind::Picture => {
                    self.pictures
                        .update(|pictures| drop(pictures.insert(arrived.path, arrived.file)));
                }
                Kind::Calibration => self.calibration.set(Some(arrived.file)),
                Kind::Poses => self.poses.set(Some(arrived.file)),
                Kind::Other => {}
            }
        }
        self.files_changed();
    }

    /// Answers a question.
    pub(super) fn answer(self, id: String, answer: String) {
        self.answers
            .update(|answers| drop(answers.insert(id, answer)));
        self.tell(|news| news.answers = true);
    }

    pub(super) fn files_changed(self) {
        self.tell(|news| news.files = true);
    }

    /// Tells a worker what is new, and shows what it says. What changes meanwhile is told next.
    fn tell(self, what: impl FnOnce(&mut News)) {
        let idle = self.news.try_update_value(|news| {
            what(news);
            !std::mem::replace(&mut news.on_the_way, true)
        });
        if idle != Some(true) {
            return;
        }
        spawn_local(async move {
            if let Err(problem) = self.tell_all().await {
                self.hand.set_value(None);
                self.news.set_value(News {
                    files: true,
                    ..News::default()
                });
                self.problem.set(Some(problem));
            }
        });
    }

    async fn tell_all(self) -> Result<(), Problem> {
        let hand = self.hand().await?;
        loop {
            let news = self.news.get_value();
            if !news.files && !news.answers {
                self.news.update_value(|news| news.on_the_way = false);
                return Ok(());
            }
            self.news.update_value(|news| {
                news.files = false;
                news.answers = false;
            });
            if news.files {
                hand.make(self.gathered()).await?;
            }
            let answers = self.answers.get_untracked();
            let MakeReply::Drafted(drafted) = hand.make(MakeRequest::Draft(answers)).await? else {
                return Err(unexpected());
            };
            self.drafted.set(Some(Arc::new(*drafted)));
        }
    }

    async fn hand(self) -> Result<Rc<Hand>, Problem> {
        if let Some(hand) = self.hand.get_value() {
            return Ok(hand);
        }
        let hand = Rc::new(Hand::start().await?);
        self.hand.set_value(Some(Rc::clone(&hand)));
        Ok(hand)
    }

    fn gathered(self) -> MakeRequest {
        let pictures = self.pictures.with_untracked(|pictures| {
            let files = pictures.iter();
            by_turns(files.map(|(path, file)| (path.as_str(), file)))
        });
        let file = |file: Option<File>| file.map_or(JsValue::UNDEFINED, JsValue::from);
        MakeRequest::Gather {
            pictures,
            calibration: file(self.calibration.get_untracked()),
            poses: file(self.poses.get_untracked()),
        }
    }

    /// Some of the views that were drafted last, as far as there are so many.
    pub(super) async fn views(self, wanted: Range<usize>) -> Result<Vec<ViewShown>, Problem> {
        let hand = self.hand().await?;
        match hand.make(MakeRequest::Views(wanted)).await? {
            MakeReply::Views(views) => Ok(views),
            _ => Err(unexpected()),
        }
    }

    /// A view's pictures, small: with the laser on, and with it off.
    pub(super) async fn thumbnails(
        self,
        view: ViewShown,
    ) -> Result<(Thumbnail, Option<Thumbnail>), Problem> {
        const LOOK: i32 = 20;
        // One at a time: what is typed meanwhile waits for one view's pictures, not for a screenful.
        while self.developing.get_value() {
            sleep(LOOK).await;
        }
        self.developing.set_value(true);
        let thumbnails = self.developed(view).await;
        self.developing.set_value(false);
        thumbnails
    }

    async fn developed(self, view: ViewShown) -> Result<(Thumbnail, Option<Thumbnail>), Problem> {
        let ViewShown { on, off, .. } = view;
        let hand = self.hand().await?;
        match hand.make(MakeRequest::Thumbnails { on, off }).await? {
            MakeReply::Thumbnails(on, off) => Ok((on, off)),
            _ => Err(unexpected()),
        }
    }

    /// The archive of what was drafted last.
    pub(super) async fn archive(self, tell: impl Fn([usize; 2])) -> Result<Blob, Problem> {
        const LOOK: i32 = 20;
        while self.news.with_value(|news| news.on_the_way) {
            sleep(LOOK).await;
        }
        let ready = |drafted: &Option<Arc<Drafted>>| drafted.as_ref().is_some_and(|d| d.ready);
        if !self.drafted.with_untracked(ready) {
            return Err(Problem::input(
                "The scan is not complete.",
                "Add what is missing, as the form says.",
            ));
        }
        let hand = self.hand().await?;
        packed(&hand, MakeRequest::Pack, tell).await
    }

    /// What the archive is to be called.
    pub(super) fn file_name(self) -> String {
        let name = self
            .answers
            .with_untracked(|answers| answers.get("name").cloned());
        let name = name.unwrap_or_default();
        let plain = name.trim().replace(['/', '\\', ':'], "-");
        match plain.is_empty() {
            true => "scan.zip".to_owned(),
            false => format!("{plain}.zip"),
        }
    }
}

/// What a file is for, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Picture,
    Calibration,
    Poses,
    Other,
}

impl Kind {
    pub(super) fn of(name: &str) -> Self {
        let lower = name.to_lowercase();
        let ending = lower.rsplit('.').next().unwrap_or_default();
        match ending {
            _ if is_picture(name) => Self::Picture,
            "yml" | "yaml" | "xml" => Self::Calibration,
            "csv" | "tsv" | "txt" | "tum" => Self::Poses,
            "json" if lower.contains("pose") || lower.contains("traj") => Self::Poses,
            "json" if lower.contains("calib") || lower.contains("camera") => Self::Calibration,
            _ => Self::Other,
        }
    }
}

/// Path and file by turns, as workers take them.
pub(super) fn by_turns<'a>(files: impl Iterator<Item = (&'a str, &'a File)>) -> Array {
    let list = Array::new();
    for (path, file) in files {
        list.push(&path.into());
        list.push(file);
    }
    list
}

/// Has a worker pack an archive, file by file.
pub(super) async fn packed(
    hand: &Hand,
    begin: MakeRequest,
    tell: impl Fn([usize; 2]),
) -> Result<Blob, Problem> {
    let MakeReply::ToDo(files) = hand.make(begin).await? else {
        return Err(unexpected());
    };
    for packed in 0..files {
        tell([packed, files]);
        hand.make(MakeRequest::Next).await?;
    }
    match hand.make(MakeRequest::Close).await? {
        MakeReply::Archive(archive) => Ok(archive),
        _ => Err(unexpected()),
    }
}
