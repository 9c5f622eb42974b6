//! A hand: the page's side of one worker. Ask it, await the answer; drop it, and the worker ends at once.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;

use futures::channel::oneshot;
use js_sys::Uint8Array;
use snellius::export::Format;
use snellius::pipeline::Settings;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, ErrorEvent, MessageEvent, Url, Worker};

use super::figure::{FigureForm, FigureOf, Figured};
use super::guest::Guest;
use super::making::{MakeReply, MakeRequest};
use super::messages::{
    Answer, PictureSet, Question, READY, Reply, Request, Thumbnail, WrittenSpots,
};
use super::passing::{LinkMade, PageWish};
use super::plan::Plan;
use super::problem::Problem;
use super::program::Program;
use super::report::{Facts, Outcome, Piece};
use super::study::Study;

type Answered = Result<Reply, Problem>;
type Listener<E> = Closure<dyn FnMut(E)>;

/// The page's side of one worker.
pub(crate) struct Hand {
    worker: Worker,
    /// The worker's own script, as long as it is needed.
    script: String,
    open_questions: OpenQuestions,
    last_number: Cell<u32>,
    /// Kept as long as the worker may call it.
    _on_message: Listener<MessageEvent>,
    /// Likewise.
    _on_error: Listener<ErrorEvent>,
}

impl Drop for Hand {
    fn drop(&mut self) {
        self.worker.set_onmessage(None);
        self.worker.set_onerror(None);
        self.worker.terminate();
        let _ = Url::revoke_object_url(&self.script);
    }
}

impl Hand {
    /// Starts a worker and waits until it is there.
    pub(crate) async fn start() -> Result<Self, Problem> {
        let program = Program::get().await?;
        let hand = Self::new(&program).map_err(|e| {
            Problem::own(format!("The browser did not start a worker: {}", text(&e)))
        })?;
        match hand.open_questions.add(READY).await {
            Ok(Ok(Reply::Ready)) => Ok(hand),
            Ok(Err(problem)) => Err(problem),
            _ => Err(unexpected()),
        }
    }

    fn new(program: &Program) -> Result<Self, JsValue> {
        let (worker, script) = program.start()?;
        let open_questions = OpenQuestions::default();
        let questions = open_questions.clone();
        let on_message =
            Closure::<dyn FnMut(_)>::new(move |event: MessageEvent| questions.receive(&event));
        let questions = open_questions.clone();
        let on_error = Closure::<dyn FnMut(_)>::new(move |event: ErrorEvent| {
            event.prevent_default();
            questions.fail_all(&format!("A worker stopped: {}", event.message()));
        });
        worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
        worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));
        Ok(Self {
            worker,
            script,
            open_questions,
            last_number: Cell::new(READY),
            _on_message: on_message,
            _on_error: on_error,
        })
    }

    /// Has the worker open an archive.
    pub(crate) async fn open(&self, file: &Blob) -> Result<Facts, Problem> {
        match self.ask(Request::Open(file.clone())).await? {
            Reply::Opened(facts) => Ok(*facts),
            _ => Err(unexpected()),
        }
    }

    /// Has the worker open an archive that another has opened already.
    pub(crate) async fn open_too(&self, file: &Blob) -> Result<(), Problem> {
        match self.ask(Request::OpenToo(file.clone())).await? {
            Reply::Ready => Ok(()),
            _ => Err(unexpected()),
        }
    }

    /// Has it find the spots of a view.
    pub(crate) async fn observe(
        &self,
        view: usize,
        settings: Settings,
    ) -> Result<WrittenSpots, Problem> {
        match self.ask(Request::Observe { view, settings }).await? {
            Reply::Observed(spots) => Ok(spots),
            _ => Err(unexpected()),
        }
    }

    /// Gives it the spots of all views to keep.
    pub(crate) async fn keep(&self, spots: &[WrittenSpots]) -> Result<(), Problem> {
        // So many go over in some milliseconds.
        const AT_ONCE: usize = 100;
        let mut before = 0;
        for some in spots.chunks(AT_ONCE) {
            let request = Request::Keep(before, some.iter().collect());
            let Reply::Kept = self.ask(request).await? else {
                return Err(unexpected());
            };
            before += some.len();
        }
        Ok(())
    }

    /// Has it measure vessel and object from the spots it keeps.
    pub(crate) async fn measure(&self, plan: &Plan) -> Result<Outcome, Problem> {
        match self.ask(Request::Measure(Box::new(plan.clone()))).await? {
            Reply::Measured(outcome) => Ok(*outcome),
            _ => Err(unexpected()),
        }
    }

    /// Has it say what the spots it keeps tell of the liquid's index.
    pub(crate) async fn study(&self, plan: &Plan) -> Result<Study, Problem> {
        match self.ask(Request::Study(Box::new(plan.clone()))).await? {
            Reply::Studied(study) => Ok(*study),
            _ => Err(unexpected()),
        }
    }

    /// Has it decode the pictures of a view.
    pub(crate) async fn pictures(&self, view: usize) -> Result<PictureSet, Problem> {
        match self.ask(Request::Pictures { view }).await? {
            Reply::Pictures(pictures) => Ok(pictures),
            _ => Err(unexpected()),
        }
    }

    /// Has it decode a view's picture, small.
    pub(crate) async fn thumbnail(&self, view: usize) -> Result<Thumbnail, Problem> {
        match self.ask(Request::Thumbnail { view }).await? {
            Reply::Thumbnail(thumbnail) => Ok(thumbnail),
            _ => Err(unexpected()),
        }
    }

    /// Has it draw a figure, or write it as a table.
    pub(crate) async fn figure(&self, of: FigureOf, form: FigureForm) -> Result<Figured, Problem> {
        match self.ask(Request::Figure { of, form }).await? {
            Reply::Figured(figured) => Ok(figured),
            _ => Err(unexpected()),
        }
    }

    /// Has it write a file.
    pub(crate) async fn write(&self, format: Format) -> Result<Uint8Array, Problem> {
        match self.ask(Request::Write(format)).await? {
            Reply::Written(bytes) => Ok(bytes),
            _ => Err(unexpected()),
        }
    }

    /// Has it put a note into the archive; says how many of its first bytes stay, and what follows them.
    pub(crate) async fn note(&self, note: String) -> Result<(f64, Uint8Array), Problem> {
        match self.ask(Request::Note(note)).await? {
            Reply::Noted(keep, bytes) => Ok((keep, bytes)),
            _ => Err(unexpected()),
        }
    }

    /// Has it open what a link holds.
    pub(crate) async fn open_link(&self, fragment: String) -> Result<Guest, Problem> {
        self.receive(Request::OpenLink(fragment)).await
    }

    /// Has it open a file that was passed on.
    pub(crate) async fn open_passed(&self, file: Blob) -> Result<Guest, Problem> {
        self.receive(Request::OpenPassed(file)).await
    }

    async fn receive(&self, request: Request) -> Result<Guest, Problem> {
        match self.ask(request).await? {
            Reply::Received(guest) => Ok(*guest),
            _ => Err(unexpected()),
        }
    }

    /// Has it make a link.
    pub(crate) async fn link(&self, settings: Settings) -> Result<LinkMade, Problem> {
        match self.ask(Request::Link(settings)).await? {
            Reply::Linked(made) => Ok(made),
            _ => Err(unexpected()),
        }
    }

    /// Has it write a one-file page.
    pub(crate) async fn page(
        &self,
        settings: Settings,
        wish: PageWish,
    ) -> Result<Uint8Array, Problem> {
        match self.ask(Request::Page(settings, wish)).await? {
            Reply::Written(bytes) => Ok(bytes),
            _ => Err(unexpected()),
        }
    }

    /// Has it help with making a scan.
    pub(crate) async fn make(&self, request: MakeRequest) -> Result<MakeReply, Problem> {
        match self.ask(Request::Make(request)).await? {
            Reply::Make(reply) => Ok(reply),
            _ => Err(unexpected()),
        }
    }

    async fn ask(&self, request: Request) -> Answered {
        let number = self.last_number.get() + 1;
        self.last_number.set(number);
        let answer = self.open_questions.add(number);
        let question = serde_wasm_bindgen::to_value(&Question { number, request })
            .map_err(|e| Problem::own(e.to_string()))?;
        self.worker
            .post_message(&question)
            .map_err(|e| Problem::own(text(&e)))?;
        answer.await.unwrap_or_else(|_| Err(unexpected()))
    }
}

