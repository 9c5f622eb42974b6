//! What a large archive costs in the page: memory, the main thread's time, views a second with one worker
//! and with two, and how soon Cancel is felt.
//!
//! `cargo xtask bench --large` makes an archive of 4.2 GB and runs this on it; `cargo bench -p snellius-tests
//! --bench large -- SCAN.zip`, after `cargo xtask dist`, on any other. Linux only: what a process holds is
//! read from `/proc`.
#![allow(clippy::print_stdout, reason = "it is what a benchmark is for")]

use std::{
    fs,
    path::Path,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, ensure};
use snellius_tests::{
    Browser, PATIENCE, Page, Site,
    places::dist,
    workbench::{Workbench, part},
};

/// Measuring a large scan on a busy machine.
const LONG: Duration = Duration::from_secs(3 * 3600);
/// For so many seconds views are counted for the comparison of one worker with two,
const WINDOW: f64 = 20.0;
/// or until so much of the scan is done.
const MOST: f64 = 0.7;
/// How often one worker is compared with two.
const COMPARISONS: usize = 3;
/// The result is looked at for so long.
const LOOK: Duration = Duration::from_secs(5);

/// Watches the page from inside: tasks of 50 ms and more as the browser tells of them; how late a timer of
/// 10 ms comes, which shows the shorter ones as well; when a phase begins; when Cancel was clicked.
const PROBE: &str = "(() => {
    const probe = window.probe = { long: [], late: [], phases: {}, clicked: null, cancelled: null };
    new PerformanceObserver(list => probe.long.push(
        ...list.getEntries().map(task => [task.startTime, task.duration])
    )).observe({ type: 'longtask' });
    const begin = phase => probe.phases[phase] ??= performance.now();
    let before = performance.now();
    setInterval(() => {
        const now = performance.now();
        probe.late.push([before, now - before - 10]);
        before = now;
        const bar = document.querySelector('[data-testid=progress]');
        if (bar?.max > 1) begin('spots');
        if (bar?.max > 1 && bar.value === bar.max) begin('measuring');
    }, 10);
    new MutationObserver(() => {
        const state = document.documentElement.dataset.state;
        if (state === 'running') begin('opening');
        if (state === 'done') begin('shown');
        if (state === 'start' && probe.clicked !== null) probe.cancelled ??= performance.now();
    }).observe(document.documentElement, { attributeFilter: ['data-state'] });
    addEventListener('click', event => {
        if (event.target.closest('[data-testid=cancel]')) probe.clicked = event.timeStamp;
    }, true);
})()";

/// The page tells a few times a second how many views are done: when it does next, seconds, how many, of how many.
const NEXT_COUNT: &str = "(bar => new Promise(told => {
    const before = bar?.value;
    const look = () => bar?.isConnected && bar.value === before
        ? setTimeout(look, 5)
        : told([performance.now() / 1000, bar?.value, bar?.max]);
    look();
}))(document.querySelector('[data-testid=progress]'))";

const PHASES: [(&str, &str); 4] = [
    ("opening", "opening"),
    ("spots", "spots"),
    ("measuring", "vessel, object"),
    ("shown", "shown"),
];

fn main() -> Result<()> {
    let given = std::env::args().skip(1).find(|word| word.ends_with(".zip"));
    let scan = given.context("which scan archive?")?;
    let scan = Path::new(&scan).canonicalize()?;
    let site = Site::at_root(&dist()?)?;
    let bytes = fs::metadata(&scan)?.len();
    println!("{}, {:.2} GB", scan.display(), bytes as f64 / 1e9);
    println!("load of the machine before: {}", load());
    whole_run(&site, &scan, 2)?;
    compare(&site, &scan)?;
    println!("load of the machine after: {}", load());
    Ok(())
}

/// The page in a browser of its own, with so many cores, and watched.
fn with_page<T>(
    site: &Site,
    workers: u32,
    test: impl FnOnce(&Browser, &Workbench) -> Result<T>,
) -> Result<T> {
    let browser = Browser::start()?;
    let page = browser.new_page()?;
    page.set_cores(workers)?;
    page.open(&site.url())?;
    let workbench = Workbench { page: &page };
    workbench.wait_state("start", PATIENCE)?;
    page.value_of(PROBE)?;
    let outcome = test(&browser, &workbench)?;
    ensure!(page.problems().is_empty(), "{:#?}", page.problems());
    Ok(outcome)
}

