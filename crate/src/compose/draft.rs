//! A scan under way: what there is of it, what is missing, and its manifest.

use super::calibration::{Lens, read_calibration};
use super::matching::match_poses;
use super::pairs::{Pair, Pairing, pair};
use super::poses::{LengthScale, ListedPose, PoseList, Reading, read_poses};
use super::question::{Answers, Key, Part};
use super::view_numbers::ViewNumbers;
use crate::geometry::{Flange, Pose, World};
use crate::robust::sort_stably;
use crate::scan::{
    CalibrationSigmaEntry, CameraEntry, FarWall, InsideMedium, KnownKind, KnownShape, LaserEntry,
    LaserKind, LengthUnit, Manifest, MediaEntry, Motion, PoseEntry, Scan, ScanError, ScanFormat,
    VesselEntry, VesselShape, ViewEntry,
};
use crate::text::{count, some_of};

/// What somebody has so far to make a scan of.
#[derive(Clone, Debug, Default)]
pub struct Draft {
    /// The names of the pictures, paths with `/`.
    pub pictures: Vec<String>,
    /// Width and height of one of them, px.
    pub picture_size: Option<[u32; 2]>,
    /// The text of a calibration file.
    pub calibration: Option<String>,
    /// The text of a list of poses.
    pub poses: Option<String>,
    /// What was typed.
    pub answers: Answers,
}

/// Something that a scan lacks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap {
    /// Where it belongs.
    pub part: Part,
    /// One sentence.
    pub sentence: String,
}

/// What a draft comes to.
#[derive(Clone, Debug)]
pub struct Composed {
    /// The questions that matter for these files and answers, part by part.
    pub asked: Vec<Key>,
    /// The pictures, paired.
    pub pairing: Pairing,
    /// The pictures of each view, in the views' order.
    pub views: Vec<Pair>,
    /// The lens, if its file can be read.
    pub lens: Option<Lens>,
    /// How many poses there are, if their file can be read.
    pub poses: Option<usize>,
    /// What is missing.
    pub gaps: Vec<Gap>,
    /// Once nothing is: a manifest that passes the checks of an archive's own.
    pub manifest: Option<Manifest>,
}

impl Draft {
    /// Says what is missing; if nothing is, the manifest is made.
    pub fn compose(&self) -> Composed {
        let pairing = pair(&self.pictures);
        let mut gaps = Gaps::default();
        let lens = self.lens(&mut gaps);
        let list = self.list(&mut gaps);
        let views = self.taken(&pairing, &mut gaps);
        let manifest = self.manifest(&views, lens.as_ref(), list.as_ref(), &mut gaps);
        let manifest = manifest.filter(|_| gaps.0.is_empty());
        let manifest = manifest.and_then(|manifest| gaps.check(manifest));
        let mut gaps = gaps.0;
        sort_stably(&mut gaps, |a, b| a.part.cmp(&b.part));
        Composed {
            asked: self.asked(&pairing, list.as_ref()),
            lens,
            poses: list.map(|list| list.poses.len()),
            pairing,
            views,
            gaps,
            manifest,
        }
    }

    /// The questions that matter.
    fn asked(&self, pairing: &Pairing, list: Option<&PoseList>) -> Vec<Key> {
        let is_line = self.answers.get(Key::LaserKind) == "line";
        let hand = self.has_hand();
        let matters = |key: &Key| match key {
            Key::Alone => !pairing.unpaired.is_empty(),
            Key::Angle => list.is_some_and(|list| list.has_vectors),
            Key::Order => list.is_some_and(|list| list.has_bare_quaternions),
            Key::HandRotation | Key::HandTranslation => hand,
            Key::SigmaHandRotation | Key::SigmaHandTranslation => hand,
            Key::LaserDirection => !is_line,
            Key::LaserNormal => is_line,
            Key::WallKnown => self.wall_keys().is_some(),
            Key::WallPoint
            | Key::WallNormal
            | Key::WallAxisPoint
            | Key::WallAxis
            | Key::WallCentre
            | Key::WallRadius => self.known_wall_keys().contains(key),
            Key::FarWall => self.can_have_far_wall(),
            Key::FarDistance | Key::FarThickness => self.has_far_wall(),
            Key::IndexInside => self.answers.get(Key::IndexKnown) != "no",
            Key::InAir => !list.is_some_and(PoseList::says_inside),
            _ => true,
        };
        let keys = super::QUESTIONS.iter().map(|question| question.key);
        keys.filter(matters).collect()
    }

