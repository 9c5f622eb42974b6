//! The object's points of a sheet of light.
//!
//! A line of sight meets the refracted sheet where one of its rays crosses it, so there is a point for
//! every point of the line, and no ray distance that would tell a false one. What tells it is the place
//! (behind the wall), the surface that the other views make ([`super::arcs`]) and the company: on each ray of
//! the sheet only one point is the object's, and that is taken from the curve with the most light.

use nalgebra::{DVector, Matrix3, Vector3};

use super::arcs::{self, Arc, Sample};
use super::choice::{Choice, ObjectPoint, ObjectSettings, Refusal};
use super::fan::Fan;
use super::neighbours::Place;
use super::select::{Evidence, Look};
use super::uncertainty::{Noise, PIXEL_STEP, Slope, WALL_STEP};
use super::{Meeting, MeetingError, Setup, line_of_sight};
use crate::camera::Pixel;
use crate::geometry::{Ray, World, closest_approach};
use crate::optics::Stack;
use crate::rig::{Profiles, Sheet};
use crate::robust::{median, sort_by_number};
use crate::scan::{InsideMedium, Station};
use crate::spots::{Line, Spot, SpotRole, Spots};
use crate::vessel::NoRoom;

/// Finds each view's object points among the line's points that are not the wall's.
pub(super) fn find_on_line<'a>(
    setup: &'a Setup,
    sheet: &'a Sheet,
    spots: &'a [Spots],
    settings: &ObjectSettings,
) -> Vec<Choice> {
    let liquid = Walls::new(setup, InsideMedium::Liquid);
    let air = Walls::new(setup, InsideMedium::Air);
    let seen = |(view, spots): (usize, &'a Spots)| {
        let station = &setup.stations[view];
        let walls = match station.inside {
            InsideMedium::Liquid => &liquid,
            InsideMedium::Air => &air,
        };
        let light = Light {
            setup,
            station,
            sheet,
            walls: walls.as_ref().ok()?,
        };
        let on_wall = setup.vessel.points[view].iter().map(|p| p.spot);
        View::new(light, spots, on_wall, settings)
    };
    let views: Vec<Option<View>> = spots.iter().enumerate().map(seen).collect();
    let arcs: Vec<Vec<Arc>> = views.iter().map(|view| arcs_of(view.as_ref())).collect();
    let evidence = arcs::judge(&arcs);
    let views = views.into_iter().zip(&arcs).zip(&evidence);
    views
        .map(|((view, arcs), evidence)| {
            view.map_or_else(Choice::default, |view| view.choose(arcs, evidence))
        })
        .collect()
}

fn arcs_of(view: Option<&View>) -> Vec<Arc> {
    view.map_or_else(Vec::new, View::arcs)
}

/// The wall, and the wall with each of its parameters a little more and a little less.
struct Walls {
    stack: Stack,
    nudged: Vec<[Stack; 2]>,
}

impl Walls {
    fn new(setup: &Setup, inside: InsideMedium) -> Result<Self, NoRoom> {
        let wall = &setup.vessel.wall;
        let freedom = wall.outer.freedom();
        let moved = |parameter: usize, step: f64| {
            let mut steps = DVector::zeros(freedom);
            steps[parameter] = step;
            wall.nudged(&steps).stack(&setup.media, inside)
        };
        let both = |parameter| Ok([moved(parameter, WALL_STEP)?, moved(parameter, -WALL_STEP)?]);
        Ok(Self {
            stack: wall.stack(&setup.media, inside)?,
            nudged: (0..freedom).map(both).collect::<Result<_, NoRoom>>()?,
        })
    }
}

/// A point of the line that may be the object's.
struct Candidate {
    spot: usize,
    curve: usize,
    /// A person says that it is.
    said: bool,
    /// The ray that meets the line of sight.
    angle: f64,
    meeting: Meeting,
}

/// A view, and what of its line may be the object's.
struct View<'a> {
    light: Light<'a>,
    line: &'a Line,
    spots: &'a [Spot],
    candidates: Vec<Candidate>,
    refused: Vec<(usize, Refusal)>,
}

