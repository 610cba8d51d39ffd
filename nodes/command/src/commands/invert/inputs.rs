//! The inputs of a state: keys of a table's columns and of JSON, and the number that each one sets.

use super::state::State;
use grainlab_core::quantity::{Alias, by_key};
use grainlab_core::results::{InferredQuantity, QUANTITIES};
use grainlab_emt::{Measured, Modulus, Probe};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::sync::LazyLock;

/// Share of a quantity below which a standard deviation of 1 Pa and less is improbable.
const SHARE: f64 = 1e-5;

pub(super) struct Input {
    /// Name in JSON.
    pub(super) key: &'static str,
    /// Meaning; empty if the table of quantities contains it.
    meaning: &'static str,
    pub(super) role: Role,
    get: fn(&State) -> Option<f64>,
    set: fn(&mut State, f64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// The required input.
    Pressure,
    /// One of the moduli, which follow from the 36 entries of a stiffness, if given.
    Modulus,
    /// Standard deviation: 0 or more.
    Stddev,
    /// Another input of a model.
    Datum,
    Truth(InferredQuantity),
}

/// The inputs, one per row: key, role, meaning, getter and setter.
macro_rules! inputs {
    ($($key:literal $role:ident $meaning:literal |$from:ident| $get:expr, |$state:ident, $value:ident| $set:expr;)*) => {
        [$(Input {
            key: $key,
            meaning: $meaning,
            role: Role::$role,
            get: |$from| $get,
            set: |$state, $value| $set,
        }),*]
    };
}

/// Every input that a table may contain, in the order of JSON; the truths follow from the inferred quantities.
pub(super) static INPUTS: LazyLock<Vec<Input>> = LazyLock::new(|| {
    let truth = |q: InferredQuantity| Input {
        key: q.name(),
        meaning: q.meaning(),
        role: Role::Truth(q),
        get: |_| None,
        set: |_, _| {},
    };
    DATA.into_iter().chain(InferredQuantity::ALL.map(truth)).collect()
});

const DATA: [Input; 30] = inputs! {
    "g12_pa" Modulus "" |s| s.moduli.get(Modulus::G12), |s, v| s.set_modulus(Modulus::G12, v);
    "g12_sigma_pa" Stddev "standard deviation of g12_pa" |s| s.sigma_of(Modulus::G12), |s, v| s.set_sigma(Modulus::G12, v);
    "g13_pa" Modulus "" |s| s.moduli.get(Modulus::G13), |s, v| s.set_modulus(Modulus::G13, v);
    "g13_sigma_pa" Stddev "of g13_pa" |s| s.sigma_of(Modulus::G13), |s, v| s.set_sigma(Modulus::G13, v);
    "theta_pa" Modulus "" |s| s.moduli.get(Modulus::Theta), |s, v| s.set_modulus(Modulus::Theta, v);
    "theta_sigma_pa" Stddev "of theta_pa" |s| s.sigma_of(Modulus::Theta), |s, v| s.set_sigma(Modulus::Theta, v);
    "c11_pa" Modulus "" |s| s.moduli.get(Modulus::C11), |s, v| s.set_modulus(Modulus::C11, v);
    "c11_sigma_pa" Stddev "of c11_pa" |s| s.sigma_of(Modulus::C11), |s, v| s.set_sigma(Modulus::C11, v);
    "c33_pa" Modulus "" |s| s.moduli.get(Modulus::C33), |s, v| s.set_modulus(Modulus::C33, v);
    "c33_sigma_pa" Stddev "of c33_pa" |s| s.sigma_of(Modulus::C33), |s, v| s.set_sigma(Modulus::C33, v);
    "c13_pa" Modulus "" |s| s.moduli.get(Modulus::C13), |s, v| s.set_modulus(Modulus::C13, v);
    "c13_sigma_pa" Stddev "of c13_pa" |s| s.sigma_of(Modulus::C13), |s, v| s.set_sigma(Modulus::C13, v);
    "theta_printed_pa" Datum "theta_pa of the model ratio-as-printed"
        |s| s.theta_printed, |s, v| s.theta_printed = Some(v);
    "pressure_pa" Pressure "" |s| Some(s.conditions.pressure.value), |s, v| s.conditions.pressure.value = v;
    "pressure_sigma_pa" Stddev "standard deviation of the pressure"
        |s| Some(s.conditions.pressure.stddev), |s, v| s.conditions.pressure.stddev = v;
    "gamma_over_delta" Datum "ratio of deviatoric to volumetric strain; measured by grainlab analyze: the next three (see --gamma)"
        |s| s.gamma.map(|g| g.value), |s, v| s.gamma = Some(Measured::exact(v));
    "gamma_over_delta_sigma" Stddev "standard deviation of gamma_over_delta"
        |s| s.gamma.map(|g| g.stddev), |s, v| if let Some(gamma) = &mut s.gamma { gamma.stddev = v };
    "g_total" Datum "" |s| s.measured_gamma.total, |s, v| s.measured_gamma.total = Some(v);
    "g_elastic" Datum "" |s| s.measured_gamma.elastic, |s, v| s.measured_gamma.elastic = Some(v);
    "g_contact" Datum "" |s| s.measured_gamma.contact, |s, v| s.measured_gamma.contact = Some(v);
    "grain_shear_modulus_pa" Datum "" |s| s.grain_shear_modulus, |s, v| s.grain_shear_modulus = Some(v);
    "grain_shear_modulus_sigma_pa" Stddev "standard deviation of the shear modulus of the grains"
        |s| Some(s.conditions.shear_modulus_stddev), |s, v| s.conditions.shear_modulus_stddev = v;
    "poisson" Datum "" |s| s.poisson, |s, v| s.poisson = Some(v);
    "poisson_sigma" Stddev "standard deviation of poisson" |s| Some(s.conditions.poisson_ratio_stddev), |s, v| s.conditions.poisson_ratio_stddev = v;
    "phi" Datum "" |s| s.conditions.solid_fraction.map(|p| p.value), |s, v| s.conditions.solid_fraction = Some(Measured::exact(v));
    "phi_sigma" Stddev "standard deviation of phi"
        |s| s.conditions.solid_fraction.map(|p| p.stddev), |s, v| if let Some(phi) = &mut s.conditions.solid_fraction { phi.stddev = v };
    "axial_q_over_p" Datum "" |s| s.conditions.stress_ratio.map(|r| r.value), |s, v| s.conditions.stress_ratio = Some(Measured::exact(v));
    "axial_q_over_p_sigma" Stddev "standard deviation of axial_q_over_p"
        |s| s.conditions.stress_ratio.map(|r| r.stddev), |s, v| if let Some(ratio) = &mut s.conditions.stress_ratio { ratio.stddev = v };
    "size_spread" Datum "" |s| s.conditions.size_spread, |s, v| s.conditions.size_spread = Some(v);
    "grains" Datum "" |s| s.grains, |s, v| s.grains = Some(v);
};

impl Input {
    pub(super) fn get(&self, state: &State) -> Option<f64> {
        match self.role {
            Role::Truth(q) => state.truth.get(q),
            _ => (self.get)(state),
        }
    }

