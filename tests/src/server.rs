//! A static file server on a free loopback port, as plain as the hosts that the page is for.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    thread::JoinHandle,
};

use anyhow::{Context, Result, anyhow};
use tiny_http::{Header, Request, Response, Server};

/// A browser asks for several files at a time.
const THREADS: usize = 4;

/// A served directory. Ends when dropped.
pub struct Site {
    server: Arc<Server>,
    threads: Vec<JoinHandle<()>>,
    port: u16,
    files: Arc<Files>,
}

struct Files {
    directory: PathBuf,
    /// Where in the site the directory lies, with a slash at both ends.
    base: String,
    /// Files that a test adds, by their whole path.
    extra: Mutex<HashMap<String, Vec<u8>>>,
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
        let server = Server::http("127.0.0.1:0").map_err(|error| anyhow!("no server: {error}"))?;
        let server = Arc::new(server);
        let port = server
            .server_addr()
            .to_ip()
            .context("the server has no port")?
            .port();
        let files = Arc::new(Files {
            directory: directory.to_owned(),
            base: base.to_owned(),
            extra: Mutex::default(),
        });
        let threads = (0..THREADS)
            .map(|_| {
                let (server, files) = (Arc::clone(&server), Arc::clone(&files));
                std::thread::spawn(move || serve(&server, &files))
            })
            .collect();
        Ok(Self {
            server,
            threads,
            port,
            files,
        })
    }

    /// The address of the directory.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}{}", self.port, self.files.base)
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
        for _ in &self.threads {
            self.server.unblock();
        }
        for thread in self.threads.drain(..) {
            // A panic of the thread has been printed; there is nothing else to do about it here.
            let _ = thread.join();
        }
    }
}

fn serve(server: &Server, files: &Files) {
    // An error from `recv` is how `unblock` ends this thread.
    while let Ok(request) = server.recv() {
        respond(request, files);
    }
}

fn respond(request: Request, files: &Files) {
    let path = request.url().split(['?', '#']).next().unwrap_or_default();
    let response = match files.read(path) {
        Some(content) => Response::from_data(content)
            .with_header(header("Content-Type", mime_type(path)))
            .with_header(header("Cache-Control", "no-store")),
        None => Response::from_data(format!("nothing at {path}")).with_status_code(404),
    };
    // The browser may have gone away meanwhile, which is its right.
    let _ = request.respond(response);
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

fn header(name: &str, value: &str) -> Header {
    Header::from_bytes(name, value).expect("a header of plain letters")
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
