//! Which part of the pictures is seen.

use snellius::export::SpotRole;

use super::Found;

/// How the pictures are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// How many times larger than the whole picture.
    pub(super) zoom: f64,
    /// What is in the middle, px; the spots, unless it was moved.
    pub(super) centre: Option<[f64; 2]>,
}

/// The part of the pictures that is shown, px; the same in all three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// As much as the zoom leaves, around the spots, within the picture.
pub(super) fn window([width, height]: [f64; 2], look: Look, spots: &[Found]) -> Window {
    let (shown_width, shown_height) = (width / look.zoom, height / look.zoom);
    let [u, v] = look
        .centre
        .or_else(|| middle(spots, [shown_width, shown_height]))
        .unwrap_or([width / 2.0, height / 2.0]);
    Window {
        left: (u - shown_width / 2.0).clamp(0.0, width - shown_width),
        top: (v - shown_height / 2.0).clamp(0.0, height - shown_height),
        width: shown_width,
        height: shown_height,
    }
}

/// The middle of the spots that matter; if they do not all fit, the object's.
fn middle(spots: &[Found], [width, height]: [f64; 2]) -> Option<[f64; 2]> {
    let known = || spots.iter().filter(|spot| spot.role != SpotRole::Stray);
    let range = |axis: usize| {
        let values = known().map(move |spot| spot.pixel[axis]);
        values.fold((f64::MAX, f64::MIN), |(low, high), v| {
            (low.min(v), high.max(v))
        })
    };
    let ([left, top], [right, bottom]) = {
        let (u, v) = (range(0), range(1));
        ([u.0, v.0], [u.1, v.1])
    };
    if right - left < 0.9 * width && bottom - top < 0.9 * height {
        return known()
            .next()
            .map(|_| [0.5 * (left + right), 0.5 * (top + bottom)]);
    }
    let object = known().find(|spot| spot.role == SpotRole::Object);
    object.or_else(|| known().next()).map(|spot| spot.pixel)
}

impl Window {
    /// What is in the middle, in the corners' coordinates.
    pub(super) const fn centre(self) -> [f64; 2] {
        [self.left + self.width / 2.0, self.top + self.height / 2.0]
    }

    /// The pixel at a place of the frame (0 to 1 across and down).
    pub(super) fn pixel(self, [across, down]: [f64; 2]) -> [usize; 2] {
        // A cast to a whole number ends at 0.
        [
            (self.left + across * self.width) as usize,
            (self.top + down * self.height) as usize,
        ]
    }

    /// The pixels that are seen, if they are few enough to write in.
    pub(super) fn large_pixels(self) -> Option<impl Iterator<Item = [usize; 2]>> {
        const MOST_ACROSS: f64 = 16.0;
        let (left, top) = (self.left as usize, self.top as usize);
        let right = (self.left + self.width).ceil() as usize;
        let bottom = (self.top + self.height).ceil() as usize;
        (self.width <= MOST_ACROSS)
            .then(|| (top..bottom).flat_map(move |v| (left..right).map(move |u| [u, v])))
    }
}

impl Look {
    /// The strongest zoom: a pixel is as large as a thumb.
    const STRONGEST: f64 = 128.0;

    /// Zooms by a factor; the place of the frame (0 to 1) keeps what it shows.
    pub(super) fn zoom(&mut self, factor: f64, window: Window, [across, down]: [f64; 2]) {
        let zoom = (self.zoom * factor).clamp(1.0, Self::STRONGEST);
        let left = 1.0 - self.zoom / zoom;
        let [u, v] = window.centre();
        self.centre = Some([
            u + left * (across - 0.5) * window.width,
            v + left * (down - 0.5) * window.height,
        ]);
        self.zoom = zoom;
    }

    /// Shifts what is seen, px.
    pub(super) fn shift(&mut self, window: Window, [du, dv]: [f64; 2]) {
        let [u, v] = window.centre();
        self.centre = Some([u + du, v + dv]);
    }
}
