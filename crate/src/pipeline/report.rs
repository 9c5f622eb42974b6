//! From a reconstruction to its public format.

use super::Reconstruction;
use crate::export::{
    BaseResult, GlowResult, InsideResult, LineResult, MediaResult, OneOrMany, ReconstructionFormat,
    ReconstructionResult, RefusedResult, ShapeChoiceResult, SpotResult, SpotRole, Status,
    VesselResult, ViewResult, WallResult,
};
use crate::geometry::Point;
use crate::object::{Choice, ObjectPoint};
use crate::optics::{BaseShape, Freeform, Surface};
use crate::rig::Laser;
use crate::scan::{LengthUnit, sweeps};

impl Reconstruction<'_> {
    /// The reconstruction in its public format.
    pub fn result(&self) -> ReconstructionResult {
        let manifest = &self.scan.manifest;
        let sweeps = sweeps(&self.scan.stations);
        let views = sweeps.into_iter().enumerate();
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
            views: views
                .map(|(view, sweep)| self.view_result(view, sweep as u32))
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

    fn view_result(&self, view: usize, sweep: u32) -> ViewResult {
        let choice = &self.object[view];
        let status = self.status(view);
        let points =
            |value: fn(&ObjectPoint) -> [f64; 3]| self.of_laser(choice.points.iter().map(value));
        ViewResult {
            id: self.scan.manifest.views[view].id.clone(),
            sweep,
            status,
            reason: self.reason(view),
            inside_proposed: self.inside_proposed[view],
            inside: self.inside_proposed[view]
                .filter(|inside| *inside == self.stations[view].inside),
            vessel: self.of_laser(self.vessel.points[view].iter().map(|p| p.point.to_array())),
            object: points(|p| p.meeting.point().to_array()),
            object_sigma: points(|p| p.noise.sigma().into()),
            object_sigma_calibration: self
                .of_laser(self.common_sigmas[view].iter().map(|s| s.point.into())),
            ray_distance: self.of_laser(choice.points.iter().map(|p| p.meeting.gap().abs())),
            object_unrefracted: self.of_laser(
                self.unrefracted[view]
                    .iter()
                    .map(|point| point.map(Point::to_array)),
            ),
            spots: match self.scan.rig.laser {
                Laser::Beam(_) => self.spot_results(view),
                Laser::Sheet(_) => Vec::new(),
            },
            line: match self.scan.rig.laser {
                Laser::Beam(_) => None,
                Laser::Sheet(_) => Some(self.line_result(view)),
            },
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

    fn line_result(&self, view: usize) -> LineResult {
        let choice = &self.object[view];
        let spots = &self.spots[view].spots;
        let pixel = |spot: usize| [spots[spot].u, spots[spot].v];
        let on_vessel = self.vessel.points[view].iter().map(|p| p.spot);
        let on_object = choice.points.iter().map(|p| p.spot);
        let mut is_stray = vec![true; spots.len()];
        for spot in on_vessel.clone().chain(on_object.clone()) {
            is_stray[spot] = false;
        }
        LineResult {
            vessel: on_vessel.map(pixel).collect(),
            object: on_object.map(pixel).collect(),
            stray: (0..spots.len())
                .filter(|s| is_stray[*s])
                .map(pixel)
                .collect(),
            refused: refused_alike(choice),
        }
    }

    fn reason(&self, view: usize) -> Option<String> {
        let choice = &self.object[view];
        match self.status(view) {
            Status::Ok => None,
            Status::NoVesselSpot if choice.refused.is_empty() => Some("no laser spot".to_owned()),
            Status::NoVesselSpot => {
                Some("no spot lies on the wall, and none on the object".to_owned())
            }
            Status::NoObjectSpot => Some("no spot but the wall's".to_owned()),
            Status::Rejected => match self.scan.rig.laser {
                // The brightest spot comes first, and its refusal is the one to know.
                Laser::Beam(_) => choice.refused.first().map(|(_, why)| why.to_string()),
                Laser::Sheet(_) => refused_alike(choice).into_iter().next().map(|r| r.reason),
            },
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
    let (base, radius) = match sheet.base.shape {
        BaseShape::Plane => (BaseResult::Plane, None),
        BaseShape::Cylinder { radius } => (BaseResult::Cylinder, Some(radius)),
        BaseShape::Sphere { radius } => (BaseResult::Sphere, Some(radius)),
    };
    WallResult::Freeform {
        base,
        radius,
        origin: sheet.base.origin.to_array(),
        normal: sheet.base.normal.vector().into(),
        tangents: sheet.base.tangents.map(Into::into),
        start: sheet.grid.start.into(),
        step: sheet.grid.step.into(),
        columns: sheet.grid.columns,
        rows: sheet.grid.rows,
        heights: sheet.heights.clone(),
        patch: sheet.patch.iter().map(|corner| (*corner).into()).collect(),
    }
}

/// Why points of a line were refused, most frequent first.
fn refused_alike(choice: &Choice) -> Vec<RefusedResult> {
    RefusedResult::alike(choice.refused.iter().map(|(_, refusal)| refusal.kind()))
}
