//! How object points stand to the truth.

use nalgebra::Vector3;

#[derive(Debug, Default)]
pub struct Errors {
    /// How many points there are, and how many of them were found.
    pub wanted: f64,
    pub found: f64,
    squares: f64,
    within: f64,
}

impl Errors {
    /// Counts a true point and what was found of it: a place with its standard deviations.
    pub fn count(&mut self, there: [f64; 3], found: Option<([f64; 3], [f64; 3])>) {
        self.wanted += 1.0;
        let Some((here, sigma)) = found else {
            return;
        };
        self.found += 1.0;
        let off = Vector3::from(here) - Vector3::from(there);
        self.squares += off.norm_squared();
        let within = (0..3).filter(|axis| off[*axis].abs() <= 2.0 * sigma[*axis]);
        self.within += within.count() as f64 / 3.0;
    }

    /// Root mean square error, mm.
    pub fn rms(&self) -> f64 {
        (self.squares / self.found).sqrt()
    }

    /// Of the coordinates, the share within two standard deviations.
    pub fn honest(&self) -> f64 {
        self.within / self.found
    }

    pub fn add(&mut self, other: &Self) {
        self.wanted += other.wanted;
        self.found += other.found;
        self.squares += other.squares;
        self.within += other.within;
    }
}
