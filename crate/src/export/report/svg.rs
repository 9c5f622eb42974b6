//! What the figures share: a scale with round ticks, colours of the scans.

/// The colour of a sweep: eight that stay apart in print and for most eyes (after Okabe and Ito, 2008).
pub(super) fn colour(sweep: u32) -> &'static str {
    const COLOURS: [&str; 8] = [
        "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6a3d9a", "#000000",
    ];
    COLOURS[sweep as usize % COLOURS.len()]
}

/// A number as it stands in a drawing: a hundredth of a pixel is enough.
pub(super) fn px(value: f64) -> String {
    let text = format!("{value:.2}");
    if text == "-0.00" {
        "0.00".to_owned()
    } else {
        text
    }
}

/// Round values within a range, about `count` of them.
pub(super) fn ticks(low: f64, high: f64, count: f64) -> Vec<f64> {
    let step = round_step((high - low) / count);
    let first = (low / step).ceil();
    let last = (high / step).floor();
    // At most a few dozen, whatever the range: the step follows it.
    (0..=(last - first).clamp(0.0, 50.0) as u32)
        .map(|k| (first + f64::from(k)) * step)
        .filter(|tick| *tick <= high)
        .collect()
}

/// The next of 1, 2, 5, 10, 20, ... at or above a value.
fn round_step(least: f64) -> f64 {
    let mut decade = 1e-6;
    while decade < 1e6 {
        for factor in [1.0, 2.0, 5.0] {
            if decade * factor >= least {
                return decade * factor;
            }
        }
        decade *= 10.0;
    }
    least
}

/// A tick's number without digits that say nothing.
pub(super) fn label(tick: f64) -> String {
    // Through a text of few digits, so that 0.1 + 0.2 is 0.3.
    let rounded: f64 = format!("{tick:.6}").parse().unwrap_or(tick);
    (rounded + 0.0).to_string()
}
