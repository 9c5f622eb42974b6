//! A section: only a slab of the scene is shown.

use leptos::prelude::*;
use three_d::{InnerSpace, Vec3, vec3};

use crate::state::{Section, SectionAxis, Workbench};

/// The slab: what lies from the first to the second millimetre along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slab {
    pub(super) normal: Vec3,
    pub(super) range: [f32; 2],
}

impl Slab {
    /// Everything.
    pub(super) const ALL: Self = Self {
        normal: vec3(0.0, 0.0, 0.0),
        range: [-1.0, 1.0],
    };

    /// A slab across a direction, as a part of the way from the first to the last of some places.
    pub(super) fn of(section: Section, normal: Vec3, places: &[Vec3]) -> Self {
        let ways = places.iter().map(|place| place.dot(normal));
        let (low, high) = ways.fold((f32::MAX, f32::MIN), |(low, high), way| {
            (low.min(way), high.max(way))
        });
        let at = |part: f32| low + (high - low) * part;
        let half = 0.5 * section.thickness;
        Self {
            normal,
            range: [at(section.middle - half), at(section.middle + half)],
        }
    }

    /// Whether a place is shown.
    pub(super) fn holds(&self, place: Vec3) -> bool {
        let way = place.dot(self.normal);
        (self.range[0]..=self.range[1]).contains(&way)
    }
}

const AXES: [(Option<SectionAxis>, &str, &str); 4] = [
    (None, "off", "Off"),
    (Some(SectionAxis::Depth), "depth", "Across depth"),
    (Some(SectionAxis::Height), "height", "Across height"),
    (Some(SectionAxis::Width), "width", "Across width"),
];

/// What of a section is slid.
struct Slider {
    name: &'static str,
    test_id: &'static str,
    least: &'static str,
    get: fn(&Section) -> f32,
    set: fn(&mut Section, f32),
}

const SLIDERS: [Slider; 2] = [
    Slider {
        name: "at",
        test_id: "section-middle",
        least: "0",
        get: |section| section.middle,
        set: |section, value| section.middle = value,
    },
    Slider {
        name: "thick",
        test_id: "section-thickness",
        least: "0.02",
        get: |section| section.thickness,
        set: |section, value| section.thickness = value,
    },
];

/// Which slab is shown.
#[component]
pub(super) fn SectionControl() -> impl IntoView {
    let workbench = Workbench::get();
    let section = workbench.section;
    let axis = Memo::new(move |_| section.with(|section| section.axis));
    let choose = move |event| {
        let word = event_target_value(&event);
        let chosen = AXES.iter().find(|(_, known, _)| *known == word);
        section.update(|section| section.axis = chosen.and_then(|(axis, ..)| *axis));
    };
    let option = move |(of, word, name): (Option<SectionAxis>, &'static str, &'static str)| {
        view! {
            <option value=word selected=move || axis.get() == of>
                {name}
            </option>
        }
    };
    let slider = move |slider: Slider| {
        let Slider {
            name,
            test_id,
            least,
            get,
            set,
        } = slider;
        let slide = move |event| {
            if let Ok(value) = event_target_value(&event).parse() {
                section.update(|section| set(section, value));
            }
        };
        view! {
            <label class="field">
                <span>{name}</span>
                <input
                    type="range"
                    min=least
                    max="1"
                    step="0.01"
                    data-testid=test_id
                    prop:value=move || section.with(get).to_string()
                    on:input=slide
                />
            </label>
        }
    };
    view! {
        <label class="field">
            <span>"Section"</span>
            <select data-testid="section" on:change=choose>
                {AXES.map(option).collect_view()}
            </select>
        </label>
        <Show when=move || axis.get().is_some()>
            {SLIDERS.map(slider).collect_view()}
        </Show>
    }
}
