//! Refractive indices of common liquids, to hold an estimate against.

use serde::Serialize;

/// A liquid's index at a temperature, over the wavelength.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Liquid {
    /// Its name.
    pub name: &'static str,
    /// Degrees Celsius at which it was measured.
    pub temperature: f64,
    /// How the index changes with temperature near that, per kelvin.
    pub per_kelvin: f64,
    /// Who measured it. The coefficients are those of refractiveindex.info (CC0).
    pub source: &'static str,
    dispersion: Dispersion,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
enum Dispersion {
    /// Pairs of B and C: `n^2 = 1 + sum B w^2 / (w^2 - C)`, w the wavelength in micrometres.
    Sellmeier([(f64, f64); 4]),
    /// A, B and C: `n = A + B / w^2 + C / w^4`.
    Cauchy([f64; 3]),
}

/// Liquids that vessels are filled with.
pub const LIQUIDS: [Liquid; 3] = [
    Liquid {
        name: "water",
        temperature: 20.0,
        per_kelvin: -0.9e-4,
        source: "M. Daimon and A. Masumura, Appl. Opt. 46, 3811 (2007)",
        dispersion: Dispersion::Sellmeier([
            (5.684_027_565e-1, 5.101_829_712e-3),
            (1.726_177_391e-1, 1.821_153_936e-2),
            (2.086_189_578e-2, 2.620_722_293e-2),
            (1.130_748_688e-1, 1.069_792_721e1),
        ]),
    },
    Liquid {
        name: "ethanol",
        temperature: 20.0,
        per_kelvin: -4.0e-4,
        source: "J. Rheims, J. Koeser and T. Wriedt, Meas. Sci. Technol. 8, 601 (1997)",
        dispersion: Dispersion::Cauchy([1.352_65, 0.003_06, 0.000_02]),
    },
    Liquid {
        name: "glycerol",
        temperature: 20.0,
        per_kelvin: -2.3e-4,
        source: "J. Rheims, J. Koeser and T. Wriedt, Meas. Sci. Technol. 8, 601 (1997)",
        dispersion: Dispersion::Cauchy([1.457_97, 0.005_98, -0.000_36]),
    },
];

impl Liquid {
    /// Its index at a wavelength in air, nm (400 to 1000), and a temperature, degrees Celsius.
    ///
    /// ```
    /// let water = snellius::index::LIQUIDS[0];
    /// assert!((water.index(635.0, 20.0) - 1.3320).abs() < 1e-4);
    /// ```
    pub fn index(&self, wavelength: f64, temperature: f64) -> f64 {
        let square = (wavelength * 1e-3) * (wavelength * 1e-3);
        let at_its_own = match &self.dispersion {
            Dispersion::Sellmeier(terms) => {
                let term = |(b, c): &(f64, f64)| b * square / (square - c);
                (1.0 + terms.iter().map(term).sum::<f64>()).sqrt()
            }
            Dispersion::Cauchy([a, b, c]) => a + b / square + c / (square * square),
        };
        at_its_own + self.per_kelvin * (temperature - self.temperature)
    }
}
