//! The wall by the line that a sheet of light draws on it.
//!
//! A line has thousands of points, and a surface of few numbers needs no such crowd: the fit takes blocks of
//! neighbouring points, each a parabola through them, taken in its middle. What the points share (the inner
//! face's glow, calibration) is carried beside, so the blocks' noise may be taken as independent.

use std::ops::Range;

use nalgebra::{Matrix3, Vector2, Vector3};

use super::find::{Finder, Pick, VesselError, VesselFit, VesselPoint};
use super::glow::{self, Faces, LineGlow};
use super::pick::Candidate;
use super::refine::SurfaceFit;
use super::shape;
use crate::camera::Pixel;
use crate::geometry::{Direction, Point, WeightedPoint, World};
use crate::optics::Surface;
use crate::rig::{Profiles, Sheet};
use crate::robust::{median, sort_by_number};
use crate::spots::{Grain, Line, Spot, SpotRole};

/// A block has so many points at least.
const LEAST: usize = 5;
/// And at most, where there are few points and where there are many: a parabola follows the wall no farther.
const MOST: (usize, usize) = (8, 32);
/// More blocks than this tell a surface nothing new.
const MOST_BLOCKS: usize = 1500;

/// A view's line, its points triangulated in air.
struct ViewLine<'a> {
    view: usize,
    line: &'a Line,
    spots: &'a [Spot],
    /// Which points a person says to be the wall's.
    said: Vec<bool>,
    /// Points that are said to be something else are not taken for the wall's.
    lit: Vec<Option<Lit>>,
}

/// A point of the line, taken for one of the sheet in air.
#[derive(Clone, Copy)]
struct Lit {
    /// The angle of its ray within the sheet, radians.
    angle: f64,
    /// How far along that ray, mm.
    along: f64,
    point: Point<World>,
}

/// Neighbouring points of a curve as one.
#[derive(Clone)]
struct Block {
    view: usize,
    /// Its points among the view's spots.
    spots: Range<usize>,
    /// How far the line moves along a profile from one profile to the next, px.
    slope: f64,
    pick: Pick,
    /// How the point moves with the place in the profile, mm/px, camera frame.
    by_pixel: Vector3<f64>,
}

