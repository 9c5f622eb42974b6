use nalgebra::{UnitQuaternion, Vector3};

use super::Medium;
use crate::camera::{Distortion, Intrinsics, Pixel};
use crate::geometry::{Camera, Direction, Plane, Point, Pose, World};
use crate::optics::{Cylinder, Interface, Sphere, Stack, Surface};

/// What of the lab is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// The bench, from above and in space.
    #[default]
    Bench,
    /// The camera's picture through the wall.
    See,
    /// Finding the index.
    Index,
    /// The list of lessons.
    Lessons,
    /// The teacher's sheet.
    Sheet,
}

/// The wall's shape; round ones curve away from the rig.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WallShape {
    /// A tank's.
    #[default]
    Plane,
    /// A jar's, upright.
    Cylinder,
    /// A bowl's.
    Sphere,
}

/// What stands in the vessel of the view through the wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Thing {
    /// A slanting rod that reaches out of the liquid.
    #[default]
    Rod,
    /// A ball.
    Ball,
    /// A card with squares of 10 mm.
    Card,
}

/// All that can be set in the lab.
///
/// Numbers are kept as links carry them: within the range and to the decimals of their
/// [`Quantity`](super::Quantity).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bench {
    /// What is shown.
    pub view: View,
    /// The lesson under way, by its place in [`LESSONS`](super::LESSONS).
    pub lesson: Option<usize>,
    /// The wall's shape.
    pub wall: WallShape,
    /// A round wall's outer radius.
    pub radius: f64,
    /// The wall's thickness.
    pub thickness: f64,
    /// Around the rig: n1.
    pub outside: Medium,
    /// The wall: n2.
    pub glass: Medium,
    /// Behind it: n3.
    pub liquid: Medium,
    /// The laser's x and z before the rig is turned.
    pub laser: [f64; 2],
    /// The camera's x and z before the rig is turned.
    pub camera: [f64; 2],
    /// The object point's x and z.
    pub object: [f64; 2],
    /// The beam's angle to the rig's forward direction, degrees, positive to the right; `None`: the
    /// beam is aimed at the object point.
    pub aim: Option<f64>,
    /// The rig turned about the upright through the wall's nearest point, degrees.
    pub turn: f64,
    /// The rig raised so that it looks down at that point, degrees.
    pub pitch: f64,
    /// The liquid's index that the measurement takes for granted; `None`: the right one.
    pub assumed: Option<f64>,
    /// The view in space: the way round the bench, degrees.
    pub space_round: f64,
    /// The view in space: the height above the bench, degrees.
    pub space_above: f64,
    /// What stands in the vessel.
    pub thing: Thing,
    /// The eye's way round the vessel, degrees.
    pub eye_round: f64,
    /// The eye's height above it, degrees.
    pub eye_above: f64,
    /// How full the vessel is, per cent.
    pub fill: f64,
    /// How much of the picture shows the liquid, per cent from the left.
    pub divider: f64,
    /// The index at which the L is reconstructed.
    pub trial: f64,
    /// The L turned out of the position in which both its planes meet the wall at 45 degrees, degrees.
    pub l_turn: f64,
    /// Standard deviation of a spot in the picture, px, along each of its sides.
    pub noise: f64,
    /// Standard deviation of the laser's tilt out of the plane of camera and beam, degrees.
    pub out_of_plane: f64,
    /// Standard deviation of the laser's tilt within that plane, degrees.
    pub in_plane: f64,
}

impl Default for Bench {
    fn default() -> Self {
        Self {
            view: View::Bench,
            lesson: None,
            wall: WallShape::Plane,
            radius: 80.0,
            thickness: 6.0,
            outside: Medium::Named(0),
            glass: Medium::Named(7),
            liquid: Medium::Named(1),
            laser: [-70.0, -170.0],
            camera: [70.0, -170.0],
            object: [10.0, 90.0],
            aim: None,
            turn: 0.0,
            pitch: 0.0,
            assumed: None,
            space_round: 35.0,
            space_above: 28.0,
            thing: Thing::Rod,
            eye_round: 12.0,
            eye_above: 6.0,
            fill: 65.0,
            divider: 50.0,
            trial: 1.3,
            l_turn: 0.0,
            noise: 0.2,
            out_of_plane: 0.0,
            in_plane: 0.0,
        }
    }
}

