//! How many points the scene carries: a scan is opened in the page, and its scene turned by hand.
//!
//! `cargo bench -p snellius-tests --bench scene -- SCAN.zip`, after `cargo xtask dist`. The more points the
//! scan gives, the more it tells: `samples/scenes/line.toml` with more views and higher pictures gives any
//! number.
#![allow(clippy::print_stdout, reason = "it is what a benchmark is for")]

use std::{path::Path, time::Duration, time::Instant};

use anyhow::{Context, Result};
use serde_json::Value;
use snellius_tests::{places::samples, workbench::with_workbench};

/// Reading a scan of a million points on a busy machine.
const PATIENCE: Duration = Duration::from_secs(3600);

/// Turns the scene a little in each of many frames, and gives the times between them, ms.
const TURN: &str = "(async () => {
    const scene = document.querySelector('[data-testid=scene]');
    const box = scene.getBoundingClientRect();
    const send = (kind, x) => scene.dispatchEvent(new PointerEvent(kind,
        { clientX: x, clientY: box.y + 100, pointerId: 7, button: 0, bubbles: true }));
    const frame = () => new Promise(done => requestAnimationFrame(done));
    send('pointerdown', box.x + 300);
    await frame();
    const times = [];
    let before = performance.now();
    for (let i = 1; i <= 60; i++) {
        send('pointermove', box.x + 300 + 3 * i);
        await frame();
        const now = performance.now();
        times.push(now - before);
        before = now;
    }
    send('pointerup', box.x + 480);
    return times.sort((a, b) => a - b);
})()";

fn main() -> Result<()> {
    let given = std::env::args().skip(1).find(|word| word.ends_with(".zip"));
    let scan = match &given {
        Some(path) => Path::new(path).canonicalize()?,
        None => samples()?.pop().context("there is no sample")?,
    };
    with_workbench("bench-scene", |workbench| {
        let page = workbench.page;
        page.value_of(
            "(() => {
                window.longTasks = [];
                new PerformanceObserver(list => longTasks.push(...list.getEntries().map(t => t.duration)))
                    .observe({ type: 'longtask' });
            })()",
        )?;
        let longest = || page.value_of("Math.max(0, ...longTasks)");
        let start = Instant::now();
        workbench.choose(&scan)?;
        workbench.wait_state("running", PATIENCE)?;
        let is_running = "document.documentElement.dataset.state === 'running'";
        let mut while_running = Value::Null;
        while page.value_of(is_running)? == true {
            while_running = longest()?;
            std::thread::sleep(Duration::from_millis(200));
        }
        workbench.wait_state("done", PATIENCE)?;
        let measured = start.elapsed();
        let times = page.value_of(TURN)?;
        let time = |share: f64| {
            let times = times.as_array().map_or(&[][..], Vec::as_slice);
            let at = (share * (times.len().max(1) - 1) as f64) as usize;
            times.get(at).and_then(Value::as_f64).unwrap_or(f64::NAN)
        };
        println!("{}", page.text("[data-testid=stage-object] .brief")?);
        println!(
            "{}",
            page.text("[data-testid=stage-vessel]")?.replace('\n', " ")
        );
        println!("measured in {:.1} s", measured.as_secs_f64());
        println!(
            "longest task of the main thread: {while_running} ms while it ran, {} ms in all",
            longest()?
        );
        println!(
            "a frame of a turning scene: {:.0} ms (median), {:.0} ms (nine tenths), {:.0} ms (worst)",
            time(0.5),
            time(0.9),
            time(1.0)
        );
        page.screenshot("bench-scene")?;
        Ok(())
    })
}
