//! What is to be seen of a measured scan, as points, lines and faces.

use std::sync::Arc;

use three_d::{InnerSpace, Vec3, vec3};

use super::ellipsoids::ellipsoid;
use super::faces::Face;
use super::grid::Grid;
use super::labels::Label;
use super::lines::{Line, chain};
use super::orbit::Orbit;
use super::palette::Palette;
use super::patch::Patch;
use super::points::ScenePoint;
use super::section::Slab;
use crate::colours::{MIDDLE, Scale};
use crate::measuring::Picked;
use crate::run::{Facts, ObjectPoint, Outcome, Place, Shown, Stand};
use crate::state::{ColourBy, Section, SectionAxis};

/// More beams would hide what they light.
const MOST_BEAMS: usize = 150;

/// Likewise of cameras.
const MOST_STATIONS: usize = 1000;

/// What is to be seen. Empty until a scan is measured.
#[derive(Default)]
pub(super) struct Content {
    measured: Option<Measured>,
    /// Whether the colours are about the wall's points.
    pub(super) about_wall: bool,
    /// The view that is chosen.
    pub(super) chosen: Option<usize>,
    /// The points that are measured with, face by face.
    pub(super) picked: [Vec<Picked>; 2],
    patch: Option<Patch>,
    grid: Option<Grid>,
    /// Places between which everything lies that was measured.
    extent: Vec<Vec3>,
}

/// What was measured, and what its colours mean.
struct Measured {
    facts: Arc<Facts>,
    outcome: Arc<Outcome>,
    by: ColourBy,
    scale: Scale,
    /// Points that have no value.
    plain_object: [f32; 4],
    plain_vessel: [f32; 4],
}

impl Measured {
    fn object_point(&self, index: usize) -> ScenePoint {
        let point = &self.outcome.object[index];
        let (colour, fraction) = match self.scale.of_object(&self.facts, self.by, point) {
            Some((colour, fraction)) => (opaque(colour), fraction),
            None => (self.plain_object, MIDDLE),
        };
        ScenePoint {
            view: point.view,
            index: Some(index - self.outcome.views[point.view].points.start),
            place: shown(point.place),
            unrefracted: shown(point.unrefracted),
            colour,
            fraction,
        }
    }

    fn vessel_point(&self, index: usize) -> ScenePoint {
        let point = &self.outcome.vessel[index];
        let (colour, fraction) = match self.scale.of_vessel(self.by, point) {
            Some((colour, fraction)) => (opaque(colour), fraction),
            None => (self.plain_vessel, MIDDLE),
        };
        ScenePoint {
            view: point.view,
            index: None,
            place: shown(point.place),
            unrefracted: shown(point.place),
            colour,
            fraction,
        }
    }
}

impl Content {
    pub(super) fn new(
        facts: Arc<Facts>,
        outcome: Arc<Outcome>,
        by: ColourBy,
        chosen: Option<usize>,
        palette: &Palette,
    ) -> Self {
        let up = up(&facts);
        let patch = Patch::new(
            &outcome.wall,
            &some(&outcome.vessel, |p| shown(p.place)),
            up,
        );
        let object = some(&outcome.object, |p| [shown(p.place), shown(p.unrefracted)]);
        let mut content = Self {
            about_wall: by == ColourBy::Residual,
            chosen,
            picked: Default::default(),
            extent: object.into_iter().flatten().chain(patch.places()).collect(),
            patch: Some(patch),
            grid: None,
            measured: Some(Measured {
                scale: Scale::of(&facts, &outcome, by),
                facts,
                outcome,
                by,
                plain_object: palette.plain_point,
                plain_vessel: palette.vessel_point,
            }),
        };
        content.grid = Grid::below(content.extent(), up, content.front_direction());
        content
    }

    /// Whether it shows the same points as another, if perhaps in other colours.
    pub(super) fn has_points_of(&self, other: &Self) -> bool {
        match (&self.measured, &other.measured) {
            (Some(one), Some(other)) => Arc::ptr_eq(&one.outcome, &other.outcome),
            _ => false,
        }
    }

    /// What the colours mean.
    pub(super) fn scale(&self) -> Option<&Scale> {
        Some(&self.measured.as_ref()?.scale)
    }

