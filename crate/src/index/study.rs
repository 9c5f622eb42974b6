//! All methods on one scan, side by side.

use super::curve::{IndexCurve, IndexRange, PreparedSights};
use super::error::IndexError;
use super::estimate::{Correction, IndexEstimate, IndexMethod, NORMAL_95, Verdict, WIDEST};
use super::face::Face;
use super::given::Given;
use super::known::{Constraint, Known};
use super::model::{Hypothesis, Model, Parts, State, Unknown};
use super::observability::Observability;
use super::remedy::Remedy;
use super::segment::Cloud;
use super::sights::Sights;
use super::solve::{Disagreement, Row, Solution, Which};
use crate::geometry::{Direction, Point, WeightedPoint, World};
use crate::object::{Choice, Setup, calibration_sigmas};
use crate::robust::median;
use crate::scan::{KnownKind, Station};
use crate::spots::Spots;
use crate::vessel::refit_shape;

/// What all methods say of a scan's index.
#[derive(Clone, Debug)]
pub struct IndexStudy {
    /// What the ray distance can tell, before any search; `None` for a line laser, whose rays meet every
    /// line of sight.
    pub observability: Option<Observability>,
    /// The estimates of the methods that apply.
    pub estimates: Vec<IndexEstimate>,
    /// The methods that do not apply, and why.
    pub not_applicable: Vec<(IndexMethod, String)>,
    /// Eq. (3) as printed: the mean ray distance (mm) over the index, with calibration as it was given.
    pub plain_curve: IndexCurve,
    /// The mean robust loss of each view's gap over its standard deviation, with the laser where the
    /// vessel's spots say that it is.
    pub ray_distance_curve: IndexCurve,
    /// The root mean square distance (mm) of the points from the faces that they share.
    pub overlap_curve: Option<IndexCurve>,
    /// Each known shape's measure over the index: Fig. 12 of the paper.
    pub known_curves: Vec<KnownCurve>,
    /// The light, traced as far as the index does not matter, with the laser where the vessel's spots say
    /// that it is.
    pub prepared: PreparedSights,
    /// What would determine the index, where a method does not.
    pub remedies: Vec<(IndexMethod, Remedy)>,
}

/// M of eq. (4) over the index, degrees or mm, and what it ought to be.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownCurve {
    /// Its place in the manifest's list.
    pub entry: usize,
    /// What it is.
    pub kind: KnownKind,
    /// What it ought to be, degrees or mm.
    pub known: f64,
    /// What is measured; for a flat face the root mean square distance of its points from it, mm.
    pub measured: IndexCurve,
    /// dM/dn at the estimate: how sensitive it is.
    pub sensitivity: f64,
}

impl IndexStudy {
    /// A method's estimate, if it applies.
    pub fn estimate(&self, method: IndexMethod) -> Option<&IndexEstimate> {
        self.estimates.iter().find(|e| e.method == method)
    }

    /// The estimate of the most evidence.
    pub fn best(&self) -> Option<&IndexEstimate> {
        self.estimate(IndexMethod::Joint)
    }

    /// What would let a method determine the index.
    pub fn remedy(&self, method: IndexMethod) -> Option<&Remedy> {
        let found = self.remedies.iter().find(|(m, _)| *m == method);
        found.map(|(_, remedy)| remedy)
    }
}

const METHODS: [(IndexMethod, Parts); 4] = [
    (
        IndexMethod::RayDistance,
        Parts {
            gaps: true,
            faces: false,
            known: false,
        },
    ),
    (
        IndexMethod::Overlap,
        Parts {
            gaps: false,
            faces: true,
            known: false,
        },
    ),
    (
        IndexMethod::KnownShape,
        Parts {
            gaps: false,
            faces: true,
            known: true,
        },
    ),
    (
        IndexMethod::Joint,
        Parts {
            gaps: true,
            faces: true,
            known: true,
        },
    ),
];

/// Tries all methods on a scan. `setup.media.liquid` is where the search starts.
pub fn study(
    setup: &Setup,
    spots: &[Spots],
    choices: &[Choice],
    known: &[Known],
    range: &IndexRange,
) -> Result<IndexStudy, IndexError> {
    let valid = range.from >= 1.0 && range.to <= 2.5 && range.from < range.to && range.count >= 3;
    if !valid {
        return Err(IndexError::Range {
            from: range.from,
            to: range.to,
        });
    }
    let sights = Sights::new(setup, spots, choices);
    if sights.object.is_empty() {
        return Err(IndexError::NoSights);
    }
    Student::new(setup, &sights, known, range)?.study()
}

