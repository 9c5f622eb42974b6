//! One page in Chromium: look at it, use it as a person would, ask what it did.
//!
//! Elements are named by CSS selectors. Whatever is looked for is waited for; an error says
//! what was not there and which address the page had.

use std::{fs, path::Path, time::Duration};

use anyhow::{Context, Result, bail, ensure};
use base64::{Engine, prelude::BASE64_STANDARD};
use serde_json::{Value, json};

use crate::{browser::Browser, journal, keys, picture::Picture, places, wait::wait_for};

/// How long something on a page may take, unless a test knows better. A busy machine that draws in
/// software may need half of it to begin.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A page of a running Chromium.
pub struct Page<'a> {
    browser: &'a Browser,
    session: String,
}

/// A file that the page let the browser save.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Download {
    /// The name it was to be saved under.
    pub name: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

/// Where an element is, in CSS pixels of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Area {
    /// A point by shares of width and height: (0.5, 0.5) is the middle.
    fn point(self, (across, down): (f64, f64)) -> (f64, f64) {
        (self.x + across * self.width, self.y + down * self.height)
    }
}

/// Loading and looking.
impl<'a> Page<'a> {
    pub(crate) fn new(browser: &'a Browser, session: &str) -> Result<Self> {
        let page = Self {
            browser,
            session: session.to_owned(),
        };
        page.call("Page.enable", json!({}))?;
        Ok(page)
    }

    /// Loads an address and waits until all that it names is loaded.
    pub fn open(&self, url: &str) -> Result<()> {
        let answer = self.call("Page.navigate", json!({ "url": url }))?;
        if let Some(error) = answer["errorText"].as_str() {
            bail!("{url}: {error}");
        }
        self.wait_until("the page to load", "document.readyState === 'complete'")
    }

    /// Loads the same address again.
    pub fn reload(&self) -> Result<()> {
        let address = self.address();
        // Page.reload answers before the old page is gone.
        self.open("about:blank")?;
        self.open(&address)
    }

    /// Has a script run in every page that is loaded from now on, before the page's own.
    pub fn run_before_all(&self, script: &str) -> Result<()> {
        let source = json!({ "source": script });
        self.call("Page.addScriptToEvaluateOnNewDocument", source)
            .map(drop)
    }

    /// The value of a JavaScript expression, awaited if it is a promise.
    pub fn value_of(&self, expression: &str) -> Result<Value> {
        let parameters =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let mut answer = self.call("Runtime.evaluate", parameters)?;
        if let Some(details) = answer.get("exceptionDetails") {
            let thrown = details["exception"]["description"].as_str();
            bail!("{expression}: {}", thrown.unwrap_or("exception"));
        }
        Ok(answer["result"]["value"].take())
    }

    /// Waits until a JavaScript expression is true.
    pub fn wait_until(&self, what: &str, condition: &str) -> Result<()> {
        self.wait_long(PATIENCE, what, condition)
    }

    /// Waits that long until a JavaScript expression is true.
    pub fn wait_long(&self, patience: Duration, what: &str, condition: &str) -> Result<()> {
        let condition = format!("Boolean({condition})");
        wait_for(patience, || {
            Ok((self.value_of(&condition)? == true).then_some(()))
        })
        .with_context(|| format!("waited for {what} at {}", self.address()))
    }

    /// Waits until an element is there and can be seen.
    pub fn wait_visible(&self, selector: &str) -> Result<()> {
        let visible = format!("{}?.checkVisibility()", query(selector));
        self.wait_until(&format!("`{selector}` to be seen"), &visible)
    }

    /// Waits until an element's text holds some words.
    pub fn wait_text(&self, selector: &str, words: &str) -> Result<()> {
        let has = format!("{}?.innerText.includes({})", query(selector), quoted(words));
        self.wait_until(&format!("`{selector}` to say {words:?}"), &has)
    }

    /// Whether such an element is there and can be seen, now.
    pub fn is_visible(&self, selector: &str) -> Result<bool> {
        let visible = format!("Boolean({}?.checkVisibility())", query(selector));
        Ok(self.value_of(&visible)? == true)
    }

    /// The text of an element as it is shown.
    pub fn text(&self, selector: &str) -> Result<String> {
        self.wait_visible(selector)?;
        let text = self.value_of(&format!("{}.innerText", query(selector)))?;
        Ok(text.as_str().unwrap_or_default().trim().to_owned())
    }