    /// How many points the object has, and the wall.
    pub(super) fn counts(&self) -> [usize; 2] {
        let measured = self.measured.as_ref();
        measured.map_or([0; 2], |m| [m.outcome.object.len(), m.outcome.vessel.len()])
    }

    /// A point of the object in its colour.
    pub(super) fn object_point(&self, index: usize) -> Option<ScenePoint> {
        Some(self.measured.as_ref()?.object_point(index))
    }

    /// A point of the wall in its colour.
    pub(super) fn vessel_point(&self, index: usize) -> Option<ScenePoint> {
        Some(self.measured.as_ref()?.vessel_point(index))
    }

    /// Where all points are, the object's first, and where each would be without refraction.
    pub(super) fn places(&self) -> impl Iterator<Item = [Vec3; 2]> {
        self.measured.iter().flat_map(|measured| {
            let Outcome { object, vessel, .. } = &*measured.outcome;
            let object = object.iter().map(|p| [p.place, p.unrefracted]);
            let both = object.chain(vessel.iter().map(|p| [p.place; 2]));
            both.map(|places| places.map(shown))
        })
    }

    /// A point by its number among the places.
    pub(super) fn point(&self, number: usize) -> Option<ScenePoint> {
        let measured = self.measured.as_ref()?;
        let object = measured.outcome.object.len();
        Some(match number.checked_sub(object) {
            None => measured.object_point(number),
            Some(index) => measured.vessel_point(index),
        })
    }

    /// Places between which everything lies that was measured, to be got into the picture.
    pub(super) fn extent(&self) -> &[Vec3] {
        &self.extent
    }

    /// As [`Content::extent`], with the rig's stations.
    pub(super) fn whole_extent(&self) -> Vec<Vec3> {
        let rig = self
            .stands()
            .flat_map(|s| [vector(s.camera), vector(s.laser)]);
        self.extent.iter().copied().chain(rig).collect()
    }

    /// A camera beside the rig.
    pub(super) fn front(&self) -> Orbit {
        match &self.measured {
            Some(Measured { facts, .. }) => Orbit::facing(up(facts), self.front_direction()),
            None => Orbit::default(),
        }
    }

    /// From the scene towards the rig, across up.
    fn front_direction(&self) -> Vec3 {
        let Some(Measured { facts, outcome, .. }) = &self.measured else {
            return vec3(0.0, 0.0, -1.0);
        };
        let up = up(facts);
        let back = match stands(facts).next() {
            Some(_) => -mean(facts, |stand| stand.ahead),
            None => towards_wall(outcome),
        };
        let level = back - up * back.dot(up);
        // A rig that looks straight down has no front; any will do.
        if level.magnitude() > 0.05 {
            level.normalize()
        } else {
            up.cross(vec3(0.6, 0.0, 0.8)).normalize()
        }
    }

    /// Cameras; of very many stations every so many-th.
    pub(super) fn station_lines(&self, palette: &Palette) -> Vec<Line> {
        let size = self.station_size();
        let few = self
            .stands()
            .step_by(self.stands().count() / MOST_STATIONS + 1);
        few.flat_map(|s| camera_lines(s, size, palette.station))
            .collect()
    }

    pub(super) fn grid_lines(&self, palette: &Palette) -> Vec<Line> {
        let grid = self.grid.iter();
        grid.flat_map(|g| g.lines(palette.grid)).collect()
    }

    pub(super) fn wall_edges(&self, palette: &Palette) -> Vec<Line> {
        let patch = self.patch.iter();
        patch.flat_map(|p| p.edges(palette.wall_edge)).collect()
    }

    /// The beams up to the wall.
    pub(super) fn beams(&self, palette: &Palette) -> Vec<Line> {
        let Some(Measured { facts, outcome, .. }) = &self.measured else {
            return Vec::new();
        };
        // Of a sheet of light, a few rays.
        let few = outcome
            .vessel
            .iter()
            .step_by(outcome.vessel.len() / MOST_BEAMS + 1);
        few.filter_map(|point| {
            let laser = vector(facts.stations[point.view].stand?.laser);
            Some(Line::new(laser, shown(point.place), palette.station_beam))
        })
        .collect()
    }

