//! What a worker tells the page of a scan: numbers to show, none that the page would have to compute.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use snellius::camera::{Pixel, Slope};
use snellius::export::{LineResult, ShapeChoiceResult, SpotResult, SpotRole, Status, ViewResult};
use snellius::geometry::{Camera, Direction, Point, Pose, World};
use snellius::index::IndexMethod;
use snellius::optics::Surface;
use snellius::pipeline::{LightPaths, Reconstruction, Summary, Warning};
use snellius::scan::{Scan, VesselShape, sweeps};

use super::columns;
use super::mesh::Mesh;
use super::packed::{self, Packed};

/// A place in the world, mm.
pub(crate) type Place = [f64; 3];

/// What is known of a scan before anything is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Facts {
    /// What the scan is of.
    pub(crate) name: String,
    /// The liquid's index, if the manifest says it.
    pub(crate) given_index: Option<f64>,
    /// The wall's shape, as the manifest says.
    pub(crate) declared_shape: VesselShape,
    /// Picture width and height, px.
    pub(crate) picture: [u32; 2],
    /// The beam's image in air, px; empty for a line laser.
    pub(crate) epipolar_line: Vec<[f64; 2]>,
    /// How many sweeps there are.
    pub(crate) sweeps: usize,
    /// The stations, in the manifest's order.
    #[serde(skip)]
    pub(crate) stations: Vec<StationFacts>,
    /// The session that was packed with the scan, as it is written down.
    pub(crate) session: Option<String>,
}

/// A view, and where it was taken from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StationFacts {
    /// The view's id.
    pub(crate) id: String,
    /// The sweep it belongs to, from 0.
    pub(crate) sweep: usize,
    /// Where the rig stood; not known of a reconstruction that came in a link.
    pub(crate) stand: Option<Stand>,
}

/// Where the rig stood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stand {
    /// The camera's centre.
    pub(crate) camera: Place,
    /// The picture's corners as seen from the camera, a millimetre ahead; clockwise from top left.
    pub(crate) corners: [Place; 4],
    /// Where the laser stands.
    pub(crate) laser: Place,
    /// Down the picture, in the world.
    pub(crate) down: Place,
    /// Ahead of the camera, in the world.
    pub(crate) ahead: Place,
}

/// A measured scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Outcome {
    /// The liquid's index that was used.
    pub(crate) index: Index,
    /// The wall.
    pub(crate) wall: Wall,
    /// The result in a few numbers.
    pub(crate) summary: Summary,
    /// The views, in the manifest's order.
    #[serde(skip)]
    pub(crate) views: Vec<ViewOutcome>,
    /// The object's points, view after view.
    #[serde(skip)]
    pub(crate) object: Vec<ObjectPoint>,
    /// The wall's points, view after view.
    #[serde(skip)]
    pub(crate) vessel: Vec<VesselPoint>,
    /// What to know before trusting it.
    pub(crate) warnings: Vec<Warning>,
}

/// A part of the long lists of facts and outcome, which are sent ahead of the rest. The page takes one after
/// the other, each in a task of its own: a million points in one task would keep it from everything else.
#[derive(Serialize, Deserialize)]
pub(crate) enum Piece {
    Stations(#[serde(with = "columns::stations")] Vec<StationFacts>),
    Views(#[serde(with = "columns::views")] Vec<ViewOutcome>),
    Object(#[serde(with = "packed")] Vec<ObjectPoint>),
    Vessel(#[serde(with = "packed")] Vec<VesselPoint>),
}

/// Takes a list apart, and leaves it empty.
fn pieces<T>(list: &mut Vec<T>, most: usize, piece: fn(Vec<T>) -> Piece) -> Vec<Piece> {
    let mut rest = std::mem::take(list).into_iter();
    let mut pieces = Vec::new();
    while rest.len() > 0 {
        pieces.push(piece(rest.by_ref().take(most).collect()));
    }
    pieces
}

/// Views, or stations, that the page takes in some milliseconds.
const VIEWS: usize = 100;
/// Likewise, of points.
const POINTS: usize = 16_384;

/// The liquid's index, and what it is worth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Index {
    pub(crate) value: f64,
    /// One standard deviation; missing where the index was given.
    pub(crate) sigma: Option<f64>,
    pub(crate) method: IndexMethod,
}

/// The vessel's wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Wall {
    /// The outer face.
    pub(crate) face: Face,
    /// What `auto` decided between.
    pub(crate) choice: Option<ShapeChoiceResult>,
    /// Whether the scan says where it is.
    pub(crate) known: bool,
    /// As the scan gives it, mm.
    pub(crate) thickness: f64,
    /// What the wall's two glows suggest, mm.
    pub(crate) thickness_of_glows: Option<f64>,
    /// Root mean square distance of the vessel points from it, mm.
    pub(crate) rms: f64,
    /// How many vessel points carry it.
    pub(crate) points: usize,
}

/// A place as a screen shows it, mm.
pub(crate) type Shown = [f32; 3];

/// A point of the object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ObjectPoint {
    /// The view that shows it.
    pub(crate) view: usize,
    /// Where it is.
    pub(crate) place: Shown,
    /// Where it would lie if refraction were ignored.
    pub(crate) unrefracted: Shown,
    /// Its covariance from the pictures' noise: xx, xy, xz, yy, yz, zz, mm^2.
    pub(crate) covariance: [f32; 6],
    /// How far its two light paths pass each other, mm.
    pub(crate) ray_distance: f32,
    /// How far behind the wall's inner face it lies, mm.
    pub(crate) depth: f32,
}

/// A point of the wall's outer face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VesselPoint {
    /// The view that shows it.
    pub(crate) view: usize,
    /// Where it is.
    pub(crate) place: Shown,
    /// How far in front of the fitted wall, mm.
    pub(crate) residual: f32,
}