    /// How many elements a selector finds.
    pub fn count(&self, selector: &str) -> Result<usize> {
        let count = format!("document.querySelectorAll({}).length", quoted(selector));
        let count = self.value_of(&count)?;
        count
            .as_u64()
            .map(|count| count as usize)
            .context("no count")
    }

    /// Brings an element into view and says where it is.
    pub fn area(&self, selector: &str) -> Result<Area> {
        self.wait_visible(selector)?;
        let found = self.value_of(&format!(
            "(() => {{
                const element = {};
                element.scrollIntoView({{ block: 'nearest', inline: 'nearest' }});
                const box = element.getBoundingClientRect();
                return [box.x, box.y, box.width, box.height];
            }})()",
            query(selector)
        ))?;
        let number = |at: usize| found[at].as_f64().context("no rectangle");
        Ok(Area {
            x: number(0)?,
            y: number(1)?,
            width: number(2)?,
            height: number(3)?,
        })
    }

    fn address(&self) -> String {
        let address = self.value_of("location.href").unwrap_or_default();
        address.as_str().unwrap_or("no page").to_owned()
    }

    pub(crate) fn call(&self, method: &str, params: Value) -> Result<Value> {
        let connection = self.browser.connection();
        connection.call(Some(&self.session), method, params)
    }
}