impl Finder<'_> {
    /// As [`super::find_vessel`], of a sheet: on each of its rays the first point is taken.
    pub(super) fn find_on_line(&self, sheet: &Sheet) -> Result<VesselFit, VesselError> {
        let lines = self.lines(sheet);
        let firsts: Vec<Vec<bool>> = lines.iter().map(|line| line.first_of(|_| true)).collect();
        let blocks = self.blocks(&lines, &firsts, 0.0);
        if blocks.is_empty() {
            return Err(VesselError::NoLine);
        }
        let (start, choice) = self.first_fit(&blocks)?;
        let on_wall: Vec<Vec<bool>> = lines
            .iter()
            .map(|line| line.first_of(|point| self.is_near(&start, point)))
            .collect();
        let grain = grain(&lines, &on_wall);
        let merged = self.blocks(&lines, &on_wall, grain);
        let picks = |blocks: &[Block]| blocks.iter().map(|b| b.pick).collect::<Vec<_>>();
        let first = self.refit(&picks(&merged), &start.surface)?;
        let faces = self.faces(&picks(&merged), &self.wall(first.surface.clone())?);
        let glow = self.line_glow(&lines, &merged, &faces);
        let of_share = |share: f64| -> Vec<Block> {
            let shift = |(block, faces): (&Block, &Option<Faces>)| {
                self.shifted(block, lines[block.view].line, faces, &glow, share)
            };
            merged.iter().zip(&faces).map(shift).collect()
        };
        let share = glow.glows.map_or(0.0, |glows| glows.share);
        let blocks = of_share(share);
        let mut fit = self.refit(&picks(&blocks), &first.surface)?;
        if let (Some(glows), None) = (&glow.glows, &self.known) {
            self.add_uncertainty(&mut fit, &picks(&of_share(share + glows.share_sigma)));
        }
        let points = self.line_points(&lines, (&merged, &blocks), &fit, (share, grain));
        let grain = Grain::alone(grain);
        let mut found = self.assemble(&picks(&blocks), &faces, fit, (grain, glow.glows, choice))?;
        found.replace_points(points);
        Ok(found)
    }

    fn lines(&self, sheet: &Sheet) -> Vec<ViewLine<'_>> {
        let views = self.spots.iter().enumerate();
        let with_line = views.filter_map(|(view, spots)| Some((view, spots, spots.line.as_ref()?)));
        with_line
            .map(|(view, spots, line)| ViewLine {
                view,
                line,
                spots: &spots.spots,
                said: (0..spots.spots.len())
                    .map(|index| spots.said_of(index) == Some(SpotRole::Vessel))
                    .collect(),
                lit: spots
                    .spots
                    .iter()
                    .enumerate()
                    .map(|(index, spot)| {
                        let may_be = spots.may_be(index, SpotRole::Vessel);
                        self.lit(sheet, view, spot).filter(|_| may_be)
                    })
                    .collect(),
            })
            .collect()
    }

    fn lit(&self, sheet: &Sheet, view: usize, spot: &Spot) -> Option<Lit> {
        let lit = super::pick::lit_point(self.rig, spot.pixel())?;
        Some(Lit {
            angle: sheet.angle_of(lit.point),
            along: lit.along,
            point: self.stations[view].world_from_camera.point(lit.point),
        })
    }

    fn first_fit(
        &self,
        blocks: &[Block],
    ) -> Result<(SurfaceFit, Option<shape::ShapeChoice>), VesselError> {
        let points: Vec<_> = blocks.iter().map(|b| self.weighted(b)).collect();
        match &self.known {
            Some(known) => Ok((self.hold_against(known.clone(), &points)?, None)),
            None => shape::fit(&points, self.front, self.shape),
        }
    }

    fn weighted(&self, block: &Block) -> WeightedPoint<World> {
        let pose = &self.stations[block.view].world_from_camera;
        WeightedPoint {
            point: pose.point(block.pick.candidate.point),
            sigma: block.pick.candidate.sigma,
        }
    }

    /// Whether a point lies on a surface, as far as the surface's own blocks do.
    fn is_near(&self, fit: &SurfaceFit, point: Point<World>) -> bool {
        /// A point has more noise than a block of them, mm.
        const SLACK: f64 = 0.3;
        let limit = self.settings.outlier * fit.scale + SLACK;
        fit.surface.signed_distance(point).abs() <= limit
    }

    /// Blocks of the marked points, thinned to what a fit can use.
    fn blocks(&self, lines: &[ViewLine], marked: &[Vec<bool>], grain: f64) -> Vec<Block> {
        let count = marked.iter().flatten().filter(|marked| **marked).count();
        let most = (count / MOST_BLOCKS).clamp(MOST.0, MOST.1);
        let ranges = |(line, marked): (&ViewLine, &Vec<bool>)| {
            let view = line.view;
            let ranges = line.runs(marked).into_iter().flat_map(|run| cut(run, most));
            ranges.map(move |range| (view, range)).collect::<Vec<_>>()
        };
        let all: Vec<_> = lines.iter().zip(marked).flat_map(ranges).collect();
        let stride = all.len().div_ceil(MOST_BLOCKS).max(1);
        let by_view = |view: usize| lines.iter().find(|line| line.view == view);
        all.into_iter()
            .step_by(stride)
            .filter_map(|(view, range)| self.block(by_view(view)?, range, grain))
            .collect()
    }

    fn block(&self, line: &ViewLine, spots: Range<usize>, grain: f64) -> Option<Block> {
        let profiles = line.line.profiles;
        let middle = profiles
            .place(line.spots[spots.start + spots.len() / 2].pixel())
            .0;
        let (at, slope, variance) = parabola(&line.spots[spots.clone()], profiles, middle, grain)?;
        let pixel = profiles.pixel(middle, at);
        let by_pixel = self.by_pixel(profiles, pixel)?;
        let lit = super::pick::lit_point(self.rig, pixel)?;
        let candidate = Candidate {
            spot: spots.start + spots.len() / 2,
            point: lit.point,
            along: lit.along,
            sigma: by_pixel.norm() * variance.sqrt(),
            way: Direction::new(by_pixel).ok()?,
            off_line: None,
            said: false,
        };
        Some(Block {
            view: line.view,
            spots,
            slope,
            by_pixel,
            pick: Pick {
                view: line.view,
                candidate,
                pixel,
            },
        })
    }

    /// How the triangulated point moves as the line does along its profile.
    fn by_pixel(&self, profiles: Profiles, pixel: Pixel) -> Option<Vector3<f64>> {
        const H: f64 = 0.01;
        let at = |step: f64| {
            let moved = profiles.moved(pixel, step);
            Some(super::pick::lit_point(self.rig, moved)?.point)
        };
        Some((at(H)? - at(-H)?) / (2.0 * H))
    }

    /// What the mean profiles of the wall's curves say of its two glows.
    fn line_glow(&self, lines: &[ViewLine], blocks: &[Block], faces: &[Option<Faces>]) -> LineGlow {
        if !self.settings.separate_glows {
            return LineGlow::default();
        }
        let mut profiles = Vec::new();
        for line in lines {
            for curve in &line.line.curves {
                let own = blocks.iter().zip(faces).filter(|(block, _)| {
                    block.view == line.view && curve.range().contains(&block.spots.start)
                });
                let offsets: Vec<f64> = own
                    .filter_map(|(b, f)| Some(b.offset(line.line.profiles, f.as_ref()?)))
                    .collect();
                if !offsets.is_empty() {
                    profiles.push((curve, line.line.kernel, median(offsets)));
                }
            }
        }
        glow::of_profiles(&profiles, self.thickness)
    }

    /// The block without what the inner face's glow does to it.
    fn shifted(
        &self,
        block: &Block,
        line: &Line,
        faces: &Option<Faces>,
        glow: &LineGlow,
        share: f64,
    ) -> Block {
        let mut block = block.clone();
        let Some(faces) = faces else { return block };
        let offset = block.offset(line.profiles, faces);
        let shift = glow::ridge_shift(share, offset, glow.width + line.kernel);
        block.pick.pixel = line.profiles.moved(block.pick.pixel, -shift);
        block
    }

    /// Every point of the blocks that carry the wall, moved as its block was.
    fn line_points(
        &self,
        lines: &[ViewLine],
        (merged, blocks): (&[Block], &[Block]),
        fit: &SurfaceFit,
        (share, grain): (f64, f64),
    ) -> Vec<Vec<VesselPoint>> {
        let mut points = vec![Vec::new(); self.stations.len()];
        for (row, (before, block)) in merged.iter().zip(blocks).enumerate() {
            let Some(line) = lines.iter().find(|line| line.view == block.view) else {
                continue;
            };
            // What a person says is the wall's is listed, however little the fit thinks of it.
            let is_said = block.spots.clone().all(|spot| line.said[spot]);
            if fit.weights[row] <= 0.0 && !is_said {
                continue;
            }
            let shift = Vector2::new(
                block.pick.pixel.u - before.pick.pixel.u,
                block.pick.pixel.v - before.pick.pixel.v,
            );
            let of_spot =
                |spot| self.line_point(line, block, spot, shift, &fit.surface, (share, grain));
            points[block.view].extend(block.spots.clone().filter_map(of_spot));
        }
        points
    }

    fn line_point(
        &self,
        line: &ViewLine,
        block: &Block,
        spot: usize,
        shift: Vector2<f64>,
        surface: &Surface,
        (share, grain): (f64, f64),
    ) -> Option<VesselPoint> {
        let seen = &line.spots[spot];
        let pixel = Pixel::new(seen.u + shift.x, seen.v + shift.y);
        let pose = &self.stations[line.view].world_from_camera;
        let point = pose.point(super::pick::lit_point(self.rig, pixel)?.point);
        let cosine = surface.normal_at(point).map_or(1.0, |n| {
            pose.direction(block.pick.candidate.way).dot(n).abs()
        });
        let variance = seen.variance_along(line.line.profiles, grain);
        Some(VesselPoint {
            spot,
            pixel,
            // To first order the ridge moves with the share.
            by_glow_share: match share > 0.0 {
                true => -shift / share,
                false => Vector2::zeros(),
            },
            point,
            sigma: block.by_pixel.norm() * variance.sqrt() * cosine,
            off_line: None,
            residual: surface.signed_distance(point),
        })
    }
}