    /// What tells where a wall of the chosen shape stands, if it is one of those that can be known.
    fn wall_keys(&self) -> Option<&'static [Key]> {
        match self.shape() {
            VesselShape::Plane => Some(&[Key::WallPoint, Key::WallNormal]),
            VesselShape::Cylinder => Some(&[Key::WallAxisPoint, Key::WallAxis, Key::WallRadius]),
            VesselShape::Sphere => Some(&[Key::WallCentre, Key::WallRadius]),
            VesselShape::Freeform | VesselShape::Auto => None,
        }
    }

    /// Likewise, and nothing if the wall is not known.
    fn known_wall_keys(&self) -> &'static [Key] {
        match self.answers.get(Key::WallKnown) {
            "yes" => self.wall_keys().unwrap_or_default(),
            _ => &[],
        }
    }

    /// A far wall is measured through flat walls alone.
    fn can_have_far_wall(&self) -> bool {
        matches!(self.shape(), VesselShape::Plane | VesselShape::Auto)
    }

    fn has_far_wall(&self) -> bool {
        self.can_have_far_wall() && self.answers.get(Key::FarWall) == "yes"
    }

    /// Whether the poses are the flange's, so that the camera's place on it matters.
    fn has_hand(&self) -> bool {
        self.answers.get(Key::Frames).contains("flange")
    }

    fn lens(&self, gaps: &mut Gaps) -> Option<Lens> {
        let Some(text) = &self.calibration else {
            gaps.add(Part::Camera, "No camera calibration: choose its file.");
            return None;
        };
        let lens = read_calibration(text);
        lens.map_err(|error| gaps.add(Part::Camera, format!("The calibration file: {error}.")))
            .ok()
    }

    fn list(&self, gaps: &mut Gaps) -> Option<PoseList> {
        let Some(text) = &self.poses else {
            gaps.add(Part::Poses, "No poses: choose their file.");
            return None;
        };
        let reading = Reading {
            length: match self.answers.get(Key::Length) {
                "cm" => LengthScale::Centimetre,
                "m" => LengthScale::Metre,
                _ => LengthScale::Millimetre,
            },
            degrees: self.answers.get(Key::Angle) == "deg",
            w_last: self.answers.get(Key::Order) == "xyzw",
        };
        let list = read_poses(text, reading);
        let list = list.map_err(|error| gaps.add(Part::Poses, format!("The poses: {error}.")));
        let list = list.ok()?;
        if list.has_vectors && self.answers.get(Key::Angle).is_empty() {
            gaps.add(Part::Poses, "Rotation vectors: radians or degrees?");
        }
        if list.has_bare_quaternions && self.answers.get(Key::Order).is_empty() {
            gaps.add(Part::Poses, "Quaternions: is w first or last?");
        }
        Some(list)
    }

    /// The manifest, as far as everything is there.
    fn manifest(
        &self,
        views: &[Pair],
        lens: Option<&Lens>,
        list: Option<&PoseList>,
        gaps: &mut Gaps,
    ) -> Option<Manifest> {
        // Each looks for its own gaps, so none may stop the others.
        let camera = self.camera(lens, gaps);
        let views = self.views(views, list, gaps);
        let hand = self.hand(gaps);
        let laser = self.laser(gaps);
        let vessel = self.vessel(gaps);
        let media = self.media(gaps);
        let known = self.known(gaps);
        let calibration_sigma = self.calibration_sigma(gaps);
        Some(Manifest {
            format: ScanFormat::RefractiveScan,
            version: 1,
            name: self.answers.get(Key::Name).to_owned(),
            length_unit: LengthUnit::Millimetre,
            motion: self.motion(),
            camera: camera?,
            laser: laser?,
            flange_from_camera: hand?,
            calibration_sigma,
            vessel: vessel?,
            media: media?,
            known,
            views: views?,
            extra: Default::default(),
        })
    }

    fn camera(&self, lens: Option<&Lens>, gaps: &mut Gaps) -> Option<CameraEntry> {
        let lens = lens?;
        match (lens.size, self.picture_size) {
            (Some(of_lens), Some(of_picture)) if of_lens != of_picture => {
                let [[w, h], [width, height]] = [of_lens, of_picture];
                gaps.add(
                    Part::Camera,
                    format!(
                        "The calibration is for pictures of {w} x {h} pixels, and these have {width} x \
                         {height}."
                    ),
                );
                None
            }
            (of_lens, of_picture) => Some(lens.entry(of_picture.or(of_lens)?)),
        }
    }

    fn motion(&self) -> Motion {
        match self.answers.get(Key::Motion) {
            "vessel" => Motion::Vessel,
            _ => Motion::Rig,
        }
    }

    fn views(
        &self,
        views: &[Pair],
        list: Option<&PoseList>,
        gaps: &mut Gaps,
    ) -> Option<Vec<ViewEntry>> {
        let in_air = self.in_air(views.len(), list, gaps);
        let frames = Frames::named(self.answers.get(Key::Frames));
        if frames.is_none() {
            gaps.add(Part::Poses, "Choose what a pose says: its frames.");
        }
        let list = list.filter(|_| !views.is_empty())?;
        let poses = match_poses(views, list);
        let poses = poses.map_err(|sentences| {
            for sentence in sentences {
                gaps.add(Part::Poses, sentence);
            }
        });
        let (frames, in_air) = (frames?, in_air?);
        let motion = self.motion();
        let views = views.iter().zip(poses.ok()?).enumerate();
        let entries = views.map(|(number, (view, pose))| {
            let inside = pose.inside.unwrap_or(match in_air.has(number) {
                true => InsideMedium::Air,
                false => InsideMedium::Liquid,
            });
            entry(view, pose, frames, motion, inside)
        });
        Some(entries.collect())
    }

    /// The views in air, unless the poses' file has its say.
    fn in_air(
        &self,
        views: usize,
        list: Option<&PoseList>,
        gaps: &mut Gaps,
    ) -> Option<ViewNumbers> {
        if list.is_some_and(PoseList::says_inside) {
            return Some(ViewNumbers::default());
        }
        let numbers = ViewNumbers::read(self.answers.get(Key::InAir), views);
        let name = Key::InAir.question().label;
        let numbers = numbers.map_err(|why| gaps.add(Part::Media, format!("{name}: {why}.")));
        numbers.ok()
    }

    /// The pictures that make views, in natural order.
    fn taken(&self, pairing: &Pairing, gaps: &mut Gaps) -> Vec<Pair> {
        let mut views = pairing.pairs.clone();
        let alone = pairing.unpaired.iter().filter_map(|one| one.alone.clone());
        match self.answers.get(Key::Alone) {
            "alone" => views.extend(alone),
            "skip" => {}
            _ => self.tell_unpaired(pairing, gaps),
        }
        sort_stably(&mut views, |a, b| a.key.cmp(&b.key));
        if views.is_empty() {
            let sentence = match pairing.unpaired.is_empty() {
                true => "No pictures: choose those with the laser on and off.",
                false => {
                    "No two pictures make a pair: let their names say laser on and off, such as \
                          view01_on.png and view01_off.png."
                }
            };
            gaps.add(Part::Pictures, sentence);
        }
        views
    }

    fn tell_unpaired(&self, pairing: &Pairing, gaps: &mut Gaps) {
        let names: Vec<&str> = pairing
            .unpaired
            .iter()
            .map(|one| one.picture.as_str())
            .collect();
        if !names.is_empty() && !pairing.pairs.is_empty() {
            let (what, has) = (
                count(names.len(), "picture"),
                if names.len() == 1 { "has" } else { "have" },
            );
            gaps.add(
                Part::Pictures,
                format!("{what} {has} no partner: {}.", some_of(&names)),
            );
        }
    }

    /// Where the camera is on the flange. Where poses are the camera's own, the flange is the camera.
    fn hand(&self, gaps: &mut Gaps) -> Option<PoseEntry> {
        if !self.has_hand() {
            return Some(pose_entry([1.0, 0.0, 0.0, 0.0], [0.0; 3]));
        }
        let rotation = self.numbers::<4>(Key::HandRotation, gaps);
        let translation = self.numbers(Key::HandTranslation, gaps);
        let (rotation, translation) = (rotation?, translation?);
        let length = rotation.iter().map(|part| part * part).sum::<f64>().sqrt();
        if (length - 1.0).abs() > 0.01 {
            gaps.add(
                Part::Poses,
                format!(
                    "Camera on the flange: a quaternion of length {length:.3}; a rotation's is 1."
                ),
            );
        }
        Some(pose_entry(rotation, translation))
    }

    fn laser(&self, gaps: &mut Gaps) -> Option<LaserEntry> {
        let is_line = self.answers.get(Key::LaserKind) == "line";
        let (kind, key) = match is_line {
            true => (LaserKind::Line, Key::LaserNormal),
            false => (LaserKind::Spot, Key::LaserDirection),
        };
        let origin = self.numbers(Key::LaserOrigin, gaps);
        let vector = self.numbers(key, gaps);
        let (origin, vector) = (origin?, vector?);
        Some(LaserEntry {
            kind,
            origin,
            direction: (!is_line).then_some(vector),
            normal: is_line.then_some(vector),
            extra: Default::default(),
        })
    }

    fn shape(&self) -> VesselShape {
        match self.answers.get(Key::Shape) {
            "plane" => VesselShape::Plane,
            "cylinder" => VesselShape::Cylinder,
            "sphere" => VesselShape::Sphere,
            "freeform" => VesselShape::Freeform,
            _ => VesselShape::Auto,
        }
    }

    fn vessel(&self, gaps: &mut Gaps) -> Option<VesselEntry> {
        let wall_thickness = self.one(Key::WallThickness, gaps);
        let wanted = self.known_wall_keys();
        let mut place = |key: Key| wanted.contains(&key).then(|| self.numbers(key, gaps))?;
        let [point, normal] = [Key::WallPoint, Key::WallNormal].map(&mut place);
        let [axis_point, axis] = [Key::WallAxisPoint, Key::WallAxis].map(&mut place);
        let center = place(Key::WallCentre);
        let radius = wanted.contains(&Key::WallRadius);
        let radius = radius.then(|| self.one(Key::WallRadius, gaps)).flatten();
        let far_wall = self.has_far_wall().then(|| self.far_wall(gaps)).flatten();
        Some(VesselEntry {
            shape: self.shape(),
            wall_thickness: wall_thickness?,
            point,
            normal,
            axis_point,
            axis,
            center,
            radius,
            far_wall,
            extra: Default::default(),
        })
    }

    fn far_wall(&self, gaps: &mut Gaps) -> Option<FarWall> {
        let distance = self.one(Key::FarDistance, gaps);
        let thickness = self.one(Key::FarThickness, gaps);
        Some(FarWall {
            distance: distance?,
            thickness: thickness?,
            extra: Default::default(),
        })
    }

    fn media(&self, gaps: &mut Gaps) -> Option<MediaEntry> {
        let outside = self.one(Key::IndexOutside, gaps);
        let wall = self.one(Key::IndexWall, gaps);
        let inside = match self.answers.get(Key::IndexKnown) {
            "no" => Some(None),
            _ => self.one(Key::IndexInside, gaps).map(Some),
        };
        Some(MediaEntry {
            outside: outside?,
            wall: wall?,
            inside: inside?,
            extra: Default::default(),
        })
    }

    /// What is known of the object; its faces are found.
    fn known(&self, gaps: &mut Gaps) -> Vec<KnownShape> {
        let of = |kind, degrees, mm| KnownShape {
            kind,
            degrees,
            mm,
            weight: 1.0,
            views: None,
            extra: Default::default(),
        };
        let angle = self.below(180.0, Key::KnownAngle, gaps);
        let edge = self.below(f64::INFINITY, Key::KnownEdge, gaps);
        let radius = self.below(f64::INFINITY, Key::KnownRadius, gaps);
        let is_flat = self.answers.get(Key::KnownFlat) == "yes";
        let known = [
            angle.map(|degrees| of(KnownKind::PlaneAngle, Some(degrees), None)),
            edge.map(|mm| of(KnownKind::EdgeLength, None, Some(mm))),
            radius.map(|mm| of(KnownKind::Radius, None, Some(mm))),
            is_flat.then(|| of(KnownKind::Flatness, None, None)),
        ];
        known.into_iter().flatten().collect()
    }

    /// What was typed, and nothing for what was not: the manifest's defaults are the form's.
    fn calibration_sigma(&self, gaps: &mut Gaps) -> Option<CalibrationSigmaEntry> {
        let mut of = |key: Key| self.optional(key, gaps);
        let entry = CalibrationSigmaEntry {
            laser_origin: of(Key::SigmaLaserOrigin),
            laser_direction: of(Key::SigmaLaserDirection),
            focal_length: of(Key::SigmaFocal),
            principal_point: of(Key::SigmaCentre),
            hand_eye_rotation: of(Key::SigmaHandRotation),
            hand_eye_translation: of(Key::SigmaHandTranslation),
            extra: Default::default(),
        };
        let given = [
            entry.laser_origin,
            entry.laser_direction,
            entry.focal_length,
            entry.principal_point,
            entry.hand_eye_rotation,
            entry.hand_eye_translation,
        ];
        given.iter().any(Option::is_some).then_some(entry)
    }

    /// A number between 0 and a limit, if one is given.
    fn below(&self, limit: f64, key: Key, gaps: &mut Gaps) -> Option<f64> {
        let number = self.optional(key, gaps)?;
        if number > 0.0 && number < limit {
            return Some(number);
        }
        let name = key.question().label;
        let most = match limit.is_finite() {
            true => format!(" and less than {limit}"),
            false => String::new(),
        };
        gaps.add(
            key.question().part,
            format!("{name}: {number}; it is more than 0{most}."),
        );
        None
    }

    fn optional(&self, key: Key, gaps: &mut Gaps) -> Option<f64> {
        match self.answers.get(key) {
            "" => None,
            _ => self.one(key, gaps),
        }
    }

    fn one(&self, key: Key, gaps: &mut Gaps) -> Option<f64> {
        self.numbers(key, gaps).map(|[number]| number)
    }

    fn numbers<const N: usize>(&self, key: Key, gaps: &mut Gaps) -> Option<[f64; N]> {
        let numbers = self.answers.numbers(key);
        numbers
            .map_err(|sentence| gaps.add(key.question().part, sentence))
            .ok()
    }
}

