//! A scene as its TOML file states it.

use nalgebra::{UnitQuaternion, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::{Ghosts, Solid, rotation_from_degrees};
use crate::camera::Intrinsics;
use crate::geometry::{Camera, Direction, Flange, Point, Pose, Ray, World, ZeroLength};
use crate::optics::{self, Base, BaseShape, Freeform, Grid, Surface};
use crate::rig::{Calibration, Rig, Sheet};
use crate::scan::{
    CalibrationSigmaEntry, CameraEntry, FarWall, InsideMedium, KnownShape, LaserEntry, LengthUnit,
    Manifest, MediaEntry, Motion, PoseEntry, ScanError, ScanFormat, VesselEntry, VesselShape,
};
use crate::vessel::{NoRoom, Wall};

/// What is wrong with a scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// It is no TOML, or lacks something.
    #[error(transparent)]
    Toml(#[from] toml::de::Error),
    /// It makes no valid scan.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// There is no room for the wall.
    #[error(transparent)]
    NoRoom(#[from] NoRoom),
    /// A direction or rotation has no length.
    #[error("{key}: {problem}")]
    Direction {
        /// The key.
        key: &'static str,
        /// What is wrong.
        problem: ZeroLength,
    },
    /// A number is impossible.
    #[error("{key}: {problem}")]
    Value {
        /// The key.
        key: &'static str,
        /// What is wrong.
        problem: &'static str,
    },
}

/// A scene. Frames, units and signs are those of scan archives; the world's y axis points down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// What the scan is of.
    pub name: String,
    /// Where the noise starts from.
    #[serde(default)]
    pub seed: u64,
    /// Whether the manifest says what the liquid is.
    #[serde(default = "yes")]
    pub index_known: bool,
    /// The lens, as in `scan.json`.
    pub camera: CameraEntry,
    /// The laser, as in `scan.json`.
    pub laser: LaserEntry,
    /// Hand-eye calibration, as in `scan.json`.
    pub flange_from_camera: PoseEntry,
    /// The vessel.
    pub vessel: Vessel,
    /// Refractive indices.
    pub media: SceneMedia,
    /// What stands in the vessel.
    #[serde(default, rename = "object")]
    pub objects: Vec<SceneObject>,
    /// What turns the vessel before a rig that stands still; without it the rig moves.
    #[serde(default)]
    pub turntable: Option<Turntable>,
    /// Rows of stations.
    #[serde(rename = "sweep")]
    pub sweeps: Vec<Sweep>,
    /// The beam.
    #[serde(default)]
    pub beam: BeamProfile,
    /// The spots' light.
    #[serde(default)]
    pub brightness: Brightness,
    /// How the true range finder differs from what the manifest says of it.
    #[serde(default)]
    pub calibration_error: CalibrationError,
    /// What calibration is worth, as in `scan.json`.
    #[serde(default)]
    pub calibration_sigma: Option<CalibrationSigmaEntry>,
    /// What is known of the object, as in `scan.json`.
    #[serde(default)]
    pub known: Vec<KnownShape>,
    /// The light of the room.
    #[serde(default)]
    pub ambient: Ambient,
    /// The camera's noise.
    #[serde(default)]
    pub noise: PictureNoise,
    /// False spots.
    #[serde(default)]
    pub ghosts: Ghosts,
}

const fn yes() -> bool {
    true
}

/// Refractive indices.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneMedia {
    /// Around the rig.
    pub outside: f64,
    /// The wall.
    pub wall: f64,
    /// The liquid.
    pub inside: f64,
}

