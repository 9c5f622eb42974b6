//! What a scan can tell of the index by the ray distance, before any search.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::model::{Hypothesis, Kind, Model, Parts, State, Unknown};
use super::sights::ObjectSight;
use super::solve::{Moved, Normal};
use crate::camera::Pixel;
use crate::object::line_of_sight;
use crate::rig::Calibration;
use crate::robust::median;

/// Why the ray distance says little of the index. With s_L and s_C the sines of the angles of incidence
/// in air, phi the angle between the two planes of incidence and z the depth behind the wall, the signal
/// vanishes with sin phi, with s_L - s_C and with z, and falls with the third power of the angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Blindness {
    /// D1: the wall's normal lies in the plane of the beam and the camera's centre (a mirror plane).
    MirrorPlane,
    /// D2: beam and line of sight meet the wall at equal angles.
    EqualAngles,
    /// D3: the object lies close behind the wall.
    Shallow,
    /// D4: both rays meet the wall nearly square.
    SquareOn,
}

/// What the ray distance can tell on a scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observability {
    /// Of each of the object's sights: its view, and by how many pixels its spot would leave the refracted
    /// epipolar curve if the index were off by one.
    pub pixels_per_index: Vec<(usize, f64)>,
    /// The median of these.
    pub median_pixels: f64,
    /// By how much the index shifts if the laser's direction is off by 0.05 degrees within the plane of
    /// the beam and the camera's centre, and nothing corrects for it.
    pub shift_in_plane: f64,
    /// The same across that plane.
    pub shift_out_of_plane: f64,
    /// The angle of the wall's normal to the plane of the beam and the camera's centre: the larger of the
    /// two rays', median over the views, degrees.
    pub off_mirror_plane: f64,
    /// The angle of incidence of the beam, median, degrees.
    pub beam_incidence: f64,
    /// The angle of incidence of the line of sight, median, degrees.
    pub sight_incidence: f64,
    /// The depth of the object behind the wall along the light, median, mm.
    pub depth: f64,
    /// What is most to blame where the signal is small.
    pub blindness: Blindness,
}

impl Observability {
    /// What is to blame, with the measured angles.
    pub fn cause(&self) -> String {
        let (beam, sight) = (self.beam_incidence, self.sight_incidence);
        match self.blindness {
            Blindness::MirrorPlane => format!(
                "the wall's normal lies within {:.1} degrees of the plane of the beam and the camera (D1), \
                 where the two rays meet whatever the index is",
                self.off_mirror_plane
            ),
            Blindness::EqualAngles => format!(
                "beam and line of sight meet the wall at nearly equal angles, {beam:.1} and {sight:.1} \
                 degrees (D2), where the two rays meet whatever the index is"
            ),
            Blindness::Shallow => format!(
                "the object lies {:.0} mm behind the wall (D3), where the light has hardly parted",
                self.depth
            ),
            Blindness::SquareOn => format!(
                "the rays meet the wall at {beam:.1} and {sight:.1} degrees (D4), and the signal falls with \
                 the third power of these angles"
            ),
        }
    }
}

/// One sight as seen from the wall.
struct Incidence {
    off_mirror_plane: f64,
    beam: f64,
    sight: f64,
    depth: f64,
}

