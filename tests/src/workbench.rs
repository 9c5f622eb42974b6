//! The page of this project, by the names that it gives its parts (`data-testid`) and its state.

use std::{path::Path, time::Duration};

use anyhow::{Context, Result, ensure};

use crate::{Download, Page, Site, places, with_page};

/// Reading and measuring a whole scan, on a busy machine with two cores.
pub const RECONSTRUCTION: Duration = Duration::from_secs(180);

/// The selector of a part of the page.
pub fn part(name: &str) -> String {
    format!("[data-testid=\"{name}\"]")
}

/// The page, opened and ready.
pub struct Workbench<'a> {
    /// For all that any page can do.
    pub page: &'a Page<'a>,
}

/// Runs a test with the built page at the root of a site.
pub fn with_workbench(name: &str, test: impl FnOnce(&Workbench) -> Result<()>) -> Result<()> {
    with_workbench_under("/", name, test)
}

/// Runs a test with the built page somewhere within a site.
pub fn with_workbench_under(
    base: &str,
    name: &str,
    test: impl FnOnce(&Workbench) -> Result<()>,
) -> Result<()> {
    let site = Site::under(base, &places::dist()?)?;
    with_page(name, |page| {
        page.open(&site.url())?;
        let workbench = Workbench { page };
        workbench.wait_state("start", crate::PATIENCE)?;
        test(&workbench)
    })
}

impl Workbench<'_> {
    /// `start`, `running`, `done` or `failed`.
    pub fn state(&self) -> Result<String> {
        let state = self
            .page
            .value_of("document.querySelector('[data-state]')?.dataset.state")?;
        Ok(state.as_str().unwrap_or("none").to_owned())
    }

    /// Waits for a state; a run that fails does so at once, with what the page says.
    pub fn wait_state(&self, state: &str, patience: Duration) -> Result<()> {
        let reached = format!(
            "['{state}', 'failed'].includes(document.querySelector('[data-state]')?.dataset.state)
                && !document.querySelector('main [aria-busy=true]')"
        );
        self.page
            .wait_long(patience, &format!("state {state}"), &reached)?;
        let is = self.state()?;
        ensure!(is == state, "state {is}, not {state}: {:?}", self.alert());
        Ok(())
    }

    /// Waits until a run fails, which shows an alert.
    pub fn wait_failed(&self, patience: Duration) -> Result<()> {
        let failed = "document.querySelector('[data-state]')?.dataset.state === 'failed'";
        self.page.wait_long(patience, "state failed", failed)?;
        self.page.wait_visible(&part("error"))
    }

    /// The text of the alert, empty without one.
    pub fn alert(&self) -> String {
        let error = part("error");
        match self.page.is_visible(&error) {
            Ok(true) => self.page.text(&error).unwrap_or_default(),
            _ => String::new(),
        }
    }

    /// Chooses a scan archive by the file input.
    pub fn choose(&self, archive: &Path) -> Result<()> {
        self.page.choose_files(&part("file-input"), &[archive])
    }

    /// Clicks `cancel` in the very moment in which it can be clicked: a small scan on a quick
    /// machine is done before a click from outside arrives. Sets `window.cancelClicked`.
    pub fn cancel_as_soon_as_possible(&self) -> Result<()> {
        let watch = format!(
            "void new MutationObserver((_, observer) => {{
                const cancel = document.querySelector({});
                if (!cancel?.checkVisibility() || cancel.disabled) return;
                observer.disconnect();
                cancel.click();
                window.cancelClicked = true;
            }}).observe(document, {{ subtree: true, childList: true, attributes: true }})",
            serde_json::Value::from(part("cancel"))
        );
        self.page.value_of(&watch).map(drop)
    }

    /// Chooses a scan archive and waits until it is measured.
    pub fn reconstruct(&self, archive: &Path) -> Result<()> {
        self.choose(archive)?;
        self.wait_state("done", RECONSTRUCTION)
            .with_context(|| format!("{} is not reconstructed", archive.display()))
    }

    /// Clicks a part of the page.
    pub fn click(&self, name: &str) -> Result<()> {
        self.page.click(&part(name))
    }

    /// Clicks a view's row of the table, which is scrolled until that is made.
    pub fn click_row(&self, view: &str) -> Result<()> {
        let row = part(&format!("view-row-{view}"));
        let found = self.page.value_of(&format!(
            "(async () => {{
                const frame = document.querySelector('.table-frame');
                const found = () => document.querySelector({});
                const step = frame.clientHeight / 2;
                for (let to = 0; !found() && to < frame.scrollHeight; to += step) {{
                    frame.scrollTop = to;
                    await new Promise(done => requestAnimationFrame(() => setTimeout(done)));
                }}
                return !!found();
            }})()",
            serde_json::Value::from(row.as_str())
        ))?;
        ensure!(found == true, "no row of view {view}");
        self.page.click(&row)
    }

    /// How many views the table has, made or not.
    pub fn row_count(&self) -> Result<usize> {
        let count = format!(
            "document.querySelector({:?})?.ariaRowCount",
            part("views-table")
        );
        let count = self.page.value_of(&count)?;
        let rows: usize = count.as_str().context("no table")?.parse()?;
        Ok(rows - 1)
    }

    /// Clicks one of the download buttons and gives the file.
    pub fn download(&self, button: &str) -> Result<Download> {
        self.page
            .download(|| self.click(button))
            .with_context(|| format!("`{button}` gives no file"))
    }
}
