//! How many points the page carries, and how long it keeps its thread: a scan is opened, its scene is turned,
//! looked through, coloured and picked from as by hand.
//!
//! `cargo bench -p snellius-tests --bench scene -- [SCAN.zip | COPIES]`, after `cargo xtask dist`. Without a scan
//! the sample of a line laser is taken so many times, each copy a little further along the wall: 108 copies give
//! a million spots and 334,000 points, 455 give 10,000 views.
#![allow(clippy::print_stdout, reason = "it is what a benchmark is for")]

use std::{
    path::Path,
    time::{Duration, Instant},
};

use anyhow::Result;
use serde_json::Value;
use snellius_tests::{
    Page,
    copies::line_copies,
    workbench::{Workbench, with_workbench},
};

/// Reading a scan of a million spots on a busy machine.
const PATIENCE: Duration = Duration::from_secs(3600);

/// As many copies of the sample as make a million spots.
const COPIES: usize = 108;

/// Notes every frame that keeps the page's thread for long, and what it does meanwhile.
const WATCH: &str = "(() => {
    window.longTasks = [];
    window.longFrames = [];
    const watch = (type, see) => new PerformanceObserver(list => list.getEntries().forEach(see)).observe({ type });
    watch('longtask', task => longTasks.push(task.duration));
    watch('long-animation-frame', frame => longFrames.push(
        `${Math.round(frame.startTime)}: ${Math.round(frame.duration)} ms, blocked ${Math.round(frame.blockingDuration)}, `
        + frame.scripts.map(({ invoker, duration, forcedStyleAndLayoutDuration: layout }) =>
            `${invoker.slice(-40)} ${Math.round(duration)} (layout ${Math.round(layout)})`).join('; ')));
})()";

/// Counts the points that are drawn, and notes when something was drawn last.
const COUNT: &str = "(() => {
    window.points = 0;
    window.drawnAt = 0;
    const graphics = WebGL2RenderingContext.prototype;
    const draw = graphics.drawArrays;
    graphics.drawArrays = function (kind, first, count) {
        if (kind === this.POINTS) points += count;
        drawnAt = performance.now();
        return draw.call(this, kind, first, count);
    };
})()";

/// What a hand does in the scene, and the times it takes, ms: between frames that are asked for one by one.
const HANDS: &str = "
    const part = name => document.querySelector(`[data-testid=${name}]`);
    const scene = part('scene');
    const box = scene.getBoundingClientRect();
    const send = (kind, x, y) => scene.dispatchEvent(new PointerEvent(kind,
        { clientX: box.x + x, clientY: box.y + y, pointerId: 7, button: 0, bubbles: true }));
    const frame = () => new Promise(done => requestAnimationFrame(done));
    const pause = time => new Promise(done => setTimeout(done, time));
    const times = async (count, act) => {
        const times = [];
        await frame();
        let before = performance.now();
        for (let i = 1; i <= count; i++) {
            act(i);
            await frame();
            const now = performance.now();
            times.push(now - before);
            before = now;
        }
        return times.sort((a, b) => a - b);
    };
    const kept = act => {
        const before = performance.now();
        act();
        return performance.now() - before;
    };
    const set = (input, value, kind) => {
        input.value = value;
        input.dispatchEvent(new Event(kind, { bubbles: true }));
    };
";

const TURN: &str = "
    send('pointerdown', 300, 100);
    const turned = await times(60, i => send('pointermove', 300 + 3 * i, 100));
    send('pointerup', 480, 100);
    return turned;
";

/// Turns a little, and waits until nothing more is drawn: how long that takes after the last turn, ms, and how
/// many points there are then.
const FILL: &str = "
    const known = [];
    for (let i = 0; i < 3; i++) {
        send('pointerdown', 300, 100);
        await times(5, i => send('pointermove', 300 + 3 * i, 100));
        const begun = performance.now();
        points = 0;
        send('pointermove', 330, 110);
        send('pointerup', 330, 110);
        do await pause(100); while (performance.now() - drawnAt < 1500);
        known.push(drawnAt - begun);
    }
    return known.sort((a, b) => a - b);
";

const BRUSH: &str = "
    const handle = part('hide-above');
    const brushed = await times(30, i => set(handle, 1 - i / 40, 'input'));
    set(handle, 1, 'input');
    return brushed;
";

const COLOURS: &str = "
    const list = part('colour-by');
    const coloured = [];
    for (const by of ['depth', 'sigma', 'residual', 'scan', 'ray-distance']) {
        longTasks.length = 0;
        set(list, by, 'change');
        await pause(2500);
        coloured.push(Math.max(0, ...longTasks));
    }
    return coloured.sort((a, b) => a - b);
