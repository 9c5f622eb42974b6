//! Scenes -> scans with ground truth: pictures with noise, both glows of the wall, ambient light, ghosts.
//!
//! Each laser spot is drawn as light makes it: the beam's cross-section is sampled, each sample is
//! traced to the surface it lands on, and the place where the camera sees that through the wall gets the
//! lens's blur. Spots on oblique faces come out oblique.

mod ghosts;
mod ideal;
mod noise;
mod render;
mod scene;
mod shapes;
mod truth;

pub use ghosts::{Ghost, GhostKind, Ghosts};
pub use render::Exposure;
pub use scene::{
    Ambient, BeamProfile, Brightness, CalibrationError, PictureNoise, Relief, Scene, SceneError,
    SceneFarWall, SceneMedia, SceneObject, Sweep, Turntable, Vessel,
};
pub use shapes::Solid;
pub use truth::{Truth, TruthView};

use nalgebra::UnitQuaternion;

use crate::camera::Pixel;
use crate::geometry::{Camera, Direction, Frame, Point, Pose, Ray, World};
use crate::optics::{Media, Stack, aim_through};
use crate::rig::{Laser, Rig, Sheet};
use crate::scan::{InsideMedium, Manifest, Motion, PicturePair, PoseEntry, Scan, ViewEntry};
use crate::vessel::Wall;
use ghosts::FalseLight;
use noise::Grains;

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
#[derive(Clone, Debug, Default, PartialEq)]
struct Landing {
    /// On the wall's faces, from the rig inwards: outer, inner, and those of a far wall.
    faces: Vec<Point<World>>,
    object: Option<Point<World>>,
    /// On the vessel's back, where no object stands in the way.
    back: Option<Point<World>>,
}

impl Landing {
    fn outer(&self) -> Option<Point<World>> {
        self.faces.first().copied()
    }

    fn inner(&self) -> Option<Point<World>> {
        self.faces.get(1).copied()
    }
}

