//! The worker's side: answers one question after another about the archive it was told to open.

use std::cell::RefCell;

use js_sys::{Array, Uint8Array};
use snellius::export::{Format, ReconstructionResult};
use snellius::pipeline::{Settings, correct, observe, reconstruct, study_index};
use snellius::scan::Archive;
use snellius::share::Document;
use snellius::spots::Spots;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, DedicatedWorkerGlobalScope, MessageEvent};

use super::blob_reader::BlobReader;
use super::develop::{develop, thumbnail};
use super::guest::Guest;
use super::making::Maker;
use super::messages::{Answer, Question, READY, Reply, Request};
use super::passing;
use super::plan::Plan;
use super::problem::Problem;
use super::report::{Facts, Outcome};
use super::study::Study;

type OpenArchive = Archive<BlobReader>;

/// What a worker remembers between questions.
#[derive(Default)]
struct Desk {
    archive: Option<OpenArchive>,
    spots: Vec<Spots>,
    result: Option<ReconstructionResult>,
    /// What was passed on, in place of an archive.
    passed_on: Option<Document>,
    /// What was said last of the index, and for which plan.
    study: Option<(Plan, Study)>,
    /// A scan that is being made.
    maker: Maker,
}

thread_local! {
    static DESK: RefCell<Desk> = RefCell::default();
    /// The number of the question at work, for the message in case of a panic.
    static AT_WORK: std::cell::Cell<u32> = const { std::cell::Cell::new(READY) };
}

/// Starts answering.
pub(crate) fn start(scope: &DedicatedWorkerGlobalScope) {
    std::panic::set_hook(Box::new(|panic| {
        web_sys::console::error_1(&panic.to_string().into());
        answer(AT_WORK.get(), Reply::Panicked(panic.to_string()));
    }));
    let listen = Closure::<dyn FnMut(MessageEvent)>::new(|event: MessageEvent| {
        let question: Question = serde_wasm_bindgen::from_value(event.data())
            .expect("the page and its workers are one program");
        AT_WORK.set(question.number);
        let reply = DESK.with_borrow_mut(|desk| desk.reply(question.request));
        answer(question.number, reply.unwrap_or_else(Reply::Refused));
    });
    scope.set_onmessage(Some(listen.as_ref().unchecked_ref()));
    listen.forget();
    answer(READY, Reply::Ready);
}

fn answer(number: u32, mut reply: Reply) {
    for piece in reply.take_apart() {
        send(number, Reply::Piece(piece));
    }
    send(number, reply);
}

fn send(number: u32, reply: Reply) {
    let transfer = reply.transfer();
    let Ok(message) = serde_wasm_bindgen::to_value(&Answer { number, reply }) else {
        return;
    };
    let scope: DedicatedWorkerGlobalScope = js_sys::global().unchecked_into();
    post(&scope, &message, &transfer);
}

fn post(scope: &DedicatedWorkerGlobalScope, message: &JsValue, transfer: &Array) {
    if let Err(error) = scope.post_message_with_transfer(message, transfer) {
        web_sys::console::error_1(&error);
    }
}

impl Desk {
    fn reply(&mut self, request: Request) -> Result<Reply, Problem> {
        match request {
            Request::Open(file) => self.open(file),
            Request::OpenToo(file) => self.open(file).map(|_| Reply::Ready),
            Request::Observe { view, settings } => {
                let spots = observe(self.archive()?, view, &settings)?;
                let written = serde_json::to_vec(&spots).map_err(unreadable)?;
                Ok(Reply::Observed(Uint8Array::from(written.as_slice())))
            }
            Request::Keep(before, spots) => {
                self.spots.truncate(before);
                self.spots.extend(read(&spots)?);
                self.study = None;
                Ok(Reply::Kept)
            }
            Request::Measure(plan) => self.measure(&plan),
            Request::Study(plan) => self.study(&plan),
            Request::Pictures { view } => {
                Ok(Reply::Pictures(develop(&self.archive()?.pictures(view)?)))
            }
            Request::Thumbnail { view } => Ok(Reply::Thumbnail(thumbnail(
                &self.archive()?.pictures(view)?.on,
            ))),
            Request::Figure { of, form } => {
                let result = self.result.as_ref().ok_or_else(out_of_order)?;
                let study = self.study.as_ref().map(|(_, study)| study);
                Ok(Reply::Figured(of.make(form, result, study)))
            }
            Request::Write(format) => self.write(format),
            Request::Note(note) => self.note(&note),
            Request::OpenLink(fragment) => {
                let (document, rounding) = passing::from_link(&fragment)?;
                self.receive(document, Some(rounding))
            }
            Request::OpenPassed(file) => self.receive(passing::from_file(&file)?, None),
            Request::Link(settings) => {
                let result = self.result.as_ref().ok_or_else(out_of_order)?;
                passing::link(&settings, result).map(Reply::Linked)
            }
            Request::Page(settings, wish) => {
                let page = passing::page(wish, self.document(settings)?)?;
                Ok(Reply::Written(page.as_bytes().into()))
            }
            Request::Make(request) => self.maker.reply(request).map(Reply::Make),
        }
    }

