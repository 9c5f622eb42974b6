//! How far the two light paths of each object point miss each other, view by view.

use maud::{Markup, html};

use super::super::ReconstructionResult;
use super::svg::{colour, label, px, ticks};

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 150.0;

pub(super) fn figure(result: &ReconstructionResult) -> Markup {
    let highest = super::distances(result).fold(0.0, f64::max);
    // The sheet of a line laser meets every line of sight, to the last bits of the numbers.
    const NOTHING: f64 = 1e-9;
    if highest < NOTHING {
        return html! { p { "No two light paths miss each other: there are no object points, or the laser is a line." } };
    }
    let top = 1.05 * highest;
    let y = |l: f64| px(HEIGHT * (1.0 - l / top));
    let x = |view: usize| px(WIDTH * (view as f64 + 0.5) / result.views.len() as f64);
    html! {
        figure {
            svg viewBox=(format!("-44 -6 {} {}", WIDTH + 50.0, HEIGHT + 12.0))
                width=(WIDTH + 50.0) height=(HEIGHT + 12.0) role="img" aria-label="ray distance of each view" {
                g.grid {
                    @for tick in ticks(0.0, top, 4.0) {
                        line x1="0" x2=(WIDTH) y1=(y(tick)) y2=(y(tick)) {}
                        text x="-5" y=(y(tick)) dy="3.5" text-anchor="end" { (label(tick)) }
                    }
                    rect x="0" y="0" width=(WIDTH) height=(HEIGHT) {}
                }
                @for (number, view) in result.views.iter().enumerate() {
                    @for l in view.ray_distance.iter() {
                        circle cx=(x(number)) cy=(y(*l)) r="2.2" fill=(colour(view.sweep)) {}
                    }
                }
            }
            figcaption { "Ray distance l (mm) of each object point, views in their order" }
        }
    }
}
