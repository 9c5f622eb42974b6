//! The unknowns of the joint estimate, and what the sights say for given values of them.

use crate::robust::sort_by_number;
use nalgebra::{DMatrix, DVector, Matrix2, Matrix4x2, SymmetricEigen, Vector2};

use super::face::Face;
use super::known::Constraint;
use super::sights::{ObjectSight, Sights, VesselSight};
use crate::camera::Pixel;
use crate::object::{Meeting, Setup, meet};
use crate::optics::{Media, Stack, Surface};
use crate::rig::{Calibration, Laser, Rig};
use crate::scan::InsideMedium;
use crate::vessel::{VesselFit, Wall};

/// A number that the scan was measured with and that may be off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// The liquid's refractive index.
    Index,
    /// One of calibration's.
    Calibration(Calibration),
    /// One of the wall's outer face, in the order of [`Surface::nudged`](crate::optics::Surface::nudged).
    Wall(usize),
    /// The inner face's share of a vessel spot's light.
    Glow,
    /// One of a face of the object.
    Face {
        /// Which face.
        face: usize,
        /// Which of its numbers.
        number: usize,
    },
}

/// Values of all unknowns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct State {
    pub(super) index: f64,
    pub(super) rig: Rig,
    pub(super) wall: Wall,
    /// What the inner glow's share is off from what the vessel's fit took it for.
    pub(super) glow: f64,
    pub(super) faces: Vec<Face>,
    /// Where the wall follows its measured points: how far its own noise has moved it, mode by mode.
    modes: Vec<f64>,
}

/// How the wall may move.
#[derive(Clone, Debug)]
enum WallMotion {
    /// It was known beforehand.
    Fixed,
    /// Its few numbers are unknowns, and the vessel's spots must lie on it.
    Free,
    /// A free form has too many numbers for that. It follows its measured points as calibration moves
    /// them, and beyond that moves along the few modes (principal axes of its covariance, one standard
    /// deviation each) that hold most of its noise.
    Follows(Vec<DVector<f64>>),
}

impl WallMotion {
    fn of(vessel: &VesselFit) -> Self {
        match &vessel.wall.outer {
            _ if vessel.known => Self::Fixed,
            Surface::Freeform(_) => Self::Follows(modes(&vessel.wall.covariance)),
            _ => Self::Free,
        }
    }
}

/// The largest principal axes of a covariance, each as long as its standard deviation.
fn modes(covariance: &DMatrix<f64>) -> Vec<DVector<f64>> {
    const MOST: usize = 8;
    let axes = SymmetricEigen::new(covariance.clone());
    let mut order: Vec<usize> = (0..axes.eigenvalues.len()).collect();
    sort_by_number(&mut order, |axis| -axes.eigenvalues[*axis]);
    let mode = |i: usize| axes.eigenvectors.column(i) * axes.eigenvalues[i].max(0.0).sqrt();
    order.into_iter().take(MOST).map(mode).collect()
}

/// What part of the evidence counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Parts {
    /// The two rays must meet.
    pub(super) gaps: bool,
    /// Points of a face must lie on it.
    pub(super) faces: bool,
    /// What is known of the faces must hold.
    pub(super) known: bool,
}

/// The kind of a residual; each kind has a scale of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    OffLine,
    OnWall,
    Gap,
    OnFace,
    Known,
}

impl Kind {
    pub(super) const ALL: [Self; 5] = [
        Self::OffLine,
        Self::OnWall,
        Self::Gap,
        Self::OnFace,
        Self::Known,
    ];
}

/// The residuals of one sight (one or two of them), or of one known shape: whitened, so that each has a
/// standard deviation of 1 and they do not depend on one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Whitened {
    pub(super) source: Source,
    pub(super) kinds: [Option<Kind>; 2],
    /// Lower triangular; turns raw residuals into whitened ones.
    whitener: Matrix2<f64>,
    /// Where the spot would be without its noise.
    at: Pixel,
    /// What the way from there to where it is seen adds to the raw residuals.
    offset: Vector2<f64>,
}

/// Where residuals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    Vessel(usize),
    Object { sight: usize, face: Option<usize> },
    Known(usize),
}

/// Everything that does not change while the unknowns are sought.
#[derive(Clone, Debug)]
pub(super) struct Model<'a> {
    pub(super) setup: &'a Setup<'a>,
    pub(super) sights: &'a Sights,
    pub(super) known: Vec<Constraint>,
    pub(super) parts: Parts,
    /// One standard deviation of the inner glow's share.
    glow_sigma: f64,
    wall: WallMotion,
}

