//! One headless Chromium with a fresh profile, gone without a trace when dropped.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::{cdp::Connection, page::Page, places, wait::wait_for};

/// The size of the window unless a test sets another.
const WINDOW: (u32, u32) = (1280, 800);

const FLAGS: &[&str] = &[
    "--headless=new",
    // Root, which containers run as, gets no sandbox; only pages of this project are loaded.
    "--no-sandbox",
    "--disable-dev-shm-usage",
    // WebGL in software, the same on every machine.
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    // No traffic of Chromium's own, and no way out for the page's.
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--disable-default-apps",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-breakpad",
    "--disable-extensions",
    // A hidden window is no reason to draw or count slower.
    "--disable-renderer-backgrounding",
    "--disable-background-timer-throttling",
    "--hide-scrollbars",
    "--force-color-profile=srgb",
    "--remote-debugging-port=0",
];

/// A running Chromium.
pub struct Browser {
    connection: Option<Connection>,
    process: Child,
    /// Profile, downloads and whatever Chromium thinks it must write.
    directory: TempDir,
}

/// A process of Chromium.
#[derive(Clone, Debug, PartialEq)]
pub struct Process {
    /// `browser`, `renderer`, `GPU`, `utility`.
    pub kind: String,
    /// Its number.
    pub id: u32,
    /// How long it has been at work, seconds of a core.
    pub seconds: f64,
}

impl Browser {
    /// Starts Chromium and waits until it listens.
    pub fn start() -> Result<Self> {
        let directory = tempfile::Builder::new()
            .prefix("snellius-e2e-")
            .tempdir()
            .context("no temporary directory for Chromium")?;
        let process = launch(directory.path())?;
        let mut browser = Self {
            connection: None,
            process,
            directory,
        };
        browser.connect()?;
        Ok(browser)
    }

    fn connect(&mut self) -> Result<()> {
        let (port, path) = self.debugging_address()?;
        self.connection = Some(Connection::open(port, &path)?);
        self.keep_downloads()
    }

    /// Ends Chromium as a power failure would, without a word, and starts it again on what is left.
    pub fn kill_and_restart(&mut self) -> Result<()> {
        self.connection = None;
        self.process.kill()?;
        self.process.wait()?;
        let profile = self.directory().join("profile");
        // The helpers of the one that was killed may hold the profile for a moment longer.
        std::thread::sleep(Duration::from_secs(1));
        for left in [
            "DevToolsActivePort",
            "SingletonLock",
            "SingletonSocket",
            "SingletonCookie",
        ] {
            let _ = fs::remove_file(profile.join(left));
        }
        self.process = launch(self.directory())?;
        self.connect()
    }

    /// Opens an empty page.
    pub fn new_page(&self) -> Result<Page<'_>> {
        let target = self.call("Target.createTarget", json!({ "url": "about:blank" }))?;
        let parameters = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = self.call("Target.attachToTarget", parameters)?;
        let session = attached["sessionId"]
            .as_str()
            .context("Target.attachToTarget gave no session")?;
        Page::new(self, session)
    }

    /// Chromium's process number.
    pub fn process_id(&self) -> u32 {
        self.process.id()
    }

    /// All processes of Chromium.
    pub fn processes(&self) -> Result<Vec<Process>> {
        let answer = self.call("SystemInfo.getProcessInfo", json!({}))?;
        let list = answer["processInfo"].as_array().context("no processes")?;
        let process = |told: &Value| {
            Some(Process {
                kind: told["type"].as_str()?.to_owned(),
                id: u32::try_from(told["id"].as_u64()?).ok()?,
                seconds: told["cpuTime"].as_f64()?,
            })
        };
        let processes = list.iter().map(process);
        processes
            .collect::<Option<_>>()
            .context("Chromium tells otherwise of its processes")
    }

    /// The directory that holds all that Chromium writes.
    pub fn directory(&self) -> &Path {
        self.directory.path()
    }

    pub(crate) fn connection(&self) -> &Connection {
        self.connection
            .as_ref()
            .expect("there from `start` to `drop`")
    }

    pub(crate) fn downloads(&self) -> PathBuf {
        self.directory().join("downloads")
    }

    fn call(&self, method: &str, params: Value) -> Result<Value> {
        self.connection().call(None, method, params)
    }

    /// Chromium writes its port and path into its profile once it listens.
    fn debugging_address(&mut self) -> Result<(u16, String)> {
        let file = self.directory().join("profile").join("DevToolsActivePort");
        let log = self.directory().join("chromium.log");
        let deadline = Instant::now() + Duration::from_secs(60);
        loop {
            let text = fs::read_to_string(&file).unwrap_or_default();
            if let Some((port, path)) = text.split_once('\n')
                && path.starts_with('/')
            {
                return Ok((port.parse()?, path.trim().to_owned()));
            }
            let ended = self.process.try_wait()?;
            if ended.is_some() || Instant::now() > deadline {
                let said = fs::read_to_string(log).unwrap_or_default();
                bail!("Chromium did not start ({ended:?}). It said:\n{said}");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Saves what pages let one download, each file under a name of Chromium's own, so that two
    /// files of one name do not meet.
    fn keep_downloads(&self) -> Result<()> {
        let parameters = json!({
            "behavior": "allowAndName",
            "downloadPath": self.downloads(),
            "eventsEnabled": true,
        });
        self.call("Browser.setDownloadBehavior", parameters)?;
        Ok(())
    }

    fn stop(&mut self) -> Result<()> {
        if let Some(connection) = self.connection.take() {
            // Asked politely it ends its helpers too; it may also be gone already.
            let _ = connection.call(None, "Browser.close", json!({}));
        }
        let ended = wait_for(Duration::from_secs(10), || {
            Ok(self.process.try_wait()?.map(drop))
        });
        if ended.is_err() {
            self.process.kill()?;
            self.process.wait()?;
        }
        Ok(())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // In `drop` there is nobody to hand an error to; the tests of the harness look at what
        // is left behind.
        let _ = self.stop();
        // Chromium's helpers may still write for a moment.
        let _ = wait_for(Duration::from_secs(5), || {
            let _ = fs::remove_dir_all(self.directory.path());
            Ok((!self.directory.path().exists()).then_some(()))
        });
    }
}

fn launch(directory: &Path) -> Result<Child> {
    let chromium = places::chromium()?;
    let inside = |name: &str| -> Result<PathBuf> {
        let path = directory.join(name);
        fs::create_dir_all(&path)?;
        Ok(path)
    };
    let mut command = Command::new(&chromium);
    command
        .args(FLAGS)
        .arg(format!("--user-data-dir={}", inside("profile")?.display()))
        .arg(format!("--window-size={},{}", WINDOW.0, WINDOW.1))
        .arg("about:blank")
        .env("XDG_CACHE_HOME", inside("cache")?)
        .env("XDG_CONFIG_HOME", inside("config")?)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(directory.join("chromium.log"))?);
    inside("downloads")?;
    if cfg!(target_os = "linux") {
        // Elsewhere the path would be too long for the socket that Chromium keeps there.
        command.env("TMPDIR", inside("tmp")?);
    }
    command
        .spawn()
        .with_context(|| format!("cannot start {}", chromium.display()))
}