    fn open(&mut self, file: Blob) -> Result<Reply, Problem> {
        let reader = BlobReader::new(file)
            .map_err(|e| Problem::own(format!("The browser gives no file reader: {e:?}")))?;
        let mut archive = Archive::open(reader)?;
        let mut facts = Facts::of(archive.scan());
        facts.session = archive.session();
        self.archive = Some(archive);
        Ok(Reply::Opened(Box::new(facts)))
    }

    fn measure(&mut self, plan: &Plan) -> Result<Reply, Problem> {
        correct(&mut self.spots, &plan.corrections);
        let scan = self.archive()?.scan().clone();
        let reconstruction = reconstruct(&scan, &self.spots, &plan.settings)?;
        if let Some(study) = &reconstruction.index_study {
            self.study = Some((plan.without_index(), Study::of(study)));
        }
        if reconstruction.index.value.is_none() {
            return Err(Problem::index_wanted(
                reconstruction.index.reason.as_deref(),
            ));
        }
        let outcome = Outcome::of(&reconstruction);
        self.result = Some(reconstruction.result());
        Ok(Reply::Measured(Box::new(outcome)))
    }

    /// What the spots tell of the index; at hand if the last measurement had to find it out.
    fn study(&mut self, plan: &Plan) -> Result<Reply, Problem> {
        let plan = plan.without_index();
        if let Some((of, study)) = &self.study
            && *of == plan
        {
            return Ok(Reply::Studied(Box::new(study.clone())));
        }
        correct(&mut self.spots, &plan.corrections);
        let scan = self.archive()?.scan().clone();
        let study = Study::of(&study_index(&scan, &self.spots, &plan.settings)?);
        self.study = Some((plan, study.clone()));
        Ok(Reply::Studied(Box::new(study)))
    }

    fn write(&self, format: Format) -> Result<Reply, Problem> {
        let result = self.result.as_ref().ok_or_else(out_of_order)?;
        let bytes = result.write(format)?;
        Ok(Reply::Written(Uint8Array::from(bytes.as_slice())))
    }

    /// The archive is closed afterwards.
    fn note(&mut self, note: &str) -> Result<Reply, Problem> {
        let archive = self.archive.take().ok_or_else(out_of_order)?;
        let tail = archive.with_session(note)?;
        let bytes = Uint8Array::from(tail.bytes.as_slice());
        Ok(Reply::Noted(tail.keep as f64, bytes))
    }

    /// Takes in what was passed on in place of an archive.
    fn receive(&mut self, document: Document, rounding: Option<f64>) -> Result<Reply, Problem> {
        let guest = Guest::of(&document, rounding)?;
        self.result = Some(document.result.clone());
        self.passed_on = Some(document);
        Ok(Reply::Received(Box::new(guest)))
    }

    /// What was measured last, or was passed on, to be passed on.
    fn document(&self, settings: Settings) -> Result<Document, Problem> {
        if let Some(document) = &self.passed_on {
            return Ok(document.clone());
        }
        let result = self.result.clone().ok_or_else(out_of_order)?;
        let archive = self.archive.as_ref().ok_or_else(out_of_order)?;
        let manifest = archive.scan().manifest.clone();
        Ok(Document::new(
            None,
            String::new(),
            settings,
            Some(manifest),
            result,
        ))
    }

    fn archive(&mut self) -> Result<&mut OpenArchive, Problem> {
        self.archive.as_mut().ok_or_else(out_of_order)
    }
}

/// The spots that another worker has written.
fn read(written: &Array) -> Result<Vec<Spots>, Problem> {
    let views = written.iter();
    let read = |view: JsValue| {
        let bytes = view.unchecked_into::<Uint8Array>().to_vec();
        serde_json::from_slice(&bytes).map_err(unreadable)
    };
    views.map(read).collect()
}

fn unreadable(error: serde_json::Error) -> Problem {
    Problem::own(format!("A worker does not read spots: {error}."))
}

fn out_of_order() -> Problem {
    Problem::own("A worker was asked before it had what the question is about.")
}