impl Model<'_> {
    /// What the ray distance can tell at a state; `None` where no sight's light gets through.
    pub(super) fn observability(&self, state: &State) -> Option<Observability> {
        let here = Hypothesis::new(self, state.clone())?;
        let signal = |sight: &ObjectSight| Some((sight.view, self.signal(&here, sight)?));
        let pixels_per_index: Vec<(usize, f64)> =
            self.sights.object.iter().filter_map(signal).collect();
        if pixels_per_index.is_empty() {
            return None;
        }
        let incidences: Vec<Incidence> = self
            .sights
            .object
            .iter()
            .filter_map(|sight| self.incidence(&here, sight))
            .collect();
        if incidences.is_empty() {
            return None;
        }
        let middle =
            |of: &dyn Fn(&Incidence) -> f64| median(incidences.iter().map(of).collect::<Vec<_>>());
        let [shift_in_plane, shift_out_of_plane] = self.laser_shifts(state);
        Some(Observability {
            median_pixels: median(pixels_per_index.iter().map(|(_, px)| *px).collect()),
            pixels_per_index,
            shift_in_plane,
            shift_out_of_plane,
            off_mirror_plane: middle(&|i| i.off_mirror_plane).to_degrees(),
            beam_incidence: middle(&|i| i.beam).to_degrees(),
            sight_incidence: middle(&|i| i.sight).to_degrees(),
            depth: middle(&|i| i.depth),
            blindness: blindness(&incidences),
        })
    }

    /// |dl/dn| over |dl/dpixel|.
    fn signal(&self, here: &Hypothesis, sight: &ObjectSight) -> Option<f64> {
        const N: f64 = 1e-4;
        const PX: f64 = 1e-3;
        let gap = |at: &Hypothesis, du: f64, dv: f64| {
            let pixel = Pixel::new(sight.pixel.u + du, sight.pixel.v + dv);
            self.meeting(at, sight, pixel).map(|m| m.gap())
        };
        let moved = |by| Hypothesis::new(self, self.moved(&here.state, Unknown::Index, by));
        let by_index = (gap(&moved(N)?, 0.0, 0.0)? - gap(&moved(-N)?, 0.0, 0.0)?) / (2.0 * N);
        let by_pixel = Vector2::new(
            gap(here, PX, 0.0)? - gap(here, -PX, 0.0)?,
            gap(here, 0.0, PX)? - gap(here, 0.0, -PX)?,
        ) / (2.0 * PX);
        Some(by_index.abs() / by_pixel.norm())
    }

    fn incidence(&self, here: &Hypothesis, sight: &ObjectSight) -> Option<Incidence> {
        let rig = &here.state.rig;
        let pose = rig.station(&self.setup.stations[sight.view].world_from_flange);
        let beam = pose.ray(&rig.laser.axis());
        let line = line_of_sight(rig, &pose, sight.pixel).ok()?;
        let outer = &here.state.wall.outer;
        let normals = [outer.hit(&beam)?.normal, outer.hit(&line)?.normal];
        let baseline = beam.origin - line.origin;
        let across = baseline
            .cross(&beam.direction.vector())
            .try_normalize(0.0)?;
        let off = normals.map(|n| libm::asin(n.vector().dot(&across).abs().min(1.0)));
        let angle = |cosine: f64| libm::acos(cosine.abs().min(1.0));
        Some(Incidence {
            off_mirror_plane: off[0].max(off[1]),
            beam: angle(beam.direction.dot(normals[0])),
            sight: angle(line.direction.dot(normals[1])),
            depth: self.meeting(here, sight, sight.pixel)?.depth(),
        })
    }

    /// By how much the index shifts if the laser's direction is off by 0.05 degrees within and across the
    /// plane of the beam and the camera's centre, calibration is taken at its word, and the wall is fitted
    /// to what the vessel's spots then seem to be.
    fn laser_shifts(&self, state: &State) -> [f64; 2] {
        let off = 0.05_f64.to_radians();
        let beam = state.rig.laser.axis();
        let (u, v) = beam.direction.tangents();
        let Some(across) = beam
            .origin
            .coords
            .cross(&beam.direction.vector())
            .try_normalize(0.0)
        else {
            return [0.0; 2];
        };
        let within = across.cross(&beam.direction.vector());
        let tilts = [0, 1].map(|i| Unknown::Calibration(Calibration::LaserDirection(i)));
        let mut model = self.clone();
        model.parts = Parts {
            gaps: true,
            faces: false,
            known: false,
        };
        let free = model.unknowns(state).into_iter();
        let held = |u: &Unknown| {
            matches!(u, Unknown::Calibration(_) | Unknown::Glow) && !tilts.contains(u)
        };
        let unknowns: Vec<Moved> = free
            .filter(|(u, _)| !held(u))
            .map(|(u, prior)| Moved::new(u, prior))
            .collect();
        let Some((mut rows, _)) = model.linearise(state, &unknowns) else {
            return [0.0; 2];
        };
        for row in &mut rows {
            row.count_fully();
            if row.whitened.kinds[0] == Some(Kind::OffLine) {
                row.weight.x = 0.0;
            }
        }
        let tilt_columns: Vec<usize> = (0..unknowns.len())
            .filter(|i| tilts.contains(&unknowns[*i].unknown))
            .collect();
        [within, across].map(|towards| {
            let (a, b) = (towards.dot(&u) * off, towards.dot(&v) * off);
            let mut shifted = rows.clone();
            for row in &mut shifted {
                row.residual = Vector2::zeros();
                for (column, by) in tilt_columns.iter().zip([a, b]) {
                    row.residual += row.jacobian.column(*column) * by;
                    row.jacobian.column_mut(*column).fill(0.0);
                }
            }
            let normal = Normal::new(&shifted, &unknowns);
            let step = normal.inverse().map(|inverse| inverse * &normal.right);
            let index = unknowns.iter().position(|m| m.unknown == Unknown::Index);
            step.zip(index).map_or(0.0, |(step, index)| step[index])
        })
    }
}

/// The factor of the signal that is smallest beside what a good scan has.
fn blindness(incidences: &[Incidence]) -> Blindness {
    let middle =
        |of: &dyn Fn(&Incidence) -> f64| median(incidences.iter().map(of).collect::<Vec<_>>());
    let sine2 = |angle: f64| libm::sin(angle) * libm::sin(angle);
    let causes = [
        (
            middle(&|i| libm::sin(i.off_mirror_plane)) / 0.3,
            Blindness::MirrorPlane,
        ),
        (
            middle(&|i| (sine2(i.beam) - sine2(i.sight)).abs()) / 0.08,
            Blindness::EqualAngles,
        ),
        (middle(&|i| i.depth) / 50.0, Blindness::Shallow),
        (
            middle(&|i| sine2(i.beam).max(sine2(i.sight))) / 0.15,
            Blindness::SquareOn,
        ),
    ];
    let least = causes.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    least.map_or(Blindness::SquareOn, |(_, cause)| cause)
}