impl<'a> View<'a> {
    fn new(
        light: Light<'a>,
        of_view: &'a Spots,
        on_wall: impl Iterator<Item = usize>,
        settings: &ObjectSettings,
    ) -> Option<Self> {
        let line = of_view.line.as_ref()?;
        let spots = of_view.spots.as_slice();
        let may_be = |spot: usize| of_view.may_be(spot, SpotRole::Object);
        let mut taken: Vec<bool> = (0..spots.len()).map(|spot| !may_be(spot)).collect();
        on_wall.for_each(|spot| taken[spot] = true);
        let mut refused = Vec::new();
        let mut candidates = Vec::new();
        for (index, curve) in line.curves.iter().enumerate() {
            for spot in curve.range().filter(|spot| !taken[*spot]) {
                match light.examine(spots[spot].pixel(), settings) {
                    Ok((angle, meeting)) => candidates.push(Candidate {
                        spot,
                        curve: index,
                        said: of_view.said_of(spot).is_some(),
                        angle,
                        meeting,
                    }),
                    Err(refusal) => refused.push((spot, refusal)),
                }
            }
        }
        Some(Self {
            light,
            line,
            spots,
            candidates,
            refused,
        })
    }

    /// The candidates' curves.
    fn arcs(&self) -> Vec<Arc> {
        let curves = self.candidates.chunk_by(|a, b| a.curve == b.curve);
        curves.map(|candidates| self.arc(candidates)).collect()
    }

    fn arc(&self, candidates: &[Candidate]) -> Arc {
        /// Light of a single pixel has no width.
        const LEAST_WIDTH: f64 = 0.1;
        let of = |number: &dyn Fn(&Spot) -> f64| {
            median(
                candidates
                    .iter()
                    .map(|c| number(&self.spots[c.spot]))
                    .collect(),
            )
        };
        let across = |spot: &Spot| match self.line.profiles {
            Profiles::Rows => spot.shape[0],
            Profiles::Columns => spot.shape[2],
        };
        let mut wall_part = WallPart::default();
        let every = candidates.len().div_ceil(arcs::SAMPLES);
        let sampled = candidates.iter().skip(every / 2).step_by(every);
        Arc {
            curve: candidates[0].curve,
            look: Look {
                brightness: of(&|spot| spot.brightness),
                width: of(&|spot| across(spot).max(LEAST_WIDTH * LEAST_WIDTH).sqrt()),
            },
            samples: sampled
                .filter_map(|candidate| self.sample(candidate, &mut wall_part))
                .collect(),
        }
    }

    fn sample(&self, candidate: &Candidate, wall_part: &mut WallPart) -> Option<Sample> {
        let light = &self.light;
        let beam = light.ray(&light.walls.stack, candidate.angle).ok()?;
        let noise = light.noise(candidate, &self.spots[candidate.spot], self.line, wall_part);
        Some(Sample {
            beam,
            place: Place::new(&candidate.meeting, &noise.ok()?, &beam),
        })
    }

    /// Chooses, given what speaks for each of the arcs.
    fn choose(mut self, arcs: &[Arc], evidence: &[Evidence]) -> Choice {
        let mut of_curve = vec![None; self.line.curves.len()];
        for (arc, evidence) in arcs.iter().zip(evidence) {
            of_curve[arc.curve] = Some(*evidence);
        }
        let alone = |candidate: &Candidate| {
            let evidence: Evidence = of_curve[candidate.curve]?;
            let refused = !candidate.said && arcs::is_ghost(&evidence);
            refused.then(|| Refusal::Alone(evidence.neighbourhood()))
        };
        let refused = &mut self.refused;
        self.candidates.retain(|candidate| {
            let alone = alone(candidate);
            let is_supported = alone.is_none();
            refused.extend(alone.map(|refusal| (candidate.spot, refusal)));
            is_supported
        });
        let outdone = outdone(&self.candidates, self.line, self.spots);
        let mut points = Vec::new();
        let mut wall_part = WallPart::default();
        for (candidate, outdone) in self.candidates.iter().zip(outdone) {
            let spot = &self.spots[candidate.spot];
            if outdone {
                self.refused.push((candidate.spot, Refusal::Outdone(None)));
                continue;
            }
            match self.light.noise(candidate, spot, self.line, &mut wall_part) {
                Ok(noise) => points.push(ObjectPoint {
                    spot: candidate.spot,
                    meeting: candidate.meeting,
                    noise,
                }),
                Err(error) => self
                    .refused
                    .push((candidate.spot, Refusal::NoMeeting(error))),
            }
        }
        sort_by_number(&mut self.refused, |(spot, _)| *spot as f64);
        Choice {
            points,
            refused: self.refused,
        }
    }
}