    /// What refraction does: from where each point would be without it to where it is.
    pub(super) fn displacements(&self, palette: &Palette) -> Vec<Line> {
        let few = self.every_so_many(MOST_BEAMS);
        few.map(|(_, p)| Line::new(p.unrefracted, p.place, palette.displacement))
            .collect()
    }

    /// The slab of a section.
    pub(super) fn slab(&self, section: Section) -> Slab {
        let (Some(Measured { facts, .. }), Some(axis)) = (&self.measured, section.axis) else {
            return Slab::ALL;
        };
        let (up, front) = (up(facts), self.front_direction());
        let normal = match axis {
            SectionAxis::Depth => -front,
            SectionAxis::Height => up,
            SectionAxis::Width => up.cross(front),
        };
        Slab::of(section, normal, self.extent())
    }

    /// Error ellipsoids, so many times as large as they are; of very many points every so many-th.
    pub(super) fn ellipsoids(&self, magnified: f32) -> Vec<Line> {
        const MOST: usize = 400;
        let few = self.every_so_many(MOST);
        few.flat_map(|(of, seen)| ellipsoid(seen.place, of.covariance, magnified, seen.colour))
            .collect()
    }

    /// At most about so many of the object's points, evenly taken, as measured and as shown.
    fn every_so_many(&self, most: usize) -> impl Iterator<Item = (&ObjectPoint, ScenePoint)> {
        self.measured.iter().flat_map(move |measured| {
            let points = &measured.outcome.object;
            let few = (0..points.len()).step_by(points.len() / most + 1);
            few.map(|index| (&points[index], measured.object_point(index)))
        })
    }

    pub(super) fn wall_faces(&self, palette: &Palette) -> Vec<Face> {
        let faces = self.patch.iter().flat_map(|p| p.faces(palette.wall));
        faces.collect()
    }

    pub(super) fn labels(&self) -> Vec<Label> {
        self.grid.iter().flat_map(Grid::labels).collect()
    }

    /// A ring around each point of the chosen view, and of those that are measured with.
    pub(super) fn rings(&self, palette: &Palette) -> Vec<ScenePoint> {
        let chosen = self
            .chosen
            .into_iter()
            .flat_map(|view| self.points_of(view));
        let marked = |colour| move |point| ScenePoint { colour, ..point };
        let mut rings: Vec<_> = chosen.map(marked(palette.marker)).collect();
        for (face, picked) in self.picked.iter().enumerate() {
            let points = picked
                .iter()
                .filter_map(|(view, index)| self.points_of(*view).nth(*index));
            rings.extend(points.map(marked(palette.faces[face])));
        }
        rings
    }

    /// The object's points of a view.
    fn points_of(&self, view: usize) -> impl Iterator<Item = ScenePoint> {
        self.measured.iter().flat_map(move |measured| {
            let view = measured.outcome.views.get(view);
            let points = view.map_or(0..0, |view| view.points.clone());
            points.map(|index| measured.object_point(index))
        })
    }

    /// How large points are drawn, CSS px: of many each is small.
    pub(super) fn point_size(&self) -> f32 {
        match self.counts().into_iter().max().unwrap_or_default() {
            0..3_000 => 9.0,
            3_000..30_000 => 5.0,
            _ => 3.0,
        }
    }

    /// The light of the chosen view, on the way from straight (0) to bent (1).
    pub(super) fn chosen_light(&self, palette: &Palette, refraction: f32) -> Vec<Line> {
        let Some(Measured { outcome, .. }) = &self.measured else {
            return Vec::new();
        };
        let Some(chosen) = self.chosen.filter(|view| *view < outcome.views.len()) else {
            return Vec::new();
        };
        let view = &outcome.views[chosen];
        let end = outcome.point_of(chosen);
        let straight_end = end.map(|point| shown(point.unrefracted));
        let bend = |path: &[Place], colour| {
            let bent: Vec<Vec3> = path.iter().copied().map(vector).collect();
            let places = straightened(&bent, straight_end, refraction);
            chain(&places, colour).collect::<Vec<_>>()
        };
        [
            bend(&view.beam, palette.beam),
            bend(&view.sight, palette.sight),
        ]
        .concat()
    }

