//! An SVG file as plotters' drawing surface.
//!
//! plotters' own SVG surface measures text with the system's fonts or the browser's, so that the same
//! figure would differ from machine to machine, and knows no classes.

use std::convert::Infallible;
use std::fmt::Write as _;

use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};

use super::paint::class_of;

/// plotters counts in whole units: a tenth of a pixel each, so that curves are smooth.
pub(super) const UNITS: u32 = 10;

/// The letters' size, px.
pub(super) const LETTERS: u32 = 12;

type Done = Result<(), DrawingErrorKind<Infallible>>;

/// The inside of an SVG as it grows.
pub(super) struct Canvas<'a> {
    svg: &'a mut String,
    size: [u32; 2],
}

impl<'a> Canvas<'a> {
    /// A canvas of some px, over the text of its file.
    pub(super) fn new(svg: &'a mut String, size: [u32; 2]) -> Self {
        Self { svg, size }
    }

    fn path(&mut self, d: &str, closed: bool, style: &impl BackendStyle, filled: bool) {
        let close = if closed { "Z" } else { "" };
        let look = look(style, filled);
        let _ = write!(self.svg, "<path d=\"{d}{close}\"{look}/>");
    }
}

/// A whole file around the inside of a drawing.
pub(super) fn file(title: &str, [width, height]: [u32; 2], inside: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"system-ui, sans-serif\" font-size=\"{LETTERS}\" role=\"img\">\
         <title>{}</title>{inside}</svg>\n",
        escaped(title)
    )
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.size[0] * UNITS, self.size[1] * UNITS)
    }

    fn ensure_prepared(&mut self) -> Done {
        Ok(())
    }

    fn present(&mut self) -> Done {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, colour: BackendColor) -> Done {
        self.draw_rect(at, (at.0 + 1, at.1 + 1), &colour, true)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Done {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Done {
        let [x, y] = px((left, top));
        let [width, height] = px((right - left, bottom - top)).map(|side| side.max(0.0));
        let look = look(style, fill);
        let _ = write!(
            self.svg,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{look}/>"
        );
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Done {
        self.path(&through(path), false, style, false);
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        centre: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Done {
        let [x, y] = px(centre);
        let radius = f64::from(radius) / f64::from(UNITS);
        let look = look(style, fill);
        let _ = write!(
            self.svg,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{look}/>"
        );
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Done {
        self.path(&through(corners), true, style, true);
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, at: BackendCoord) -> Done {
        let [x, y] = px(at);
        let anchor = match style.anchor().h_pos {
            HPos::Left => "start",
            HPos::Center => "middle",
            HPos::Right => "end",
        };
        // From a place in the letters' box to their base line.
        let down = match style.anchor().v_pos {
            VPos::Top => "0.8em",
            VPos::Center => "0.35em",
            VPos::Bottom => "-0.3em",
        };
        let turn = match style.transform() {
            FontTransform::None => 0,
            FontTransform::Rotate90 => 90,
            FontTransform::Rotate180 => 180,
            FontTransform::Rotate270 => 270,
        };
        let place = match turn {
            0 => format!("x=\"{x}\" y=\"{y}\""),
            turn => format!("transform=\"translate({x} {y}) rotate({turn})\""),
        };
        let look = look(&style.color(), true);
        let _ = write!(
            self.svg,
            "<text {place} dy=\"{down}\" text-anchor=\"{anchor}\"{look}>{}</text>",
            escaped(text)
        );
        Ok(())
    }

    /// The same on every machine: a little more than usual letters take.
    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let letters = text.chars().count() as f64;
        Ok(((0.58 * style.size() * letters) as u32, style.size() as u32))
    }
}

/// The attributes of a shape: its class, so that a page can repaint it, and its colour for a file.
fn look(style: &impl BackendStyle, filled: bool) -> String {
    let BackendColor { rgb, alpha } = style.color();
    let class = class_of(rgb);
    let (red, green, blue) = rgb;
    let colour = format!("#{red:02x}{green:02x}{blue:02x}");
    let mut look = String::new();
    if filled {
        let _ = write!(look, " fill=\"{colour}\"");
    } else {
        let width = f64::from(style.stroke_width().max(1)) / f64::from(UNITS);
        let _ = write!(
            look,
            " fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\""
        );
    }
    if let Some(class) = class {
        let kind = if filled { "fill" } else { "line" };
        let _ = write!(look, " class=\"{kind}-{class}\"");
    }
    if class == Some("known") && !filled {
        look.push_str(" stroke-dasharray=\"5 4\"");
    }
    if alpha < 1.0 {
        let _ = write!(look, " opacity=\"{alpha}\"");
    }
    look
}

fn through(path: impl IntoIterator<Item = BackendCoord>) -> String {
    let mut d = String::new();
    for (i, at) in path.into_iter().enumerate() {
        let [x, y] = px(at);
        let _ = write!(d, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
    }
    d
}

fn px((x, y): BackendCoord) -> [f64; 2] {
    [x, y].map(|part| f64::from(part) / f64::from(UNITS))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
