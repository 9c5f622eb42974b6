//! The scene's own colours, for a light and a dark page.

/// Colours that mean nothing but what a thing is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Palette {
    pub(super) background: [f32; 3],
    pub(super) rim: [f32; 3],
    pub(super) grid: [f32; 4],
    pub(super) station: [f32; 4],
    pub(super) station_beam: [f32; 4],
    pub(super) vessel_point: [f32; 4],
    /// A point whose colour means nothing.
    pub(super) plain_point: [f32; 4],
    pub(super) wall: [f32; 4],
    pub(super) wall_edge: [f32; 4],
    pub(super) displacement: [f32; 4],
    pub(super) marker: [f32; 4],
    /// Points of the first and the second face that are measured with.
    pub(super) faces: [[f32; 4]; 2],
    pub(super) beam: [f32; 4],
    pub(super) sight: [f32; 4],
}

impl Palette {
    /// As the system asks for.
    pub(super) fn of_the_system() -> Self {
        if crate::colours::is_dark() {
            DARK
        } else {
            LIGHT
        }
    }
}

const DARK: Palette = Palette {
    background: rgb(0x0d1318),
    rim: rgb(0xf2f6f8),
    grid: rgba(0x9fb4c0, 0.16),
    station: rgba(0x8ea3b0, 0.85),
    station_beam: rgba(0xff8a66, 0.10),
    vessel_point: rgba(0x7fc4d8, 1.0),
    plain_point: rgba(0x6d828e, 1.0),
    wall: rgba(0x6fc3dc, 0.085),
    wall_edge: rgba(0x8fd3e6, 0.75),
    displacement: rgba(0xd7e3ea, 0.45),
    marker: rgba(0xffffff, 1.0),
    faces: [rgba(0x56b4e9, 1.0), rgba(0xe69f00, 1.0)],
    beam: rgba(0xff6a4d, 1.0),
    sight: rgba(0xffd166, 1.0),
};

const LIGHT: Palette = Palette {
    background: rgb(0xf6f8f9),
    rim: rgb(0x13222b),
    grid: rgba(0x24404f, 0.14),
    station: rgba(0x5b6f7b, 0.85),
    station_beam: rgba(0xc8401e, 0.09),
    vessel_point: rgba(0x1c7c96, 1.0),
    plain_point: rgba(0xa9b7bf, 1.0),
    wall: rgba(0x2f93b0, 0.10),
    wall_edge: rgba(0x1b7a96, 0.75),
    displacement: rgba(0x24404f, 0.4),
    marker: rgba(0x10202a, 1.0),
    faces: [rgba(0x0072b2, 1.0), rgba(0xd55e00, 1.0)],
    beam: rgba(0xc8330f, 1.0),
    sight: rgba(0x9a5b00, 1.0),
};

const fn rgb(hex: u32) -> [f32; 3] {
    [
        (hex >> 16) as f32 / 255.0,
        (hex >> 8 & 0xff) as f32 / 255.0,
        (hex & 0xff) as f32 / 255.0,
    ]
}

const fn rgba(hex: u32, opacity: f32) -> [f32; 4] {
    let [red, green, blue] = rgb(hex);
    [red, green, blue, opacity]
}
