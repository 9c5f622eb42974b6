//! Which of the spots that pass by their ray distance is real: all views together.
//!
//! Three things speak for a spot, each as the logarithm of how much likelier they make it the object's than
//! a ghost's: its ray distance, its agreement with the surface that the neighbouring views make
//! ([`super::neighbours`]), and its brightness beside that of the object's other spots. In each view the
//! spot with the greatest sum is taken; as neighbours speak for each other, this is repeated until nothing
//! changes. A spot with which no neighbours agree is refused at last, if the scan has shown that there are
//! ghosts.

use super::neighbours::{Forecasts, Misfit, Place, around, together, usual_curvature};
use super::{Neighbourhood, ObjectPoint};
use crate::geometry::{Point, Ray, World};
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

    /// `before` is what speaks for a spot before one looks at it.
    fn new(
        spot: &Fitting,
        before: f64,
        looks: &Looks,
        surface: f64,
        misfit: Option<Misfit>,
    ) -> Self {
        /// Ray distances of ghosts are as likely up to the limit, here in standard deviations.
        const GAPS: f64 = 8.0;
        /// This part of them lies on the beam's image, as the object's spots do.
        const ALIKE: f64 = 0.5;
        let gap = odds_to_some_uniform(spot.gap, GAPS, ALIKE).max(Self::MOST);
        Self {
            favour: before + gap + looks.favour(&spot.look) + surface,
            misfit,
        }
    }

    /// Whether it is rather the object's than a ghost's.
    pub(super) fn is_supported(&self) -> bool {
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
const SURE: f64 = 2.5;

/// Even a vague forecast tells a ghost that lies centimetres off, mm.
pub(super) const VAGUEST: f64 = 30.0;

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

/// How often what is seen, as the scan itself tells.
#[derive(Clone, Copy, Debug)]
struct Rates {
    /// Ghosts that pass by their ray distance, of each view.
    ghosts: f64,
    /// Views in which the object's spot is missing.
    missing: f64,
}

impl Rates {
    /// Before anything is known.
    const START: Self = Self {
        ghosts: 0.05,
        missing: 0.1,
    };

    /// Counted in what was chosen, each spot with the probability that it is the object's.
    fn of(selections: &[Selection], strays: usize) -> Self {
        let count = selections.len() as f64;
        let spots: usize = selections.iter().map(|view| view.evidence.len()).sum();
        let missing: f64 = selections.iter().map(Selection::missing).sum();
        /// Where so many ghosts do not pass by their ray distance, one will that is not told otherwise.
        const STRAYS: f64 = 0.25;
        // Half a view more: that none was seen does not say that there are none.
        let part = |views: f64| (views + 0.5) / (count + 1.0);
        Self {
            ghosts: part(spots as f64 - (count - missing) + STRAYS * strays as f64),
            missing: part(missing),
        }
    }

    /// How much likelier a view shows the object's spot than a ghost alone, before one looks at it: as a
    /// logarithm. In so many of some views `beside` it the object's spot is missing.
    fn favour(&self, missing: f64, beside: f64) -> f64 {
        /// What makes a ghost hides the object's spot so often.
        const HIDES: f64 = 0.25;
        /// The whole scan counts as so many views beside it.
        const SCAN: f64 = 0.3;
        let missing = (missing + SCAN * self.missing) / (beside + SCAN);
        let hidden = missing + (1.0 - missing) * HIDES;
        libm::log((1.0 - missing) / (self.ghosts * hidden))
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
    let mut rates = Rates::START;
    let places = places(fitting, beams, &selections);
    let scan = Scan {
        fitting,
        beams,
        around: around_each(beams, &places),
        beside: beside_each(beams, &places),
    };
    for _ in 0..ROUNDS {
        let next = scan.round(&selections, &rates);
        let settled = choices(&next) == choices(&selections);
        selections = next;
        rates = Rates::of(&selections, strays);
        if settled {
            break;
        }
    }
    refuse_unsupported(&mut selections, strays);
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

    /// The probability that the object's spot is missing.
    fn missing(&self) -> f64 {
        let chosen = self.chosen.map(|spot| self.evidence[spot]);
        chosen.map_or(1.0, |evidence| 1.0 - evidence.probability())
    }
}

/// Each view by itself.
fn alone(fitting: &[&[Fitting]], looks: &Looks) -> Vec<Selection> {
    // For a start everything is as if neighbours spoke for it.
    let evidence = |spot: &Fitting| Evidence::new(spot, 2.0 * SURE, looks, 0.0, None);
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

/// The views that lie beside each.
fn beside_each(beams: &[Option<Ray<World>>], places: &[Option<Place>]) -> Vec<Vec<usize>> {
    let depth = |(beam, place): (&Option<Ray<World>>, &Option<Place>)| {
        let (beam, place) = (beam.as_ref()?, place.as_ref()?);
        Some((place.point - beam.origin).dot(&beam.direction.vector()))
    };
    let depths: Vec<f64> = beams.iter().zip(places).filter_map(depth).collect();
    if depths.is_empty() {
        return vec![Vec::new(); beams.len()];
    }
    let depth = median(depths);
    let ends: Vec<Option<Point<World>>> = beams
        .iter()
        .map(|beam| Some(beam.as_ref()?.at(depth)))
        .collect();
    let beside = |end: &Option<Point<World>>| end.map_or_else(Vec::new, |end| nearest(&ends, end));
    ends.iter().map(beside).collect()
}

/// The few points that lie nearest to one of them, without itself.
fn nearest(points: &[Option<Point<World>>], to: Point<World>) -> Vec<usize> {
    const MOST: usize = 6;
    let mut nearest: Vec<(f64, usize)> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let Some(distance) = point.map(|point| point.distance(to)) else {
            continue;
        };
        let place = nearest.partition_point(|(other, _)| *other <= distance);
        if place <= MOST {
            nearest.insert(place, (distance, index));
            nearest.truncate(MOST + 1);
        }
    }
    // The first is the point itself.
    nearest
        .into_iter()
        .skip(1)
        .map(|(_, index)| index)
        .collect()
}

/// What there is to choose from.
struct Scan<'a> {
    fitting: &'a [&'a [Fitting]],
    beams: &'a [Option<Ray<World>>],
    /// The views that each view's neighbours are among,
    around: Vec<Vec<usize>>,
    /// and those the beams of which pass beside its own.
    beside: Vec<Vec<usize>>,
}

