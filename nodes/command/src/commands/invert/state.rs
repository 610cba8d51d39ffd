//! The data of one state.

use super::case::Case;
use grainlab_core::Material;
use grainlab_core::notes::Note;
use grainlab_core::results::Microstructure;
use grainlab_core::results::StrainRatios;
use grainlab_emt::{
    Calibration, Conditions, EmtError, Inversion, Measured, Moduli, ModuliCovariance, Modulus, Observation,
    Posterior, PosteriorSettings, Probe, StrainRatio, StrainRatioSource,
};

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct State {
    pub(crate) sample: Option<String>,
    pub(crate) moduli: Moduli,
    /// Part of a full stiffness that is not isotropic about e3; `None` if only moduli are given.
    pub(crate) asymmetry: Option<f64>,
    /// True if the moduli are the projection of one stiffness, so that five of them were measured and Θ follows.
    pub(crate) projected: bool,
    /// Standard deviations of the moduli, Pa.
    pub(crate) sigma: [Option<f64>; grainlab_emt::MODULI],
    /// Covariance of all moduli, Pa², if they follow from wave speeds.
    pub(crate) full_covariance: Option<ModuliCovariance>,
    /// Relative standard deviation of the moduli without their own.
    pub(crate) relative_error: Option<f64>,
    /// Θ for the model `ratio-as-printed`, if it differs, Pa.
    pub(crate) theta_printed: Option<f64>,
    /// The state besides γ/Δ and the material.
    pub(crate) conditions: Conditions,
    /// The γ/Δ given.
    pub(crate) gamma: Option<Measured>,
    /// The γ/Δ measured by `grainlab analyze`.
    pub(crate) measured_gamma: StrainRatios,
    /// Shear modulus of the grains, Pa.
    pub(crate) grain_shear_modulus: Option<f64>,
    pub(crate) poisson: Option<f64>,
    /// Whether contacts slid while the moduli were measured; `None` if nothing is stated.
    pub(crate) probe: Option<Probe>,
    pub(crate) notes: Vec<Note>,
    pub(crate) grains: Option<f64>,
    pub(crate) truth: Microstructure,
}

impl State {
    /// The given flags for all states, with the keys of the inputs that they set; --error is for moduli without their own error.
    pub(super) fn flags(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        [
            (self.grain_shear_modulus.is_some(), ("grain-shear-modulus", "grain_shear_modulus_pa")),
            (
                self.conditions.shear_modulus_stddev > 0.0,
                ("grain-shear-modulus-sigma", "grain_shear_modulus_sigma_pa"),
            ),
            (self.poisson.is_some(), ("poisson", "poisson")),
            (self.conditions.poisson_ratio_stddev > 0.0, ("poisson-sigma", "poisson_sigma")),
        ]
        .into_iter()
        .filter_map(|(given, flag)| given.then_some(flag))
    }

    pub(super) fn set_modulus(&mut self, modulus: Modulus, value: f64) {
        self.moduli = self.moduli.with(modulus, value);
    }

    pub(super) fn set_sigma(&mut self, modulus: Modulus, value: f64) {
        self.sigma[modulus as usize] = Some(value);
    }

    /// Standard deviation of one of the moduli, Pa: its own or the common one.
    pub(super) fn sigma_of(&self, modulus: Modulus) -> Option<f64> {
        self.moduli.get(modulus)?;
        let at = modulus as usize;
        self.covariance(&self.moduli).map(|c| c[(at, at)].sqrt())
    }

    pub(super) fn infer(&self, case: &Case) -> Result<Inversion, EmtError> {
        let estimate = case.model.infer(&self.observation(case)?, &case.calibration)?;
        match &case.prior {
            Some(prior) => estimate.with_prior(prior)?.within(&case.model.prior_domain(&case.calibration)),
            None => Ok(estimate),
        }
    }