impl ViewLine<'_> {
    /// Which of the points that `may` be are the first on their ray, whatever curve the others are of. What a
    /// person says to be the wall's comes before all others.
    fn first_of(&self, may: impl Fn(Point<World>) -> bool) -> Vec<bool> {
        let mut first = vec![false; self.spots.len()];
        let mut curve_of = vec![0; self.spots.len()];
        for (index, curve) in self.line.curves.iter().enumerate() {
            curve_of[curve.range()].fill(index);
        }
        let eligible = (0..self.spots.len()).filter_map(|spot| {
            let lit = self.lit[spot].filter(|lit| self.said[spot] || may(lit.point))?;
            Some((spot, lit))
        });
        let mut points: Vec<(usize, Lit)> = eligible.collect();
        sort_by_number(&mut points, |(_, lit)| lit.angle);
        let pitch = self.pitch();
        for (place, (spot, lit)) in points.iter().enumerate() {
            let before = points[..place].iter().rev();
            let near = |other: &&(usize, Lit)| (other.1.angle - lit.angle).abs() <= pitch;
            let around = before
                .take_while(near)
                .chain(points[place..].iter().take_while(near));
            let mut around = around.filter(|(other, _)| curve_of[*other] != curve_of[*spot]);
            first[*spot] = self.said[*spot]
                || !around.any(|(other, at)| self.said[*other] || at.along < lit.along);
        }
        first
    }

    /// The angle between the rays of neighbouring profiles, radians.
    fn pitch(&self) -> f64 {
        let steps = self.line.curves.iter().flat_map(|curve| {
            let lit = &self.lit[curve.range()];
            lit.windows(2)
                .filter_map(|pair| Some((pair[1]?.angle - pair[0]?.angle).abs()))
        });
        let steps: Vec<f64> = steps.collect();
        if steps.is_empty() { 0.0 } else { median(steps) }
    }

    /// Neighbouring marked points of the curves.
    fn runs(&self, marked: &[bool]) -> Vec<Range<usize>> {
        let mut runs = Vec::new();
        for curve in &self.line.curves {
            let mut start = curve.start;
            for spot in curve.range() {
                if !marked[spot] {
                    runs.push(start..spot);
                    start = spot + 1;
                }
            }
            runs.push(start..curve.end);
        }
        runs
    }
}

