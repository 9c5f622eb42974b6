//! Round numbers along an axis.

/// Round values within a range, about `count` of them.
pub(super) fn ticks([low, high]: [f64; 2], count: f64) -> Vec<f64> {
    let step = round_step((high - low) / count);
    // A round end counts, though the numbers miss it by their last bits.
    const BITS: f64 = 1e-9;
    let first = (low / step - BITS).ceil();
    let last = (high / step + BITS).floor();
    // At most a few dozen, whatever the range: the step follows it.
    (0..=(last - first).clamp(0.0, 50.0) as u32)
        .map(|k| (first + f64::from(k)) * step)
        .collect()
}

/// The next of 1, 2, 5, 10, 20, ... at or above a value.
fn round_step(least: f64) -> f64 {
    let mut decade = 1e-9;
    while decade < 1e9 {
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
    let rounded: f64 = format!("{tick:.8}").parse().unwrap_or(tick);
    minus(&(rounded + 0.0).to_string())
}

/// A number of so many decimals, with a typographic minus; -0.00 is 0.00.
pub(super) fn fixed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let is_nothing = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    if is_nothing {
        text.trim_start_matches('-').to_owned()
    } else {
        minus(&text)
    }
}

fn minus(text: &str) -> String {
    text.replacen('-', "\u{2212}", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(ticks([-0.01, 1.02], 5.0), [0.0, 0.5, 1.0]);
        let labels = ticks([-0.3, 0.3], 6.0).into_iter().map(label);
        let labels: Vec<_> = labels.collect();
        assert_eq!(
            labels,
            [
                "\u{2212}0.3",
                "\u{2212}0.2",
                "\u{2212}0.1",
                "0",
                "0.1",
                "0.2",
                "0.3"
            ]
        );
        assert_eq!(fixed(-0.0004, 3), "0.000");
        assert_eq!(fixed(-1.25, 1), "\u{2212}1.2");
    }
}