#[derive(Default)]
struct Gaps(Vec<Gap>);

impl Gaps {
    fn add(&mut self, part: Part, sentence: impl Into<String>) {
        self.0.push(Gap {
            part,
            sentence: sentence.into(),
        });
    }

    /// The last word is the archive's own check.
    fn check(&mut self, manifest: Manifest) -> Option<Manifest> {
        match Scan::new(manifest) {
            Ok(scan) => Some(scan.manifest),
            Err(error) => {
                self.add(part_of(&error), format!("{error}."));
                None
            }
        }
    }
}

/// Where an error of a manifest belongs.
fn part_of(error: &ScanError) -> Part {
    let place = error.to_string();
    let parts = [
        ("camera", Part::Camera),
        ("laser", Part::Laser),
        ("vessel", Part::Vessel),
        ("media", Part::Media),
        ("calibration_sigma", Part::Calibration),
        ("flange_from_camera", Part::Poses),
    ];
    let part = parts.iter().find(|(key, _)| place.starts_with(key));
    part.map_or(Part::Pictures, |(_, part)| *part)
}

/// The two frames that a list's poses join.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Frames {
    /// Of the flange, or of the camera where there is no flange, in the world.
    InWorld,
    /// Of the world, seen from the flange or the camera.
    OfWorld,
}

