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
use crate::run::{Facts, Outcome, Place, Shown, Stand};
use crate::state::{ColourBy, Section, SectionAxis};

/// More beams would hide what they light.
const MOST_BEAMS: usize = 150;

/// What is to be seen. Empty until a scan is measured.
#[derive(Default)]
pub(super) struct Content {
    measured: Option<(Arc<Facts>, Arc<Outcome>)>,
    /// The object's points in their colours.
    pub(super) object: Vec<ScenePoint>,
    /// The wall's points.
    pub(super) vessel: Vec<ScenePoint>,
    /// Whether the colours are about the wall's points.
    pub(super) about_wall: bool,
    /// The view that is chosen.
    pub(super) chosen: Option<usize>,
    /// The points that are measured with, face by face.
    pub(super) picked: [Vec<Picked>; 2],
    patch: Option<Patch>,
    grid: Option<Grid>,
}

impl Content {
    pub(super) fn new(
        facts: Arc<Facts>,
        outcome: Arc<Outcome>,
        by: ColourBy,
        chosen: Option<usize>,
        palette: &Palette,
    ) -> Self {
        let scale = Scale::of(&facts, &outcome, by);
        let object = outcome.object.iter().enumerate().map(|(index, point)| {
            let index = index - outcome.views[point.view].points.start;
            let coloured = scale.of_object(&facts, by, point);
            let places = [point.place, point.unrefracted].map(shown);
            scene_point(
                (point.view, Some(index)),
                places,
                coloured,
                palette.plain_point,
            )
        });
        let vessel = outcome.vessel.iter().map(|point| {
            let coloured = scale.of_vessel(by, point);
            let places = [shown(point.place); 2];
            scene_point((point.view, None), places, coloured, palette.vessel_point)
        });
        let up = up(&facts);
        let places: Vec<Vec3> = outcome.vessel.iter().map(|p| shown(p.place)).collect();
        let patch = Patch::new(&outcome.wall, &places, up);
        let mut content = Self {
            object: object.collect(),
            vessel: vessel.collect(),
            about_wall: by == ColourBy::Residual,
            chosen,
            picked: Default::default(),
            patch: Some(patch),
            grid: None,
            measured: Some((facts, outcome)),
        };
        content.grid = Grid::below(&content.extent(), up, content.front_direction());
        content
    }

    /// Everything that was measured, to be got into the picture.
    pub(super) fn extent(&self) -> Vec<Vec3> {
        let object = self.object.iter().flat_map(|p| [p.place, p.unrefracted]);
        let wall = self.patch.iter().flat_map(Patch::places);
        object.chain(wall).collect()
    }

    /// As [`Content::extent`], with the rig's stations.
    pub(super) fn whole_extent(&self) -> Vec<Vec3> {
        let rig = self
            .stands()
            .flat_map(|s| [vector(s.camera), vector(s.laser)]);
        self.extent().into_iter().chain(rig).collect()
    }

    /// A camera beside the rig.
    pub(super) fn front(&self) -> Orbit {
        match &self.measured {
            Some((facts, _)) => Orbit::facing(up(facts), self.front_direction()),
            None => Orbit::default(),
        }
    }