/// Which candidates share their ray with one that a person says to be the object's, or with one of a curve
/// that has more light.
fn outdone(candidates: &[Candidate], line: &Line, spots: &[Spot]) -> Vec<bool> {
    let mut light = vec![0.0; line.curves.len()];
    for candidate in candidates {
        light[candidate.curve] += spots[candidate.spot].brightness;
    }
    let mut by_angle: Vec<usize> = (0..candidates.len()).collect();
    sort_by_number(&mut by_angle, |index| candidates[*index].angle);
    let pitch = pitch(candidates);
    let mut outdone = vec![false; candidates.len()];
    for (place, &index) in by_angle.iter().enumerate() {
        let here = &candidates[index];
        for &other in &by_angle[place + 1..] {
            let there = &candidates[other];
            if there.angle - here.angle > 0.5 * pitch {
                break;
            }
            if there.curve != here.curve {
                let weight = |c: &Candidate| (c.said, light[c.curve]);
                let fainter = weight(there) < weight(here);
                outdone[if fainter { other } else { index }] = true;
            }
        }
    }
    outdone
}

/// The angle between the rays of neighbouring points.
fn pitch(candidates: &[Candidate]) -> f64 {
    let pairs = candidates.windows(2);
    let steps =
        pairs.filter(|pair| pair[0].curve == pair[1].curve && pair[0].spot + 1 == pair[1].spot);
    let steps: Vec<f64> = steps
        .map(|pair| (pair[1].angle - pair[0].angle).abs())
        .collect();
    if steps.is_empty() { 0.0 } else { median(steps) }
}

/// What the wall's covariance does to a point, which hardly changes from one point to the next.
#[derive(Default)]
struct WallPart {
    computed: Option<(usize, usize, Matrix3<f64>)>,
}

/// The light of a view.
struct Light<'a> {
    setup: &'a Setup<'a>,
    station: &'a Station,
    sheet: &'a Sheet,
    walls: &'a Walls,
}