impl Scan<'_> {
    /// Each view in the light of what was chosen in the others.
    fn round(&self, before: &[Selection], rates: &Rates) -> Vec<Selection> {
        let chosen = before.iter().zip(self.fitting);
        let chosen = chosen.filter_map(|(selection, spots)| Some(&spots[selection.chosen?].look));
        let Some(looks) = Looks::of(chosen) else {
            return before.to_vec();
        };
        let places = places(self.fitting, self.beams, before);
        let missing: Vec<f64> = before.iter().map(Selection::missing).collect();
        let places: Vec<Option<Place>> = places
            .into_iter()
            .zip(&missing)
            .map(|(place, missing)| Some(place?.trusted(1.0 - missing)))
            .collect();
        let forecasts = self.forecasts(&places);
        let trusted: Vec<Option<Place>> = places
            .iter()
            .zip(before)
            .map(|(place, selection)| place.filter(|_| selection.is_supported()))
            .collect();
        let light = Light {
            looks,
            curvature: usual_curvature(&forecasts, &trusted, VAGUEST),
        };
        let view = |(view, forecasts): (usize, &Option<Forecasts>)| {
            let beside = self.beside[view].iter().map(|other| missing[*other]);
            let prior = rates.favour(beside.sum(), self.beside[view].len() as f64);
            let spots = self.fitting[view].iter();
            let evidence = spots.map(|spot| {
                let place = self.beams[view].as_ref().map(|beam| place(spot, beam));
                light.evidence(spot, prior, place.zip(forecasts.as_ref()))
            });
            Selection::best_of(evidence.collect())
        };
        forecasts.iter().enumerate().map(view).collect()
    }

    fn forecasts(&self, places: &[Option<Place>]) -> Vec<Option<Forecasts>> {
        let views = self.beams.iter().zip(&self.around);
        let of_view = |(beam, around): (&Option<Ray<World>>, &Vec<usize>)| {
            let others = around.iter().filter_map(|other| places[*other]);
            Some(Forecasts::of(beam.as_ref()?, others))
        };
        views.map(of_view).collect()
    }
}

/// The light in which a spot is seen.
struct Light {
    looks: Looks,
    curvature: f64,
}

impl Light {
    fn evidence(&self, spot: &Fitting, prior: f64, seen: Option<(Place, &Forecasts)>) -> Evidence {
        let misfits = seen.map_or_else(Vec::new, |(place, forecasts)| {
            forecasts.hold(&place, self.curvature, VAGUEST)
        });
        let surface = together(&misfits);
        let best = misfits
            .into_iter()
            .max_by(|a, b| a.favour().total_cmp(&b.favour()));
        Evidence::new(spot, prior, &self.looks, surface, best)
    }
}

fn place(spot: &Fitting, beam: &Ray<World>) -> Place {
    Place::new(&spot.point.meeting, &spot.point.noise, beam)
}

/// Refuses what is rather a ghost than the object's, where there are ghosts at all.
fn refuse_unsupported(selections: &mut [Selection], strays: usize) {
    let spots = selections.iter().map(|view| view.evidence.len());
    let outdone: usize = spots.map(|spots| spots.saturating_sub(1)).sum();
    if strays + outdone == 0 {
        return;
    }
    for selection in selections {
        if !selection.is_supported() {
            selection.chosen = None;
        }
    }
}