/// A wall's outer face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Face {
    /// Flat; the unit normal points towards the rig.
    Plane { point: Place, normal: Place },
    /// Round about an axis.
    Cylinder {
        point: Place,
        axis: Place,
        radius: f64,
    },
    /// Round about a centre.
    Sphere { centre: Place, radius: f64 },
    /// Any smooth form.
    Freeform(Mesh),
}

/// What a view gave.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ViewOutcome {
    /// What became of it.
    pub(crate) status: Status,
    /// Why it has no object point.
    pub(crate) reason: Option<String>,
    /// Its spots, brightest first.
    pub(crate) spots: Vec<Spot>,
    /// Why spots were refused: the spot, and the reason.
    pub(crate) reasons: Vec<(usize, String)>,
    /// Which of the object's points are its own.
    pub(crate) points: Range<usize>,
    /// The laser's light to the middle one of them, bent at every face.
    pub(crate) beam: Vec<Place>,
    /// The line of sight to it, bent at every face.
    pub(crate) sight: Vec<Place>,
}

/// Of a line's thousands of points nobody reads every reason.
const MOST_REASONS: usize = 64;

/// A spot in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spot {
    /// Its centroid, px.
    pub(crate) pixel: [f32; 2],
    /// What it is.
    pub(crate) role: SpotRole,
}

impl Facts {
    /// Takes the long list away.
    pub(super) fn take_apart(&mut self) -> Vec<Piece> {
        pieces(&mut self.stations, VIEWS, Piece::Stations)
    }

    /// Puts it back.
    pub(super) fn put_together(&mut self, pieces: Vec<Piece>) {
        for piece in pieces {
            if let Piece::Stations(stations) = piece {
                self.stations.extend(stations);
            }
        }
    }

    pub(crate) fn of(scan: &Scan) -> Self {
        let sweep_of = sweeps(&scan.stations);
        let manifest = &scan.manifest;
        let stations = scan.stations.iter().zip(&manifest.views).zip(&sweep_of);
        Self {
            name: manifest.name.clone(),
            session: None,
            given_index: manifest.media.inside,
            declared_shape: manifest.vessel.shape,
            picture: [manifest.camera.width, manifest.camera.height],
            epipolar_line: epipolar_line(scan),
            sweeps: sweep_of.iter().max().map_or(0, |last| last + 1),
            stations: stations
                .map(|((station, view), sweep)| {
                    station_facts(scan, &station.world_from_camera, &view.id, *sweep)
                })
                .collect(),
        }
    }
}

fn epipolar_line(scan: &Scan) -> Vec<[f64; 2]> {
    let line = scan.rig.epipolar_line().into_iter();
    line.flat_map(|line| line.polyline(&scan.rig.camera))
        .map(|pixel| [pixel.u, pixel.v])
        .collect()
}

fn station_facts(scan: &Scan, pose: &Pose<World, Camera>, id: &str, sweep: usize) -> StationFacts {
    StationFacts {
        id: id.to_owned(),
        sweep,
        stand: Some(stand(scan, pose)),
    }
}