/// Most liquids' index is about this.
const USUAL: f64 = 1.37;

/// What does not change during the study.
struct Student<'a> {
    setup: &'a Setup<'a>,
    sights: &'a Sights,
    known: &'a [Known],
    range: &'a IndexRange,
    /// The state to which the vessel's spots alone bring the calibration and the wall.
    corrected: State,
    vessel_only: Option<Solution>,
    prepared: PreparedSights,
    /// Where the camera of each view is.
    eyes: Vec<Point<World>>,
    /// What noise does to each sight's gap and to its point along the line of sight, mm.
    gap_sigmas: Vec<f64>,
    point_sigmas: Vec<f64>,
    /// How far calibration may move the points, mm.
    common: f64,
}

impl<'a> Student<'a> {
    fn new(
        setup: &'a Setup<'a>,
        sights: &'a Sights,
        known: &'a [Known],
        range: &'a IndexRange,
    ) -> Result<Self, IndexError> {
        let none = Parts {
            gaps: false,
            faces: false,
            known: false,
        };
        let vessel_only = Model::new(setup, sights, none);
        let start = vessel_only.start(setup.media.liquid);
        let solved = vessel_only.solve(start.clone(), Which::AllButIndex);
        let corrected = solved.as_ref().map_or(start, |s| s.state.clone());
        let model = Model::new(setup, sights, METHODS[0].1);
        let here = Hypothesis::new(&model, corrected.clone()).ok_or(IndexError::NoSights)?;
        let sigmas = sights.object.iter().map(|s| model.noise_of(&here, s));
        let (gap_sigmas, point_sigmas) = sigmas.map(|s| s.unwrap_or((1.0, 1.0))).unzip();
        let mut pixels = vec![Vec::new(); setup.stations.len()];
        for sight in &sights.object {
            pixels[sight.view] = vec![sight.pixel];
        }
        let common: Vec<f64> = calibration_sigmas(setup, &pixels)
            .into_iter()
            .flatten()
            .map(|sigma| sigma.point.norm())
            .collect();
        let eye = |station: &Station| station.world_from_camera.point(Point::origin());
        Ok(Self {
            prepared: prepared(setup, sights, &corrected),
            eyes: setup.stations.iter().map(eye).collect(),
            setup,
            sights,
            known,
            range,
            corrected,
            vessel_only: solved,
            gap_sigmas,
            point_sigmas,
            common: if common.is_empty() {
                0.0
            } else {
                median(common)
            },
        })
    }

    fn study(&self) -> Result<IndexStudy, IndexError> {
        let ray_distance_curve = self.prepared.robust_curve(self.range, &self.gap_sigmas);
        let observer = Model::new(self.setup, self.sights, METHODS[0].1);
        let observability = observer
            .has_beam()
            .then(|| observer.observability(&self.corrected))
            .flatten();
        let mut faces = self.start_faces(&ray_distance_curve)?;
        let mut joint = self.solve(METHODS[3].1, &faces);
        // The joint solution tells more exactly which points lie on which face.
        for _ in 0..2 {
            let Some(solution) = &joint else { break };
            faces = self.refined_faces(solution)?;
            joint = self.solve(METHODS[3].1, &faces);
        }
        let near = joint.as_ref().map_or(faces.index, |s| s.state.index);
        faces.index = near;
        self.contradictions(&faces)?;
        let mut study = IndexStudy {
            observability,
            estimates: Vec::new(),
            not_applicable: Vec::new(),
            plain_curve: self.plain_curve(),
            overlap_curve: self.overlap_curve(&faces),
            known_curves: self.known_curves(&faces),
            ray_distance_curve,
            prepared: self.prepared.clone(),
            remedies: Vec::new(),
        };
        for (method, parts) in METHODS {
            match self.applies(method, &faces) {
                Ok(()) => self.add(&mut study, method, parts, &faces),
                Err(why) => study.not_applicable.push((method, why)),
            }
        }
        Ok(study)
    }

