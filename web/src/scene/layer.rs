//! A picture off the screen, with its depth: what is drawn on it stays there from frame to frame.

use three_d::context::{
    COLOR_ATTACHMENT0, COLOR_BUFFER_BIT, DEPTH_ATTACHMENT, DEPTH_BUFFER_BIT, DEPTH_COMPONENT24,
    DRAW_FRAMEBUFFER, FRAMEBUFFER, Framebuffer, NEAREST, READ_FRAMEBUFFER, RENDERBUFFER, RGBA8,
    Renderbuffer,
};
use three_d::{ClearState, Context, CoreError, HasContext, RenderTarget, Viewport};

/// A picture in graphics memory.
pub(super) struct Layer {
    context: Context,
    framebuffer: Framebuffer,
    /// Its colours and its depths.
    parts: [Renderbuffer; 2],
    /// It owns the framebuffer.
    target: RenderTarget<'static>,
}

impl Drop for Layer {
    fn drop(&mut self) {
        for part in self.parts {
            // SAFETY: nothing else has it.
            unsafe { self.context.delete_renderbuffer(part) };
        }
    }
}

impl Layer {
    /// A layer as large as the viewport; none if the context is lost.
    pub(super) fn new(context: &Context, Viewport { width, height, .. }: Viewport) -> Option<Self> {
        // SAFETY: all that is bound here was made here.
        unsafe {
            let framebuffer = context.create_framebuffer().ok()?;
            context.bind_framebuffer(FRAMEBUFFER, Some(framebuffer));
            let part = |format, place| {
                let part = context.create_renderbuffer().ok()?;
                context.bind_renderbuffer(RENDERBUFFER, Some(part));
                context.renderbuffer_storage(RENDERBUFFER, format, width as i32, height as i32);
                context.framebuffer_renderbuffer(FRAMEBUFFER, place, RENDERBUFFER, Some(part));
                Some(part)
            };
            Some(Self {
                parts: [
                    part(RGBA8, COLOR_ATTACHMENT0)?,
                    part(DEPTH_COMPONENT24, DEPTH_ATTACHMENT)?,
                ],
                target: RenderTarget::from_framebuffer(context, width, height, framebuffer),
                context: context.clone(),
                framebuffer,
            })
        }
    }

    /// Whether it is as large as the viewport.
    pub(super) fn fits(&self, viewport: Viewport) -> bool {
        (self.target.width(), self.target.height()) == (viewport.width, viewport.height)
    }

    /// Nothing but a ground: red, green, blue, opacity.
    pub(super) fn clear(&self, [red, green, blue, opacity]: [f32; 4]) {
        self.target
            .clear(ClearState::color_and_depth(red, green, blue, opacity, 1.0));
    }

    /// Draws on it.
    pub(super) fn draw(&self, draw: impl FnOnce()) {
        let drawn: Result<_, CoreError> = self.target.write(|| {
            draw();
            Ok(())
        });
        debug_assert!(drawn.is_ok(), "what is drawn says nothing of failures");
    }

    /// Copies it onto one of the same size, or, without its depth, onto the screen.
    pub(super) fn copy_to(&self, other: Option<&Self>) {
        let parts = match other {
            Some(_) => COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT,
            None => COLOR_BUFFER_BIT,
        };
        let [width, height] = [self.target.width(), self.target.height()].map(|side| side as i32);
        let context = &self.context;
        // SAFETY: both are there as long as they are borrowed.
        unsafe {
            context.bind_framebuffer(READ_FRAMEBUFFER, Some(self.framebuffer));
            context.bind_framebuffer(DRAW_FRAMEBUFFER, other.map(|other| other.framebuffer));
            context.blit_framebuffer(0, 0, width, height, 0, 0, width, height, parts, NEAREST);
        }
    }
}