";

const PICK: &str = "
    const picked = [];
    for (let i = 0; i < 8; i++) {
        const [x, y] = [box.width * (0.3 + 0.05 * i), box.height / 2];
        send('pointerdown', x, y);
        picked.push(kept(() => send('pointerup', x, y)));
        await pause(400);
    }
    return picked.sort((a, b) => a - b);
";

const SCROLL: &str = "
    const table = document.querySelector('.table-frame');
    const scrolled = await times(40, i => table.scrollTop = table.scrollHeight * i / 40);
    return scrolled;
";

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let folder = tempfile::tempdir()?;
    let scan = match words.iter().find(|word| word.ends_with(".zip")) {
        Some(path) => Path::new(path).canonicalize()?,
        None => {
            let copies = words.iter().find_map(|word| word.parse().ok());
            line_copies(folder.path(), copies.unwrap_or(COPIES))?
        }
    };
    with_workbench("bench-scene", |workbench| measure(workbench, &scan))
}

fn measure(workbench: &Workbench, scan: &Path) -> Result<()> {
    let page = workbench.page;
    page.value_of(WATCH)?;
    page.value_of(COUNT)?;
    let start = Instant::now();
    workbench.choose(scan)?;
    workbench.wait_state("running", PATIENCE)?;
    let is_running = "document.documentElement.dataset.state === 'running'";
    let longest = || page.value_of("Math.round(Math.max(0, ...longTasks))");
    let mut while_running = Value::Null;
    while page.value_of(is_running)? == true {
        while_running = longest()?;
        std::thread::sleep(Duration::from_millis(200));
    }
    workbench.wait_state("done", PATIENCE)?;
    println!("measured in {:.1} s", start.elapsed().as_secs_f64());
    std::thread::sleep(Duration::from_secs(8));
    println!(
        "longest task of the main thread: {while_running} ms while it ran, {} ms until it was shown",
        longest()?
    );
    for frame in page
        .value_of("longFrames")?
        .as_array()
        .into_iter()
        .flatten()
    {
        println!("    {frame}");
    }
    for stage in ["object", "vessel"] {
        println!(
            "{stage}: {}",
            page.text(&format!("[data-testid=stage-{stage}] .brief"))?
        );
    }
    println!(
        "rows of the table: {}",
        page.count("[data-testid^=view-row-]")?
    );
    println!("thumbnails: {}", page.count(".thumb")?);
    println!("elements of the page: {}", page.count("*")?);
    println!("memory of the page's heap: {} MB", megabytes(page)?);
    println!("WebGL: {}", renderer(page)?);
    report(page, "a frame of the turning scene", TURN)?;
    report(page, "from the last turn to the whole picture", FILL)?;
    println!("points of the whole picture: {}", page.value_of("points")?);
    report(page, "a frame under the range brush", BRUSH)?;
    report(page, "the longest task at another colour", COLOURS)?;
    report(page, "picking a point", PICK)?;
    report(page, "a frame of the scrolling table", SCROLL)?;
    page.screenshot("bench-scene")?;
    Ok(())
}

/// Does something in the page, and says how long its parts took.
fn report(page: &Page, what: &str, act: &str) -> Result<()> {
    let times = page.value_of(&format!("(async () => {{ {HANDS} {act} }})()"))?;
    let times: Vec<f64> = serde_json::from_value(times)?;
    let time = |share: f64| {
        let at = (share * (times.len().max(1) - 1) as f64) as usize;
        times.get(at).copied().unwrap_or(f64::NAN)
    };
    println!(
        "{what}: {:.0} ms (median), {:.0} ms (nine tenths), {:.0} ms (worst)",
        time(0.5),
        time(0.9),
        time(1.0)
    );
    Ok(())
}

fn megabytes(page: &Page) -> Result<Value> {
    page.value_of(
        "(async () => Math.round((performance.measureUserAgentSpecificMemory && crossOriginIsolated
            ? (await performance.measureUserAgentSpecificMemory()).bytes
            : performance.memory.totalJSHeapSize) / 1e6))()",
    )
}

fn renderer(page: &Page) -> Result<Value> {
    page.value_of(
        "(() => {
            const graphics = document.createElement('canvas').getContext('webgl2');
            const names = graphics.getExtension('WEBGL_debug_renderer_info');
            return graphics.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : graphics.RENDERER);
        })()",
    )
}