fn stand(scan: &Scan, pose: &Pose<World, Camera>) -> Stand {
    let camera = &scan.rig.camera;
    let (right, bottom) = (f64::from(camera.width), f64::from(camera.height));
    let corner = |u: f64, v: f64| {
        // A corner beyond the lens model's range is drawn where a lens without distortion had it.
        let pixel = Pixel::new(u - 0.5, v - 0.5);
        let slope = camera.slope(pixel).unwrap_or(Slope {
            x: (pixel.u - camera.centre.u) / camera.focal[0],
            y: (pixel.v - camera.centre.v) / camera.focal[1],
        });
        pose.point(Point::from_coords(slope.homogeneous()))
            .to_array()
    };
    Stand {
        camera: pose.point(Point::origin()).to_array(),
        corners: [
            corner(0.0, 0.0),
            corner(right, 0.0),
            corner(right, bottom),
            corner(0.0, bottom),
        ],
        laser: pose.point(scan.rig.laser.origin()).to_array(),
        down: axis(pose, [0.0, 1.0, 0.0]),
        ahead: axis(pose, [0.0, 0.0, 1.0]),
    }
}

fn axis(pose: &Pose<World, Camera>, axis: Place) -> Place {
    let unit = Direction::new(axis.into()).expect("an axis has a direction");
    pose.direction(unit).vector().into()
}

impl Outcome {
    /// Takes the long lists away.
    pub(super) fn take_apart(&mut self) -> Vec<Piece> {
        let mut all = pieces(&mut self.views, VIEWS, Piece::Views);
        all.extend(pieces(&mut self.object, POINTS, Piece::Object));
        all.extend(pieces(&mut self.vessel, POINTS, Piece::Vessel));
        all
    }

    /// Puts them back.
    pub(super) fn put_together(&mut self, pieces: Vec<Piece>) {
        for piece in pieces {
            match piece {
                Piece::Stations(_) => {}
                Piece::Views(views) => self.views.extend(views),
                Piece::Object(points) => self.object.extend(points),
                Piece::Vessel(points) => self.vessel.extend(points),
            }
        }
    }

    pub(crate) fn of(reconstruction: &Reconstruction) -> Self {
        let result = reconstruction.result();
        let mut object = Vec::new();
        let views = result.views.into_iter().enumerate().map(|(view, result)| {
            let first = object.len();
            object.extend(object_points(reconstruction, view));
            view_outcome(reconstruction, view, result, first..object.len())
        });
        Self {
            index: Index {
                value: reconstruction.media.liquid,
                sigma: reconstruction.index.sigma,
                method: reconstruction.index.method,
            },
            views: views.collect(),
            object,
            vessel: vessel_points(reconstruction),
            wall: Wall {
                face: face(&reconstruction.vessel.wall),
                choice: result.vessel.choice,
                known: reconstruction.vessel.known,
                thickness: result.vessel.wall_thickness,
                thickness_of_glows: result.vessel.glow.and_then(|glow| glow.thickness),
                rms: result.vessel.rms,
                points: result.vessel.points,
            },
            summary: reconstruction.summary(),
            warnings: reconstruction.warnings(),
        }
    }

    /// The object's points of a view.
    pub(crate) fn points_of(&self, view: usize) -> &[ObjectPoint] {
        let points = self.views.get(view).map(|view| view.points.clone());
        points.map_or(&[], |points| &self.object[points])
    }

    /// The point that stands for a view: the middle one of a line.
    pub(crate) fn point_of(&self, view: usize) -> Option<&ObjectPoint> {
        let points = self.points_of(view);
        points.get(points.len() / 2)
    }
}

impl ObjectPoint {
    /// The length of the three standard deviations together, mm.
    pub(crate) fn sigma(&self) -> f32 {
        let [xx, _, _, yy, _, zz] = self.covariance;
        (xx + yy + zz).sqrt()
    }
}

impl Face {
    /// Its shape.
    pub(crate) const fn shape(&self) -> VesselShape {
        match self {
            Self::Plane { .. } => VesselShape::Plane,
            Self::Cylinder { .. } => VesselShape::Cylinder,
            Self::Sphere { .. } => VesselShape::Sphere,
            Self::Freeform(_) => VesselShape::Freeform,
        }
    }
}

impl Packed for ObjectPoint {
    const COUNT: usize = 15;

    fn pack(&self, numbers: &mut Vec<f32>) {
        numbers.push(self.view as f32);
        numbers.extend(self.place.iter().chain(&self.unrefracted));
        numbers.extend(self.covariance);
        numbers.extend([self.ray_distance, self.depth]);
    }

    fn unpack(n: &[f32]) -> Self {
        Self {
            view: n[0] as usize,
            place: [n[1], n[2], n[3]],
            unrefracted: [n[4], n[5], n[6]],
            covariance: [n[7], n[8], n[9], n[10], n[11], n[12]],
            ray_distance: n[13],
            depth: n[14],
        }
    }
}

impl Spot {
    pub(super) fn of(spot: &SpotResult) -> Self {
        Self {
            pixel: spot.pixel.map(|p| p as f32),
            role: spot.role,
        }
    }
}

impl Packed for Spot {
    const COUNT: usize = 3;