    /// Stations are drawn large enough to be seen and small enough not to hide each other.
    fn station_size(&self) -> f32 {
        let places: Vec<Vec3> = self.stands().map(|s| vector(s.camera)).collect();
        let steps = places
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).magnitude());
        let mut steps: Vec<f32> = steps.collect();
        steps.sort_by(f32::total_cmp);
        let usual = steps.get(steps.len() / 2).copied().unwrap_or(20.0);
        (usual * 1.4).clamp(6.0, 30.0)
    }

    /// Where the rig stood, as far as that is known.
    fn stands(&self) -> impl Iterator<Item = &Stand> {
        self.measured.iter().flat_map(|m| stands(&m.facts))
    }
}

/// So many of a list's places, evenly taken, that a scene is known by them.
fn some<T, P>(list: &[T], place: impl Fn(&T) -> P) -> Vec<P> {
    const MOST: usize = 20_000;
    let few = list.iter().step_by(list.len() / MOST + 1);
    few.map(place).collect()
}

fn opaque(colour: [u8; 3]) -> [f32; 4] {
    let [red, green, blue] = colour.map(|part| f32::from(part) / 255.0);
    [red, green, blue, 1.0]
}

/// Light through the faces, drawn towards the straight line to `straight_end` as refraction goes.
fn straightened(bent: &[Vec3], straight_end: Option<Vec3>, refraction: f32) -> Vec<Vec3> {
    let (Some(&start), Some(&end)) = (bent.first(), bent.last()) else {
        return Vec::new();
    };
    let straight_end = straight_end.unwrap_or(end);
    let length = (end - start).magnitude().max(f32::EPSILON);
    let place = |at: &Vec3| {
        let part = (*at - start).magnitude() / length;
        let straight = start + (straight_end - start) * part;
        straight + (*at - straight) * refraction
    };
    bent.iter().map(place).collect()
}

/// A pyramid from the camera's centre over the picture's corners, with a tick upwards; and the laser.
fn camera_lines(station: &Stand, size: f32, colour: [f32; 4]) -> Vec<Line> {
    let eye = vector(station.camera);
    let corners = station.corners.map(|c| eye + (vector(c) - eye) * size);
    let [top_left, top_right, bottom_right, bottom_left] = corners;
    let rays = corners.map(|corner| Line::new(eye, corner, colour));
    let frame = [top_left, top_right, bottom_right, bottom_left, top_left];
    let up = -vector(station.down) * (0.25 * size);
    let peak = (top_left + top_right) * 0.5 + up;
    let roof = [top_left, peak, top_right];
    rays.into_iter()
        .chain(chain(&frame, colour))
        .chain(chain(&roof, colour))
        .collect()
}

/// From the object to the wall before it, of length 1; nothing without points.
fn towards_wall(outcome: &Outcome) -> Vec3 {
    let middle = |places: &mut dyn Iterator<Item = Shown>| {
        let mut count = 0.0_f32;
        let sum = places.fold(vec3(0.0, 0.0, 0.0), |sum, place| {
            count += 1.0;
            sum + shown(place)
        });
        sum / count.max(1.0)
    };
    let wall = middle(&mut outcome.vessel.iter().map(|point| point.place));
    let way = wall - middle(&mut outcome.object.iter().map(|point| point.place));
    let length = way.magnitude();
    if length > 0.0 { way / length } else { way }
}

/// The scene's up: against the pictures' down, on the average.
fn up(facts: &Facts) -> Vec3 {
    let down = mean(facts, |station| station.down);
    if down.magnitude() > 0.05 {
        -down.normalize()
    } else {
        vec3(0.0, -1.0, 0.0)
    }
}

fn stands(facts: &Facts) -> impl Iterator<Item = &Stand> {
    let stations = facts.stations.iter();
    stations.filter_map(|station| station.stand.as_ref())
}

fn mean(facts: &Facts, of: impl Fn(&Stand) -> Place) -> Vec3 {
    let sum = stands(facts).fold(vec3(0.0, 0.0, 0.0), |sum, stand| sum + vector(of(stand)));
    sum / facts.stations.len().max(1) as f32
}

/// A place as the graphics card takes it.
pub(super) fn vector([x, y, z]: Place) -> Vec3 {
    vec3(x as f32, y as f32, z as f32)
}

/// Likewise, for a point.
fn shown(place: Shown) -> Vec3 {
    place.into()
}
