//! Which of the spots that pass by their ray distance is real: all views together.
//!
//! Four things speak for a spot, each as the logarithm of how much likelier they make it the object's than
//! a ghost's: its ray distance, its agreement with the surface that the neighbouring views make
//! ([`super::neighbours`]), and its brightness and its width beside those of the object's other spots. In each view the
//! spot with the greatest sum is taken; as neighbours speak for each other, this is repeated until nothing
//! changes. A spot with which no neighbours agree is refused at last, if the scan has shown that there are
//! ghosts.

use super::neighbours::{Forecasts, Misfit, Place, around, together, usual_curvature};
use super::{Neighbourhood, ObjectPoint};
use crate::geometry::{Ray, World};
use crate::robust::{median, robust_scale};

/// A spot that passes by its ray distance.
#[derive(Clone, Debug)]
pub(super) struct Fitting {
    pub(super) point: ObjectPoint,
    pub(super) look: Look,
    /// The ray distance in standard deviations.
    pub(super) gap: f64,
}

/// What a spot looks like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Grey values.
    pub(super) brightness: f64,
    /// Standard deviation of its light, px.
    pub(super) width: f64,
}

/// What became of the fitting spots of a view.
#[derive(Clone, Debug, Default)]
pub(super) struct Selection {
    /// The one that is the object's.
    pub(super) chosen: Option<usize>,
    /// What is known of each of them.
    pub(super) evidence: Vec<Evidence>,
}

/// What speaks for a spot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence {
    /// The logarithm of how much likelier it is the object's than a ghost's.
    pub(super) favour: f64,
    /// Its nearest agreement with the neighbours' surface.
    pub(super) misfit: Option<Misfit>,
}

impl Evidence {
    /// Neither ray distance nor brightness alone refuse a spot here; this is the most that either says
    /// against it, as a logarithm.
    const MOST: f64 = -3.0;

    fn new(spot: &Fitting, looks: &Looks, surface: f64, misfit: Option<Misfit>) -> Self {
        /// Ray distances of ghosts are as likely up to the limit, here in standard deviations.
        const GAPS: f64 = 8.0;
        let gap = odds_to_uniform(spot.gap, GAPS).max(Self::MOST);
        Self {
            favour: gap + looks.favour(&spot.look) + surface,
            misfit,
        }
    }

    /// Whether it is rather the object's than a ghost's.
    fn is_supported(&self) -> bool {
        self.favour > SURE
    }

    /// The probability that it is the object's.
    pub(super) fn probability(&self) -> f64 {
        1.0 / (1.0 + libm::exp(-self.favour))
    }

    /// How the neighbours see it, for a refusal.
    pub(super) fn neighbourhood(&self) -> Neighbourhood {
        Neighbourhood {
            off: self.misfit.map(|misfit| misfit.off),
            sigma: self.misfit.map(|misfit| misfit.sigma),
        }
    }
}

const ROOT_TAU: f64 = 2.506_628_274_631_000_2;

fn normal(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) / ROOT_TAU
}

/// How much likelier a value is from a normal distribution than from an even one that is `range` standard
/// deviations wide: as a logarithm.
fn odds_to_uniform(z: f64, range: f64) -> f64 {
    libm::log(range / ROOT_TAU) - 0.5 * z * z
}

/// The same where of the others, too, the share `alike` is normally distributed.
fn odds_to_some_uniform(z: f64, range: f64, alike: f64) -> f64 {
    let own = normal(z).max(f64::MIN_POSITIVE);
    libm::log(own / (alike * own + (1.0 - alike) / range))
}

/// A sum of more than this takes a spot for the object's. A false point is worse than a missing one, so it
/// is more than 0.
const SURE: f64 = 1.85;
/// The same for a view's only spot: a ghost would have to hide the object's, too.
const ONLY: f64 = 1.65;
/// A foretold depth that is more uncertain than this says nothing, mm.
const VAGUEST: f64 = 10.0;

/// A number that the object's spots have in common, as a logarithm.
#[derive(Clone, Copy)]
struct Usual {
    middle: f64,
    spread: f64,
}

impl Usual {
    /// `least` is by how much it varies at least.
    fn of(values: impl Iterator<Item = f64>, least: f64) -> Option<Self> {
        let logs: Vec<f64> = values.map(libm::log).collect();
        if logs.is_empty() {
            return None;
        }
        let middle = median(logs.clone());
        let off: Vec<f64> = logs.iter().map(|log| log - middle).collect();
        Some(Self {
            middle,
            spread: robust_scale(&off).max(least),
        })
    }