    pub(super) fn set(&self, state: &mut State, value: f64) {
        match self.role {
            Role::Truth(q) => state.truth = state.truth.with(q, value),
            _ => (self.set)(state, value),
        }
    }

    /// A note on a standard deviation in Pa that is probably a share of its quantity.
    pub(super) fn improbable_error(&self, state: &State) -> Option<String> {
        // Numbers before names: this is asked of every input of every row.
        let stddev = self.get(state).filter(|s| self.role == Role::Stddev && *s > 0.0 && *s <= 1.0)?;
        let key = self.key.strip_suffix("_sigma_pa")?;
        let of = INPUTS.iter().find(|input| input.key.strip_suffix("_pa") == Some(key))?;
        let value = of.get(state)?;
        (stddev < SHARE * value.abs()).then(|| {
            format!(
                "{} = {stddev} Pa is improbably small compared with {} = {value:e} Pa: is it a share of it?",
                self.key, of.key
            )
        })
    }

    /// Column names of an input, the preferred one first, with its unit in SI: the quantity of a packing with
    /// this key or alias, and all its aliases.
    pub(super) fn names(&self) -> Vec<Alias> {
        let called = |name| Alias { name, factor: 1.0 };
        let is_it = |aliases: &[Alias]| aliases.iter().any(|a| a.name == self.key);
        match by_key(QUANTITIES, self.key).or_else(|| QUANTITIES.iter().find(|q| is_it(q.aliases))) {
            Some(q) => [called(q.key)].iter().chain(q.aliases).copied().collect(),
            None => vec![called(self.key)],
        }
    }

    fn meaning(&self) -> &'static str {
        let quantity = self.names().first().and_then(|name| by_key(QUANTITIES, name.name));
        let is_known = self.meaning.is_empty() || matches!(self.role, Role::Truth(_));
        quantity.filter(|_| is_known).map_or(self.meaning, |q| q.meaning)
    }
}

/// The columns as text for the help of a command, one line each.
pub(super) fn reference() -> String {
    let line = |input: &Input| {
        let names: Vec<&str> = input.names().iter().map(|alias| alias.name).collect();
        format!("  {:<34} {}\n", names.join(", "), input.meaning())
    };
    let law = "  contact_law                        hertz_mindlin, or linear:KN,RATIO or rough:SQ,FACTOR, of which only --model free-contact has an estimate\n";
    let probe = "  probe                              sticking if no contact slid while the moduli were measured, else unknown (see --probe)\n";
    let smooth = "  smooth                             true: the stiffness is without tangential springs, which no model can invert\n";
    let axis = "  axis_found                         of grainlab probe: false if no axis stood out in the speeds, which is noted\n";
    INPUTS.iter().map(line).chain([law, probe, smooth, axis].map(str::to_owned)).collect()
}

/// The inputs given, with the standard deviations in force.
impl Serialize for State {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("sample", &self.sample)?;
        for input in INPUTS.iter().filter(|input| !matches!(input.role, Role::Truth(_))) {
            map.serialize_entry(input.key, &input.get(self))?;
        }
        map.serialize_entry("contact_law", &self.conditions.contact_law.map(|law| law.to_string()))?;
        map.serialize_entry("probe", &self.probe.map(Probe::name))?;
        map.serialize_entry("asymmetry", &self.asymmetry)?;
        map.serialize_entry("relative_error", &self.relative_error)?;
        map.end()
    }
}
