//! Scenes -> scans with ground truth: pictures with noise, both glows of the wall, ambient light.
//!
//! Each laser spot is drawn as light makes it: the beam's cross-section is sampled, each sample is
//! traced to the surface it lands on, and the place where the camera sees that through the wall gets the
//! lens's blur. Spots on oblique faces come out oblique.

mod ideal;
mod noise;
mod render;
mod scene;
mod shapes;
mod truth;

pub use scene::{
    Ambient, BeamProfile, Brightness, CalibrationError, PictureNoise, Scene, SceneError,
    SceneMedia, SceneObject, Sweep, Turntable, Vessel,
};
pub use shapes::Solid;
pub use truth::{Truth, TruthView};

use nalgebra::UnitQuaternion;

use crate::camera::Pixel;
use crate::geometry::{Camera, Frame, Point, Pose, Ray, World};
use crate::optics::{Media, Stack, aim_through};
use crate::rig::Rig;
use crate::scan::{InsideMedium, Manifest, Motion, PicturePair, PoseEntry, Scan, ViewEntry};
use crate::vessel::Wall;
use render::Exposure;

/// A scene ready to be photographed.
#[derive(Clone, Debug)]
pub struct Simulation {
    scene: Scene,
    scan: Scan,
    wall: Wall,
    media: Media,
    solids: Vec<Solid>,
}

/// Where the laser's light lands in a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Landing {
    outer: Option<Point<World>>,
    inner: Option<Point<World>>,
    object: Option<Point<World>>,
}

impl Simulation {
    /// Checks a scene and lays out its stations.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        let mut manifest = scene.manifest()?;
        let wall = scene.wall()?;
        let solids = scene.solids()?;
        let media = Media {
            outside: scene.media.outside,
            wall: scene.media.wall,
            liquid: scene.media.inside,
        };
        let poses = scene.stations()?;
        manifest.views = poses
            .iter()
            .enumerate()
            .map(|(index, pose)| scene.view_entry(index, pose))
            .collect::<Result<_, _>>()?;
        let mut simulation = Self {
            scan: Scan::new(manifest)?,
            scene,
            wall,
            media,
            solids,
        };
        simulation.note_media()?;
        let rig = simulation
            .scene
            .calibration_error
            .apply(&simulation.scan.rig);
        Ok(simulation.with_rig(rig))
    }

    /// The same scene photographed with a range finder other than the manifest says.
    pub fn with_rig(mut self, rig: Rig) -> Self {
        self.scan.rig = rig;
        for station in &mut self.scan.stations {
            station.world_from_camera = rig.station(&station.world_from_flange);
        }
        self
    }

    /// The range finder that takes the pictures.
    pub const fn rig(&self) -> &Rig {
        &self.scan.rig
    }

    /// Notes for each view what the beam enters behind the wall.
    fn note_media(&mut self) -> Result<(), SceneError> {
        let mut manifest = self.scan.manifest.clone();
        for (view, entry) in manifest.views.iter_mut().enumerate() {
            entry.inside = self.medium(view);
        }
        self.scan = Scan::new(manifest)?;
        Ok(())
    }

    /// The manifest of the scan.
    pub fn manifest(&self) -> &Manifest {
        &self.scan.manifest
    }

    /// How many views there are.
    pub fn views(&self) -> usize {
        self.scan.stations.len()
    }

    /// Takes the two pictures of a view.
    pub fn pictures(&self, view: usize) -> PicturePair {
        let station = &self.scan.stations[view];
        let dark = render::ambient(self, &station.world_from_camera);
        let mut lit = dark.clone();
        self.add_laser(view, &mut lit);
        PicturePair {
            on: lit.develop(&self.scene.noise, noise::seed(self.scene.seed, view, true)),
            off: Some(dark.develop(&self.scene.noise, noise::seed(self.scene.seed, view, false))),
        }
    }

    /// What is true of the scan.
    pub fn truth(&self) -> Truth {
        truth::of(self)
    }

    /// What the beam of a view enters: air if it meets the inner face above the liquid's level.
    fn medium(&self, view: usize) -> InsideMedium {
        let station = &self.scan.stations[view];
        let axis = self.scan.rig.laser.axis();
        let beam = station.world_from_camera.ray(&axis);
        match self.through(InsideMedium::Liquid).path(&beam) {
            Ok(path) => self.scene.medium_at(path.last.origin),
            Err(_) => InsideMedium::Liquid,
        }
    }

    fn stack(&self, view: usize) -> Stack {
        self.through(self.scan.stations[view].inside)
    }

    /// What light crosses into a medium behind the wall.
    fn through(&self, inside: InsideMedium) -> Stack {
        self.wall
            .stack(&self.media, inside)
            .expect("the wall was checked to fit when the scene was made")
    }

    /// Follows a ray of the beam (camera frame) to the wall's faces and the object.
    fn landing(&self, view: usize, ray: &Ray<Camera>) -> Landing {
        let station = &self.scan.stations[view];
        let beam = station.world_from_camera.ray(ray);
        let Ok(path) = self.stack(view).path(&beam) else {
            return Landing::default();
        };
        let nearest = shapes::nearest(&self.solids, &path.last);
        Landing {
            outer: path.vertices.get(1).copied(),
            inner: path.vertices.get(2).copied(),
            object: nearest.map(|hit| hit.point),
        }
    }

    /// The pixel at which the camera of a view sees a point behind the first `faces` faces; `None` where
    /// a solid hides it.
    fn seen(&self, view: usize, point: Point<World>, faces: usize) -> Option<Pixel> {
        const SAME_PLACE: f64 = 0.01;
        let world_from_camera = &self.scan.stations[view].world_from_camera;
        let mut stack = self.stack(view);
        stack.interfaces.truncate(faces);
        let eye = world_from_camera.point(Point::origin());
        let aim = aim_through(&stack, eye, point).ok()?;
        let arriving = stack.trace(&Ray::new(eye, aim)).ok()?;
        let hit = shapes::nearest(&self.solids, &arriving);
        let way = arriving.origin.distance(point);
        if hit.is_some_and(|hit| hit.distance < way - SAME_PLACE) {
            return None;
        }
        let ahead = world_from_camera.inverse().direction(aim);
        self.scan
            .rig
            .camera
            .project(Point::from_coords(ahead.vector()))
    }

    /// Adds the light of the three spots of a view.
    fn add_laser(&self, view: usize, exposure: &mut Exposure) {
        let brightness = &self.scene.brightness;
        for (ray, share) in self.scene.beam.rays(&self.scan.rig.laser.axis()) {
            let landing = self.landing(view, &ray);
            let spots = [
                (landing.outer, 0, brightness.outer_face),
                (landing.inner, 1, brightness.inner_face),
                (landing.object, 2, brightness.object),
            ];
            for (point, faces, light) in spots {
                let pixel = point.and_then(|point| self.seen(view, point, faces));
                if let Some(pixel) = pixel {
                    exposure.add_spot(pixel, self.scene.beam.blur, share * light);
                }
            }
        }
    }
}