/// How far inside a round wall an object point is kept, mm.
const CLEARANCE: f64 = 2.0;

impl Bench {
    /// The bench with an object point that fits into its vessel.
    pub fn tidied(mut self) -> Self {
        if self.wall == WallShape::Plane {
            self.object[1] = self.object[1].max(self.thickness + CLEARANCE);
            return self;
        }
        let [x, z] = [self.object[0], self.object[1] - self.radius];
        let (away, room) = (
            (x * x + z * z).sqrt(),
            self.radius - self.thickness - CLEARANCE,
        );
        if away > room {
            // A little further in than need be, so that rounding does not bring it out again.
            let scale = (room - 0.2) / away;
            let tenth = |value: f64| (value * 10.0).round() / 10.0 + 0.0;
            self.object = [tenth(x * scale), tenth(self.radius + z * scale)];
        }
        self
    }

    /// The light's way in, with the liquid that is really there.
    pub fn stack(&self) -> Stack {
        self.stack_with(self.liquid.index())
    }

    /// The light's way in, as if the liquid had another index.
    pub fn stack_with(&self, liquid: f64) -> Stack {
        let face = |depth, index_behind| Interface {
            surface: self.face(depth),
            index_behind,
        };
        Stack {
            outside: self.outside.index(),
            interfaces: vec![face(0.0, self.glass.index()), face(self.thickness, liquid)],
        }
    }

    /// The surface `depth` behind the wall's outer face.
    fn face(&self, depth: f64) -> Surface {
        let centre = Point::new(0.0, 0.0, self.radius);
        let radius = self.radius - depth;
        match self.wall {
            WallShape::Plane => Surface::Plane(Plane::new(
                Point::new(0.0, 0.0, depth),
                Direction::assume_unit(-Vector3::z()),
            )),
            WallShape::Cylinder => Surface::Cylinder(Cylinder {
                point: centre,
                axis: Direction::assume_unit(Vector3::y()),
                radius,
            }),
            WallShape::Sphere => Surface::Sphere(Sphere { centre, radius }),
        }
    }

    /// How the rig is turned and raised: the world from the rig's own directions.
    pub fn rig_rotation(&self) -> UnitQuaternion<f64> {
        let about = |axis: Vector3<f64>, degrees: f64| {
            UnitQuaternion::from_scaled_axis(axis * degrees.to_radians())
        };
        // Raised and looking down: y points down, so the rig goes to negative y. A turn to the
        // right takes the rig to the left.
        about(Vector3::y(), self.turn) * about(Vector3::x(), -self.pitch)
    }

    /// A place of the rig, given by its x and z before the rig is turned, in the world.
    pub fn on_rig(&self, [x, z]: [f64; 2]) -> Point<World> {
        Point::from_coords(self.rig_rotation() * Vector3::new(x, 0.0, z))
    }

    /// The inverse of [`Bench::on_rig`], from the world's x and z: where on the rig's own plane a place
    /// of the view from above lies.
    pub fn from_above(&self, x: f64, z: f64) -> [f64; 2] {
        let (sine, cosine) = libm::sincos(self.turn.to_radians());
        let along = x * sine + z * cosine;
        [
            x * cosine - z * sine,
            along / libm::cos(self.pitch.to_radians()),
        ]
    }

    /// Where the object point is.
    pub const fn object_point(&self) -> Point<World> {
        Point::new(self.object[0], 0.0, self.object[1])
    }

    /// The camera's pose: it looks along the rig's forward direction.
    pub fn world_from_camera(&self) -> Pose<World, Camera> {
        Pose::from_parts(self.rig_rotation(), self.on_rig(self.camera).coords)
    }

    /// The camera's lens: 1280 by 960 pixels, as wide as the bench needs, without distortion.
    pub const fn intrinsics() -> Intrinsics {
        Intrinsics {
            width: 1280,
            height: 960,
            focal: [1100.0, 1100.0],
            centre: Pixel::new(639.5, 479.5),
            distortion: Distortion {
                numerator: [0.0; 3],
                denominator: [0.0; 3],
                tangential: [0.0; 2],
            },
        }
    }

    /// Whether the liquid's index is to be found out, and so not to be told.
    pub const fn hides_index(&self) -> bool {
        self.liquid.is_mystery()
    }
}
