//! From a reconstruction to its public format.

use super::Reconstruction;
use crate::export::{
    GlowResult, InsideResult, MediaResult, OneOrMany, ReconstructionFormat, ReconstructionResult,
    ShapeChoiceResult, SpotResult, SpotRole, Status, VesselResult, ViewResult, WallResult,
};
use crate::object::{Choice, ObjectPoint};
use crate::optics::{Freeform, Surface};
use crate::rig::Laser;
use crate::scan::LengthUnit;

impl Reconstruction<'_> {
    /// The reconstruction in its public format.
    pub fn result(&self) -> ReconstructionResult {
        let manifest = &self.scan.manifest;
        ReconstructionResult {
            format: ReconstructionFormat::RefractiveReconstruction,
            version: 1,
            scan: manifest.name.clone(),
            length_unit: LengthUnit::Millimetre,
            media: MediaResult {
                outside: self.media.outside,
                wall: self.media.wall,
                inside: InsideResult {
                    value: self.index.value,
                    sigma: self.index.sigma,
                    method: self.index.method,
                    verdict: self.index.verdict,
                    interval: self.index.interval,
                    reason: self.index.reason.clone(),
                },
            },
            vessel: self.vessel_result(),
            views: (0..manifest.views.len())
                .map(|view| self.view_result(view))
                .collect(),
            warnings: self.warnings().into_iter().map(|w| w.text).collect(),
        }
    }

    fn vessel_result(&self) -> VesselResult {
        let wall = match &self.vessel.wall.outer {
            Surface::Plane(plane) => WallResult::Plane {
                point: plane.point.to_array(),
                normal: plane.normal.vector().into(),
            },
            Surface::Cylinder(cylinder) => WallResult::Cylinder {
                axis_point: cylinder.point.to_array(),
                axis: cylinder.axis.vector().into(),
                radius: cylinder.radius,
            },
            Surface::Sphere(sphere) => WallResult::Sphere {
                center: sphere.centre.to_array(),
                radius: sphere.radius,
            },
            Surface::Freeform(freeform) => freeform_result(freeform),
        };
        VesselResult {
            wall,
            wall_thickness: self.vessel.wall.thickness,
            rms: self.vessel.rms,
            points: self.vessel.points.iter().flatten().count(),
            glow: self.vessel.glows.map(|glows| GlowResult {
                inner_share: glows.share,
                inner_share_sigma: glows.share_sigma,
                thickness: glows.thickness,
            }),
            choice: self.vessel.choice.map(|choice| ShapeChoiceResult {
                chosen: choice.chosen,
                runner_up: choice.runner_up,
                margin: choice.margin,
            }),
        }
    }

    fn view_result(&self, view: usize) -> ViewResult {
        let choice = &self.object[view];
        let status = self.status(view);
        let points =
            |value: fn(&ObjectPoint) -> [f64; 3]| self.of_laser(choice.points.iter().map(value));
        ViewResult {
            id: self.scan.manifest.views[view].id.clone(),
            status,
            reason: reason(status, choice),
            vessel: self.of_laser(self.vessel.points[view].iter().map(|p| p.point.to_array())),
            object: points(|p| p.meeting.point().to_array()),
            object_sigma: points(|p| p.noise.sigma().into()),
            object_sigma_calibration: self
                .of_laser(self.common_sigmas[view].iter().map(|s| s.point.into())),
            ray_distance: self.of_laser(choice.points.iter().map(|p| p.meeting.gap().abs())),
            spots: self.spot_results(view),
        }
    }

    /// What a view gave, as its laser has it: one or none from a beam, a list from a sheet.
    fn of_laser<T>(&self, mut values: impl Iterator<Item = T>) -> OneOrMany<T> {
        match self.scan.rig.laser {
            Laser::Beam(_) => OneOrMany::One(values.next()),
            Laser::Sheet(_) => OneOrMany::Many(values.collect()),
        }
    }

    /// What became of a view.
    pub(super) fn status(&self, view: usize) -> Status {
        let choice = &self.object[view];
        let has_vessel = !self.vessel.points[view].is_empty();
        if !choice.points.is_empty() {
            Status::Ok
        } else if !has_vessel {
            Status::NoVesselSpot
        } else if choice.refused.is_empty() {
            Status::NoObjectSpot
        } else {
            Status::Rejected
        }
    }

    fn spot_results(&self, view: usize) -> Vec<SpotResult> {
        let choice = &self.object[view];
        let on_vessel = |spot: usize| self.vessel.points[view].iter().any(|p| p.spot == spot);
        let on_object = |spot: usize| choice.points.iter().any(|p| p.spot == spot);
        let spots = self.spots[view].spots.iter().enumerate();
        spots
            .map(|(index, spot)| SpotResult {
                pixel: [spot.u, spot.v],
                role: match index {
                    i if on_vessel(i) => SpotRole::Vessel,
                    i if on_object(i) => SpotRole::Object,
                    _ => SpotRole::Stray,
                },
                reason: choice
                    .refused
                    .iter()
                    .find(|(refused, _)| *refused == index)
                    .map(|(_, refusal)| refusal.to_string()),
            })
            .collect()
    }
}

/// A free-form wall as the spline that it is.
fn freeform_result(freeform: &Freeform) -> WallResult {
    let sheet = freeform.sheet();
    let (u, v) = sheet.reference.normal.tangents();
    WallResult::Freeform {
        origin: sheet.reference.point.to_array(),
        normal: sheet.reference.normal.vector().into(),
        tangents: [u.into(), v.into()],
        start: sheet.grid.start.into(),
        step: sheet.grid.step.into(),
        columns: sheet.grid.columns,
        rows: sheet.grid.rows,
        heights: sheet.heights.clone(),
        patch: sheet.patch.iter().map(|corner| (*corner).into()).collect(),
    }
}

fn reason(status: Status, choice: &Choice) -> Option<String> {
    match status {
        Status::Ok => None,
        Status::NoVesselSpot if choice.refused.is_empty() => Some("no laser spot".to_owned()),
        Status::NoVesselSpot => Some("no spot lies on the wall, and none on the object".to_owned()),
        Status::NoObjectSpot => Some("no spot but the wall's".to_owned()),
        // The brightest spot comes first, and its refusal is the one to know.
        Status::Rejected => choice
            .refused
            .first()
            .map(|(_, refusal)| refusal.to_string()),
    }
}
