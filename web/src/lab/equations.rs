//! Eqs. (1) and (2) of the paper with the numbers of this moment, as MathML.

use leptos::prelude::*;
use snellius::lab::{Bench, Bend, Light, LightPath};

use super::state::LabState;

/// Both equations, for the beam and for the line of sight.
#[component]
pub(super) fn Equations() -> impl IntoView {
    let lab = LabState::get();
    let shown = move || {
        lab.bench
            .with(|bench| lab.light.with(|light| equations(bench, light)))
    };
    view! {
        <div class="equations" data-testid="equations" inner_html=shown></div>
        <p class="help">
            "d: the light's direction before and behind a face, N: the face's normal there, \u{d7}: the vector \
             product; |d \u{d7} N| is the sine of the angle between them. Index l: laser, c: camera; 1: around the rig, \
             2: in the wall, 3: inside. Section II-D of the paper."
        </p>
    }
}

fn equations(bench: &Bench, light: &Light) -> String {
    let known = |index: f64| Some(index);
    let inside = (!bench.hides_index()).then(|| bench.liquid.index());
    let indices = [
        known(bench.outside.index()),
        known(bench.glass.index()),
        inside,
    ];
    let mut text = String::new();
    for face in 0..2 {
        text.push_str("<div class=\"equation\"><span class=\"equation-number\">(");
        text.push_str(["1", "2"][face]);
        text.push_str(")</span>");
        for (letter, path) in [("l", &light.beam), ("c", &light.sight)] {
            text.push_str(&equation(letter, face, path, indices));
        }
        text.push_str("</div>");
    }
    text
}

/// |d1 x N| / |d2 x N| = n2 / n1, once in letters and once in numbers.
fn equation(letter: &str, face: usize, path: &LightPath, indices: [Option<f64>; 3]) -> String {
    let product = |number: usize| {
        format!(
            "<mrow><mo>|</mo><msub><mover><mi>d</mi><mo>\u{2192}</mo></mover><mi>{letter}{number}</mi></msub>\
             <mo>\u{d7}</mo><msub><mover><mi>N</mi><mo>\u{2192}</mo></mover><mi>{}{}</mi></msub><mo>|</mo></mrow>",
            letter.to_uppercase(),
            face + 1
        )
    };
    let index = |number: usize| format!("<msub><mi>n</mi><mn>{number}</mn></msub>");
    let letters = format!(
        "{}<mo>=</mo>{}",
        fraction(&product(face + 1), &product(face + 2)),
        fraction(&index(face + 2), &index(face + 1))
    );
    let numbers = match path.bends.get(face) {
        None => "<mtext>no light here</mtext>".to_owned(),
        Some(bend) if bend.thrown_back.is_some() => format!(
            "<mtext>thrown back: </mtext>{}<mo>\u{22c5}</mo>{}<mo>=</mo>{}<mo>&gt;</mo><mn>1</mn>",
            number(bend.sine_before(), 4),
            fraction(&number(bend.index_before, 4), &number(bend.index_behind, 4)),
            number(
                bend.sine_before() * bend.index_before / bend.index_behind,
                4
            )
        ),
        Some(bend) => sines(bend, indices[face], indices[face + 1]),
    };
    format!(
        "<span class=\"both\"><math><mstyle displaystyle=\"true\">{letters}</mstyle></math> \
         <math><mstyle displaystyle=\"true\">{numbers}</mstyle></math></span>"
    )
}

fn sines(bend: &Bend, before: Option<f64>, behind: Option<f64>) -> String {
    let (a, b) = (bend.sine_before(), bend.sine_after());
    // Squarely in, both sines are nothing, and their ratio says nothing.
    let ratio = if b < 1e-6 {
        "<mi>\u{2013}</mi>".to_owned()
    } else {
        number(a / b, 4)
    };
    let index = |n: Option<f64>| n.map_or("<mi>?</mi>".to_owned(), |n| number(n, 4));
    let right = match (before, behind) {
        (Some(before), Some(behind)) => format!("<mo>=</mo>{}", number(behind / before, 4)),
        _ => String::new(),
    };
    format!(
        "{}<mo>=</mo>{ratio}<mo>,</mo><mspace width=\"0.8em\"/>{}{right}",
        fraction(&number(a, 4), &number(b, 4)),
        fraction(&index(behind), &index(before)),
    )
}

fn fraction(above: &str, below: &str) -> String {
    format!("<mfrac><mrow>{above}</mrow><mrow>{below}</mrow></mfrac>")
}

fn number(value: f64, decimals: usize) -> String {
    format!("<mn>{value:.decimals$}</mn>")
}