/// Mouse, keys and files.
impl Page<'_> {
    /// Clicks the middle of an element, once it can be seen, is not disabled, and nothing lies
    /// over it.
    pub fn click(&self, selector: &str) -> Result<()> {
        let (x, y) = self.point_free_for_a_click(selector)?;
        self.mouse("mouseMoved", (x, y), json!({}))?;
        let button = json!({ "button": "left", "clickCount": 1 });
        self.mouse("mousePressed", (x, y), button.clone())?;
        self.mouse("mouseReleased", (x, y), button)
    }

    fn point_free_for_a_click(&self, selector: &str) -> Result<(f64, f64)> {
        wait_for(PATIENCE, || {
            let point = self.area_at_rest(selector)?.point((0.5, 0.5));
            Ok(self.is_reached(selector, point)?.then_some(point))
        })
        .with_context(|| {
            format!(
                "waited for `{selector}` to be free for a click at {}",
                self.address()
            )
        })
    }

    /// Where an element is once it moves no more: while a page is still filling, things do.
    fn area_at_rest(&self, selector: &str) -> Result<Area> {
        let mut before = None;
        wait_for(PATIENCE, || {
            let area = self.area(selector)?;
            Ok((before.replace(area) == Some(area)).then_some(area))
        })
        .with_context(|| format!("waited for `{selector}` to rest"))
    }

    /// Whether a click there meets the element or its label, and the element can be used.
    fn is_reached(&self, selector: &str, (x, y): (f64, f64)) -> Result<bool> {
        let reached = format!(
            "(() => {{
                const element = {};
                const hit = document.elementFromPoint({x}, {y});
                const label = hit?.closest('label');
                return !element.disabled
                    && (element.contains(hit) || label?.control === element);
            }})()",
            query(selector)
        );
        Ok(self.value_of(&reached)? == true)
    }

    /// Clicks a point of an element, given as shares of its size.
    pub fn click_at(&self, selector: &str, at: (f64, f64)) -> Result<()> {
        self.clicks_at(selector, at, 1)
    }

    /// Clicks it twice.
    pub fn double_click_at(&self, selector: &str, at: (f64, f64)) -> Result<()> {
        self.clicks_at(selector, at, 2)
    }

    fn clicks_at(&self, selector: &str, at: (f64, f64), count: u32) -> Result<()> {
        let point = self.area_at_rest(selector)?.point(at);
        self.mouse("mouseMoved", point, json!({}))?;
        for number in 1..=count {
            let button = json!({ "button": "left", "clickCount": number });
            self.mouse("mousePressed", point, button.clone())?;
            self.mouse("mouseReleased", point, button)?;
        }
        Ok(())
    }

    /// Drags with the left button between two points of an element, given as shares of its size.
    pub fn drag(&self, selector: &str, from: (f64, f64), to: (f64, f64)) -> Result<()> {
        self.drag_with(("left", 1), selector, from, to)
    }

    /// Likewise, with the right button.
    pub fn drag_right(&self, selector: &str, from: (f64, f64), to: (f64, f64)) -> Result<()> {
        self.drag_with(("right", 2), selector, from, to)
    }

    fn drag_with(
        &self,
        (button, buttons): (&str, u32),
        selector: &str,
        from: (f64, f64),
        to: (f64, f64),
    ) -> Result<()> {
        const STEPS: u32 = 12;
        let area = self.area_at_rest(selector)?;
        let (start, end) = (area.point(from), area.point(to));
        let held = json!({ "button": button, "buttons": buttons, "clickCount": 1 });
        self.mouse("mouseMoved", start, json!({}))?;
        self.mouse("mousePressed", start, held.clone())?;
        for step in 1..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            let between = |a: f64, b: f64| a + share * (b - a);
            let point = (between(start.0, end.0), between(start.1, end.1));
            self.mouse("mouseMoved", point, held.clone())?;
        }
        let released = json!({ "button": button, "clickCount": 1 });
        self.mouse("mouseReleased", end, released)
    }

    /// Draws fingers over an element: each from a point to another one, given as shares of its size.
    pub fn touch(&self, selector: &str, fingers: &[[(f64, f64); 2]]) -> Result<()> {
        const STEPS: u32 = 12;
        let area = self.area_at_rest(selector)?;
        let touching = |share: f64| {
            let fingers = fingers.iter().enumerate();
            let points = fingers.map(|(id, [from, to])| {
                let between = |a: f64, b: f64| a + share * (b - a);
                let (x, y) = area.point((between(from.0, to.0), between(from.1, to.1)));
                json!({ "x": x, "y": y, "id": id })
            });
            points.collect::<Vec<_>>()
        };
        let touch = |kind: &str, points: Vec<Value>| {
            let event = json!({ "type": kind, "touchPoints": points });
            self.call("Input.dispatchTouchEvent", event).map(drop)
        };
        touch("touchStart", touching(0.0))?;
        for step in 1..=STEPS {
            touch("touchMove", touching(f64::from(step) / f64::from(STEPS)))?;
        }
        touch("touchEnd", vec![])
    }

    /// Turns the wheel over the middle of an element; positive scrolls down.
    pub fn wheel(&self, selector: &str, pixels: f64) -> Result<()> {
        self.wheel_at(selector, (0.5, 0.5), pixels)
    }

    /// Likewise, over a point given as shares of its size.
    pub fn wheel_at(&self, selector: &str, at: (f64, f64), pixels: f64) -> Result<()> {
        let point = self.area_at_rest(selector)?.point(at);
        let turn = json!({ "deltaX": 0, "deltaY": pixels });
        self.mouse("mouseWheel", point, turn)
    }

    fn mouse(&self, kind: &str, (x, y): (f64, f64), more: Value) -> Result<()> {
        let mut event = json!({ "type": kind, "x": x, "y": y });
        merge(&mut event, more);
        self.call("Input.dispatchMouseEvent", event).map(drop)
    }

    /// Presses a key: `Enter`, `Space`, `a`, `Shift+Tab`.
    pub fn press(&self, key: &str) -> Result<()> {
        for event in keys::press(key)? {
            self.call("Input.dispatchKeyEvent", event)?;
        }
        Ok(())
    }

    /// Writes text where the focus is.
    pub fn type_text(&self, text: &str) -> Result<()> {
        self.call("Input.insertText", json!({ "text": text }))
            .map(drop)
    }

    /// Whether an element has the focus and shows it as it does for people at the keyboard.
    pub fn has_focus(&self, selector: &str) -> Result<bool> {
        let focused = format!("{}?.matches(':focus-visible') === true", query(selector));
        Ok(self.value_of(&focused)? == true)
    }

    /// Presses Tab until an element has the focus.
    pub fn tab_to(&self, selector: &str) -> Result<()> {
        const MOST: usize = 200;
        self.wait_visible(selector)?;
        for _ in 0..MOST {
            if self.has_focus(selector)? {
                return Ok(());
            }
            self.press("Tab")?;
        }
        bail!("`{selector}` cannot be reached by Tab");
    }

    /// Chooses files in an `input[type=file]`, as its dialog would.
    pub fn choose_files(&self, selector: &str, files: &[&Path]) -> Result<()> {
        self.wait_until(&format!("`{selector}`"), &query(selector))?;
        let found = self.call("Runtime.evaluate", json!({ "expression": query(selector) }))?;
        let parameters = json!({ "objectId": found["result"]["objectId"], "files": files });
        self.call("DOM.setFileInputFiles", parameters)
            .with_context(|| format!("cannot choose {files:?} in `{selector}`"))
            .map(drop)
    }

    /// Chooses an entry of a `select` by its value.
    pub fn choose_option(&self, selector: &str, value: &str) -> Result<()> {
        self.wait_visible(selector)?;
        let chosen = self.value_of(&format!(
            "(() => {{
                const list = {};
                list.value = {};
                list.dispatchEvent(new Event('change', {{ bubbles: true }}));
                return list.value;
            }})()",
            query(selector),
            quoted(value)
        ))?;
        ensure!(chosen == value, "`{selector}` has no entry {value:?}");
        Ok(())
    }

    /// Drags files from outside over an element and drops them there.
    pub fn drop_files(&self, selector: &str, files: &[&Path]) -> Result<()> {
        const COPY: u32 = 1;
        let (x, y) = self.area_at_rest(selector)?.point((0.5, 0.5));
        let data = json!({ "items": [], "files": files, "dragOperationsMask": COPY });
        for kind in ["dragEnter", "dragOver", "drop"] {
            let event = json!({ "type": kind, "x": x, "y": y, "data": data });
            self.call("Input.dispatchDragEvent", event)?;
        }
        Ok(())
    }

    /// Does something that makes the page save a file, and gives that file.
    pub fn download(&self, trigger: impl FnOnce() -> Result<()>) -> Result<Download> {
        let before = self.browser.connection().event_count();
        trigger()?;
        let (guid, name) =
            wait_for(PATIENCE, || Ok(self.download_begun(before))).context("no download began")?;
        wait_for(PATIENCE, || self.download_ended(before, &guid))
            .with_context(|| format!("the download of {name} did not end"))?;
        let bytes = fs::read(self.browser.downloads().join(guid))
            .with_context(|| format!("{name} was not saved"))?;
        Ok(Download { name, bytes })
    }

    fn download_begun(&self, since: usize) -> Option<(String, String)> {
        let events = self.browser.connection().events_since(since);
        let begun = events
            .iter()
            .find(|event| event.method == "Browser.downloadWillBegin")?;
        let text = |key: &str| begun.params[key].as_str().map(str::to_owned);
        Some((text("guid")?, text("suggestedFilename")?))
    }

    fn download_ended(&self, since: usize, guid: &str) -> Result<Option<()>> {
        let events = self.browser.connection().events_since(since);
        let mut states = events
            .iter()
            .filter(|event| event.method == "Browser.downloadProgress")
            .filter(|event| event.params["guid"] == guid)
            .map(|event| &event.params["state"]);
        ensure!(
            !states.clone().any(|state| state == "canceled"),
            "it was cancelled"
        );
        Ok(states.any(|state| state == "completed").then_some(()))
    }
}