/// Cuts a run into blocks of nearly equal length, at most `most`; too short a run gives none.
fn cut(run: Range<usize>, most: usize) -> Vec<Range<usize>> {
    if run.len() < LEAST {
        return Vec::new();
    }
    let parts = (run.len() / LEAST).min(run.len().div_ceil(most));
    let edge = |part: usize| run.start + run.len() * part / parts;
    (0..parts).map(|part| edge(part)..edge(part + 1)).collect()
}

impl Block {
    /// How far beside the outer face's line the inner one's runs, along a profile, px.
    fn offset(&self, profiles: Profiles, faces: &Faces) -> f64 {
        let (lanes, along) = match profiles {
            Profiles::Rows => (faces.offset.y, faces.offset.x),
            Profiles::Columns => (faces.offset.x, faces.offset.y),
        };
        along - self.slope * lanes
    }
}

/// The weighted parabola through points of a curve: its value and slope at a profile, and the value's
/// variance. `None` where the points leave it open.
fn parabola(
    spots: &[Spot],
    profiles: Profiles,
    middle: f64,
    grain: f64,
) -> Option<(f64, f64, f64)> {
    let mut information = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for spot in spots {
        let (lane, at) = profiles.place(spot.pixel());
        let t = lane - middle;
        let row = Vector3::new(1.0, t, t * t);
        let weight = 1.0 / spot.variance_along(profiles, grain);
        information += row * row.transpose() * weight;
        right += row * (at * weight);
    }
    let inverse = information.try_inverse()?;
    let solution = inverse * right;
    Some((solution.x, solution.y, inverse.m11))
}

/// The grain of the laser's light: what the points scatter about their curves beyond the camera's noise, in
/// parts of the line's own second moment (see [`Grain`]).
///
/// Third differences tell scatter from course: that of a round wall bends, but hardly changes its bend.
fn grain(lines: &[ViewLine], marked: &[Vec<bool>]) -> f64 {
    /// Points so far apart share no light.
    const APART: usize = 4;
    const THIRD_DIFFERENCE: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
    let mut excesses = Vec::new();
    for (line, marked) in lines.iter().zip(marked) {
        let profiles = line.line.profiles;
        for run in line.runs(marked) {
            let spots = &line.spots[run];
            for window in spots.windows(3 * APART + 1).step_by(APART) {
                let four = || window.iter().step_by(APART).zip(THIRD_DIFFERENCE);
                let place = |spot: &Spot| profiles.place(spot.pixel());
                let lanes = place(&window[3 * APART]).0 - place(&window[0]).0;
                if lanes != (3 * APART) as f64 {
                    continue;
                }
                let change: f64 = four().map(|(spot, factor)| factor * place(spot).1).sum();
                let own = |spot: &Spot| spot.variance_along(profiles, 0.0);
                let unit = |spot: &Spot| spot.variance_along(profiles, 1.0) - own(spot);
                let together = |of: &dyn Fn(&Spot) -> f64| -> f64 {
                    let parts = four().map(|(spot, factor)| factor * factor * of(spot));
                    parts.sum()
                };
                excesses.push((change * change, together(&own), together(&unit)));
            }
        }
    }
    excess(&excesses)
}

/// The g with median (square / (camera + g unit)) as for normal errors; never negative.
fn excess(samples: &[(f64, f64, f64)]) -> f64 {
    /// The median of the square of a normal error.
    const MEDIAN: f64 = 0.4549;
    const FEWEST: usize = 30;
    if samples.len() < FEWEST {
        return 0.0;
    }
    let ratio = |(square, camera, unit): &(f64, f64, f64)| (square / MEDIAN - camera) / unit;
    median(samples.iter().map(ratio).collect()).max(0.0)
}
