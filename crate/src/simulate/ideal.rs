//! Spots without pictures: where the lens sees them, and normal noise. Thousands of scans can be
//! simulated in the time of one with pictures.

use nalgebra::Vector2;

use super::Simulation;
use super::noise::Normal;
use crate::camera::Pixel;
use crate::spots::{Spot, Spots};

impl Simulation {
    /// The spots of a view with centroids off by normal noise of standard deviation `sigma`, px, along
    /// each axis: the vessel's, in which both glows of the wall are merged, and the object's.
    pub fn spots(&self, view: usize, sigma: f64, seed: u64) -> Spots {
        let mut normal = Normal::new(super::noise::seed(seed, view, true));
        let landing = self.landing(view, &self.scan.rig.laser.axis());
        let seen = |point: Option<_>, faces: usize| {
            let pixel = self.seen(view, point?, faces)?;
            let camera = &self.scan.rig.camera;
            let within = (0.0..f64::from(camera.width)).contains(&pixel.u)
                && (0.0..f64::from(camera.height)).contains(&pixel.v);
            within.then_some(pixel)
        };
        let brightness = &self.scene.brightness;
        let mut spots = Vec::new();
        if let Some(outer) = seen(landing.outer(), 0) {
            let light = brightness.outer_face + brightness.inner_face;
            let inner = seen(landing.inner(), 1).unwrap_or(outer);
            let offset = Vector2::new(inner.u - outer.u, inner.v - outer.v);
            spots.push(self.spot(outer, offset, brightness.inner_face / light, light));
        }
        if let Some(pixel) = seen(landing.object, self.faces()) {
            spots.push(self.spot(pixel, Vector2::zeros(), 0.0, brightness.object));
        }
        for spot in &mut spots {
            spot.u += sigma * normal.next();
            spot.v += sigma * normal.next();
            spot.covariance = [sigma * sigma, 0.0, sigma * sigma];
        }
        Spots {
            spots,
            said: Vec::new(),
            noise: self.scene.noise.read,
            line: None,
        }
    }

    /// A spot of two glows, the second of which has the share q of the light and lies `offset` from the
    /// first: its moments are those of the mixture.
    fn spot(&self, first: Pixel, offset: Vector2<f64>, q: f64, light: f64) -> Spot {
        let blur = self.scene.beam.blur * self.scene.beam.blur;
        let (x, y) = (offset.x, offset.y);
        let second = q * (1.0 - q);
        let third = second * (1.0 - 2.0 * q);
        Spot {
            u: first.u + q * x,
            v: first.v + q * y,
            covariance: [0.0; 3],
            shape: [blur + second * x * x, second * x * y, blur + second * y * y],
            skew: [
                third * x * x * x,
                third * x * x * y,
                third * x * y * y,
                third * y * y * y,
            ],
            brightness: light,
            peak: light / (2.0 * std::f64::consts::PI * blur),
            area: 40,
            saturated: false,
        }
    }
}