    /// Why a method does not apply to this scan.
    fn applies(&self, method: IndexMethod, faces: &Faces) -> Result<(), String> {
        let line = !Model::new(self.setup, self.sights, METHODS[0].1).has_beam();
        match method {
            IndexMethod::RayDistance if line => Err(
                "the rays of a line laser meet every line of sight whatever the index is; use overlap or a \
                 known shape"
                    .to_owned(),
            ),
            IndexMethod::Joint if line && faces.faces.is_empty() => {
                Err("no face of the object is shared by enough points".to_owned())
            }
            IndexMethod::Overlap if faces.faces.is_empty() => {
                Err("no face of the object is shared by enough points".to_owned())
            }
            IndexMethod::KnownShape if faces.constraints.is_empty() => {
                Err("the scan says nothing of the object's shape".to_owned())
            }
            _ => Ok(()),
        }
    }

    fn model(&self, parts: Parts, faces: &Faces) -> Model<'a> {
        let mut model = Model::new(self.setup, self.sights, parts);
        model.known = faces.constraints.clone();
        model
    }

    fn solve(&self, parts: Parts, faces: &Faces) -> Option<Solution> {
        let mut start = self.corrected.clone();
        start.index = faces.index;
        start.faces = faces.faces.clone();
        self.model(parts, faces).solve(start, Which::All)
    }

    fn add(&self, study: &mut IndexStudy, method: IndexMethod, parts: Parts, faces: &Faces) {
        let model = self.model(parts, faces);
        let found = match method {
            IndexMethod::Joint => self.solve(parts, faces).map(|s| self.solved(&model, s)),
            _ => self.given(&model, self.start(method, faces, study)),
        };
        let Some(found) = found else {
            let why = "the light gets through in too few views".to_owned();
            study.not_applicable.push((method, why));
            return;
        };
        let estimate = self.estimate(method, &model, &found, study.observability.as_ref());
        if estimate.verdict == Verdict::NotDetermined {
            let enough = WIDEST / NORMAL_95;
            if let Some(remedy) = model.remedy(&found.state, enough) {
                study.remedies.push((method, remedy));
            }
        }
        study.estimates.push(estimate);
    }

    /// Where a method that holds calibration starts from.
    fn start(&self, method: IndexMethod, faces: &Faces, study: &IndexStudy) -> State {
        let mut start = self.corrected.clone();
        start.faces = faces.faces.clone();
        start.index = match method {
            IndexMethod::RayDistance => {
                let minimum = study.ray_distance_curve.minimum();
                minimum.map_or(faces.index, |minimum| minimum.index)
            }
            _ => faces.index,
        };
        start
    }

    /// Eqs. (3) and (4), robust and weighted, with calibration held as the vessel's spots leave it.
    fn given(&self, model: &Model, start: State) -> Option<Found> {
        let vessel = self.vessel_only.as_ref()?;
        let given = Given::solve(model, start, vessel)?;
        let groups = self.groups();
        let group_of = |row: &Row| model.view(row.whitened.source).map(|view| groups[view]);
        Some(Found {
            sigma: given.sigma(),
            disagreement: given.disagreement(group_of),
            corrections: corrections(vessel),
            entangled: given.most_entangled(),
            state: given.state,
        })
    }

    fn solved(&self, model: &Model, solution: Solution) -> Found {
        let groups = self.groups();
        let group_of = |row: &Row| model.view(row.whitened.source).map(|view| groups[view]);
        Found {
            sigma: solution.sigma(),
            disagreement: solution.disagreement(group_of),
            corrections: corrections(&solution),
            entangled: most_entangled(&solution),
            state: solution.state,
        }
    }

    fn estimate(
        &self,
        method: IndexMethod,
        model: &Model,
        found: &Found,
        observability: Option<&Observability>,
    ) -> IndexEstimate {
        let model_sigma = found.disagreement.map(|d| d.factor * found.sigma);
        let disagreeing = found.disagreement.filter(|d| d.significant);
        let sigma = found.sigma * disagreeing.map_or(1.0, |d| d.factor.max(1.0));
        let index = found.state.index;
        let inside = index > self.range.from && index < self.range.to;
        let verdict = if inside {
            Verdict::of_sigma(sigma)
        } else {
            Verdict::NotDetermined
        };
        let reason = (verdict == Verdict::NotDetermined)
            .then(|| self.reason(method, found, sigma, inside, observability));
        let half = NORMAL_95 * sigma;
        IndexEstimate {
            method,
            verdict,
            value: (verdict != Verdict::NotDetermined).then_some(index),
            sigma,
            sampling_sigma: found.sigma,
            model_sigma,
            floor: model.floor(&found.state).unwrap_or(f64::INFINITY),
            interval: [index - half, index + half],
            reason,
            corrections: found.corrections.clone(),
        }
    }

    fn reason(
        &self,
        method: IndexMethod,
        found: &Found,
        sigma: f64,
        inside: bool,
        observability: Option<&Observability>,
    ) -> String {
        let wide = format!("its standard deviation would be {sigma:.3}");
        let wide = if inside {
            wide
        } else {
            format!("{wide}, and the best value is the end of the search range")
        };
        let why = match (method, observability) {
            (IndexMethod::RayDistance, Some(seen)) => format!(
                "{}; the signal is {:.2} px per unit of the index",
                seen.cause(),
                seen.median_pixels
            ),
            _ => match found.entangled {
                Some((unknown, correlation)) => format!(
                    "the index can hardly be told from {} (correlation {correlation:+.2})",
                    unknown.describe()
                ),
                None => "the noise is too large".to_owned(),
            },
        };
        format!("{why}; {wide}")
    }

    /// The views in groups that are left out in turn: the sweeps, or parts of them where there are few.
    fn groups(&self) -> Vec<usize> {
        const LEAST: usize = 4;
        let sweeps = self.sights.sweep_of.iter().max().map_or(0, |last| last + 1);
        if sweeps >= LEAST {
            return self.sights.sweep_of.clone();
        }
        let parts = LEAST.div_ceil(sweeps.max(1));
        let mut seen = vec![0; sweeps];
        let mut size = vec![0; sweeps];
        self.sights.sweep_of.iter().for_each(|s| size[*s] += 1);
        let group = |sweep: &usize| {
            let part = seen[*sweep] * parts / size[*sweep];
            seen[*sweep] += 1;
            sweep * parts + part
        };
        self.sights.sweep_of.iter().map(group).collect()
    }

    /// Faces from the points for the index at which the points agree best on any, or near which the rays
    /// do.
    fn start_faces(&self, ray_distance: &IndexCurve) -> Result<Faces, IndexError> {
        const STEP: f64 = 0.025;
        let tolerance = self.tolerance(1.0);
        let count = ((self.range.to - self.range.from) / STEP).ceil() as usize + 1;
        let coarse = IndexRange {
            count: count.max(3),
            ..*self.range
        };
        let mut tried: Vec<(f64, f64)> = Vec::new();
        let kind = self.cloud(&self.points(USUAL), tolerance).kind();
        for index in coarse.values() {
            let points = self.points(index);
            let cloud = self.cloud(&points, tolerance);
            tried.push((cloud.loss(&cloud.faces_of(kind)), index));
        }
        let least = tried.iter().map(|t| t.0).fold(f64::INFINITY, f64::min);
        // Where the faces do not tell, near the rays' own minimum, or what most liquids are.
        let usual = ray_distance
            .minimum()
            .filter(|m| !m.at_bound)
            .map_or(USUAL, |m| m.index.clamp(1.25, 1.5));
        let index = tried
            .iter()
            .filter(|(loss, _)| *loss <= 1.2 * least + 0.05)
            .map(|(_, index)| *index)
            .min_by(|a, b| (a - usual).abs().total_cmp(&(b - usual).abs()))
            .unwrap_or(usual);
        self.faces_at(index, &self.points(index), tolerance)
    }

    fn refined_faces(&self, solution: &Solution) -> Result<Faces, IndexError> {
        let prepared = prepared(self.setup, self.sights, &solution.state);
        let points: Vec<_> = prepared.points(solution.state.index).collect();
        self.faces_at(solution.state.index, &points, self.tolerance(0.2))
    }

    /// Points nearer to a face than this may lie on it: some standard deviations of their noise, and a
    /// part of what calibration may do to them.
    fn tolerance(&self, common: f64) -> f64 {
        4.0 * median(self.point_sigmas.clone()) + common * 0.5 * self.common
    }

    fn faces_at(
        &self,
        index: f64,
        points: &[Option<Point<World>>],
        tolerance: f64,
    ) -> Result<Faces, IndexError> {
        let (faces, constraints) = self.cloud(points, tolerance).with_known(self.known)?;
        Ok(Faces {
            index,
            faces,
            constraints,
        })
    }

    fn points(&self, index: f64) -> Vec<Option<Point<World>>> {
        self.prepared.points(index).collect()
    }

    fn cloud<'p>(&'p self, points: &'p [Option<Point<World>>], tolerance: f64) -> Cloud<'p> {
        Cloud {
            points,
            sigmas: &self.point_sigmas,
            sights: self.sights,
            front: self.eyes[self.sights.object[0].view],
            eyes: &self.eyes,
            axis: self.axis(),
            tolerance,
        }
    }

    /// The wall's mean normal where the beams meet it.
    fn axis(&self) -> Direction<World> {
        let rig = &self.corrected.rig;
        let normals = self.sights.object.iter().filter_map(|sight| {
            let station = &self.setup.stations[sight.view];
            let beam = rig
                .station(&station.world_from_flange)
                .ray(&rig.laser.axis());
            Some(self.corrected.wall.outer.hit(&beam)?.normal.vector())
        });
        let pose = &self.setup.stations[0].world_from_camera;
        Direction::new(normals.sum()).unwrap_or_else(|_| pose.direction(rig.laser.axis().direction))
    }

    fn plain_curve(&self) -> IndexCurve {
        let model = Model::new(self.setup, self.sights, METHODS[0].1);
        let given = model.start(self.setup.media.liquid);
        prepared(self.setup, self.sights, &given).plain_curve(self.range)
    }

    /// The faces with their surfaces fitted anew to the points for an index.
    fn faces_refitted(&self, faces: &[Face], index: f64) -> Option<Vec<Face>> {
        let points = self.points(index);
        let refit = |face: &Face| {
            let members = face.members.iter();
            let points: Vec<WeightedPoint<World>> = members
                .filter_map(|m| {
                    Some(WeightedPoint {
                        point: points[*m]?,
                        sigma: self.point_sigmas[*m],
                    })
                })
                .collect();
            Some(Face {
                surface: refit_shape(&points, &face.surface)?,
                stretch: None,
                ..face.clone()
            })
        };
        faces.iter().map(refit).collect()
    }

    fn overlap_curve(&self, faces: &Faces) -> Option<IndexCurve> {
        if faces.faces.is_empty() {
            return None;
        }
        let rms = |index: f64| {
            let points = self.points(index);
            let refitted = self.faces_refitted(&faces.faces, index)?;
            let members = refitted
                .iter()
                .flat_map(|face| face.members.iter().map(move |m| (face, *m)));
            let squares = members.filter_map(|(face, m)| {
                let off = face.distance(points[m]?);
                Some(off * off)
            });
            let squares: Vec<f64> = squares.collect();
            let count = squares.len() as f64;
            Some((squares.into_iter().sum::<f64>() / count).sqrt())
        };
        Some(self.coarse_curve(rms))
    }

    fn coarse_curve(&self, value: impl Fn(f64) -> Option<f64>) -> IndexCurve {
        const MOST: usize = 81;
        let range = IndexRange {
            count: self.range.count.min(MOST),
            ..*self.range
        };
        let index = range.values();
        IndexCurve {
            value: index.iter().map(|n| value(*n)).collect(),
            index,
        }
    }

    fn known_curves(&self, faces: &Faces) -> Vec<KnownCurve> {
        let curve = |constraint: &Constraint| {
            let measure = |index: f64| {
                let refitted = self.faces_refitted(&faces.faces, index)?;
                match constraint.known.kind {
                    KnownKind::PlaneAngle => constraint.measure(&refitted).map(f64::to_degrees),
                    KnownKind::Flatness => self.flatness(&refitted[constraint.faces[0]], index),
                    KnownKind::EdgeLength | KnownKind::Radius => constraint.measure(&refitted),
                }
            };
            const H: f64 = 0.01;
            let slope = measure(faces.index + H).zip(measure(faces.index - H));
            KnownCurve {
                entry: constraint.known.entry,
                kind: constraint.known.kind,
                known: match constraint.known.kind {
                    KnownKind::PlaneAngle => constraint.known.value.to_degrees(),
                    _ => constraint.known.value,
                },
                measured: self.coarse_curve(measure),
                sensitivity: slope.map_or(0.0, |(a, b)| (a - b) / (2.0 * H)),
            }
        };
        faces.constraints.iter().map(curve).collect()
    }

    fn flatness(&self, face: &Face, index: f64) -> Option<f64> {
        let points = self.points(index);
        let squares: Vec<f64> = face
            .members
            .iter()
            .filter_map(|m| points[*m])
            .map(|p| face.distance(p) * face.distance(p))
            .collect();
        let count = squares.len() as f64;
        (count > 0.0).then(|| (squares.into_iter().sum::<f64>() / count).sqrt())
    }

    /// Known shapes that each by itself want another index.
    fn contradictions(&self, faces: &Faces) -> Result<(), IndexError> {
        const SIGMAS: f64 = 5.0;
        if faces.constraints.len() < 2 {
            return Ok(());
        }
        let alone = |constraint: &Constraint| {
            let mut only = faces.clone();
            only.constraints = vec![constraint.clone()];
            let solution = self.solve(METHODS[2].1, &only)?;
            Some((
                constraint.known.entry,
                solution.state.index,
                solution.sigma(),
            ))
        };
        let wants: Vec<_> = faces.constraints.iter().filter_map(alone).collect();
        for (i, a) in wants.iter().enumerate() {
            for b in &wants[i + 1..] {
                let sigma = (a.2 * a.2 + b.2 * b.2).sqrt();
                if (a.1 - b.1).abs() > SIGMAS * sigma {
                    let text = |n: f64, s: f64| format!("{n:.3} +- {s:.3}");
                    return Err(IndexError::Contradiction {
                        first: a.0,
                        second: b.0,
                        first_index: text(a.1, a.2),
                        second_index: text(b.1, b.2),
                    });
                }
            }
        }
        Ok(())
    }
}

