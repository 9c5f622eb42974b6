//! The DevTools protocol: how a test talks to Chromium.
//!
//! Why not one of the crates that drive a browser? Most of what the page does happens in its
//! workers. `headless_chrome` and `chromiumoxide` follow pages only: an exception in a worker or a
//! request from one never reaches the test, and they generate types for the whole protocol,
//! which takes longer to compile than all else here. WebDriver (`fantoccini`, `thirtyfour`)
//! tells nothing of requests. The protocol itself is JSON over a WebSocket: this file is all
//! that is needed.

use std::{
    collections::HashMap,
    net::{Shutdown, TcpStream},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
        mpsc,
    },
    thread::JoinHandle,
    time::Duration,
};

use anyhow::{Context, Result, anyhow, bail};
use serde_json::{Value, json};
use tungstenite::{
    Message, WebSocket,
    protocol::{Role, WebSocketConfig},
};

/// Longest time that Chromium may take for one answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// Something that Chromium told without being asked.
#[derive(Clone, Debug)]
pub(crate) struct Event {
    pub(crate) method: String,
    pub(crate) params: Value,
}

/// A connection to one Chromium, for all its pages and workers.
pub(crate) struct Connection {
    shared: Arc<Shared>,
    socket: TcpStream,
    reader: Option<JoinHandle<()>>,
}

type Answer = Result<Value, String>;

struct Shared {
    writer: Mutex<WebSocket<TcpStream>>,
    last_id: AtomicU64,
    waiting: Mutex<HashMap<u64, mpsc::Sender<Answer>>>,
    events: Mutex<Vec<Event>>,
}

impl Connection {
    /// Connects to the WebSocket at `path` of a Chromium that listens on `port`.
    pub(crate) fn open(port: u16, path: &str) -> Result<Self> {
        let socket = TcpStream::connect(("127.0.0.1", port))?;
        socket.set_nodelay(true)?;
        let url = format!("ws://127.0.0.1:{port}{path}");
        // A screenshot or a file comes as one message.
        let limits = WebSocketConfig::default()
            .max_message_size(None)
            .max_frame_size(None);
        let (reader, _) =
            tungstenite::client::client_with_config(url, socket.try_clone()?, Some(limits))
                .map_err(|error| anyhow!("Chromium refused the connection: {error}"))?;
        let writer = WebSocket::from_raw_socket(socket.try_clone()?, Role::Client, Some(limits));
        let shared = Arc::new(Shared {
            writer: Mutex::new(writer),
            last_id: AtomicU64::new(0),
            waiting: Mutex::default(),
            events: Mutex::default(),
        });
        let reader = std::thread::spawn({
            let shared = Arc::clone(&shared);
            move || shared.read_all(reader)
        });
        Ok(Self {
            shared,
            socket,
            reader: Some(reader),
        })
    }

    /// Calls a method of the browser (no session) or of one of its targets and waits for the answer.
    pub(crate) fn call(&self, session: Option<&str>, method: &str, params: Value) -> Result<Value> {
        let (sender, receiver) = mpsc::channel();
        let id = self.shared.next_id();
        locked(&self.shared.waiting).insert(id, sender);
        self.shared.send(id, session, method, params)?;
        match receiver.recv_timeout(PATIENCE) {
            Ok(Ok(answer)) => Ok(answer),
            Ok(Err(refusal)) => bail!("{method}: {refusal}"),
            Err(mpsc::RecvTimeoutError::Timeout) => bail!("{method}: no answer in {PATIENCE:?}"),
            Err(mpsc::RecvTimeoutError::Disconnected) => bail!("{method}: Chromium has gone"),
        }
    }

    /// What has been told so far, from the event of that number on.
    pub(crate) fn events_since(&self, start: usize) -> Vec<Event> {
        let events = locked(&self.shared.events);
        events[start.min(events.len())..].to_vec()
    }

    /// How many events there have been.
    pub(crate) fn event_count(&self) -> usize {
        locked(&self.shared.events).len()
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        // The reader then sees the end of the stream. Either may have happened already.
        let _ = self.socket.shutdown(Shutdown::Both);
        if let Some(reader) = self.reader.take() {
            let _ = reader.join();
        }
    }
}

impl Shared {
    fn next_id(&self) -> u64 {
        self.last_id.fetch_add(1, Ordering::Relaxed) + 1
    }

    fn send(&self, id: u64, session: Option<&str>, method: &str, params: Value) -> Result<()> {
        let mut message = json!({ "id": id, "method": method, "params": params });
        if let Some(session) = session {
            message["sessionId"] = session.into();
        }
        locked(&self.writer)
            .send(Message::text(message.to_string()))
            .with_context(|| format!("{method}: cannot be sent to Chromium"))
    }

    fn read_all(&self, mut socket: WebSocket<TcpStream>) {
        while let Ok(message) = socket.read() {
            if let Message::Text(text) = message {
                let message = serde_json::from_str(&text).expect("Chromium sends JSON");
                self.take(message);
            }
        }
        // Whoever still waits learns that no answer will come.
        locked(&self.waiting).clear();
    }

    fn take(&self, mut message: Value) {
        if let Some(id) = message["id"].as_u64() {
            if let Some(sender) = locked(&self.waiting).remove(&id) {
                // The receiver may have lost patience.
                let _ = sender.send(answer(message));
            }
            return;
        }
        let event = Event {
            method: message["method"].as_str().unwrap_or_default().to_owned(),
            params: message["params"].take(),
        };
        if event.method == "Target.attachedToTarget"
            && let Some(session) = event.params["sessionId"].as_str()
        {
            self.listen_to(session);
        }
        locked(&self.events).push(event);
    }

    /// Hears a new page or worker from its first instruction on: it is held until then.
    fn listen_to(&self, session: &str) {
        let children =
            json!({ "autoAttach": true, "waitForDebuggerOnStart": true, "flatten": true });
        for (method, params) in [
            ("Runtime.enable", json!({})),
            ("Network.enable", json!({})),
            ("Log.enable", json!({})),
            ("Target.setAutoAttach", children),
            ("Runtime.runIfWaitingForDebugger", json!({})),
        ] {
            // Nobody waits for the answers: not every kind of worker knows every method, and a
            // closed connection shows wherever the test calls next.
            let _ = self.send(self.next_id(), Some(session), method, params);
        }
    }
}

fn answer(mut message: Value) -> Answer {
    match message["error"]["message"].as_str() {
        Some(refusal) => Err(refusal.to_owned()),
        None => Ok(message["result"].take()),
    }
}

/// A lock that outlives a panic: a failing test still has to report and to clear away.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