    fn hold(&self, value: f64) -> f64 {
        (libm::log(value) - self.middle) / self.spread
    }
}

/// What the object's spots look like.
#[derive(Clone, Copy)]
pub(super) struct Looks {
    brightness: Usual,
    width: Usual,
}

impl Looks {
    pub(super) fn of<'a>(spots: impl Iterator<Item = &'a Look> + Clone) -> Option<Self> {
        /// A surface's own brightness varies by so much, as faces turn and light is grainy,
        const BRIGHTNESS: f64 = 0.35;
        /// and its spots' width, as they are cut obliquely.
        const WIDTH: f64 = 0.12;
        Some(Self {
            brightness: Usual::of(spots.clone().map(|spot| spot.brightness), BRIGHTNESS)?,
            width: Usual::of(spots.map(|spot| spot.width), WIDTH)?,
        })
    }

    /// How much likelier the object's spots look so than ghosts do: as a logarithm.
    pub(super) fn favour(&self, spot: &Look) -> f64 {
        /// The light of ghosts is as likely within this, in the spread of the object's.
        const LIGHTS: f64 = 8.0;
        let brightness = odds_to_uniform(self.brightness.hold(spot.brightness), LIGHTS);
        brightness.max(Evidence::MOST) + self.favour_of_width(spot).max(Evidence::MOST)
    }

    /// What a flat face mirrors is as wide as the object's own spots; a curved one makes it any width.
    fn favour_of_width(&self, spot: &Look) -> f64 {
        const WIDTHS: f64 = 8.0;
        const FLAT: f64 = 0.5;
        odds_to_some_uniform(self.width.hold(spot.width), WIDTHS, FLAT)
    }
}

/// Selects each view's spot; `beams` are those behind the wall, `strays` is how many spots of the scan are
/// no point of wall or object already.
pub(super) fn select(
    fitting: &[&[Fitting]],
    beams: &[Option<Ray<World>>],
    strays: usize,
) -> Vec<Selection> {
    const ROUNDS: usize = 12;
    let Some(looks) = Looks::of(fitting.iter().filter_map(|f| Some(&f.first()?.look))) else {
        return vec![Selection::default(); fitting.len()];
    };
    let mut selections = alone(fitting, &looks);
    let around = around_each(beams, &places(fitting, beams, &selections));
    for _ in 0..ROUNDS {
        let next = round(fitting, beams, &around, &selections);
        let settled = choices(&next) == choices(&selections);
        selections = next;
        if settled {
            break;
        }
    }
    refuse_unsupported(&mut selections, fitting, strays);
    selections
}

fn choices(selections: &[Selection]) -> Vec<(Option<usize>, bool)> {
    let choice = |s: &Selection| (s.chosen, s.is_supported());
    selections.iter().map(choice).collect()
}

impl Selection {
    fn best_of(evidence: Vec<Evidence>) -> Self {
        let mut selection = Self {
            chosen: None,
            evidence,
        };
        selection.chosen = selection.likeliest();
        selection
    }

    /// The spot that is likelier the object's than the others, if not likely.
    pub(super) fn likeliest(&self) -> Option<usize> {
        let favours = self.evidence.iter().map(|e| e.favour).enumerate();
        let best = favours.max_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(index, _)| index)
    }

    fn is_supported(&self) -> bool {
        self.chosen
            .is_some_and(|spot| self.evidence[spot].is_supported())
    }

    /// What speaks for the chosen spot.
    fn favour(&self) -> Option<f64> {
        Some(self.evidence[self.chosen?].favour)
    }
}

/// Each view by itself.
fn alone(fitting: &[&[Fitting]], looks: &Looks) -> Vec<Selection> {
    // For a start everything is as if neighbours spoke for it.
    let evidence = |spot: &Fitting| Evidence::new(spot, looks, 2.0 * SURE, None);
    let view = |spots: &&[Fitting]| Selection::best_of(spots.iter().map(evidence).collect());
    fitting.iter().map(view).collect()
}

/// The views that each view's neighbours are among, whatever is chosen in them.
fn around_each(beams: &[Option<Ray<World>>], places: &[Option<Place>]) -> Vec<Vec<usize>> {
    let views = beams.iter().enumerate();
    let around_view = |(view, beam): (usize, &Option<Ray<World>>)| {
        let beam = beam.as_ref();
        beam.map_or_else(Vec::new, |beam| around(view, beam, places))
    };
    views.map(around_view).collect()
}