/// Which vertex of a path lies on the front wall's inner face.
const INNER: usize = 2;

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
        wall.stack(&media, InsideMedium::Liquid)?;
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

    /// The true wall.
    pub const fn wall(&self) -> &Wall {
        &self.wall
    }

    /// How many views there are.
    pub fn views(&self) -> usize {
        self.scan.stations.len()
    }

    /// Takes the two pictures of a view.
    pub fn pictures(&self, view: usize) -> PicturePair {
        self.pictures_by(&self.room_light(view), view)
    }

    /// A view by the light of the room alone, which is the same for every seed.
    pub fn room_light(&self, view: usize) -> Exposure {
        render::ambient(self, &self.scan.stations[view].world_from_camera)
    }

    /// As [`Self::pictures`], with the light of the room worked out before.
    pub fn pictures_by(&self, dark: &Exposure, view: usize) -> PicturePair {
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
        let beam = self.beam(view);
        match self.through(InsideMedium::Liquid).path(&beam) {
            Ok(path) => self.scene.medium_at(path.vertices[INNER]),
            Err(_) => InsideMedium::Liquid,
        }
    }

    /// How many faces light crosses on its way to the objects.
    const fn faces(&self) -> usize {
        if self.wall.far.is_some() { 4 } else { 2 }
    }

    fn stack(&self, view: usize) -> Stack {
        self.through(self.scan.stations[view].inside)
    }

    /// The beam's middle in a view.
    fn beam(&self, view: usize) -> Ray<World> {
        self.scan.stations[view]
            .world_from_camera
            .ray(&self.scan.rig.laser.axis())
    }

    /// Where the camera of a view is.
    fn eye(&self, view: usize) -> Point<World> {
        self.scan.stations[view]
            .world_from_camera
            .point(Point::origin())
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
            faces: path.vertices[1..].to_vec(),
            object: nearest.map(|hit| hit.point),
            back: match nearest {
                Some(_) => None,
                None => ghosts::back(self, &path.last),
            },
        }
    }

    /// The pixel at which the camera of a view sees a point behind the first `faces` faces; `None` where
    /// a solid hides it.
    fn seen(&self, view: usize, point: Point<World>, faces: usize) -> Option<Pixel> {
        const SAME_PLACE: f64 = 0.01;
        let aim = self.aim(view, point, faces)?;
        let arriving = self.arriving(view, aim, faces)?;
        // All solids stand behind the last face.
        let behind_all = faces == self.faces();
        let hit = shapes::nearest(&self.solids, &arriving).filter(|_| behind_all);
        let way = arriving.origin.distance(point);
        if hit.is_some_and(|hit| hit.distance < way - SAME_PLACE) {
            return None;
        }
        self.project(view, aim)
    }

    /// As [`Self::seen`], whatever stands in the way.
    fn image(&self, view: usize, point: Point<World>, faces: usize) -> Option<Pixel> {
        self.project(view, self.aim(view, point, faces)?)
    }

    /// The direction in which the camera of a view looks for a point behind the first `faces` faces.
    fn aim(&self, view: usize, point: Point<World>, faces: usize) -> Option<Direction<World>> {
        let mut stack = self.stack(view);
        stack.interfaces.truncate(faces);
        aim_through(&stack, self.eye(view), point).ok()
    }

    /// The line of sight in a direction, behind the first `faces` faces.
    fn arriving(&self, view: usize, aim: Direction<World>, faces: usize) -> Option<Ray<World>> {
        let mut stack = self.stack(view);
        stack.interfaces.truncate(faces);
        stack.trace(&Ray::new(self.eye(view), aim)).ok()
    }

    /// The pixel of a direction of the world.
    fn project(&self, view: usize, aim: Direction<World>) -> Option<Pixel> {
        let world_from_camera = &self.scan.stations[view].world_from_camera;
        let ahead = world_from_camera.inverse().direction(aim);
        self.scan
            .rig
            .camera
            .project(Point::from_coords(ahead.vector()))
    }

    /// Whether a place lies on the sensor.
    fn in_picture(&self, [u, v]: [f64; 2]) -> bool {
        let camera = &self.scan.rig.camera;
        (0.0..=f64::from(camera.width - 1)).contains(&u)
            && (0.0..=f64::from(camera.height - 1)).contains(&v)
    }

    /// Adds the light of the laser: spots, true and false, or lines.
    fn add_laser(&self, view: usize, exposure: &mut Exposure) {
        match &self.scan.rig.laser {
            Laser::Beam(beam) => self.add_beam(view, beam, exposure),
            Laser::Sheet(sheet) => self.add_sheet(view, sheet, exposure),
        }
    }

    fn add_beam(&self, view: usize, beam: &Ray<Camera>, exposure: &mut Exposure) {
        if self.scene.beam.speckle == 0.0 {
            return self.draw_spots(view, beam, exposure);
        }
        let mut spots = exposure.unlit();
        self.draw_spots(view, beam, &mut spots);
        spots.speckle(&mut Grains::of(&self.scene, view));
        exposure.add(&spots);
    }

    fn draw_spots(&self, view: usize, beam: &Ray<Camera>, exposure: &mut Exposure) {
        let brightness = &self.scene.brightness;
        let false_light = ghosts::of(self, view);
        let on_object = match false_light.object_hidden {
            true => 0.0,
            false => brightness.object,
        };
        for (ray, share) in self.scene.beam.rays(beam) {
            let landing = self.landing(view, &ray);
            let glows = [
                brightness.outer_face,
                brightness.inner_face,
                brightness.far_face,
                brightness.far_face,
            ];
            // A glow on a face is seen through the faces before it.
            let on_faces = landing.faces.iter().zip(glows).enumerate();
            let on_faces = on_faces.map(|(face, (point, light))| (Some(*point), face, light));
            let behind = [
                (landing.object, self.faces(), on_object),
                (landing.back, self.faces(), brightness.back),
            ];
            let spots = on_faces.chain(behind);
            for (point, faces, light) in spots.filter(|(.., light)| *light > 0.0) {
                let pixel = point.and_then(|point| self.seen(view, point, faces));
                if let Some(pixel) = pixel {
                    exposure.add_spot(pixel, self.scene.beam.blur, share * light);
                }
            }
        }
        for ghost in &false_light.spots(self) {
            let [u, v] = ghost.pixel;
            let width = ghost.width * self.scene.beam.blur;
            exposure.add_spot(Pixel::new(u, v), width, ghost.light);
        }
    }

    /// Draws the lines ray by ray: each ray's light is spread over its way from the ray before it.
    fn add_sheet(&self, view: usize, sheet: &Sheet, exposure: &mut Exposure) {
        /// Rays that land farther apart, px, are on different surfaces.
        const CONNECTED: f64 = 4.0;
        let fan = self.scene.beam.fan(sheet, &self.scan.rig.camera);
        let false_light = ghosts::of(self, view);
        let mut before: Vec<Vec<Glow>> = vec![Vec::new(); fan.first().map_or(0, Vec::len)];
        for rays in &fan {
            for ((ray, share), before) in rays.iter().zip(&mut before) {
                let glows = self.glows(view, ray, &false_light);
                for (glow, before) in glows.iter().zip(&*before) {
                    let Some((pixel, before)) = glow.pixel.zip(before.pixel) else {
                        continue;
                    };
                    let way = pixel.distance(before);
                    if way < CONNECTED {
                        exposure.add_spot(pixel, glow.width, share * glow.light * way);
                    }
                }
                *before = glows;
            }
        }
    }

    /// What the camera sees of a ray's light: on the faces of the wall and of the far wall, on the object
    /// and on the vessel's back, and what is false.
    fn glows(&self, view: usize, ray: &Ray<Camera>, false_light: &FalseLight) -> Vec<Glow> {
        let landing = self.landing(view, ray);
        let brightness = &self.scene.brightness;
        let blur = self.scene.beam.blur;
        let face = |face: usize, light: f64| (landing.faces.get(face).copied(), face, light);
        let on_object = match false_light.object_hidden {
            true => 0.0,
            false => brightness.object,
        };
        let places = [
            face(0, brightness.outer_face),
            face(1, brightness.inner_face),
            face(2, brightness.far_face),
            face(3, brightness.far_face),
            (landing.object, self.faces(), on_object),
            (landing.back, self.faces(), brightness.back),
        ];
        let own = places.map(|(point, faces, light)| Glow {
            pixel: point
                .filter(|_| light > 0.0)
                .and_then(|point| self.seen(view, point, faces)),
            light,
            width: blur,
        });
        let of_ghosts = false_light.invented.iter().map(|invented| Glow {
            pixel: invented.seen(self, view, ray, &landing),
            light: invented.ghost.light,
            width: invented.ghost.width * blur,
        });
        own.into_iter().chain(of_ghosts).collect()
    }
}

/// What is seen of a ray's light in one place.
#[derive(Clone, Copy)]
struct Glow {
    pixel: Option<Pixel>,
    /// Grey values, summed over a profile across the line.
    light: f64,
    /// Standard deviation, px.
    width: f64,
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