impl<'a> Model<'a> {
    pub(super) fn new(setup: &'a Setup<'a>, sights: &'a Sights, parts: Parts) -> Self {
        let beam = matches!(setup.rig.laser, Laser::Beam(_));
        Self {
            setup,
            sights,
            known: Vec::new(),
            parts: Parts {
                gaps: parts.gaps && beam,
                ..parts
            },
            glow_sigma: setup.vessel.glows.map_or(0.0, |glows| glows.share_sigma),
            wall: WallMotion::of(setup.vessel),
        }
    }

    /// The state as the scan's manifest and the vessel's fit have it.
    pub(super) fn start(&self, index: f64) -> State {
        State {
            index,
            rig: *self.setup.rig,
            wall: self.setup.vessel.wall.clone(),
            glow: 0.0,
            faces: Vec::new(),
            modes: match &self.wall {
                WallMotion::Follows(modes) => vec![0.0; modes.len()],
                _ => Vec::new(),
            },
        }
    }

    /// A state with one of its numbers moved.
    pub(super) fn moved(&self, state: &State, unknown: Unknown, step: f64) -> State {
        let mut moved = state.clone();
        match unknown {
            Unknown::Index => moved.index += step,
            Unknown::Calibration(number) => {
                moved.rig = number.nudge(&state.rig, step);
                self.follow(&mut moved);
            }
            Unknown::Wall(number) => match &self.wall {
                WallMotion::Follows(_) => {
                    moved.modes[number] += step;
                    self.follow(&mut moved);
                }
                _ => {
                    let mut steps = DVector::zeros(state.wall.outer.freedom());
                    steps[number] = step;
                    moved.wall = state.wall.nudged(&steps);
                }
            },
            Unknown::Glow => moved.glow += step,
            Unknown::Face { face, number } => {
                moved.faces[face] = state.faces[face].nudged(number, step);
            }
        }
        moved
    }

    /// Lets a wall that follows its points do so.
    fn follow(&self, state: &mut State) {
        let WallMotion::Follows(modes) = &self.wall else {
            return;
        };
        let refitted = self.setup.vessel.refitted(&state.rig, self.setup.stations);
        let mut steps = DVector::zeros(state.wall.outer.freedom());
        for (mode, size) in modes.iter().zip(&state.modes) {
            steps += mode * *size;
        }
        state.wall = refitted
            .unwrap_or_else(|| self.setup.vessel.wall.clone())
            .nudged(&steps);
    }

    /// What may move, and the prior standard deviation of each; infinite where there is none.
    pub(super) fn unknowns(&self, state: &State) -> Vec<(Unknown, f64)> {
        let mut unknowns = vec![(Unknown::Index, f64::INFINITY)];
        for number in Calibration::ALL {
            let sigma = number.sigma(self.setup.calibration_sigma);
            if sigma > 0.0 {
                unknowns.push((Unknown::Calibration(number), sigma));
            }
        }
        match &self.wall {
            WallMotion::Fixed => {}
            WallMotion::Free => {
                let freedom = state.wall.outer.freedom();
                unknowns.extend((0..freedom).map(|i| (Unknown::Wall(i), f64::INFINITY)));
            }
            WallMotion::Follows(modes) => {
                unknowns.extend((0..modes.len()).map(|i| (Unknown::Wall(i), 1.0)));
            }
        }
        if self.glow_sigma > 0.0 && !matches!(self.wall, WallMotion::Follows(_)) {
            unknowns.push((Unknown::Glow, self.glow_sigma));
        }
        if self.parts.faces {
            for (face, shape) in state.faces.iter().enumerate() {
                let numbers = 0..shape.freedom();
                unknowns
                    .extend(numbers.map(|number| (Unknown::Face { face, number }, f64::INFINITY)));
            }
        }
        unknowns
    }

    /// The sources of residuals that count.
    pub(super) fn sources(&self, state: &State) -> Vec<Source> {
        let mut face_of = vec![None; self.sights.object.len()];
        if self.parts.faces {
            for (face, shape) in state.faces.iter().enumerate() {
                shape.members.iter().for_each(|m| face_of[*m] = Some(face));
            }
        }
        let vessel = (0..self.sights.vessel.len()).map(Source::Vessel);
        let object = face_of.into_iter().enumerate();
        let object = object.map(|(sight, face)| Source::Object { sight, face });
        let counts = |source: &Source| {
            !matches!(source, Source::Object { face: None, .. }) || self.parts.gaps
        };
        let known = (0..self.known.len()).map(Source::Known);
        vessel
            .chain(object.filter(counts))
            .chain(known.filter(|_| self.parts.known))
            .collect()
    }

    /// The view that a source belongs to.
    pub(super) fn view(&self, source: Source) -> Option<usize> {
        match source {
            Source::Vessel(i) => Some(self.sights.vessel[i].view),
            Source::Object { sight, .. } => Some(self.sights.object[sight].view),
            Source::Known(_) => None,
        }
    }