/// A vessel: a cuboid tank of which the rig sees the front wall, a round jar, a bowl, or one of these
/// with bulges and dents.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vessel {
    /// Plane, cylinder, sphere, or freeform: one of these with a `relief`.
    #[serde(default)]
    pub shape: VesselShape,
    /// What the manifest says of the shape; the truth if left out.
    #[serde(default)]
    pub declared: Option<VesselShape>,
    /// Thickness of the wall, mm.
    pub wall_thickness: f64,
    /// The middle of a front wall's outer face, a point of a jar's axis, the middle of a bowl; world
    /// frame, mm.
    pub centre: [f64; 3],
    /// How the vessel is turned: degrees about x, the turned y, the turned z. Unturned, a front wall
    /// faces -z and a jar's axis is y.
    #[serde(default)]
    pub rotation: [f64; 3],
    /// Half the width (of a front wall) and half the height (of a front wall or a jar), mm.
    pub half_size: [f64; 2],
    /// The outer radius of a jar or bowl, mm.
    #[serde(default)]
    pub radius: Option<f64>,
    /// What a free form has over a simple shape.
    #[serde(default)]
    pub relief: Option<Relief>,
    /// Whether the manifest says where the wall is. It has no words for a free form.
    #[serde(default)]
    pub known: bool,
    /// The wall behind the liquid: the objects stand behind it, in air.
    #[serde(default)]
    pub far_wall: Option<SceneFarWall>,
    /// The liquid's surface, world y, mm; above it (smaller y) there is air. Full if left out.
    #[serde(default)]
    pub level: Option<f64>,
    /// How far behind a front wall's inner face the tank's back wall lights up, mm. (A round vessel's back
    /// is where its shape has it.)
    #[serde(default)]
    pub depth: Option<f64>,
}

/// Bulges (and dents) of a wall: a uniform bicubic B-spline of heights over a simple shape, towards the rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Relief {
    /// What it stands on: plane, cylinder or sphere.
    pub over: VesselShape,
    /// From one control point to the next, along a row and from row to row, mm; on a round shape along it.
    pub step: [f64; 2],
    /// The control heights, mm, in rows from the top down; each row runs to the right as the rig sees it.
    /// Their middle is at the vessel's `centre` or, on a round shape, at its nearest to the unturned rig.
    /// The wall ends a step before the outermost ones.
    pub heights: Vec<Vec<f64>>,
}

/// A wall behind the liquid, parallel to the front one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFarWall {
    /// From inner face to inner face, mm.
    pub distance: f64,
    /// Millimetres.
    pub thickness: f64,
}

/// Something that stands in the vessel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum SceneObject {
    /// A box.
    Box {
        /// Its middle, mm.
        centre: [f64; 3],
        /// Half its edges, mm.
        half: [f64; 3],
        /// Degrees about x, the turned y, the turned z.
        #[serde(default)]
        rotation: [f64; 3],
    },
    /// A ball.
    Sphere {
        /// Its middle, mm.
        centre: [f64; 3],
        /// Millimetres.
        radius: f64,
    },
}

/// A turntable. The scene is as it stands at angle 0, where its frame is the world's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turntable {
    /// A point of the axis, mm.
    pub point: [f64; 3],
    /// Along the axis, any length but zero.
    pub axis: [f64; 3],
}

/// A row of stations, evenly spaced, all looking the same way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// The camera's first place, mm.
    pub from: [f64; 3],
    /// The camera's last place, mm.
    pub to: [f64; 3],
    /// How many stations.
    pub views: usize,
    /// How the camera is turned: degrees about x (pitch), the turned y (yaw), the turned z (roll).
    #[serde(default)]
    pub rotation: [f64; 3],
    /// The turntable's first and last angle, degrees about its axis.
    #[serde(default)]
    pub turn: [f64; 2],
}

/// The beam's cross-section and the lens's blur.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BeamProfile {
    /// Standard deviation of the beam's Gaussian cross-section, or of the sheet's thickness, mm.
    pub sigma: f64,
    /// How far the fan of a line laser opens, degrees.
    pub fan: f64,
    /// Standard deviation of the lens's blur, px.
    pub blur: f64,
    /// Contrast of the speckle of a beam's spots: the standard deviation of a grain's light over its mean, 1
    /// for fully developed speckle. Grains are a pixel wide, as the lens makes them whatever they lie on.
    pub speckle: f64,
}

