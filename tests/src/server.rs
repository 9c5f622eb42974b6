//! A static file server on a free loopback port, as plain as the hosts that the page is for.

use std::{
    collections::HashMap,
    fs,
    io::{BufRead, BufReader, Write},
    net::{TcpListener, TcpStream},
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread::JoinHandle,
};

use anyhow::{Context, Result};

/// A served directory. Ends when dropped.
pub struct Site {
    port: u16,
    files: Arc<Files>,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

struct Files {
    directory: PathBuf,
    /// Where in the site the directory lies, with a slash at both ends.
    base: String,
    /// Files that a test adds, by their whole path.
    extra: Mutex<HashMap<String, Vec<u8>>>,
    /// Whether pages of other hosts may read the files.
    for_all: AtomicBool,
}

impl Site {
    /// Serves a directory at the root of the site.
    pub fn at_root(directory: &Path) -> Result<Self> {
        Self::under("/", directory)
    }

    /// Serves a directory under a path such as `/lab/snellius/`; all else is not found.
    pub fn under(base: &str, directory: &Path) -> Result<Self> {
        assert!(
            base.starts_with('/') && base.ends_with('/'),
            "a base path has a slash at both ends"
        );
        let listener = TcpListener::bind("127.0.0.1:0").context("no server")?;
        let port = listener
            .local_addr()
            .context("the server has no port")?
            .port();
        let files = Arc::new(Files {
            directory: directory.to_owned(),
            base: base.to_owned(),
            extra: Mutex::default(),
            for_all: AtomicBool::new(false),
        });
        let over = Arc::new(AtomicBool::new(false));
        let thread = std::thread::spawn({
            let (files, over) = (Arc::clone(&files), Arc::clone(&over));
            move || serve(&listener, &files, &over)
        });
        Ok(Self {
            port,
            files,
            over,
            thread: Some(thread),
        })
    }

    /// The address of the directory.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}{}", self.port, self.files.base)
    }

    /// Lets pages of other hosts read the files (CORS).
    pub fn allow_other_hosts(&self) {
        self.files.for_all.store(true, Ordering::SeqCst);
    }

    /// Adds a file to the site and gives its address.
    pub fn offer(&self, path: &str, content: Vec<u8>) -> String {
        let mut extra = self.files.extra.lock().expect("no thread panics with it");
        extra.insert(path.to_owned(), content);
        format!("http://127.0.0.1:{}{path}", self.port)
    }
}

impl Drop for Site {
    fn drop(&mut self) {
        self.over.store(true, Ordering::SeqCst);
        // A last visitor ends the wait for the next.
        let _ = TcpStream::connect(("127.0.0.1", self.port));
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been printed; there is nothing else to do about it here.
            let _ = thread.join();
        }
    }
}

/// A thread for each visitor, and an answer for each connection: whoever waits for another visitor here may
/// wait for ever, as browsers keep connections open.
fn serve(listener: &TcpListener, files: &Arc<Files>, over: &AtomicBool) {
    for visitor in listener.incoming() {
        if over.load(Ordering::SeqCst) {
            return;
        }
        if let Ok(visitor) = visitor {
            let files = Arc::clone(files);
            // The browser may go away meanwhile, which is its right.
            std::thread::spawn(move || respond(visitor, &files).unwrap_or_default());
        }
    }
}

fn respond(mut visitor: TcpStream, files: &Files) -> std::io::Result<()> {
    let mut request = BufReader::new(visitor.try_clone()?).lines();
    let first = request.next().transpose()?.unwrap_or_default();
    // What else the browser says is read, so that closing does not cut the answer off.
    while request
        .next()
        .transpose()?
        .is_some_and(|line| !line.is_empty())
    {}
    let url = first.split(' ').nth(1).unwrap_or_default();
    let path = url.split(['?', '#']).next().unwrap_or_default();
    let (status, content) = match files.read(path) {
        Some(content) => ("200 OK", content),
        None => ("404 Not Found", format!("nothing at {path}").into_bytes()),
    };
    let allowed = match files.for_all.load(Ordering::SeqCst) {
        true => "Access-Control-Allow-Origin: *\r\n",
        false => "",
    };
    write!(
        visitor,
        "HTTP/1.1 {status}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
         {allowed}Connection: close\r\n\r\n",
        mime_type(path),
        content.len()
    )?;
    visitor.write_all(&content)?;
    visitor.flush()
}

impl Files {
    fn read(&self, path: &str) -> Option<Vec<u8>> {
        if let Some(content) = self.extra.lock().ok()?.get(path) {
            return Some(content.clone());
        }
        let inside = path.strip_prefix(&self.base)?;
        if inside.split('/').any(|part| part == "..") {
            return None;
        }
        let file = match inside {
            "" => self.directory.join("index.html"),
            inside => self.directory.join(inside),
        };
        fs::read(file).ok()
    }
}

/// What the usual hosts send. Browsers refuse WebAssembly and modules under a wrong name.
fn mime_type(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default() {
        "wasm" => "application/wasm",
        "js" | "mjs" => "text/javascript",
        "css" => "text/css",
        "json" | "webmanifest" => "application/json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "ico" => "image/x-icon",
        "zip" => "application/zip",
        "txt" | "md" => "text/plain; charset=utf-8",
        _ if path.ends_with('/') || path.ends_with(".html") => "text/html; charset=utf-8",
        _ => "application/octet-stream",
    }
}