/// From the file to the result.
fn whole_run(site: &Site, scan: &Path, workers: u32) -> Result<()> {
    with_page(site, workers, |browser, workbench| {
        let page = workbench.page;
        println!("\n{workers} worker(s), the whole archive");
        let mut memory = Memory::default();
        memory.look(browser)?;
        println!("  memory before: {memory}");
        let begun = Instant::now();
        workbench.choose(scan)?;
        let mut said = Vec::new();
        while workbench.state()? != "done" {
            ensure!(workbench.state()? != "failed", "{}", workbench.alert());
            ensure!(begun.elapsed() < LONG, "it does not end");
            said.push((begun.elapsed(), status(page)?));
            memory.look(browser)?;
            std::thread::sleep(Duration::from_millis(250));
        }
        let all = begun.elapsed();
        let running = memory;
        while begun.elapsed() < all + LOOK {
            memory.look(browser)?;
            std::thread::sleep(Duration::from_millis(250));
        }
        println!(
            "  {}",
            workbench.page.text("[data-testid=stage-object] .brief")?
        );
        println!("  memory, peak while it ran: {running}");
        println!("  memory, peak with the result shown: {memory}");
        let views = views(&said).context("the page told of no views")?;
        report_phases(page, views, all)?;
        report_time_left(&said);
        println!("  processor time: {}", processor(browser)?);
        page.screenshot(&format!("bench-large-{workers}")).map(drop)
    })
}

/// One worker and two in turn, each for a while, so that whatever else the machine does falls on both.
fn compare(site: &Site, scan: &Path) -> Result<()> {
    println!("\none worker and two in turn");
    let mut ratios = Vec::new();
    for _ in 0..COMPARISONS {
        let [one, two] = [1, 2].map(|workers| part_of_a_run(site, scan, workers));
        let ratio = two? / one?;
        println!("  two are {ratio:.2} times as fast as one");
        ratios.push(ratio);
    }
    ratios.sort_by(f64::total_cmp);
    println!("  median: {:.2} times", ratios[COMPARISONS / 2]);
    Ok(())
}

/// Counts views for a while, then cancels; views a second.
fn part_of_a_run(site: &Site, scan: &Path, workers: u32) -> Result<f64> {
    const FIRST: usize = 20;
    with_page(site, workers, |_, workbench| {
        let page = workbench.page;
        workbench.choose(scan)?;
        let begun = format!(
            "document.querySelector('{}')?.value >= {FIRST}",
            part("progress")
        );
        page.wait_long(LONG, "the first views", &begun)?;
        let count = || -> Result<(f64, f64, f64)> {
            let now = page.value_of(NEXT_COUNT)?;
            let number = |at: usize| now[at].as_f64().context("the run has ended already");
            Ok((number(0)?, number(1)?, number(2)?))
        };
        let from = count()?;
        let mut to = from;
        while to.0 < from.0 + WINDOW && to.1 < MOST * to.2 {
            to = count()?;
        }
        workbench.click("cancel")?;
        workbench.wait_state("start", PATIENCE)?;
        let delay = page.value_of("probe.cancelled - probe.clicked")?;
        let rate = (to.1 - from.1) / (to.0 - from.0);
        println!(
            "  {workers} worker(s): {rate:.1} views a second; Cancel took effect after {:.0} ms",
            delay.as_f64().unwrap_or(f64::NAN)
        );
        Ok(rate)
    })
}