impl Default for BeamProfile {
    fn default() -> Self {
        Self {
            sigma: 0.25,
            fan: 40.0,
            blur: 0.9,
            speckle: 0.0,
        }
    }
}

/// The light of the spots: grey values summed over their pixels; of a line, over a profile across it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Brightness {
    /// The glow of the wall's outer face.
    pub outer_face: f64,
    /// The glow of the wall's inner face.
    pub inner_face: f64,
    /// The glow of each face of a far wall.
    pub far_face: f64,
    /// The spot on the object.
    pub object: f64,
    /// The spot on the vessel's back, where the beam passes the object.
    pub back: f64,
}

impl Default for Brightness {
    fn default() -> Self {
        Self {
            outer_face: 500.0,
            inner_face: 150.0,
            far_face: 120.0,
            object: 900.0,
            back: 0.0,
        }
    }
}

/// An error of calibration: truth less manifest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CalibrationError {
    /// mm.
    pub laser_origin: [f64; 3],
    /// Degrees: within the plane of the beam and the camera's centre, away from the camera's axis; and
    /// across it.
    pub laser_direction: [f64; 2],
    /// px: across, down.
    pub focal_length: [f64; 2],
    /// px: across, down.
    pub principal_point: [f64; 2],
    /// Degrees, about the camera's axes.
    pub hand_eye_rotation: [f64; 3],
    /// mm.
    pub hand_eye_translation: [f64; 3],
}

impl CalibrationError {
    /// The true range finder.
    pub fn apply(&self, rig: &Rig) -> Rig {
        let steps = [
            (Calibration::FocalLength(0), self.focal_length[0]),
            (Calibration::FocalLength(1), self.focal_length[1]),
            (Calibration::PrincipalPoint(0), self.principal_point[0]),
            (Calibration::PrincipalPoint(1), self.principal_point[1]),
        ];
        let along = |axis: usize| {
            [
                (Calibration::LaserOrigin(axis), self.laser_origin[axis]),
                (
                    Calibration::HandEyeRotation(axis),
                    self.hand_eye_rotation[axis].to_radians(),
                ),
                (
                    Calibration::HandEyeTranslation(axis),
                    self.hand_eye_translation[axis],
                ),
            ]
        };
        let all = self.tilts(rig).into_iter().chain(steps);
        all.chain((0..3).flat_map(along))
            .fold(*rig, |rig, (number, step)| number.nudge(&rig, step))
    }

    /// The error of the laser's direction as tilts towards its two tangents.
    fn tilts(&self, rig: &Rig) -> [(Calibration, f64); 2] {
        let axis = rig.laser.axis();
        let (u, v) = axis.direction.tangents();
        let across = axis.origin.coords.cross(&axis.direction.vector());
        let across = across.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let within = axis.direction.vector().cross(&across);
        let [a, b] = self.laser_direction.map(f64::to_radians);
        let tilt = within * a + across * b;
        [
            (Calibration::LaserDirection(0), tilt.dot(&u)),
            (Calibration::LaserDirection(1), tilt.dot(&v)),
        ]
    }
}

/// The light of the room, grey values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ambient {
    /// Of the room behind and beside the vessel.
    pub background: f64,
    /// Of a white surface that faces the light.
    pub object: f64,
}

impl Default for Ambient {
    fn default() -> Self {
        Self {
            background: 14.0,
            object: 70.0,
        }
    }
}

/// The camera's noise: variance = read^2 + shot * grey value, grey values squared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PictureNoise {
    /// Standard deviation in the dark.
    pub read: f64,
    /// Variance per grey value of light.
    pub shot: f64,
}

impl Default for PictureNoise {
    fn default() -> Self {
        Self {
            read: 0.8,
            shot: 0.02,
        }
    }
}

