//! Pixels onto a canvas.

use js_sys::{Object, Reflect, Uint8ClampedArray};
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
    // A canvas that is read often has its pixels in the page's own memory. Any other asks the graphics process for
    // room, and the page's thread waits until that has drawn what it was told before.
    let wishes = Object::new();
    Reflect::set(&wishes, &"willReadFrequently".into(), &true.into())?;
    let context = canvas.get_context_with_context_options("2d", &wishes)?;
    let context: CanvasRenderingContext2d = context.ok_or("no context")?.unchecked_into();
    let image = ImageData::new_with_js_u8_clamped_array_and_sh(pixels, width, height)?;
    context.put_image_data(&image, 0.0, 0.0)
}

/// Shows a small picture on a canvas.
pub(crate) fn paint_small(canvas: &HtmlCanvasElement, small: &Thumbnail) -> Result<(), JsValue> {
    paint(canvas, [small.width, small.height], &small.pixels)
}