/// How long each phase took, and the main thread's longest task within.
fn report_phases(page: &Page, views: f64, all: Duration) -> Result<()> {
    let probe = page.value_of("probe")?;
    let begin = |phase: &str| probe["phases"][phase].as_f64();
    for (index, (phase, name)) in PHASES.iter().enumerate() {
        let Some(start) = begin(phase) else { continue };
        let next = PHASES.get(index + 1).and_then(|(next, _)| begin(next));
        let end = next.unwrap_or(f64::INFINITY);
        let longest = |what: &str| {
            let tasks = probe[what].as_array().into_iter().flatten();
            let of_phase = tasks.filter_map(|task| {
                let (from, took) = (task[0].as_f64()?, task[1].as_f64()?);
                // What puts the result on the screen belongs to what it shows.
                let at = from + took;
                (start..end).contains(&at).then_some(took)
            });
            of_phase.fold(0.0, f64::max)
        };
        let tasks = match longest("long") {
            0.0 => "none of 50 ms".to_owned(),
            task => format!("{task:.0} ms"),
        };
        let late = longest("late");
        let seconds = match (end - start) / 1000.0 {
            infinite if infinite.is_infinite() => String::new(),
            seconds => format!("{seconds:.1} s; "),
        };
        println!("  {name}: {seconds}longest task {tasks}, a timer {late:.0} ms late");
    }
    if let (Some(spots), Some(measuring)) = (begin("spots"), begin("measuring")) {
        let rate = views / (measuring - spots) * 1000.0;
        println!(
            "  {views} views, {rate:.1} a second; {:.1} s in all",
            all.as_secs_f64()
        );
    }
    Ok(())
}

/// What the page said of the time left at a third of the way, and what it was.
fn report_time_left(said: &[(Duration, String)]) {
    let spots: Vec<_> = said
        .iter()
        .filter(|(_, text)| text.contains(" left"))
        .collect();
    let (Some((at, text)), Some((end, _))) = (spots.get(spots.len() / 3), spots.last()) else {
        return;
    };
    let left = (*end - *at).as_secs_f64();
    println!("  it said \u{201c}{text}\u{201d}; {left:.0} s it was");
}

fn status(page: &Page) -> Result<String> {
    let text = format!(
        "document.querySelector('{}')?.innerText ?? ''",
        part("status")
    );
    let text = page.value_of(&text)?;
    Ok(text.as_str().unwrap_or_default().to_owned())
}

/// How many views there are, as the page says it.
fn views(said: &[(Duration, String)]) -> Option<f64> {
    let number = |text: &str| text.split_once(" of ")?.1.split(' ').next()?.parse().ok();
    said.iter().find_map(|(_, text)| number(text))
}

/// The most that was held at any time, bytes.
#[derive(Clone, Copy, Default)]
struct Memory {
    page: u64,
    all: u64,
}

impl Memory {
    fn look(&mut self, browser: &Browser) -> Result<()> {
        let processes = browser.processes()?;
        let held = processes.iter().map(|p| (p.kind == "renderer", held(p.id)));
        let held: Vec<(bool, u64)> = held.collect();
        let page = held.iter().filter(|(of_page, _)| *of_page);
        self.page = self.page.max(page.map(|(_, bytes)| bytes).sum());
        self.all = self.all.max(held.iter().map(|(_, bytes)| bytes).sum());
        Ok(())
    }
}

impl std::fmt::Display for Memory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [page, all] = [self.page, self.all].map(|bytes| bytes as f64 / 1e6);
        write!(
            f,
            "{page:.0} MB in the page's processes, {all:.0} MB in all of Chromium"
        )
    }
}

/// What a process holds: what it shares with others counts by its share.
fn held(process: u32) -> u64 {
    let rollup = fs::read_to_string(format!("/proc/{process}/smaps_rollup")).unwrap_or_default();
    let mut lines = rollup.lines().filter_map(|line| line.strip_prefix("Pss:"));
    let kibibytes = lines.next().and_then(|rest| rest.trim().strip_suffix("kB"));
    kibibytes
        .and_then(|number| number.trim().parse::<u64>().ok())
        .unwrap_or(0)
        * 1024
}

fn processor(browser: &Browser) -> Result<String> {
    let processes = browser.processes()?;
    let of = |kind: &str| -> f64 {
        let of_kind = processes.iter().filter(|p| p.kind == kind);
        of_kind.map(|p| p.seconds).sum()
    };
    let [page, graphics, rest] = ["renderer", "GPU", "browser"].map(of);
    Ok(format!(
        "{page:.0} s in the page's processes, {graphics:.0} s drawing, {rest:.0} s in the browser's"
    ))
}

fn load() -> String {
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let minute = load.split(' ').next().unwrap_or("unknown");
    format!("{minute} of {cores} cores")
}
