//! What fits share that must not be led astray by a few wrong points: medians, Tukey's biweight, and a
//! choice of samples that is the same everywhere.

use std::cmp::Ordering;

/// The median (the upper one of an even number).
///
/// # Panics
///
/// If there are no values.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Sorts by a number of each item; equal ones stay in order. For each type and each way to compare, `sort_by` is a
/// program of its own, of some 5 kB; here it is one for all.
pub(crate) fn sort_by_number<T>(items: &mut Vec<T>, number: impl Fn(&T) -> f64) {
    let order = ordered(items.iter().map(number).zip(0..).collect());
    put_in_order(items, order.into_iter().map(|(_, at)| at));
}

/// Sorts by whatever order, likewise: slower than by a number, for there is a call to each comparison.
pub(crate) fn sort_stably<T>(items: &mut Vec<T>, compare: impl Fn(&T, &T) -> Ordering) {
    let order = order(items.len(), &|a, b| compare(&items[a], &items[b]));
    put_in_order(items, order.into_iter());
}

fn put_in_order<T>(items: &mut Vec<T>, order: impl Iterator<Item = usize>) {
    let mut items_left: Vec<Option<T>> = items.drain(..).map(Some).collect();
    items.extend(order.filter_map(|at| items_left[at].take()));
}

#[inline(never)]
fn ordered(mut numbers: Vec<(f64, usize)>) -> Vec<(f64, usize)> {
    numbers.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    numbers
}

#[inline(never)]
fn order(count: usize, compare: &dyn Fn(usize, usize) -> Ordering) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_unstable_by(|a, b| compare(*a, *b).then(a.cmp(b)));
    order
}

/// 1.4826 times the median size: the standard deviation, for normal errors.
pub(crate) fn robust_scale(values: &[f64]) -> f64 {
    1.4826 * median(values.iter().map(|value| value.abs()).collect())
}

/// Tukey's biweight at 4.685 scales keeps 95 % of the efficiency of least squares.
const TUKEY: f64 = 4.685;

/// Tukey's biweights of normalised residuals, at their own robust scale. That is never taken to be below
/// 1, so that points are not cast out for being better than their sigma says.
pub(crate) fn biweights(normalised: &[f64]) -> impl Iterator<Item = f64> + '_ {
    let scale = robust_scale(normalised).max(1.0);
    normalised.iter().map(move |z| biweight(z / scale))
}

/// Tukey's biweight of one residual, in standard deviations.
pub(crate) fn biweight(z: f64) -> f64 {
    let u = z / TUKEY;
    let keep = (1.0 - u * u).max(0.0);
    keep * keep
}

/// Tukey's loss, scaled so that it is z^2 near zero; it levels off at 4.685^2 / 3.
pub(crate) fn tukey_loss(z: f64) -> f64 {
    let u = (z / TUKEY) * (z / TUKEY);
    let rest = (1.0 - u).max(0.0);
    TUKEY * TUKEY / 3.0 * (1.0 - rest * rest * rest)
}

/// A repeatable choice of samples: Marsaglia's xorshift64. The quality needed is low, the sameness is
/// what counts.
pub(crate) struct Choice(u64);

impl Choice {
    /// Always starts the same.
    pub(crate) const fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound as u64) as usize
    }

    /// N different numbers below `bound`, or none for too small a bound.
    pub(crate) fn distinct<const N: usize>(&mut self, bound: usize) -> Option<[usize; N]> {
        if bound < N {
            return None;
        }
        let mut chosen = [0; N];
        let mut count = 0;
        while count < N {
            let next = self.below(bound);
            if !chosen[..count].contains(&next) {
                chosen[count] = next;
                count += 1;
            }
        }
        Some(chosen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_sorted_by_their_number_and_equal_ones_stay_in_order() {
        let mut items = vec![
            ("a", 2.0),
            ("b", -1.0),
            ("c", 2.0),
            ("d", f64::NAN),
            ("e", 0.5),
        ];
        sort_by_number(&mut items, |item| item.1);
        let names: String = items.iter().map(|item| item.0).collect();
        assert_eq!(names, "beacd");
    }

    #[test]
    fn items_are_sorted_by_any_order_and_equal_ones_stay_in_order() {
        let mut items = vec![("a", 2), ("b", 1), ("c", 2), ("d", 3), ("e", 1)];
        sort_stably(&mut items, |a, b| b.1.cmp(&a.1));
        let names: String = items.iter().map(|item| item.0).collect();
        assert_eq!(names, "dacbe");
    }
}