    /// From the scene towards the rig, across up.
    fn front_direction(&self) -> Vec3 {
        let Some((facts, outcome)) = &self.measured else {
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

    /// Cameras and the wall's edges.
    pub(super) fn solid_lines(&self, palette: &Palette) -> Vec<Line> {
        let size = self.station_size();
        let cameras = self
            .stands()
            .flat_map(|s| camera_lines(s, size, palette.station));
        let edges = self.patch.iter().flat_map(|p| p.edges(palette.wall_edge));
        cameras.chain(edges).collect()
    }

    /// The grid, and the beams up to the wall.
    pub(super) fn faint_lines(&self, palette: &Palette) -> Vec<Line> {
        let grid = self.grid.iter().flat_map(|g| g.lines(palette.grid));
        let beams = self.measured.iter().flat_map(|(facts, outcome)| {
            // Of a sheet of light, a few rays.
            let points = outcome.vessel.iter();
            let beams = points.step_by(outcome.vessel.len() / MOST_BEAMS + 1);
            beams.filter_map(|point| {
                let laser = vector(facts.stations[point.view].stand?.laser);
                Some(Line::new(laser, shown(point.place), palette.station_beam))
            })
        });
        grid.chain(beams).collect()
    }

    /// What refraction does: from where each point would be without it to where it is.
    pub(super) fn displacements(&self, palette: &Palette) -> Vec<Line> {
        let points = self.object.iter();
        let few = points.step_by(self.object.len() / MOST_BEAMS + 1);
        few.map(|p| Line::new(p.unrefracted, p.place, palette.displacement))
            .collect()
    }

    /// The slab of a section.
    pub(super) fn slab(&self, section: Section) -> Slab {
        let (Some((facts, _)), Some(axis)) = (&self.measured, section.axis) else {
            return Slab::ALL;
        };
        let (up, front) = (up(facts), self.front_direction());
        let normal = match axis {
            SectionAxis::Depth => -front,
            SectionAxis::Height => up,
            SectionAxis::Width => up.cross(front),
        };
        Slab::of(section, normal, &self.extent())
    }

    /// Error ellipsoids, so many times as large as they are; of very many points every so many-th.
    pub(super) fn ellipsoids(&self, magnified: f32) -> Vec<Line> {
        const MOST: usize = 400;
        let Some((_, outcome)) = &self.measured else {
            return Vec::new();
        };
        let points = outcome.object.iter().zip(&self.object);
        let few = points.step_by(outcome.object.len() / MOST + 1);
        few.flat_map(|(of, seen)| ellipsoid(seen.place, of.covariance, magnified, seen.colour))
            .collect()
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
        let ring = |point: &ScenePoint, colour| ScenePoint { colour, ..*point };
        let chosen = self
            .chosen
            .into_iter()
            .flat_map(|view| self.points_of(view));
        let mut rings: Vec<_> = chosen.map(|point| ring(point, palette.marker)).collect();
        for (face, picked) in self.picked.iter().enumerate() {
            let points = picked
                .iter()
                .filter_map(|(view, index)| self.points_of(*view).get(*index));
            rings.extend(points.map(|point| ring(point, palette.faces[face])));
        }
        rings
    }

    /// The object's points of a view.
    fn points_of(&self, view: usize) -> &[ScenePoint] {
        let views = self.measured.iter().flat_map(|(_, outcome)| &outcome.views);
        let points = views.into_iter().nth(view).map(|view| view.points.clone());
        points.map_or(&[], |points| &self.object[points])
    }

    /// How large points are drawn, CSS px: of many each is small.
    pub(super) fn point_size(&self) -> f32 {
        match self.object.len().max(self.vessel.len()) {
            0..3_000 => 9.0,
            3_000..30_000 => 5.0,
            _ => 3.0,
        }
    }

    /// The light of the chosen view, on the way from straight (0) to bent (1).
    pub(super) fn chosen_light(&self, palette: &Palette, refraction: f32) -> Vec<Line> {
        let Some((_, outcome)) = &self.measured else {
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
        self.measured.iter().flat_map(|(facts, _)| stands(facts))
    }
}

fn scene_point(
    (view, index): (usize, Option<usize>),
    [place, unrefracted]: [Vec3; 2],
    coloured: Option<([u8; 3], f32)>,
    plain: [f32; 4],
) -> ScenePoint {
    let (colour, fraction) = match coloured {
        Some((colour, fraction)) => (opaque(colour), fraction),
        None => (plain, MIDDLE),
    };
    ScenePoint {
        view,
        index,
        place,
        unrefracted,
        colour,
        fraction,
    }
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