fn pose_entry<A: Frame, B: Frame>(pose: &Pose<A, B>) -> PoseEntry {
    PoseEntry {
        rotation: pose.quaternion(),
        translation: pose.translation().into(),
        extra: Default::default(),
    }
}

impl Scene {
    fn view_entry(
        &self,
        index: usize,
        world_from_camera: &Pose<World, Camera>,
    ) -> Result<ViewEntry, SceneError> {
        let world_from_flange = *world_from_camera * self.hand_eye()?.inverse();
        let (of_rig, of_vessel) = match self.motion() {
            Motion::Rig => (Some(pose_entry(&world_from_flange)), None),
            Motion::Vessel => (None, Some(pose_entry(&world_from_flange.inverse()))),
        };
        Ok(ViewEntry {
            id: format!("{index:04}"),
            on: format!("images/{index:04}-on.png"),
            off: Some(format!("images/{index:04}-off.png")),
            world_from_flange: of_rig,
            flange_from_world: of_vessel,
            inside: InsideMedium::Liquid,
            extra: Default::default(),
        })
    }
}

/// A rotation from angles in degrees about x, then the turned y, then the turned z.
fn rotation_from_degrees([x, y, z]: [f64; 3]) -> UnitQuaternion<f64> {
    let about = |axis: nalgebra::Unit<nalgebra::Vector3<f64>>, degrees: f64| {
        UnitQuaternion::from_axis_angle(&axis, degrees.to_radians())
    };
    use nalgebra::Vector3;
    about(Vector3::x_axis(), x) * about(Vector3::y_axis(), y) * about(Vector3::z_axis(), z)
}
