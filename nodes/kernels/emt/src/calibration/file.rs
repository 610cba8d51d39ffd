//! Calibrations as text.

use super::isotropic::Isotropic;
use super::network::{Amplitude, ISOSTATIC, Law, Network, SCATTERED};
use super::{Calibration, CalibrationError, Discrepancy};
use crate::conditions::GammaSource;
use crate::structure::Quantity;
use grainlab_core::Material;
use serde::{Deserialize, Serialize};

/// The whole file. Units: Pa; α and ρ in MPa^⅔.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pressures: Option<[f64; 2]>,
    material: Grains,
    isotropic: Vec<Line>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    network: Option<Relaxed>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    discrepancy: Vec<Off>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Grains {
    shear_modulus: f64,
    poisson_ratio: f64,
    density: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    abscissa: String,
    alpha: f64,
    beta: f64,
    rho: f64,
    zeta: f64,
    fitted: [f64; 2],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    scatter: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    covariance: Option<[[f64; 4]; 4]>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Relaxed {
    grains: u32,
    pressure: f64,
    z: [f64; 2],
    eps: [f64; 2],
    eps_spread: [f64; 2],
    solid_fraction: [f64; 2],
    solid_fractions: [f64; 2],
    rattlers: [f64; 4],
    dilatation: [f64; 2],
    voigt: [f64; 2],
    harmonic: [f64; 2],
    eps_stiffness: [f64; 2],
    scatter: [[f64; SCATTERED]; SCATTERED],
    theta: Rise,
    shear: Rise,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rise {
    level: f64,
    by_z: f64,
    by_excess: f64,
    onset: f64,
    by_solid_fraction: f64,
    by_pressure: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Off {
    model: String,
    abscissa: String,
    gamma: String,
    mean_square: [[f64; 3]; 3],
    by_eps: [f64; 2],
}

impl Calibration {
    /// From the text of a calibration file (TOML).
    pub fn parse(text: &str) -> Result<Self, CalibrationError> {
        let file: File = toml::from_str(text).map_err(|e| CalibrationError::Text(e.to_string()))?;
        let mut lines = file.isotropic.into_iter().map(line);
        let nothing = || CalibrationError::Text("no [[isotropic]] section".into());
        let isotropic = lines.next().ok_or_else(nothing)??;
        let other = lines.next().transpose()?;
        if other.as_ref().is_some_and(|o| o.abscissa == isotropic.abscissa) || lines.next().is_some() {
            return Err(CalibrationError::Text("[[isotropic]]: one section for each abscissa".into()));
        }
        let Grains { shear_modulus, poisson_ratio, density } = file.material;
        constant("material.shear_modulus", shear_modulus, shear_modulus > 0.0, "it must be positive")?;
        let fits = (0.0..=0.5).contains(&poisson_ratio);
        constant("material.poisson_ratio", poisson_ratio, fits, "it must lie in [0, 1/2]")?;
        constant("material.density", density, density > 0.0, "it must be positive")?;
        let discrepancies = file.discrepancy.into_iter().map(off).collect::<Result<_, _>>()?;
        let network = file.network.map(relaxed).transpose()?.map(Box::new);
        Ok(Self {
            name: file.name.into(),
            isotropic,
            other,
            material: Material { shear_modulus, poisson_ratio, density },
            pressures: file.pressures,
            network,
            discrepancies,
        })
    }

    /// As [`Calibration::parse`] takes it.
    pub fn to_toml(&self) -> Result<String, CalibrationError> {
        let lines = [Some(&self.isotropic), self.other.as_ref()].into_iter().flatten();
        let m = &self.material;
        let file = File {
            name: self.name().to_owned(),
            pressures: self.pressures,
            material: Grains {
                shear_modulus: m.shear_modulus,
                poisson_ratio: m.poisson_ratio,
                density: m.density,
            },
            isotropic: lines
                .map(|i| Line {
                    abscissa: i.abscissa.name().to_owned(),
                    alpha: i.alpha,
                    beta: i.beta,
                    rho: i.rho,
                    zeta: i.zeta,
                    fitted: i.fitted,
                    scatter: i.scatter,
                    covariance: i.covariance,
                })
                .collect(),
            network: self.network().map(of_network),
            discrepancy: self
                .discrepancies
                .iter()
                .map(|d| Off {
                    model: d.model.clone(),
                    abscissa: d.abscissa.name().to_owned(),
                    gamma: d.gamma.map_or("none", GammaSource::name).to_owned(),
                    mean_square: d.mean_square,
                    by_eps: d.by_eps,
                })
                .collect(),
        };
        toml::to_string(&file).map_err(|e| CalibrationError::Text(e.to_string()))
    }
}

fn constant(
    field: &'static str,
    value: f64,
    valid: bool,
    requirement: &'static str,
) -> Result<(), CalibrationError> {
    if valid && value.is_finite() {
        return Ok(());
    }
    Err(CalibrationError::Constant { field, value, requirement })
}

fn abscissa(name: &str) -> Result<Quantity, CalibrationError> {
    let known = [Quantity::K, Quantity::Z].into_iter().find(|q| q.name() == name);
    known.ok_or_else(|| CalibrationError::Text(format!("abscissa = {name:?}: it must be \"k\" or \"z\"")))
}

fn line(l: Line) -> Result<Isotropic, CalibrationError> {
    let mut isotropic = Isotropic::new([l.alpha, l.beta, l.rho, l.zeta], abscissa(&l.abscissa)?, l.fitted)?;
    (isotropic.scatter, isotropic.covariance) = (l.scatter, l.covariance);
    Ok(isotropic)
}

fn off(o: Off) -> Result<Discrepancy, CalibrationError> {
    let sources = [GammaSource::Total, GammaSource::Elastic, GammaSource::Contact, GammaSource::Zero];
    let gamma = match o.gamma.as_str() {
        "none" => None,
        name => Some(sources.into_iter().find(|s| s.name() == name).ok_or_else(|| {
            CalibrationError::Text(format!(
                "gamma = {name:?}: it must be total, elastic, contact, zero or none"
            ))
        })?),
    };
    let m = nalgebra::Matrix3::from_fn(|i, j| o.mean_square[i][j]);
    let lowest = if m.iter().all(|v| v.is_finite()) { m.symmetric_eigenvalues().min() } else { f64::NAN };
    let valid = m == m.transpose() && lowest >= -1e-9 * m.amax();
    constant("discrepancy.mean_square", lowest, valid, "it must be symmetric without negative eigenvalue")?;
    let [f0, f1] = o.by_eps;
    constant("discrepancy.by_eps", f0.min(f1), f0 >= 0.0 && f1 >= 0.0, "no mean square is negative")?;
    let Off { model, mean_square, by_eps, .. } = o;
    Ok(Discrepancy { model, abscissa: abscissa(&o.abscissa)?, gamma, mean_square, by_eps })
}

fn relaxed(r: Relaxed) -> Result<Network, CalibrationError> {
    let amplitude = |[constant, critical]: [f64; 2]| Amplitude { constant, critical };
    let law = |l: Rise| Law {
        level: l.level,
        by_z: l.by_z,
        by_excess: l.by_excess,
        onset: l.onset,
        by_solid_fraction: l.by_solid_fraction,
        by_pressure: l.by_pressure,
    };
    let network = Network {
        theta: law(r.theta),
        shear: law(r.shear),
        dilatation: amplitude(r.dilatation),
        voigt: amplitude(r.voigt),
        harmonic: amplitude(r.harmonic),
        eps_stiffness: amplitude(r.eps_stiffness),
        rattlers: r.rattlers,
        scatter: r.scatter,
        z: r.z,
        eps: r.eps,
        eps_spread: r.eps_spread,
        solid_fraction: r.solid_fraction,
        solid_fractions: r.solid_fractions,
        pressure: r.pressure,
        grains: r.grains,
    };
    check(&network)?;
    Ok(network)
}

/// What makes the inversion unique: moduli that rise with z, a network that is stiff, a scatter that is a covariance.
fn check(n: &Network) -> Result<(), CalibrationError> {
    let [low, high] = n.z;
    constant(
        "network.z",
        low,
        low > ISOSTATIC && low < high && high.is_finite(),
        "a range above 4, low and high",
    )?;
    constant("network.eps", n.eps[0], n.eps[0] < n.eps[1], "a range, low and high")?;
    constant("network.pressure", n.pressure, n.pressure > 0.0, "it must be positive")?;
    let phi = n.solid_fraction[0];
    constant("network.solid_fraction", phi, phi > 0.0 && phi < 1.0, "it must lie in (0, 1)")?;
    let [from, to] = n.domain();
    for (field, law) in [("network.theta", &n.theta), ("network.shear", &n.shear)] {
        constant(field, law.onset, law.onset < from, "the onset must lie below every z")?;
        for i in 0..=50 {
            let slope = law.slope(from + (to - from) * f64::from(i) / 50.0);
            constant(field, slope, slope > 0.0, "the modulus must rise with z wherever the model is used")?;
        }
    }
    let scatter = super::network::Scatter::from_fn(|i, j| n.scatter[i][j]);
    let lowest =
        if scatter.iter().all(|v| v.is_finite()) { scatter.symmetric_eigenvalues().min() } else { f64::NAN };
    let symmetric = scatter == scatter.transpose();
    constant(
        "network.scatter",
        lowest,
        symmetric && lowest > 0.0,
        "it must be a covariance, of positive eigenvalues",
    )
}

fn of_network(n: &Network) -> Relaxed {
    let pair = |a: &Amplitude| [a.constant, a.critical];
    let rise = |l: &Law| Rise {
        level: l.level,
        by_z: l.by_z,
        by_excess: l.by_excess,
        onset: l.onset,
        by_solid_fraction: l.by_solid_fraction,
        by_pressure: l.by_pressure,
    };
    Relaxed {
        grains: n.grains,
        pressure: n.pressure,
        z: n.z,
        eps: n.eps,
        eps_spread: n.eps_spread,
        solid_fraction: n.solid_fraction,
        solid_fractions: n.solid_fractions,
        rattlers: n.rattlers,
        dilatation: pair(&n.dilatation),
        voigt: pair(&n.voigt),
        harmonic: pair(&n.harmonic),
        eps_stiffness: pair(&n.eps_stiffness),
        scatter: n.scatter,
        theta: rise(&n.theta),
        shear: rise(&n.shear),
    }
}