impl Light<'_> {
    fn examine(&self, pixel: Pixel, settings: &ObjectSettings) -> Result<(f64, Meeting), Refusal> {
        let (angle, meeting) = self.meet(pixel).map_err(Refusal::NoMeeting)?;
        let depth = meeting.depth();
        if depth.is_nan() || depth < settings.nearest {
            return Err(Refusal::BeforeInnerFace { depth });
        }
        Ok((angle, meeting))
    }

    /// The angle of the ray that meets a pixel's line of sight, and where.
    fn meet(&self, pixel: Pixel) -> Result<(f64, Meeting), MeetingError> {
        let rig = self.setup.rig;
        let fan = Fan {
            sheet: self.sheet,
            world_from_camera: &self.station.world_from_camera,
            stack: &self.walls.stack,
        };
        let sight = self.sight(&self.walls.stack, pixel)?;
        let in_air = rig.triangulate(rig.camera.slope(pixel)?);
        let in_air = in_air.ok_or(MeetingError::NoRayOfSheet)?;
        let angle = fan.angle_to(&sight, self.sheet.angle_of(in_air.point))?;
        Ok((
            angle,
            crossing(&self.ray(&self.walls.stack, angle)?, &sight)?,
        ))
    }

    /// A line of sight behind the wall.
    fn sight(&self, stack: &Stack, pixel: Pixel) -> Result<Ray<World>, MeetingError> {
        let sight = line_of_sight(self.setup.rig, &self.station.world_from_camera, pixel)?;
        stack.trace(&sight).map_err(MeetingError::Sight)
    }

    /// A ray of the sheet behind the wall.
    fn ray(&self, stack: &Stack, angle: f64) -> Result<Ray<World>, MeetingError> {
        let ray = self.sheet.ray_at(angle);
        let ray = self.station.world_from_camera.ray(&ray);
        stack.trace(&ray).map_err(MeetingError::Beam)
    }

    /// First-order propagation, as in [`super::noise`], with the ray of the sheet following: a change that
    /// opens a gap of g turns the ray by -g / (dg/dangle), so that the two meet again.
    fn noise(
        &self,
        candidate: &Candidate,
        spot: &Spot,
        line: &Line,
        wall_part: &mut WallPart,
    ) -> Result<Noise, MeetingError> {
        const ANGLE_STEP: f64 = 1e-5;
        let stack = &self.walls.stack;
        let (angle, pixel) = (candidate.angle, spot.pixel());
        let (ray, sight) = (self.ray(stack, angle)?, self.sight(stack, pixel)?);
        let turned = |step: f64| crossing(&self.ray(stack, angle + step)?, &sight);
        let by_angle = Slope::between(&turned(ANGLE_STEP)?, &turned(-ANGLE_STEP)?, ANGLE_STEP);
        let seen =
            |step: f64| crossing(&ray, &self.sight(stack, line.profiles.moved(pixel, step))?);
        let by_place = Slope::between(&seen(PIXEL_STEP)?, &seen(-PIXEL_STEP)?, PIXEL_STEP);
        let by_place = by_place.following(&by_angle);
        let variance = spot.variance_along(line.profiles, self.setup.vessel.grain.value);
        let wall = match wall_part.near(candidate) {
            Some(known) => known,
            None => {
                let computed = self.wall_part(angle, pixel, &by_angle)?;
                wall_part.computed = Some((candidate.curve, candidate.spot, computed));
                computed
            }
        };
        Ok(Noise {
            covariance: by_place * by_place.transpose() * variance + wall,
            gap: 0.0,
            gap_camera: 0.0,
            gap_grain: 0.0,
        })
    }

    fn wall_part(
        &self,
        angle: f64,
        pixel: Pixel,
        by_angle: &Slope,
    ) -> Result<Matrix3<f64>, MeetingError> {
        let through =
            |stack: &Stack| crossing(&self.ray(stack, angle)?, &self.sight(stack, pixel)?);
        let slope = |[ahead, back]: &[Stack; 2]| {
            let slope = Slope::between(&through(ahead)?, &through(back)?, WALL_STEP);
            Ok(slope.following(by_angle))
        };
        let slopes = self.walls.nudged.iter().map(slope);
        let slopes: Vec<Vector3<f64>> = slopes.collect::<Result<_, MeetingError>>()?;
        let mut sum = Matrix3::zeros();
        for (i, a) in slopes.iter().enumerate() {
            for (j, b) in slopes.iter().enumerate() {
                sum += a * b.transpose() * self.setup.vessel.wall.covariance[(i, j)];
            }
        }
        Ok(sum)
    }
}

impl WallPart {
    fn near(&self, candidate: &Candidate) -> Option<Matrix3<f64>> {
        /// So many points share it.
        const SHARED: usize = 8;
        let (curve, spot, part) = self.computed?;
        (curve == candidate.curve && candidate.spot - spot < SHARED).then_some(part)
    }
}

fn crossing(ray: &Ray<World>, sight: &Ray<World>) -> Result<Meeting, MeetingError> {
    Ok(Meeting {
        approach: closest_approach(ray, sight)?,
    })
}
