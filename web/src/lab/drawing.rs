//! A picture as the text of an SVG. Looks come from the style sheet, by class.

use std::fmt::Write;

/// A place in a picture, px.
pub(super) type At = [f64; 2];

/// The text of an SVG's inside, as it grows. Only numbers and the program's own words go in.
#[derive(Default)]
pub(super) struct Drawing(String);

impl Drawing {
    pub(super) fn text_of(self) -> String {
        self.0
    }

    pub(super) fn line(&mut self, class: &str, [x1, y1]: At, [x2, y2]: At) {
        let _ = write!(
            self.0,
            r#"<line class="{class}" x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}"/>"#
        );
    }

    /// A line through places; closed, it is an area.
    pub(super) fn path(&mut self, class: &str, places: &[At], closed: bool) {
        let mut d = String::new();
        for (i, [x, y]) in places.iter().enumerate() {
            let _ = write!(d, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
        }
        if closed {
            d.push('Z');
        }
        let _ = write!(self.0, r#"<path class="{class}" d="{d}"/>"#);
    }

    pub(super) fn rect(&mut self, class: &str, [x, y]: At, [width, height]: At) {
        let (width, height) = (width.max(0.0), height.max(0.0));
        let _ = write!(
            self.0,
            r#"<rect class="{class}" x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}"/>"#
        );
    }

    pub(super) fn circle(&mut self, class: &str, [x, y]: At, radius: f64) {
        let _ = write!(
            self.0,
            r#"<circle class="{class}" cx="{x:.1}" cy="{y:.1}" r="{radius:.1}"/>"#
        );
    }

    pub(super) fn text(&mut self, class: &str, [x, y]: At, text: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        let _ = write!(
            self.0,
            r#"<text class="{class}" x="{x:.1}" y="{y:.1}">{text}</text>"#
        );
    }

    /// A line with an arrowhead in its middle, pointing from the first place to the second.
    pub(super) fn ray(&mut self, class: &str, from: At, to: At) {
        self.line(class, from, to);
        self.arrowhead(class, from, to, 0.5);
    }

    /// An arrowhead on the way from one place to another, at a share of it.
    pub(super) fn arrowhead(&mut self, class: &str, from: At, to: At, share: f64) {
        const LENGTH: f64 = 11.0;
        const HALF_WIDTH: f64 = 4.2;
        let way = [to[0] - from[0], to[1] - from[1]];
        let length = way[0].hypot(way[1]);
        if length < LENGTH * 1.4 {
            return;
        }
        let [x, y] = [way[0] / length, way[1] / length];
        let tip = length * share + 0.5 * LENGTH;
        let at = |along: f64, aside: f64| {
            [
                from[0] + x * along - y * aside,
                from[1] + y * along + x * aside,
            ]
        };
        let back = tip - LENGTH;
        let head = [at(tip, 0.0), at(back, HALF_WIDTH), at(back, -HALF_WIDTH)];
        self.path(&format!("head {class}"), &head, true);
    }

    /// The arc about a corner from one direction to another, with a text beside it.
    pub(super) fn angle(&mut self, corner: At, first: At, second: At, radius: f64, text: &str) {
        let (a, b) = (first[1].atan2(first[0]), second[1].atan2(second[0]));
        let mut sweep = b - a;
        if sweep > std::f64::consts::PI {
            sweep -= std::f64::consts::TAU;
        } else if sweep < -std::f64::consts::PI {
            sweep += std::f64::consts::TAU;
        }
        let at = |angle: f64, radius: f64| {
            [
                corner[0] + radius * angle.cos(),
                corner[1] + radius * angle.sin(),
            ]
        };
        let places: Vec<At> = (0..=12)
            .map(|step| at(a + sweep * f64::from(step) / 12.0, radius))
            .collect();
        self.path("arc", &places, false);
        if !text.is_empty() {
            // A narrow angle has no room for its number: that stands beyond the first leg.
            const NARROW: f64 = 0.6;
            let middle = if sweep.abs() < NARROW {
                at(a - 0.26_f64.copysign(sweep), radius + 18.0)
            } else {
                at(a + 0.5 * sweep, radius + 24.0)
            };
            self.text("angle-text", [middle[0], middle[1] + 4.0], text);
        }
    }
}

/// An angle as drawings show it.
pub(super) fn degrees(radians: f64) -> String {
    format!("{:.1}\u{b0}", radians.to_degrees())
}
