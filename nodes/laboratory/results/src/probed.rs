//! A packing with its wave speeds: the output of `grainlab probe`.

use crate::acoustic::{ACOUSTIC, AcousticReport};
use crate::acoustic_text;
use crate::measured_packing::{MeasuredPacking, ORIGIN};
use crate::packing_text;
use crate::printer::Printed;
use crate::quantities::{cells, columns};
use grainlab_console::Table;
use grainlab_core::quantity::{Quantity, by_key};
use grainlab_core::results::{InferredQuantity, PackingReport, QUANTITIES};
use serde::Serialize;

/// The measurements on one packing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probed {
    /// Structure and stiffness.
    #[serde(flatten)]
    pub packing: MeasuredPacking,
    /// The waves; null if no wave propagates.
    pub acoustic: Option<AcousticReport>,
}

/// Quantities of the packing in CSV: the inputs of an inversion besides the speeds, and its truth. The moduli
/// are those from the speeds, under the names that `grainlab invert --table` reads.
fn inputs_and_truth() -> impl Iterator<Item = &'static Quantity<PackingReport>> {
    let inputs = ["grains", "phi", "axial_q_over_p", "size_spread", "pressure_pa"];
    let grains = ["grain_shear_modulus_pa", "poisson", "contact_law", "smooth"];
    let truth = InferredQuantity::countable().map(InferredQuantity::name);
    let keys = inputs.into_iter().chain(grains).chain(truth).chain(["rattlers"]);
    keys.filter_map(|key| by_key(QUANTITIES, key))
}

impl Printed for Probed {
    fn warnings(&self) -> Vec<String> {
        let p = &self.packing;
        let of_waves = self.acoustic.iter().flat_map(AcousticReport::notes);
        p.warnings()
            .into_iter()
            .chain(of_waves.map(|w| format!("{}, step {}: {w}", p.source, p.step)))
            .collect()
    }

    fn text(&self) -> String {
        let p = &self.packing;
        let mut text = format!("{}, step {}\n{}", p.source, p.step, packing_text::text(p));
        if let Some(a) = &self.acoustic {
            text += &acoustic_text::text(a, &p.report);
        }
        text
    }

    fn table(results: &[Self]) -> Table {
        let origin = || ORIGIN.iter().take(2);
        let mut t = Table::new(columns(origin()).chain(columns(ACOUSTIC)).chain(columns(inputs_and_truth())));
        for Probed { packing, acoustic } in results {
            let none = || columns(ACOUSTIC).map(|_| String::new()).collect();
            let acoustic: Vec<String> = acoustic.as_ref().map_or_else(none, |a| cells(ACOUSTIC, a).collect());
            t.row(cells(origin(), packing).chain(acoustic).chain(cells(inputs_and_truth(), &packing.report)));
        }
        t
    }
}