    pub(super) fn posterior<'a>(
        &self,
        case: &'a Case,
        settings: PosteriorSettings,
    ) -> Result<Posterior<'a>, EmtError> {
        let observation = self.observation(case)?;
        Posterior::new(case.model, &observation, &case.calibration, &case.own_prior(), settings)
    }

    pub(super) fn observation(&self, case: &Case) -> Result<Observation, EmtError> {
        let mut conditions = Conditions { material: self.material(&case.calibration), ..self.conditions };
        if case.model.uses_gamma() {
            let model = case.model.name();
            conditions.gamma =
                self.gamma(case.gamma).map_err(|missing| EmtError::Missing { model, missing })?;
        }
        let mut moduli = self.moduli;
        if let Some(theta) = self.theta_printed.filter(|_| case.model.name() == "ratio-as-printed") {
            moduli = moduli.with(Modulus::Theta, theta);
        }
        if self.theta_follows() {
            moduli = moduli.without(Modulus::Theta);
        }
        let covariance = self.covariance(&moduli);
        let observation = Observation::new(moduli, conditions);
        let grains = self.grains.map(|n| n as u32);
        let probe = self.probe.unwrap_or(Probe::Unknown);
        Ok(Observation { asymmetry: self.asymmetry, grains, probe, covariance, ..observation })
    }

    /// The source of the γ/Δ that a model uses or would use.
    pub(super) fn gamma_source(&self, case: &Case) -> &'static str {
        match self.gamma(case.gamma) {
            _ if !case.model.uses_gamma() => "none",
            Ok(gamma) => gamma.source.name(),
            Err(_) => case.gamma.map_or("none", StrainRatioSource::name),
        }
    }

    /// True if Θ follows from the other moduli: with an error of its own, it would count as an additional
    /// measurement, unless all others have theirs.
    fn theta_follows(&self) -> bool {
        let mut others = Modulus::ALL.into_iter().filter(|m| *m != Modulus::Theta);
        let own_error = self.sigma[Modulus::Theta as usize].is_some();
        let others_have_errors = others.clone().all(|m| self.sigma[m as usize].is_some());
        let errors_known = self.relative_error.is_some() || self.sigma.iter().any(Option::is_some);
        self.projected
            && errors_known
            && (!own_error || others_have_errors)
            && others.all(|m| self.moduli.get(m).is_some())
    }

    /// A note on the moduli that have no error where others have one.
    pub(super) fn taken_as_exact(&self) -> Option<String> {
        if self.relative_error.is_some() || self.sigma.iter().all(Option::is_none) {
            return None;
        }
        let follows = self.theta_follows();
        let is_exact = |m: &Modulus| self.sigma[*m as usize].is_none() && !(follows && *m == Modulus::Theta);
        let exact: Vec<&str> =
            self.moduli.known().map(|(m, _)| m).filter(is_exact).map(Modulus::name).collect();
        (!exact.is_empty()).then(|| {
            format!("no error of {} is given, unlike those of the others: taken as exact", exact.join(", "))
        })
    }

    /// Independent errors; moduli without one are exact if others have one. `None` if no error is known.
    fn covariance(&self, moduli: &Moduli) -> Option<ModuliCovariance> {
        if self.full_covariance.is_some() {
            return self.full_covariance;
        }
        if self.relative_error.is_none() && self.sigma.iter().all(Option::is_none) {
            return None;
        }
        let values = moduli.values();
        let variance = std::array::from_fn::<f64, { grainlab_emt::MODULI }, _>(|i| {
            let Some(value) = values[i] else { return 0.0 };
            self.sigma[i].unwrap_or_else(|| self.relative_error.unwrap_or(0.0) * value).powi(2)
        });
        Some(ModuliCovariance::from_diagonal(&variance.into()))
    }

    /// Returns the given values of the grains, with the calibration's for the others. `None` if neither a value nor an error is given.
    fn material(&self, calibration: &Calibration) -> Option<Material> {
        let own = calibration.material();
        let has_error =
            self.conditions.shear_modulus_stddev > 0.0 || self.conditions.poisson_ratio_stddev > 0.0;
        (self.grain_shear_modulus.is_some() || self.poisson.is_some() || has_error).then(|| Material {
            shear_modulus: self.grain_shear_modulus.unwrap_or(own.shear_modulus),
            poisson_ratio: self.poisson.unwrap_or(own.poisson_ratio),
            ..*own
        })
    }

    /// Returns the γ/Δ asked for, else the given γ/Δ, else the γ/Δ of the paper's models. The error is the name of the missing γ/Δ.
    fn gamma(&self, asked: Option<StrainRatioSource>) -> Result<StrainRatio, &'static str> {
        let of = |source, measured: Option<f64>, missing| {
            measured.map(|value| StrainRatio { value, stddev: 0.0, source }).ok_or(missing)
        };
        let given = self.gamma.map(|g| StrainRatio {
            value: g.value,
            stddev: g.stddev,
            source: StrainRatioSource::Given,
        });
        let measured = &self.measured_gamma;
        match asked {
            None => Ok(given.unwrap_or_else(|| StrainRatio::preferred(measured))),
            Some(StrainRatioSource::Given) => given.ok_or("gamma_over_delta"),
            Some(source @ StrainRatioSource::Total) => of(source, measured.total, "g_total"),
            Some(source @ StrainRatioSource::Elastic) => of(source, measured.elastic, "g_elastic"),
            Some(source @ StrainRatioSource::Contact) => of(source, measured.contact, "g_contact"),
            Some(StrainRatioSource::Zero) => Ok(StrainRatio::ZERO),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::case::cases;
    use super::*;

    /// 9 Θ = 4 C11 − 4 G12 + 4 C13 + C33.
    fn medium(projected: bool) -> State {
        let moduli = Moduli::of_values([140.0, 150.0, 1840.0 / 9.0, 360.0, 400.0, 140.0].map(Some));
        State {
            moduli,
            projected,
            relative_error: Some(0.01),
            conditions: Conditions::at(5e4),
            ..State::default()
        }
    }

    #[test]
    fn of_a_projected_stiffness_five_moduli_are_measured_and_of_single_ones_all() {
        let case = &cases(&["relaxed".to_owned()], &["default".to_owned()], None).unwrap()[0];
        let variance = |state: &State| {
            let observation = state.observation(case).unwrap();
            let checked = observation.checked().unwrap();
            assert!((checked.moduli.get(Modulus::Theta).unwrap() - 1840.0 / 9.0).abs() < 1e-9);
            checked.covariance.unwrap()[(Modulus::Theta as usize, Modulus::Theta as usize)]
        };
        let follows =
            [4.0 * 3.6, 4.0 * 1.4, 4.0 * 1.4, 4.0].map(|part: f64| (part / 9.0).powi(2)).iter().sum::<f64>();
        assert!((variance(&medium(true)) / follows - 1.0).abs() < 1e-12);
        assert!((variance(&medium(false)) / (0.01 * 1840.0 / 9.0f64).powi(2) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_stated_error_of_theta_is_no_additional_measurement_where_all_others_have_theirs() {
        let case = &cases(&["relaxed".to_owned()], &["default".to_owned()], None).unwrap()[0];
        let observed = |stated: f64| {
            let mut state = medium(true);
            for (modulus, value) in state.moduli.known().collect::<Vec<_>>() {
                state.set_sigma(modulus, if modulus == Modulus::Theta { stated } else { 0.01 * value });
            }
            state.observation(case).unwrap().checked().unwrap()
        };
        assert_eq!(observed(1.0), observed(50.0));
    }

    #[test]
    fn unknown_properties_of_grains_are_those_of_the_calibration() {
        let state = State { poisson: Some(0.3), conditions: Conditions::at(5e4), ..State::default() };
        let material = state.material(&Calibration::PAPER).unwrap();
        assert_eq!((material.poisson_ratio, material.shear_modulus), (0.3, Material::GLASS.shear_modulus));
        assert_eq!(State::default().material(&Calibration::PAPER), None);
    }
}
