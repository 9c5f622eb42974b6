use super::ReconstructionResult;

/// A point of the object with what is known of it. Lengths in mm, world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ObjectPoint {
    pub(super) place: [f64; 3],
    /// One standard deviation along each axis, without what calibration adds.
    pub(super) sigma: [f64; 3],
    pub(super) ray_distance: f64,
    /// The sweep it belongs to, from 0.
    pub(super) scan: u32,
    /// The view it belongs to, from 0.
    pub(super) view: u32,
}

impl ObjectPoint {
    /// Names and values of what a point carries besides its place, in the order of every format.
    pub(super) const MEASURES: [&str; 4] = ["sigma_x", "sigma_y", "sigma_z", "ray_distance"];

    pub(super) fn measures(&self) -> [f64; 4] {
        let [x, y, z] = self.sigma;
        [x, y, z, self.ray_distance]
    }
}

/// The object's points, view by view.
pub(super) fn object_points(
    result: &ReconstructionResult,
) -> impl Iterator<Item = ObjectPoint> + '_ {
    result.views.iter().enumerate().flat_map(|(number, view)| {
        let points = view.object.iter().zip(view.object_sigma.iter());
        let points = points.zip(view.ray_distance.iter());
        points.map(move |((place, sigma), ray_distance)| ObjectPoint {
            place: *place,
            sigma: *sigma,
            ray_distance: *ray_distance,
            scan: view.sweep,
            view: number as u32,
        })
    })
}