/// Who waits for which answer, and what has come of it.
#[derive(Clone, Default)]
struct OpenQuestions(Rc<RefCell<HashMap<u32, Waiting>>>);

struct Waiting {
    sender: oneshot::Sender<Answered>,
    pieces: Vec<Piece>,
}

impl OpenQuestions {
    fn add(&self, number: u32) -> oneshot::Receiver<Answered> {
        let (sender, receiver) = oneshot::channel();
        let pieces = Vec::new();
        let waiting = Waiting { sender, pieces };
        self.0.borrow_mut().insert(number, waiting);
        receiver
    }

    fn receive(&self, event: &MessageEvent) {
        match serde_wasm_bindgen::from_value(event.data()) {
            Ok(Answer {
                reply: Reply::Panicked(panic),
                ..
            }) => self.fail_all(&panic),
            Ok(Answer {
                number,
                reply: Reply::Piece(piece),
            }) => self.add_piece(number, piece),
            Ok(Answer { number, reply }) => self.answer(number, reply),
            Err(error) => self.fail_all(&error.to_string()),
        }
    }

    fn add_piece(&self, number: u32, piece: Piece) {
        if let Some(waiting) = self.0.borrow_mut().get_mut(&number) {
            waiting.pieces.push(piece);
        }
    }

    fn answer(&self, number: u32, mut reply: Reply) {
        let Some(waiting) = self.0.borrow_mut().remove(&number) else {
            return;
        };
        reply.put_together(waiting.pieces);
        // Whoever asked may have given up by now.
        let _ = waiting.sender.send(match reply {
            Reply::Refused(problem) => Err(problem),
            reply => Ok(reply),
        });
    }

    fn fail_all(&self, cause: &str) {
        for (_, waiting) in self.0.take() {
            let _ = waiting.sender.send(Err(Problem::own(cause)));
        }
    }
}

pub(crate) fn unexpected() -> Problem {
    Problem::own("A worker did not answer what it was asked.")
}

fn text(error: &JsValue) -> String {
    error
        .dyn_ref::<js_sys::Error>()
        .map_or_else(|| format!("{error:?}"), |error| error.message().into())
}