/// Where the chosen spots are.
fn places(
    fitting: &[&[Fitting]],
    beams: &[Option<Ray<World>>],
    selections: &[Selection],
) -> Vec<Option<Place>> {
    let views = selections.iter().zip(fitting).zip(beams);
    let chosen = |((selection, spots), beam): ((&Selection, &&[Fitting]), &Option<Ray<World>>)| {
        Some(place(&spots[selection.chosen?], beam.as_ref()?))
    };
    views.map(chosen).collect()
}

/// Each view in the light of what was chosen in the others.
fn round(
    fitting: &[&[Fitting]],
    beams: &[Option<Ray<World>>],
    around: &[Vec<usize>],
    before: &[Selection],
) -> Vec<Selection> {
    let chosen: Vec<Option<&Fitting>> = before
        .iter()
        .zip(fitting)
        .map(|(selection, spots)| Some(&spots[selection.chosen?]))
        .collect();
    let places = places(fitting, beams, before);
    let trusted: Vec<Option<Place>> = places
        .iter()
        .zip(before)
        .map(|(place, selection)| place.filter(|_| selection.is_supported()))
        .collect();
    let forecasts: Vec<Option<Forecasts>> = beams
        .iter()
        .enumerate()
        .map(|(view, beam)| {
            let others = around[view].iter().filter_map(|other| places[*other]);
            Some(Forecasts::of(beam.as_ref()?, others))
        })
        .collect();
    let curvature = usual_curvature(&forecasts, &trusted, VAGUEST);
    let Some(looks) = Looks::of(chosen.iter().flatten().map(|spot| &spot.look)) else {
        return before.to_vec();
    };
    let nobody = nobody(before);
    let view = |view: usize| {
        let evidence = |spot: &Fitting| {
            let hold = |(beam, forecasts): (&Ray<World>, &Forecasts)| {
                forecasts.hold(&place(spot, beam), curvature, VAGUEST)
            };
            let misfits = beams[view]
                .as_ref()
                .zip(forecasts[view].as_ref())
                .map_or_else(Vec::new, hold);
            let surface = match misfits.is_empty() {
                true => nobody,
                false => together(&misfits),
            };
            let best = misfits
                .iter()
                .copied()
                .max_by(|a, b| a.favour().total_cmp(&b.favour()));
            Evidence::new(spot, &looks, surface, best)
        };
        Selection::best_of(fitting[view].iter().map(evidence).collect())
    };
    (0..fitting.len()).map(view).collect()
}

/// How likely it is that nobody foretells a point of the object, as a logarithm: rarely, but in scans of
/// few views.
fn nobody(before: &[Selection]) -> f64 {
    const RARELY: f64 = -2.5;
    let chosen = before.iter().filter_map(|s| Some(s.evidence[s.chosen?]));
    let (mut count, mut unforetold) = (0.0, 0.0);
    for evidence in chosen {
        count += 1.0;
        unforetold += f64::from(u8::from(evidence.misfit.is_none()));
    }
    libm::log((unforetold + 0.5) / (count + 1.0)).max(RARELY)
}

fn place(spot: &Fitting, beam: &Ray<World>) -> Place {
    Place::new(&spot.point.meeting, &spot.point.noise, beam)
}

/// Refuses what no neighbours speak for, where there are ghosts at all: about as many may stand alone in
/// their views as are seen beside others. Where far more spots stand alone, the surface is too rough, or
/// its points too few, to judge by.
fn refuse_unsupported(selections: &mut [Selection], fitting: &[&[Fitting]], strays: usize) {
    let outdone: usize = fitting
        .iter()
        .map(|spots| spots.len().saturating_sub(1))
        .sum();
    let lone = selections
        .iter()
        .filter(|s| s.chosen.is_some() && !s.is_supported())
        .count();
    let ghosts = strays + outdone;
    if ghosts == 0 || lone > 3 * ghosts + fitting.len() / 10 {
        return;
    }
    for (selection, spots) in selections.iter_mut().zip(fitting) {
        let least = if spots.len() == 1 { ONLY } else { SURE };
        if selection.favour().is_some_and(|favour| favour <= least) {
            selection.chosen = None;
        }
    }
}
