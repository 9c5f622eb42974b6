//! A picture of the scene as a file, with the legend of its colours.

use three_d::Vec2;
use wasm_bindgen::prelude::*;
use web_sys::{CanvasRenderingContext2d, HtmlCanvasElement};

use crate::colours::{Quantity, Scale, css, hue, is_dark};
use crate::legend::value_text;

/// How wide the legend is, and what lies between its parts, CSS px.
const WIDTH: f64 = 220.0;
const GAP: f64 = 10.0;
const LINE: f64 = 18.0;
/// More would cover the scene, and hues repeat by then.
const MOST_HUES: usize = 8;

/// What stands on a canvas, `size` CSS px large, with a legend at its lower left.
pub(super) fn with_legend(
    scene: &HtmlCanvasElement,
    size: Vec2,
    scale: &Scale,
) -> Result<HtmlCanvasElement, JsValue> {
    let document = scene.owner_document().ok_or("no document")?;
    let picture: HtmlCanvasElement = document.create_element("canvas")?.unchecked_into();
    picture.set_width(scene.width());
    picture.set_height(scene.height());
    let context = picture.get_context("2d")?.ok_or("no context")?;
    let context: CanvasRenderingContext2d = context.unchecked_into();
    context.draw_image_with_html_canvas_element(scene, 0.0, 0.0)?;
    let ratio = f64::from(scene.width()) / f64::from(size.x.max(1.0));
    context.scale(ratio, ratio)?;
    let height = 3.0 * LINE + 2.0 * GAP;
    context.translate(GAP, f64::from(size.y) - GAP - height)?;
    let (ground, text) = if is_dark() {
        ("rgb(22 31 38 / 90%)", "#e6eef2")
    } else {
        ("rgb(255 255 255 / 90%)", "#13222b")
    };
    context.set_fill_style_str(ground);
    context.fill_rect(0.0, 0.0, WIDTH, height);
    context.set_fill_style_str(text);
    context.set_font("13px sans-serif");
    match scale {
        Scale::Quantity(quantity) => draw_quantity(&context, quantity)?,
        Scale::Sweeps(count) => draw_sweeps(&context, *count, text)?,
    }
    Ok(picture)
}

fn draw_quantity(context: &CanvasRenderingContext2d, quantity: &Quantity) -> Result<(), JsValue> {
    let inner = WIDTH - 2.0 * GAP;
    let words = |place: f64, line: f64, align: &str, words: &str| {
        context.set_text_align(align);
        context.fill_text_with_max_width(words, place, GAP + LINE * line - 4.0, inner)
    };
    words(
        GAP,
        1.0,
        "left",
        &format!("{}, {}", quantity.name, quantity.unit),
    )?;
    words(GAP, 3.0, "left", &value_text(quantity, 0.0))?;
    words(WIDTH - GAP, 3.0, "right", &value_text(quantity, 1.0))?;
    let steps = inner as usize;
    for step in 0..steps {
        let colour = quantity.map.at(step as f32 / (steps - 1) as f32);
        context.set_fill_style_str(&css(colour));
        context.fill_rect(GAP + step as f64, GAP + LINE, 1.0, LINE - 6.0);
    }
    Ok(())
}

fn draw_sweeps(
    context: &CanvasRenderingContext2d,
    count: usize,
    text: &str,
) -> Result<(), JsValue> {
    context.fill_text("Scan", GAP, GAP + LINE - 4.0)?;
    let step = (WIDTH - 2.0 * GAP) / MOST_HUES as f64;
    for sweep in 0..count.min(MOST_HUES) {
        let left = GAP + step * sweep as f64;
        context.set_fill_style_str(&css(hue(sweep)));
        context.fill_rect(left, GAP + LINE, step - 4.0, LINE - 6.0);
        context.set_fill_style_str(text);
        context.fill_text(&(sweep + 1).to_string(), left, GAP + 3.0 * LINE - 4.0)?;
    }
    Ok(())
}