impl Frames {
    fn named(word: &str) -> Option<Self> {
        match word {
            "world-from-flange" | "world-from-camera" => Some(Self::InWorld),
            "flange-from-world" | "camera-from-world" => Some(Self::OfWorld),
            _ => None,
        }
    }
}

/// A view of the manifest, with its pose in the direction that the motion asks for.
fn entry(
    view: &Pair,
    pose: &ListedPose,
    frames: Frames,
    motion: Motion,
    inside: InsideMedium,
) -> ViewEntry {
    let wanted = match motion {
        Motion::Rig => Frames::InWorld,
        Motion::Vessel => Frames::OfWorld,
    };
    // What is written in the right direction is taken over to the last digit.
    let pose_entry = if frames == wanted {
        pose_entry(pose.rotation, pose.translation)
    } else {
        inverted(pose)
    };
    let (world_from_flange, flange_from_world) = match motion {
        Motion::Rig => (Some(pose_entry), None),
        Motion::Vessel => (None, Some(pose_entry)),
    };
    ViewEntry {
        id: view.id.clone(),
        on: view.on.clone(),
        off: view.off.clone(),
        world_from_flange,
        flange_from_world,
        inside,
        extra: Default::default(),
    }
}

/// The pose read the other way; its quaternion's length was checked when it was read.
fn inverted(pose: &ListedPose) -> PoseEntry {
    let read = Pose::<World, Flange>::new(pose.rotation, pose.translation);
    let inverse = read.unwrap_or_else(|_| Pose::identity()).inverse();
    pose_entry(inverse.quaternion(), inverse.translation().into())
}

fn pose_entry(rotation: [f64; 4], translation: [f64; 3]) -> PoseEntry {
    PoseEntry {
        rotation,
        translation,
        extra: Default::default(),
    }
}