/// The page's surroundings.
impl Page<'_> {
    /// Sets the size of the page in CSS pixels.
    pub fn set_size(&self, width: u32, height: u32) -> Result<()> {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size)?;
        self.wait_until("the new size", &format!("innerWidth === {width}"))
    }

    /// Has the page believe in so many cores, from the next page that is loaded on.
    pub fn set_cores(&self, cores: u32) -> Result<()> {
        let cores = json!({ "hardwareConcurrency": cores });
        self.call("Emulation.setHardwareConcurrencyOverride", cores)
            .map(drop)
    }

    /// Leaves the page room for so many bytes more in the browser's storage.
    pub fn leave_room(&self, bytes: u64) -> Result<()> {
        let [origin, used] = [
            "location.origin",
            "navigator.storage.estimate().then(({ usage }) => usage)",
        ]
        .map(|expression| self.value_of(expression));
        let used = used?.as_f64().context("no estimate")?;
        let quota = json!({ "origin": origin?, "quotaSize": used + bytes as f64 });
        self.call("Storage.overrideQuotaForOrigin", quota).map(drop)
    }

    /// Holds back whatever is fetched from addresses of a pattern (`*`, `?`), until it is let through.
    pub fn hold_back(&self, pattern: &str) -> Result<()> {
        let patterns = json!({ "patterns": [{ "urlPattern": pattern }] });
        self.call("Fetch.enable", patterns).map(drop)
    }

    /// Lets through what was held back.
    pub fn let_through(&self) -> Result<()> {
        self.call("Fetch.disable", json!({})).map(drop)
    }

    /// Says that the person prefers `light` or `dark` pages.
    pub fn prefer_scheme(&self, scheme: &str) -> Result<()> {
        self.prefer(&[("prefers-color-scheme", scheme)])
    }

    /// Likewise, and that nothing shall move or fade.
    pub fn prefer_scheme_at_rest(&self, scheme: &str) -> Result<()> {
        self.prefer(&[
            ("prefers-color-scheme", scheme),
            ("prefers-reduced-motion", "reduce"),
        ])
    }

    fn prefer(&self, wishes: &[(&str, &str)]) -> Result<()> {
        let features = wishes.iter();
        let features = features.map(|(name, value)| json!({ "name": name, "value": value }));
        let features: Vec<Value> = features.collect();
        self.call(
            "Emulation.setEmulatedMedia",
            json!({ "features": features }),
        )?;
        for (name, value) in wishes {
            let applies = format!("matchMedia('({name}: {value})').matches");
            self.wait_until(&format!("{name}: {value}"), &applies)?;
        }
        Ok(())
    }
}

