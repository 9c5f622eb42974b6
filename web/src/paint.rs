//! Pixels onto a canvas.

use js_sys::Uint8ClampedArray;
use wasm_bindgen::prelude::*;
use web_sys::{CanvasRenderingContext2d, HtmlCanvasElement, ImageData};

use crate::run::Thumbnail;

/// Shows pixels (RGBA, row by row) on a canvas of that width and height.
pub(crate) fn paint(
    canvas: &HtmlCanvasElement,
    [width, height]: [u32; 2],
    pixels: &Uint8ClampedArray,
) -> Result<(), JsValue> {
    canvas.set_width(width);
    canvas.set_height(height);
    let context = canvas.get_context("2d")?;
    let context: CanvasRenderingContext2d = context.ok_or("no context")?.unchecked_into();
    let image = ImageData::new_with_js_u8_clamped_array_and_sh(pixels, width, height)?;
    context.put_image_data(&image, 0.0, 0.0)
}

/// Shows a small picture on a canvas.
pub(crate) fn paint_small(canvas: &HtmlCanvasElement, small: &Thumbnail) -> Result<(), JsValue> {
    paint(canvas, [small.width, small.height], &small.pixels)
}
