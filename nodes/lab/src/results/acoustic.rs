//! What wave speeds say of one packing, with the stable keys of `acoustic`.

use grainlab_core::{MeasuredWave, Packing, Vec3};
use grainlab_emt::{Conditions, Measured, Modulus, christoffel};
use grainlab_msgs::boundary::WaveSpeedsReading;
use serde::Serialize;

pub(crate) use super::acoustic_text::{heading, text};

/// Wave speeds, and the moduli of the medium whose waves they are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct AcousticView {
    /// How the speeds were measured; null without speeds, `several` if they are not all of one kind.
    pub(crate) method: Option<&'static str>,
    /// Of the mass that moves with the waves, kg/m³.
    pub(crate) density: f64,
    pub(crate) density_stddev: Option<f64>,
    /// Of all grains, kg/m³.
    pub(crate) density_bulk: f64,
    pub(crate) pressure_pa: f64,
    /// The axis that the rays were sent about; null if it was not known.
    pub(crate) axis: Option<[f64; 3]>,
    /// The axis that the moduli are about: that one, else the one that the speeds tell, else e3.
    pub(crate) moduli_axis: [f64; 3],
    pub(crate) speeds: Vec<SpeedView>,
    /// Of a medium isotropic about that axis, by Christoffel's equation; null where the speeds do not determine one.
    pub(crate) moduli: ModuliView,
    /// Their standard deviations.
    pub(crate) sigma: ModuliView,
    /// Misfit of the speeds by their errors; null where these are not known.
    pub(crate) chi_square: Option<f64>,
    /// Speeds less combinations of moduli that they determine; null where there is no medium.
    pub(crate) degrees_of_freedom: Option<usize>,
    /// Root mean square of the relative residuals of the speeds per degree of freedom.
    pub(crate) scatter: Option<f64>,
    /// Relative scatter of rho v^2 that is the packing's own, which is not quite isotropic about any axis; half of it is an error
    /// of every speed. Null where the errors of the speeds explain all.
    pub(crate) departure: Option<f64>,
    pub(crate) warnings: Vec<String>,
}

/// One speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct SpeedView {
    pub(crate) direction: [f64; 3],
    pub(crate) polarization: [f64; 3],
    /// m/s.
    pub(crate) speed: f64,
    pub(crate) stddev: Option<f64>,
    pub(crate) method: &'static str,
    /// Hz; null if extrapolated to zero.
    pub(crate) frequency: Option<f64>,
    pub(crate) strain_amplitude: f64,
}

/// Moduli about an axis, Pa.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct ModuliView {
    pub(crate) c33_pa: Option<f64>,
    pub(crate) c11_pa: Option<f64>,
    /// C44.
    pub(crate) g13_pa: Option<f64>,
    /// C66.
    pub(crate) g12_pa: Option<f64>,
    pub(crate) c13_pa: Option<f64>,
    pub(crate) theta_pa: Option<f64>,
}

impl ModuliView {
    fn of(value: impl Fn(Modulus) -> Option<f64>) -> Self {
        Self {
            c33_pa: value(Modulus::C33),
            c11_pa: value(Modulus::C11),
            g13_pa: value(Modulus::G13),
            g12_pa: value(Modulus::G12),
            c13_pa: value(Modulus::C13),
            theta_pa: value(Modulus::Theta),
        }
    }
}

impl From<&MeasuredWave> for SpeedView {
    fn from(m: &MeasuredWave) -> Self {
        Self {
            direction: m.wave.direction.into(),
            polarization: m.wave.polarization.into(),
            speed: m.wave.speed,
            stddev: m.wave.stddev,
            method: m.method.word(),
            frequency: m.frequency,
            strain_amplitude: m.strain_amplitude,
        }
    }
}

impl AcousticView {
    /// Of the speeds of this packing.
    pub(crate) fn new(packing: &Packing, found: &WaveSpeedsReading) -> Self {
        let mut warnings = found.warnings.clone();
        let speeds = found.measured();
        let told = || christoffel::find_axis(&speeds).ok().map(|found| found.axis);
        let axis = found.axis.or_else(told).unwrap_or_else(Vec3::z);
        let density = Measured { value: found.density, stddev: found.density_stddev.unwrap_or(0.0) };
        let conditions = Conditions::at(found.pressure);
        let fitted = christoffel::observation(&speeds, density, Some(axis), conditions);
        let (mut moduli, mut sigma) = (ModuliView::default(), ModuliView::default());
        match &fitted {
            Ok(fitted) => {
                let o = &fitted.observation;
                moduli = ModuliView::of(|m| o.moduli.get(m));
                sigma = ModuliView::of(|m| {
                    let (c, at) = (o.covariance?, m as usize);
                    o.moduli.get(m).map(|_| c[(at, at)].max(0.0).sqrt())
                });
                if let Some(conflict) = &fitted.conflict {
                    warnings.push(format!(
                        "the wave speeds contradict each other: speeds[{}] is {:.1} sigma from what the others say",
                        conflict.worst, conflict.sigma
                    ));
                }
            }
            Err(error) => warnings.push(error.to_string()),
        }
        let first = found.speeds.first().map(|s| s.method);
        let method = first.map(|m| match found.speeds.iter().all(|s| s.method == m) {
            true => m.word(),
            false => "several",
        });
        let fitted = fitted.ok();
        Self {
            method,
            density: found.density,
            density_stddev: found.density_stddev,
            density_bulk: packing.solid_fraction() * packing.material.density,
            pressure_pa: found.pressure,
            axis: found.axis.map(Into::into),
            moduli_axis: axis.into(),
            speeds: found.speeds.iter().map(SpeedView::from).collect(),
            moduli,
            sigma,
            chi_square: fitted.as_ref().and_then(|f| f.chi_square),
            degrees_of_freedom: fitted.as_ref().map(|f| f.degrees_of_freedom),
            scatter: fitted.as_ref().and_then(christoffel::Fitted::scatter),
            departure: fitted.as_ref().and_then(|f| Some(f.departure?.scatter)),
            warnings,
        }
    }

