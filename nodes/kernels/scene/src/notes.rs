//! Notes for the reader of a scene, which are no faults.

use crate::model::{Phase, Scene};
use grainlab_core::{ComponentControl, SymTensor};

/// Density, kg/m³, below which one in g/cm³ is more probable.
const LIGHT: f64 = 30.0;

impl Scene {
    /// Notes on the scene, one line each: components that stay uncontrolled while others are controlled, and packings published at
    /// another friction than they were prepared with.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = grouped(&self.phases, |_, phase| uncontrolled(phase));
        let friction = |n: usize, phase: &Phase| {
            (phase.publish || phase.record.is_some()).then(|| self.friction_before(n))?
        };
        notes.extend(grouped(&self.phases, friction));
        let density = self.material.density;
        if density < LIGHT {
            notes.push(format!(
                "material.density is {density} kg/m3, lighter than grains are: check its unit"
            ));
        }
        let shear_modulus = self.material.shear_modulus_doubt();
        notes.extend(shear_modulus.map(|doubt| format!("material.shear_modulus is {doubt}")));
        notes
    }

    /// The frictions before phase `n` that differ from its own, if any does; a gas has none.
    fn friction_before(&self, n: usize) -> Option<String> {
        let own = self.phases[n].friction;
        let mut before: Vec<f64> = Vec::new();
        let hard = |p: &&Phase| !matches!(p.kind, crate::model::PhaseKind::Gas { .. });
        for phase in self.phases[..n].iter().filter(hard) {
            if !before.contains(&phase.friction) {
                before.push(phase.friction);
            }
        }
        let differs = before.iter().any(|mu| *mu != own);
        let before: Vec<String> = before.iter().map(ToString::to_string).collect();
        differs.then(|| {
            format!(
                "measured at friction {own}, prepared at friction {}: phase.NAME.friction sets it",
                before.join(", ")
            )
        })
    }
}

/// Components whose strain is held while the stress of others is controlled.
fn uncontrolled(phase: &Phase) -> Option<String> {
    let controls = phase.controls();
    let of = |wanted: fn(&ComponentControl) -> bool| -> Vec<&str> {
        (0..6).filter(|c| wanted(&controls[*c])).map(|c| SymTensor::COMPONENTS[c]).collect()
    };
    let held = of(|c| matches!(c, ComponentControl::Held));
    let stressed = of(|c| matches!(c, ComponentControl::Stress(_)));
    (!held.is_empty() && !stressed.is_empty()).then(|| {
        format!(
            "the strain of {} is held, and stress remains there (q/p is not 0), while the stress of {} is controlled; \
             {{ stress = 0 }} lets a shear stress vanish",
            held.join(", "),
            stressed.join(", ")
        )
    })
}

/// One line for all phases of one note, with their names.
fn grouped(phases: &[Phase], note: impl Fn(usize, &Phase) -> Option<String>) -> Vec<String> {
    let mut found: Vec<(String, Vec<&str>)> = Vec::new();
    for (n, phase) in phases.iter().enumerate() {
        let Some(text) = note(n, phase) else { continue };
        match found.iter_mut().find(|(known, _)| *known == text) {
            Some((_, names)) => names.push(&phase.name),
            None => found.push((text, vec![&phase.name])),
        }
    }
    let line = |(text, names): (String, Vec<&str>)| {
        let shown = if names.len() > 4 {
            format!("{}, ... {}", names[..2].join(", "), names[names.len() - 1])
        } else {
            names.join(", ")
        };
        format!("{} {shown}: {text}", if names.len() > 1 { "phases" } else { "phase" })
    };
    found.into_iter().map(line).collect()
}