    /// How a source's residuals are made independent and brought to a standard deviation of 1, from the
    /// covariance C of its pixel. `None` where its light does not get through.
    ///
    /// The residuals r and their slopes A by the pixel are taken where the spot x would be without its
    /// noise, x0 = x - C A^T (A C A^T)^-1 (r + A (x - x0)), as in the Gauss-Helmert model of adjustment:
    /// slopes at the noisy spot go with its noise, and what is weakly determined would be biased by it.
    pub(super) fn whiten(&self, here: &Hypothesis, source: Source) -> Option<Whitened> {
        const ROUNDS: usize = 3;
        /// A spot farther off than this many standard deviations has more than noise.
        const NOISE: f64 = 6.0;
        let (seen, covariance) = match source {
            Source::Vessel(i) => {
                let sight = &self.sights.vessel[i];
                (sight.pixel, sight.covariance)
            }
            Source::Object { sight, .. } => {
                let sight = &self.sights.object[sight];
                (sight.pixel, sight.covariance)
            }
            Source::Known(i) => {
                return Some(Whitened {
                    source,
                    kinds: self.kinds(source),
                    whitener: Matrix2::new(1.0 / self.known[i].known.sigma(), 0.0, 0.0, 0.0),
                    at: Pixel::new(0.0, 0.0),
                    offset: Vector2::zeros(),
                });
            }
        };
        let mut whitened = self.whiten_at(here, source, covariance, seen, Vector2::zeros())?;
        for _ in 0..ROUNDS {
            let slopes = self.slopes(here, source, whitened.at)?;
            let residual = self.residual(here, &whitened)?;
            if residual.norm() > NOISE {
                break;
            }
            let back = covariance * slopes.transpose() * whitened.whitener.transpose() * residual;
            let at = Pixel::new(seen.u - back.x, seen.v - back.y);
            whitened = self.whiten_at(here, source, covariance, at, back)?;
        }
        Some(whitened)
    }

    /// As [`Model::whiten`], at a pixel from which the seen one is off by `away`.
    fn whiten_at(
        &self,
        here: &Hypothesis,
        source: Source,
        covariance: Matrix2<f64>,
        at: Pixel,
        away: Vector2<f64>,
    ) -> Option<Whitened> {
        let slopes = self.slopes(here, source, at)?;
        let spread = slopes * covariance * slopes.transpose();
        let kinds = self.kinds(source);
        let whitener = match kinds {
            [Some(_), Some(_)] => spread.cholesky()?.l().try_inverse()?,
            [Some(_), None] => Matrix2::new(1.0 / spread.m11.sqrt(), 0.0, 0.0, 0.0),
            _ => Matrix2::new(0.0, 0.0, 0.0, 1.0 / spread.m22.sqrt()),
        };
        whitener.iter().all(|x| x.is_finite()).then_some(Whitened {
            source,
            kinds,
            whitener,
            at,
            offset: slopes * away,
        })
    }

    /// How a source's raw residuals change with its pixel.
    fn slopes(&self, here: &Hypothesis, source: Source, at: Pixel) -> Option<Matrix2<f64>> {
        const H: f64 = 1e-3;
        let raw = |du: f64, dv: f64| self.raw_at(here, source, Pixel::new(at.u + du, at.v + dv));
        Some(Matrix2::from_columns(&[
            (raw(H, 0.0)? - raw(-H, 0.0)?) / (2.0 * H),
            (raw(0.0, H)? - raw(0.0, -H)?) / (2.0 * H),
        ]))
    }

    /// Whether the laser is a beam: a sheet's light meets every line of sight, so that neither the
    /// epipolar line nor the ray distance says anything.
    pub(super) const fn has_beam(&self) -> bool {
        matches!(self.setup.rig.laser, Laser::Beam(_))
    }

    fn kinds(&self, source: Source) -> [Option<Kind>; 2] {
        match source {
            Source::Vessel(_) => {
                // A wall that follows its points has used up what they say of it.
                let follows = matches!(self.wall, WallMotion::Follows(_));
                let beam = self.has_beam();
                [
                    beam.then_some(Kind::OffLine),
                    (!follows).then_some(Kind::OnWall),
                ]
            }
            Source::Object { face, .. } => [
                self.parts.gaps.then_some(Kind::Gap),
                face.map(|_| Kind::OnFace),
            ],
            Source::Known(_) => [Some(Kind::Known), None],
        }
    }

    /// The whitened residuals of a source.
    pub(super) fn residual(&self, hypothesis: &Hypothesis, w: &Whitened) -> Option<Vector2<f64>> {
        let raw = match w.source {
            Source::Known(i) => {
                let found = self.known[i].measure(&hypothesis.state.faces)?;
                Vector2::new(found - self.known[i].known.value, 0.0)
            }
            _ => self.raw_at(hypothesis, w.source, w.at)? + w.offset,
        };
        Some(w.whitener * raw)
    }