impl Scene {
    /// Reads a scene.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        let scene: Self = toml::from_str(text)?;
        scene.check()?;
        Ok(scene)
    }

    fn check(&self) -> Result<(), SceneError> {
        let positive = |value: f64, key| {
            let problem = "must be greater than 0";
            if value > 0.0 {
                Ok(())
            } else {
                Err(SceneError::Value { key, problem })
            }
        };
        positive(self.beam.sigma, "beam.sigma")?;
        positive(self.beam.blur, "beam.blur")?;
        positive(self.beam.fan, "beam.fan")?;
        if !(0.0..=1.0).contains(&self.beam.speckle) {
            let problem = "must be from 0 to 1";
            return Err(SceneError::Value {
                key: "beam.speckle",
                problem,
            });
        }
        positive(self.vessel.half_size[0], "vessel.half_size")?;
        positive(self.vessel.half_size[1], "vessel.half_size")?;
        let dark = |value: f64, key| {
            let problem = "must be 0 or more";
            if value >= 0.0 {
                Ok(())
            } else {
                Err(SceneError::Value { key, problem })
            }
        };
        dark(self.noise.read, "noise.read")?;
        dark(self.noise.shot, "noise.shot")?;
        dark(self.brightness.outer_face, "brightness.outer_face")?;
        dark(self.brightness.inner_face, "brightness.inner_face")?;
        dark(self.brightness.far_face, "brightness.far_face")?;
        dark(self.brightness.object, "brightness.object")?;
        dark(self.brightness.back, "brightness.back")?;
        self.vessel
            .depth
            .map_or(Ok(()), |depth| positive(depth, "vessel.depth"))?;
        self.ghosts.check()
    }

    /// The manifest, without its views.
    pub(super) fn manifest(&self) -> Result<Manifest, SceneError> {
        Ok(Manifest {
            format: ScanFormat::RefractiveScan,
            version: 1,
            name: self.name.clone(),
            length_unit: LengthUnit::Millimetre,
            motion: self.motion(),
            camera: self.camera.clone(),
            laser: self.laser.clone(),
            flange_from_camera: self.flange_from_camera.clone(),
            calibration_sigma: self.calibration_sigma.clone(),
            vessel: self.vessel_entry()?,
            media: MediaEntry {
                outside: self.media.outside,
                wall: self.media.wall,
                inside: self.index_known.then_some(self.media.inside),
                extra: Default::default(),
            },
            known: self.known.clone(),
            views: Vec::new(),
            extra: Default::default(),
        })
    }

    /// The hand-eye calibration.
    pub(super) fn hand_eye(&self) -> Result<Pose<Flange, Camera>, SceneError> {
        let entry = &self.flange_from_camera;
        Pose::new(entry.rotation, entry.translation).map_err(|problem| SceneError::Direction {
            key: "flange_from_camera.rotation",
            problem,
        })
    }

    fn vessel_entry(&self) -> Result<VesselEntry, SceneError> {
        let vessel = &self.vessel;
        let mut entry = VesselEntry {
            shape: vessel.declared.unwrap_or(vessel.shape),
            wall_thickness: vessel.wall_thickness,
            point: None,
            normal: None,
            axis_point: None,
            axis: None,
            center: None,
            radius: None,
            far_wall: vessel.far_wall.map(|far| FarWall {
                distance: far.distance,
                thickness: far.thickness,
                extra: Default::default(),
            }),
            extra: Default::default(),
        };
        if vessel.known {
            match self.outer_face()? {
                Surface::Plane(plane) => {
                    entry.point = Some(plane.point.to_array());
                    entry.normal = Some(plane.normal.vector().into());
                }
                Surface::Cylinder(cylinder) => {
                    entry.axis_point = Some(cylinder.point.to_array());
                    entry.axis = Some(cylinder.axis.vector().into());
                    entry.radius = Some(cylinder.radius);
                }
                Surface::Sphere(sphere) => {
                    entry.center = Some(sphere.centre.to_array());
                    entry.radius = Some(sphere.radius);
                }
                Surface::Freeform(_) => {
                    return Err(SceneError::Value {
                        key: "vessel.known",
                        problem: "a scan archive has no words for a free form",
                    });
                }
            }
        }
        Ok(entry)
    }

    /// The true wall.
    pub(super) fn wall(&self) -> Result<Wall, SceneError> {
        let far = self.vessel.far_wall.map(|far| crate::vessel::FarWall {
            distance: far.distance,
            thickness: far.thickness,
        });
        Ok(Wall::exact(
            self.outer_face()?,
            self.vessel.wall_thickness,
            far,
        ))
    }

    fn outer_face(&self) -> Result<Surface, SceneError> {
        match (self.vessel.shape, &self.vessel.relief) {
            (VesselShape::Freeform, Some(relief)) => {
                let base = self.base(relief.over, "vessel.relief.over")?;
                Ok(Surface::Freeform(relief.over_base(base)?))
            }
            (VesselShape::Freeform, None) => Err(SceneError::Value {
                key: "vessel.relief",
                problem: "a free form needs one",
            }),
            (simple, _) => Ok(self.base(simple, "vessel.shape")?.surface()),
        }
    }

    /// A simple shape, with coordinates to the right and down as the rig sees it.
    fn base(&self, shape: VesselShape, key: &'static str) -> Result<Base, SceneError> {
        let turn = rotation_from_degrees(self.vessel.rotation);
        let centre = Point::from(self.vessel.centre);
        let normal = Direction::assume_unit(turn * -Vector3::z());
        let (origin, shape) = match shape {
            VesselShape::Plane => (centre, BaseShape::Plane),
            VesselShape::Cylinder => {
                let radius = self.radius()?;
                (centre + normal * radius, BaseShape::Cylinder { radius })
            }
            VesselShape::Sphere => {
                let radius = self.radius()?;
                (centre + normal * radius, BaseShape::Sphere { radius })
            }
            VesselShape::Freeform | VesselShape::Auto => {
                return Err(SceneError::Value {
                    key,
                    problem: "must be plane, cylinder, sphere, or (vessel.shape) freeform",
                });
            }
        };
        Ok(Base {
            origin,
            normal,
            tangents: [turn * Vector3::x(), turn * Vector3::y()],
            shape,
        })
    }

    fn radius(&self) -> Result<f64, SceneError> {
        let wide = |radius: &f64| *radius > self.vessel.wall_thickness;
        self.vessel.radius.filter(wide).ok_or(SceneError::Value {
            key: "vessel.radius",
            problem: "a round vessel needs it, and it must be more than the wall's thickness",
        })
    }

    /// What stands in the vessel.
    pub(super) fn solids(&self) -> Result<Vec<Solid>, SceneError> {
        self.objects.iter().map(Solid::new).collect()
    }

    /// The camera's poses as seen from the vessel.
    pub(super) fn stations(&self) -> Result<Vec<Pose<World, Camera>>, SceneError> {
        let mut stations = Vec::new();
        for sweep in &self.sweeps {
            let rotation = rotation_from_degrees(sweep.rotation);
            let (from, to) = (Vector3::from(sweep.from), Vector3::from(sweep.to));
            let last = sweep.views.saturating_sub(1).max(1) as f64;
            for index in 0..sweep.views {
                let part = index as f64 / last;
                let rig = Pose::from_parts(rotation, from + (to - from) * part);
                let turn = sweep.turn[0] + (sweep.turn[1] - sweep.turn[0]) * part;
                stations.push(self.turned(turn)?.inverse() * rig);
            }
        }
        Ok(stations)
    }

    /// How the turntable has moved the vessel at an angle, degrees.
    fn turned(&self, degrees: f64) -> Result<Pose<World, World>, SceneError> {
        let Some(table) = &self.turntable else {
            return Ok(Pose::identity());
        };
        let axis = Direction::<World>::new(table.axis.into()).map_err(|problem| {
            let key = "turntable.axis";
            SceneError::Direction { key, problem }
        })?;
        let rotation = UnitQuaternion::from_scaled_axis(axis.vector() * degrees.to_radians());
        let point = Vector3::from(table.point);
        Ok(Pose::from_parts(rotation, point - rotation * point))
    }

    /// What moves from view to view.
    pub(super) const fn motion(&self) -> Motion {
        match self.turntable {
            Some(_) => Motion::Vessel,
            None => Motion::Rig,
        }
    }

    /// What is behind the wall at a height.
    pub(super) fn medium_at(&self, point: Point<World>) -> InsideMedium {
        match self.vessel.level {
            Some(level) if point.coords.y < level => InsideMedium::Air,
            _ => InsideMedium::Liquid,
        }
    }
}

