//! A launched run as text.

use crate::acoustic_text;
use crate::inference::{Inference, Origin, by_origin};
use crate::inference_text;
use crate::packing_text::{self, indented};
use crate::read_back::WithinPhases;
use crate::summary::Summary;
use grainlab_console::count;

/// Each packing, its waves, and the estimates of every model.
pub fn text(s: &Summary) -> String {
    let (scene, seed, of) = (&s.launched.scene, s.launched.seed, s.states.len());
    let mut text = String::new();
    for (n, state) in s.states.iter().enumerate() {
        text +=
            &format!("State {} of {of}: scene {scene}, seed {seed}, step {}\n", n + 1, state.packing.step);
        text += &packing_text::text(&state.packing);
        state.acoustics().for_each(|a| text += &acoustic_text::text(a, &state.packing.report));
        by_origin(&state.results).iter().for_each(|group| text += &inferred(group));
        text.push('\n');
    }
    if s.within_phases.packings > 0 {
        let WithinPhases { packings, structures, moduli } = s.within_phases;
        text += &format!(
            "Within phases: {} recorded, {structures} with a structure, {moduli} with moduli: \
             grainlab analyze RECORDING --format csv\n\n",
            count(packings, "packing")
        );
    }
    for group in by_origin(&s.of_instruments) {
        text += &format!("Of no packing of the run\n{}\n", inferred(&group));
    }
    text
}

fn inferred((origin, results): &(Origin, Vec<&Inference>)) -> String {
    let data = origin.data_and_node().unwrap_or_else(|| "data".to_owned());
    let table = inference_text::table(&results.iter().copied().cloned().collect::<Vec<_>>());
    format!("  inferred from {data}\n{}", indented(&table))
}