    fn raw_at(
        &self,
        hypothesis: &Hypothesis,
        source: Source,
        pixel: Pixel,
    ) -> Option<Vector2<f64>> {
        match source {
            Source::Vessel(i) => self.on_vessel(hypothesis, &self.sights.vessel[i], pixel),
            Source::Object { sight, face } => {
                let meeting = self.meeting(hypothesis, &self.sights.object[sight], pixel)?;
                let off_face = face.map_or(0.0, |face| {
                    hypothesis.state.faces[face].distance(meeting.point())
                });
                let gap = if self.parts.gaps { meeting.gap() } else { 0.0 };
                Some(Vector2::new(gap, off_face))
            }
            Source::Known(_) => None,
        }
    }

    /// How far a vessel spot lies off the epipolar line (px), and in front of the wall (mm).
    fn on_vessel(
        &self,
        hypothesis: &Hypothesis,
        sight: &VesselSight,
        pixel: Pixel,
    ) -> Option<Vector2<f64>> {
        let rig = &hypothesis.state.rig;
        let moved = sight.by_glow_share * hypothesis.state.glow;
        let pixel = Pixel::new(pixel.u - moved.x, pixel.v - moved.y);
        let lit = rig.triangulate(rig.camera.slope(pixel).ok()?)?;
        let station = &self.setup.stations[sight.view];
        let point = rig.station(&station.world_from_flange).point(lit.point);
        Some(Vector2::new(
            lit.off_line.unwrap_or(0.0) * rig.camera.mean_focal(),
            hypothesis.state.wall.outer.signed_distance(point),
        ))
    }

    pub(super) fn meeting(
        &self,
        hypothesis: &Hypothesis,
        sight: &ObjectSight,
        pixel: Pixel,
    ) -> Option<Meeting> {
        let rig = &hypothesis.state.rig;
        let station = &self.setup.stations[sight.view];
        let pose = rig.station(&station.world_from_flange);
        meet(rig, &pose, &hypothesis.stack, pixel).ok()
    }
}

/// A state and what light crosses in it.
#[derive(Clone, Debug)]
pub(super) struct Hypothesis {
    pub(super) state: State,
    pub(super) stack: Stack,
}

impl Hypothesis {
    /// `None` where the wall does not fit into the vessel.
    pub(super) fn new(model: &Model, state: State) -> Option<Self> {
        let media = Media {
            liquid: state.index,
            ..model.setup.media
        };
        let stack = state.wall.stack(&media, InsideMedium::Liquid).ok()?;
        Some(Self { state, stack })
    }
}

impl Model<'_> {
    /// What the noise of a sight's pixel does to its gap, and to its point: standard deviations, mm.
    pub(super) fn noise_of(
        &self,
        hypothesis: &Hypothesis,
        sight: &ObjectSight,
    ) -> Option<(f64, f64)> {
        const H: f64 = 1e-3;
        let at = |du: f64, dv: f64| {
            let pixel = Pixel::new(sight.pixel.u + du, sight.pixel.v + dv);
            let meeting = self.meeting(hypothesis, sight, pixel)?;
            Some(meeting.point().coords.push(meeting.gap()))
        };
        let by_u = (at(H, 0.0)? - at(-H, 0.0)?) / (2.0 * H);
        let by_v = (at(0.0, H)? - at(0.0, -H)?) / (2.0 * H);
        let slopes = Matrix4x2::from_columns(&[by_u, by_v]);
        let spread = slopes * sight.covariance * slopes.transpose();
        let point = spread.m11 + spread.m22 + spread.m33;
        Some((spread.m44.sqrt(), point.sqrt()))
    }
}

impl Unknown {
    /// What it is, in words.
    pub fn describe(self) -> String {
        const AXES: [&str; 3] = ["x", "y", "z"];
        const SIDES: [&str; 2] = ["across", "down"];
        match self {
            Self::Index => "the index".to_owned(),
            Self::Glow => "the inner glow's share".to_owned(),
            Self::Wall(number) => format!("the wall's number {number}"),
            Self::Face { face, number } => format!("number {number} of face {face}"),
            Self::Calibration(number) => match number {
                Calibration::LaserOrigin(axis) => {
                    format!("the laser's origin along {}", AXES[axis])
                }
                Calibration::LaserDirection(tangent) => {
                    format!(
                        "the laser's direction ({} tangent)",
                        ["first", "second"][tangent]
                    )
                }
                Calibration::FocalLength(side) => format!("the focal length {}", SIDES[side]),
                Calibration::PrincipalPoint(side) => {
                    format!("the principal point {}", SIDES[side])
                }
                Calibration::HandEyeRotation(axis) => {
                    format!("the hand-eye rotation about {}", AXES[axis])
                }
                Calibration::HandEyeTranslation(axis) => {
                    format!("the hand-eye translation along {}", AXES[axis])
                }
            },
        }
    }
}
