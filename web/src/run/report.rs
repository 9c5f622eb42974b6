//! What a worker tells the page of a scan: numbers to show, none that the page would have to compute.

use serde::{Deserialize, Serialize};
use snellius::camera::{Pixel, Slope};
use snellius::export::ViewResult;
use snellius::geometry::{Camera, Direction, Point, Pose, World};
use snellius::optics::Surface;
use snellius::pipeline::{LightPaths, Reconstruction, Summary};
use snellius::scan::{Scan, sweeps};

use super::mesh::Mesh;

/// A place in the world, mm.
pub(crate) type Place = [f64; 3];

/// What is known of a scan before anything is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Facts {
    /// What the scan is of.
    pub(crate) name: String,
    /// The liquid's index, if the manifest says it.
    pub(crate) given_index: Option<f64>,
    /// Picture width and height, px.
    pub(crate) picture: [u32; 2],
    /// The beam's image in air, px; empty for a line laser.
    pub(crate) epipolar_line: Vec<[f64; 2]>,
    /// How many sweeps there are.
    pub(crate) sweeps: usize,
    /// The stations, in the manifest's order.
    pub(crate) stations: Vec<StationFacts>,
}

/// Where a view was taken from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StationFacts {
    /// The view's id.
    pub(crate) id: String,
    /// The sweep it belongs to, from 0.
    pub(crate) sweep: usize,
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
    pub(crate) index: f64,
    /// The wall.
    pub(crate) wall: Wall,
    /// The result in a few numbers.
    pub(crate) summary: Summary,
    /// The views, in the manifest's order.
    pub(crate) views: Vec<ViewOutcome>,
    /// What to know before trusting it.
    pub(crate) warnings: Vec<String>,
}

/// The vessel's wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Wall {
    /// The outer face.
    pub(crate) face: Face,
    /// Millimetres.
    pub(crate) thickness: f64,
    /// Root mean square distance of the vessel points from it, mm.
    pub(crate) rms: f64,
    /// How many vessel points carry it.
    pub(crate) points: usize,
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ViewOutcome {
    /// As in the result file.
    pub(crate) result: ViewResult,
    /// Where each of the object's points would lie if refraction were ignored.
    pub(crate) unrefracted: Vec<Option<Place>>,
    /// How far behind the wall's inner face each of them lies, mm.
    pub(crate) depth: Vec<f64>,
    /// The laser's light to the middle one, bent at every face.
    pub(crate) beam: Vec<Place>,
    /// The line of sight to it, bent at every face.
    pub(crate) sight: Vec<Place>,
}

impl ViewOutcome {
    /// The point that stands for the view: the middle one of a line.
    pub(crate) fn middle(&self) -> usize {
        self.result.object.as_slice().len() / 2
    }
}

impl Facts {
    pub(crate) fn of(scan: &Scan) -> Self {
        let sweep_of = sweeps(&scan.stations);
        let manifest = &scan.manifest;
        let stations = scan.stations.iter().zip(&manifest.views).zip(&sweep_of);
        Self {
            name: manifest.name.clone(),
            given_index: manifest.media.inside,
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
    StationFacts {
        id: id.to_owned(),
        sweep,
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
    pub(crate) fn of(reconstruction: &Reconstruction) -> Self {
        let result = reconstruction.result();
        let wall = Wall {
            face: face(&reconstruction.vessel.wall),
            thickness: result.vessel.wall_thickness,
            rms: result.vessel.rms,
            points: result.vessel.points,
        };
        let views = result.views.into_iter().enumerate();
        Self {
            index: reconstruction.media.liquid,
            wall,
            summary: reconstruction.summary(),
            views: views
                .map(|(view, result)| view_outcome(reconstruction, view, result))
                .collect(),
            warnings: result.warnings,
        }
    }
}

fn face(wall: &snellius::vessel::Wall) -> Face {
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

fn view_outcome(reconstruction: &Reconstruction, view: usize, result: ViewResult) -> ViewOutcome {
    let wall = &reconstruction.vessel.wall;
    let depth = |object: Place| -wall.outer.signed_distance(object.into()) - wall.thickness;
    let unrefracted = reconstruction.unrefracted[view].iter();
    let light = reconstruction.light_paths(view);
    let (beam, sight) = light.map_or_else(Default::default, |LightPaths { beam, sight }| {
        (places(&beam), places(&sight))
    });
    ViewOutcome {
        unrefracted: unrefracted.map(|p| p.map(Point::to_array)).collect(),
        depth: result.object.iter().copied().map(depth).collect(),
        beam,
        sight,
        result,
    }
}

fn places(points: &[Point<World>]) -> Vec<Place> {
    points.iter().map(|point| point.to_array()).collect()
}
