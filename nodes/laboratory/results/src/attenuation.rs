//! Attenuation of the waves of one packing, as JSON and as text.

use grainlab_console::{Table, fixed};
use grainlab_core::Packing;
use grainlab_core::results::{Attenuation, AttenuationPoint, ContactLoss, RESOLVED, Scattering};
use serde::Serialize;
use std::f64::consts::TAU;

/// 1/Q of each ray and mode against frequency, by the dashpots of the contacts and by scattering.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AttenuationReport {
    /// Contact damping, share of critical.
    contact_damping: f64,
    /// Least number of modes of the periodic packing in the width of a line for scattering to be resolved.
    least_modes_in_width: f64,
    /// One per ray and polarization.
    waves: Vec<WaveView>,
}

/// Arrays against wavelength, longest first. Values that are not known are null.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct WaveView {
    direction: [f64; 3],
    polarization: [f64; 3],
    wavelength_m: Vec<f64>,
    /// Mean grain diameters.
    wavelength_diameters: Vec<f64>,
    /// Frequency of the damped mode.
    contact_frequency_hz: Vec<Option<f64>>,
    contact_inverse_q: Vec<Option<f64>>,
    contact_inverse_q_sigma: Vec<Option<f64>>,
    contact_inverse_q_first_order: Vec<Option<f64>>,
    /// Frequency of the coherent wave without dashpots.
    scattering_frequency_hz: Vec<Option<f64>>,
    /// Null where the packing is too small: then 1/Q is below `scattering_least_inverse_q`.
    scattering_inverse_q: Vec<Option<f64>>,
    scattering_inverse_q_sigma: Vec<Option<f64>>,
    /// The least 1/Q that a packing of this size resolves at this frequency.
    scattering_least_inverse_q: Vec<Option<f64>>,
    scattering_modes_in_width: Vec<Option<f64>>,
}

impl AttenuationReport {
    /// From curves of this packing with this contact damping, share of critical.
    pub fn new(packing: &Packing, contact_damping: f64, curves: Vec<Attenuation>) -> Self {
        let diameter = 2.0 * packing.radii.iter().sum::<f64>() / packing.grains() as f64;
        Self {
            contact_damping,
            least_modes_in_width: RESOLVED,
            waves: curves.iter().map(|curve| WaveView::new(curve, diameter)).collect(),
        }
    }

    /// A table with one row per wave and wavelength.
    pub(crate) fn text(&self) -> String {
        let mut t =
            Table::new(["ray", "wave", "length/d", "f/kHz", "1/Q dashpots", "1/Q scattering", "sigma"]);
        for w in &self.waves {
            let [x, y, z] = w.direction;
            let along: f64 = w.direction.iter().zip(&w.polarization).map(|(d, p)| d * p).sum();
            for k in 0..w.wavelength_m.len() {
                let frequency = w.scattering_frequency_hz[k].or(w.contact_frequency_hz[k]);
                let least = w.scattering_least_inverse_q[k].filter(|least| *least < 1.0);
                let bound = || least.map_or_else(|| "-".to_owned(), |least| format!("<{least:.3}"));
                let scattering = w.scattering_inverse_q[k];
                t.row([
                    format!("({x:.2}, {y:.2}, {z:.2})"),
                    if 2.0 * along * along > 1.0 { "P" } else { "S" }.to_owned(),
                    format!("{:.0}", w.wavelength_diameters[k]),
                    fixed(frequency.map(|f| f / 1e3), 2),
                    fixed(w.contact_inverse_q[k], 5),
                    scattering.map_or_else(bound, |loss| format!("{loss:.3}")),
                    fixed(w.scattering_inverse_q_sigma[k].filter(|_| scattering.is_some()), 3),
                ]);
            }
        }
        let damping = self.contact_damping;
        format!(
            "attenuation, with dashpots of {damping} of critical damping and, without them, by scattering\n{}",
            t.text()
        )
    }
}

impl WaveView {
    fn new(curve: &Attenuation, diameter: f64) -> Self {
        let points = &curve.points;
        let wavelength = |p: &AttenuationPoint| TAU / p.wavenumber;
        let contact =
            |of: fn(&ContactLoss) -> f64| points.iter().map(|p| p.contact.as_ref().map(of)).collect();
        let scattering = |of: fn(&Scattering) -> Option<f64>| {
            points.iter().map(|p| p.scattering.as_ref().and_then(of)).collect()
        };
        Self {
            direction: curve.direction.into(),
            polarization: curve.polarization.into(),
            wavelength_m: points.iter().map(wavelength).collect(),
            wavelength_diameters: points.iter().map(|p| wavelength(p) / diameter).collect(),
            contact_frequency_hz: contact(|c| c.omega / TAU),
            contact_inverse_q: contact(|c| c.loss),
            contact_inverse_q_sigma: contact(|c| c.stddev),
            contact_inverse_q_first_order: contact(|c| c.first_order),
            scattering_frequency_hz: scattering(|s| Some(s.omega / TAU)),
            scattering_inverse_q: scattering(|s| s.is_resolved().then_some(s.loss)),
            scattering_inverse_q_sigma: scattering(|s| s.is_resolved().then_some(s.stddev)),
            scattering_least_inverse_q: scattering(|s| Some(s.least_loss)),
            scattering_modes_in_width: scattering(|s| Some(s.modes_in_width)),
        }
    }
}