/// What a method found, before it is judged.
struct Found {
    state: State,
    /// One standard deviation by propagation.
    sigma: f64,
    /// By what factor the rows of views disagree more than that explains.
    disagreement: Option<Disagreement>,
    corrections: Vec<Correction>,
    /// The unknown that goes most with the index, and its correlation.
    entangled: Option<(Unknown, f64)>,
}

/// The faces of the object, what is known of them, and the index for which they were found.
#[derive(Clone, Debug)]
struct Faces {
    index: f64,
    faces: Vec<Face>,
    constraints: Vec<Constraint>,
}

/// The light of the object's sights in a state.
fn prepared(setup: &Setup, sights: &Sights, state: &State) -> PreparedSights {
    let pixels = sights.object.iter().map(|sight| (sight.view, sight.pixel));
    let pixels: Vec<_> = pixels.collect();
    PreparedSights::behind(
        &state.rig,
        &state.wall,
        &setup.media,
        setup.stations,
        &pixels,
    )
}

fn corrections(solution: &Solution) -> Vec<Correction> {
    let unknowns = solution.unknowns.iter().enumerate();
    unknowns
        .filter(|(_, m)| matches!(m.unknown, Unknown::Calibration(_) | Unknown::Glow))
        .map(|(i, moved)| Correction {
            unknown: moved.unknown,
            by: moved.by,
            prior_sigma: moved.prior,
            sigma: solution.covariance[(i, i)].sqrt(),
        })
        .collect()
}

/// The unknown of calibration that goes most with the index.
fn most_entangled(solution: &Solution) -> Option<(Unknown, f64)> {
    let index = solution.position(Unknown::Index)?;
    let c = &solution.covariance;
    let correlation = |i: usize| c[(i, index)] / (c[(i, i)] * c[(index, index)]).sqrt();
    let of_calibration = solution
        .unknowns
        .iter()
        .enumerate()
        .filter(|(_, m)| matches!(m.unknown, Unknown::Calibration(_) | Unknown::Glow));
    of_calibration
        .map(|(i, moved)| (moved.unknown, correlation(i)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}