    /// Mean of the relative standard deviations of the speeds that have one.
    pub(crate) fn relative_error(&self) -> Option<f64> {
        let errors: Vec<f64> = self.speeds.iter().filter_map(|s| Some(s.stddev? / s.speed)).collect();
        (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::{TransverseIsotropy, WaveMethod, WaveSpeed};

    pub(crate) const MEDIUM: TransverseIsotropy = TransverseIsotropy {
        c11: 360e6,
        c12: 80e6,
        c13: 70e6,
        c33: 400e6,
        g13: 150e6,
        g12: 140e6,
        residual: 0.0,
    };

    /// A gas of one grain: nothing but its density is asked for.
    pub(crate) fn packing() -> Packing {
        use grainlab_core::{Cell, Mat3, Material};
        Packing {
            step: 12,
            time: 0.0,
            cell: Cell::cube(2e-4).unwrap(),
            deformation: Mat3::identity(),
            ids: vec![0],
            radii: vec![1e-4],
            positions: vec![Vec3::zeros()],
            velocities: vec![Vec3::zeros()],
            spins: vec![Vec3::zeros()],
            contacts: Vec::new(),
            material: Material::GLASS,
            law: Default::default(),
            friction: 0.3,
            time_step: 0.0,
        }
    }

    /// Exact speeds of [`MEDIUM`] along these directions, each known to 0.3 %.
    pub(crate) fn speeds(directions: &[Vec3]) -> WaveSpeedsReading {
        let density = 1500.0;
        let stiffness = MEDIUM.stiffness();
        let along = |n: &Vec3| {
            let (n, waves) = (*n, stiffness.plane_waves(n));
            let speeds = waves.speeds(density).unwrap();
            waves.polarizations.into_iter().zip(speeds).map(move |(polarization, speed)| MeasuredWave {
                wave: WaveSpeed { direction: n, polarization, speed, stddev: Some(0.003 * speed) },
                method: WaveMethod::Dispersion,
                frequency: None,
                strain_amplitude: 0.0,
            })
        };
        WaveSpeedsReading {
            stamp: grainlab_msgs::stamp(0.0),
            source_step: Some(12),
            density,
            density_stddev: Some(3.0),
            pressure: 5e4,
            solid_fraction: Some(0.6),
            axis: Some(Vec3::z()),
            grain_shear_modulus: 29e9,
            grain_poisson_ratio: 0.2,
            speeds: directions.iter().flat_map(along).collect(),
            warnings: vec!["send less".to_owned()],
        }
    }

    #[test]
    fn the_moduli_are_those_of_the_medium_whose_speeds_were_measured() {
        let diagonal = Vec3::new(1.0, 0.0, 1.0).normalize();
        let view = AcousticView::new(&packing(), &speeds(&[Vec3::z(), Vec3::x(), diagonal]));
        let m = view.moduli;
        for (found, truth) in [
            (m.c33_pa, 400e6),
            (m.c11_pa, 360e6),
            (m.g13_pa, 150e6),
            (m.g12_pa, 140e6),
            (m.c13_pa, 70e6),
            (m.theta_pa, MEDIUM.stiffness().bulk_voigt()),
        ] {
            assert!((found.unwrap() / truth - 1.0).abs() < 1e-6, "{m:?}");
        }
        // A modulus of one speed: twice the speed's error, and the density's.
        let one = view.sigma.c33_pa.unwrap() / 400e6;
        assert!(one > 0.002 && one < 0.0064, "{one}");
        assert_eq!(
            (view.method, view.speeds.len(), view.degrees_of_freedom),
            (Some("dispersion"), 9, Some(4))
        );
        assert!((view.relative_error().unwrap() - 0.003).abs() < 1e-12);
        assert_eq!(view.warnings, ["send less"]);
    }

    #[test]
    fn what_the_speeds_leave_open_is_null_and_why_there_is_no_medium_is_said() {
        let view = AcousticView::new(&packing(), &speeds(&[Vec3::z()]));
        assert!(view.moduli.c33_pa.is_some() && view.moduli.c11_pa.is_none() && view.sigma.c11_pa.is_none());
        let none = AcousticView::new(&packing(), &speeds(&[]));
        assert_eq!((none.moduli, none.method), (ModuliView::default(), None));
        assert_eq!(none.warnings.len(), 2, "{:?}", none.warnings);
    }
}