impl Relief {
    fn over_base(&self, base: Base) -> Result<Freeform, SceneError> {
        const KEY: &str = "vessel.relief.heights";
        let fault = |key, problem| Err(SceneError::Value { key, problem });
        let (rows, columns) = (self.heights.len(), self.heights.first().map_or(0, Vec::len));
        if rows < 4 || columns < 4 {
            return fault(KEY, "needs at least four rows of four control heights");
        }
        if self.heights.iter().any(|row| row.len() != columns) {
            return fault(
                KEY,
                "every row must have as many control heights as the first",
            );
        }
        if !self.step.iter().all(|step| *step > 0.0) {
            return fault("vessel.relief.step", "must be greater than 0");
        }
        let step = Vector2::from(self.step);
        let half = 0.5 * Vector2::new((columns - 3) as f64, (rows - 3) as f64).component_mul(&step);
        let corner = |x: f64, y: f64| Vector2::new(x * half.x, y * half.y);
        Ok(Freeform::new(optics::Sheet {
            base,
            grid: Grid {
                start: -half,
                step,
                columns,
                rows,
            },
            heights: self.heights.concat(),
            patch: vec![
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ],
        }))
    }
}

impl BeamProfile {
    /// The rays of a sheet's fan, fine enough for a picture to show an even line, in their order along
    /// it: at each angle those through the sheet's thickness with their shares of the light, which add up
    /// to 1.
    pub(super) fn fan(&self, sheet: &Sheet, camera: &Intrinsics) -> Vec<Vec<(Ray<Camera>, f64)>> {
        /// Millimetres of light a radian apart are about the focal length in pixels apart.
        const PER_PIXEL: f64 = 1.5;
        const HALF: i32 = 3;
        const REACH: f64 = 2.5;
        let opening = self.fan.to_radians();
        let steps = (opening * camera.mean_focal() * PER_PIXEL).ceil();
        let offsets = (-HALF..=HALF).map(|i| f64::from(i) * REACH / f64::from(HALF));
        let shares: Vec<(f64, f64)> = offsets.map(|z| (z, libm::exp(-0.5 * z * z))).collect();
        let total: f64 = shares.iter().map(|(_, share)| share).sum();
        let at = |step: usize| {
            let ray = sheet.ray_at((step as f64 / steps - 0.5) * opening);
            let beside = |(z, share): &(f64, f64)| {
                let origin = ray.origin + sheet.normal * (z * self.sigma);
                (Ray::new(origin, ray.direction), share / total)
            };
            shares.iter().map(beside).collect()
        };
        (0..=steps as usize).map(at).collect()
    }

    /// The beam as a bundle of parallel rays with their shares of the light, which add up to 1.
    pub(super) fn rays(&self, beam: &Ray<Camera>) -> Vec<(Ray<Camera>, f64)> {
        const HALF: i32 = 4;
        const REACH: f64 = 2.5;
        let (u, v) = beam.direction.tangents();
        let step = REACH * self.sigma / f64::from(HALF);
        let mut rays = Vec::new();
        for i in -HALF..=HALF {
            for j in -HALF..=HALF {
                let (a, b) = (f64::from(i) * step, f64::from(j) * step);
                let share = libm::exp(-0.5 * (a * a + b * b) / (self.sigma * self.sigma));
                rays.push((Ray::new(beam.origin + u * a + v * b, beam.direction), share));
            }
        }
        let total: f64 = rays.iter().map(|(_, share)| share).sum();
        rays.iter_mut().for_each(|(_, share)| *share /= total);
        rays
    }
}