/// Pictures and what the page said.
impl Page<'_> {
    /// The page as it is seen, also kept as `target/e2e-screenshots/NAME.png`.
    pub fn screenshot(&self, name: &str) -> Result<Picture> {
        let png = self.capture(json!({ "format": "png" }))?;
        let file = places::screenshots()?.join(format!("{name}.png"));
        fs::write(&file, &png).with_context(|| format!("cannot write {}", file.display()))?;
        Picture::from_png(&png)
    }

    /// One element as it is seen.
    pub fn picture_of(&self, selector: &str) -> Result<Picture> {
        let Area {
            x,
            y,
            width,
            height,
        } = self.area(selector)?;
        // The window's corner may lie anywhere on the page, from whose corner a clip is counted.
        let corner = self.value_of("[scrollX, scrollY]")?;
        let [left, top] = [0, 1].map(|axis| corner[axis].as_f64().unwrap_or_default());
        let clip = json!({
            "x": (x + left).round(), "y": (y + top).round(),
            "width": width.floor(), "height": height.floor(), "scale": 1,
        });
        let png = self.capture(json!({ "format": "png", "clip": clip }))?;
        Picture::from_png(&png)
    }

    /// Waits until something is drawn on an element, and what it shows stops changing.
    pub fn drawn_picture_of(&self, selector: &str) -> Result<Picture> {
        wait_for(PATIENCE, || {
            let picture = self.settled_picture_of(selector)?;
            Ok((!picture.is_blank()).then_some(picture))
        })
        .with_context(|| format!("`{selector}` stays blank"))
    }

    /// One element as it is seen once it no longer changes.
    pub fn settled_picture_of(&self, selector: &str) -> Result<Picture> {
        let mut last = self.picture_of(selector)?;
        wait_for(PATIENCE, || {
            std::thread::sleep(Duration::from_millis(150));
            let now = self.picture_of(selector)?;
            let settled = now == last;
            last = now;
            Ok(settled.then(|| last.clone()))
        })
        .with_context(|| format!("`{selector}` does not stop changing"))
    }

    fn capture(&self, parameters: Value) -> Result<Vec<u8>> {
        let answer = self.call("Page.captureScreenshot", parameters)?;
        let data = answer["data"].as_str().context("no screenshot")?;
        Ok(BASE64_STANDARD.decode(data)?)
    }

    /// All that the page and its workers wrote to the console.
    pub fn console(&self) -> Vec<String> {
        journal::console(&self.browser.connection().events_since(0))
    }

    /// Uncaught exceptions, errors on the console, files not found: of the page and its workers.
    pub fn problems(&self) -> Vec<String> {
        journal::problems(&self.browser.connection().events_since(0))
    }

    /// The addresses that the page and its workers asked for.
    pub fn requests(&self) -> Vec<String> {
        journal::requests(&self.browser.connection().events_since(0))
    }

    /// Those of them that do not stay on this machine.
    pub fn foreign_requests(&self) -> Vec<String> {
        let mut requests = self.requests();
        requests.retain(|url| !journal::is_local(url));
        requests
    }
}

/// A JavaScript expression for the first element that a selector finds.
fn query(selector: &str) -> String {
    format!("document.querySelector({})", quoted(selector))
}

/// A JavaScript string.
fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

fn merge(into: &mut Value, more: Value) {
    if let (Value::Object(into), Value::Object(more)) = (into, more) {
        into.extend(more);
    }
}