    fn pack(&self, numbers: &mut Vec<f32>) {
        let role = match self.role {
            SpotRole::Vessel => 0.0,
            SpotRole::Object => 1.0,
            SpotRole::Stray => 2.0,
        };
        numbers.extend([self.pixel[0], self.pixel[1], role]);
    }

    fn unpack(n: &[f32]) -> Self {
        Self {
            pixel: [n[0], n[1]],
            role: match n[2] {
                0.0 => SpotRole::Vessel,
                1.0 => SpotRole::Object,
                _ => SpotRole::Stray,
            },
        }
    }
}

impl Packed for VesselPoint {
    const COUNT: usize = 5;

    fn pack(&self, numbers: &mut Vec<f32>) {
        numbers.push(self.view as f32);
        numbers.extend(self.place);
        numbers.push(self.residual);
    }

    fn unpack(n: &[f32]) -> Self {
        Self {
            view: n[0] as usize,
            place: [n[1], n[2], n[3]],
            residual: n[4],
        }
    }
}

pub(super) fn face(wall: &snellius::vessel::Wall) -> Face {
    match &wall.outer {
        Surface::Plane(plane) => Face::Plane {
            point: plane.point.to_array(),
            normal: plane.normal.vector().into(),
        },
        Surface::Cylinder(cylinder) => Face::Cylinder {
            point: cylinder.point.to_array(),
            axis: cylinder.axis.vector().into(),
            radius: cylinder.radius,
        },
        Surface::Sphere(sphere) => Face::Sphere {
            centre: sphere.centre.to_array(),
            radius: sphere.radius,
        },
        Surface::Freeform(freeform) => Face::Freeform(Mesh::of(freeform, wall.thickness)),
    }
}

fn object_points<'a>(
    reconstruction: &'a Reconstruction,
    view: usize,
) -> impl Iterator<Item = ObjectPoint> + 'a {
    let wall = &reconstruction.vessel.wall;
    let points = reconstruction.object[view].points.iter();
    let places = points.zip(&reconstruction.unrefracted[view]);
    places.map(move |(point, unrefracted)| {
        let place = point.meeting.point();
        let c = &point.noise.covariance;
        let covariance = [c.m11, c.m12, c.m13, c.m22, c.m23, c.m33];
        ObjectPoint {
            view,
            place: shown(place.to_array()),
            unrefracted: shown(unrefracted.unwrap_or(place).to_array()),
            covariance: covariance.map(|value| value as f32),
            ray_distance: point.meeting.gap().abs() as f32,
            depth: (-wall.outer.signed_distance(place) - wall.thickness) as f32,
        }
    })
}

fn vessel_points(reconstruction: &Reconstruction) -> Vec<VesselPoint> {
    let views = reconstruction.vessel.points.iter().enumerate();
    let points = views.flat_map(|(view, points)| points.iter().map(move |point| (view, point)));
    points
        .map(|(view, point)| VesselPoint {
            view,
            place: shown(point.point.to_array()),
            residual: point.residual as f32,
        })
        .collect()
}

fn view_outcome(
    reconstruction: &Reconstruction,
    view: usize,
    result: ViewResult,
    points: Range<usize>,
) -> ViewOutcome {
    let light = reconstruction.light_paths(view);
    let (beam, sight) = light.map_or_else(Default::default, |LightPaths { beam, sight }| {
        (places(&beam), places(&sight))
    });
    let spots = result.spots.iter();
    let refused = result.spots.iter().enumerate().filter_map(|(index, spot)| {
        let reason = spot.reason.clone()?;
        Some((index, reason))
    });
    ViewOutcome {
        status: result.status,
        reason: result.reason,
        spots: match &result.line {
            Some(line) => line_spots(line),
            None => spots.map(Spot::of).collect(),
        },
        reasons: refused.take(MOST_REASONS).collect(),
        points,
        beam,
        sight,
    }
}

/// The points of a line: the wall's, the object's, the others.
pub(super) fn line_spots(line: &LineResult) -> Vec<Spot> {
    let roles = [
        (&line.vessel, SpotRole::Vessel),
        (&line.object, SpotRole::Object),
        (&line.stray, SpotRole::Stray),
    ];
    let of_role = |(pixels, role): (&Vec<[f64; 2]>, SpotRole)| -> Vec<Spot> {
        let spot = |pixel: &[f64; 2]| Spot {
            pixel: pixel.map(|p| p as f32),
            role,
        };
        pixels.iter().map(spot).collect()
    };
    roles.into_iter().flat_map(of_role).collect()
}

pub(super) fn places(points: &[Point<World>]) -> Vec<Place> {
    points.iter().map(|point| point.to_array()).collect()
}

pub(super) fn shown(place: Place) -> Shown {
    place.map(|part| part as f32)
}
