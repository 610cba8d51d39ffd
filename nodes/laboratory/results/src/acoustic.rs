//! Wave speeds of one packing, and the moduli of the medium with these speeds.

use crate::measurements::Measurement;
use crate::quantities::{NoteView, entries};
use grainlab_console::count;
use grainlab_core::notes::{Note, texts};
use grainlab_core::quantities;
use grainlab_core::quantity::{Quantity, Shape::*};
use grainlab_core::{MeasuredWave, Stiffness};
use grainlab_emt::{Conditions, Measured, Modulus, WaveModuli};
use grainlab_msgs::boundary::WaveSpeedsReading;
use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::{Value, json};

/// Wave speeds, and the moduli that follow.
#[derive(Clone, Debug, PartialEq)]
pub struct AcousticReport {
    /// Name among several measurements of the packing; `None` if there is one only.
    pub measurement: Option<Measurement>,
    /// Speeds with their errors and conditions.
    pub reading: WaveSpeedsReading,
    /// Density of all grains, kg/m³.
    pub(crate) bulk_density: f64,
    /// The medium with these speeds.
    pub medium: WaveModuli,
    /// The speeds of the packing's own modes along the same rays; empty where they are not measured.
    pub modes: Vec<MeasuredWave>,
}

/// Every quantity of an [`AcousticReport`]. Moduli that the speeds do not determine are null.
pub static ACOUSTIC: &[Quantity<AcousticReport>] = quantities! { AcousticReport:
    "method" "" "" "how the speeds were measured; several if they are not all of one kind" Scalar, |a| a.method();
    "speed_count" "" "1" "number of speeds" Scalar, |a| a.reading.speeds.len();
    "density" "ρ" "kg/m3" "density of the mass that moves with the waves" Scalar, |a| a.reading.density;
    "density_sigma" "" "kg/m3" "its standard deviation" Scalar, |a| a.reading.density_stddev;
    "density_bulk" "" "kg/m3" "density of all grains" Scalar, |a| a.bulk_density;
    "pressure_pa" "p" "Pa" "confining pressure" Aside, |a| a.reading.pressure;
    "axis_named" "" "1" "axis that the rays were sent about" List, |a| a.reading.axis.map(<[f64; 3]>::from);
    "axis" "" "1" "axis of the moduli: that one, else the one inferred from the speeds, else e3"
        Vector, |a| a.medium.axis;
    "axis_found" "" "" "whether that axis is named or stands out in the speeds; if false, it is e3 for want of one"
        Scalar, |a| a.medium.no_axis.is_none();
    "g12_pa" "G12" "Pa" "C66 about the axis, by Christoffel's equation" Scalar, |a| a.medium.modulus(Modulus::G12);
    "g12_sigma_pa" "" "Pa" "its standard deviation" Scalar, |a| a.medium.stddev(Modulus::G12);
    "g13_pa" "G13" "Pa" "C44 about the axis" Scalar, |a| a.medium.modulus(Modulus::G13);
    "g13_sigma_pa" "" "Pa" "its standard deviation" Scalar, |a| a.medium.stddev(Modulus::G13);
    "theta_pa" "Θ" "Pa" "bulk modulus, if all other moduli are known" Scalar, |a| a.theta();
    "theta_sigma_pa" "" "Pa" "its standard deviation" Scalar, |a| a.theta().and(a.medium.stddev(Modulus::Theta));
    "ti_c11_pa" "C11" "Pa" "P modulus across the axis" Scalar, |a| a.medium.modulus(Modulus::C11);
    "c11_sigma_pa" "" "Pa" "its standard deviation" Scalar, |a| a.medium.stddev(Modulus::C11);
    "ti_c33_pa" "C33" "Pa" "P modulus along the axis" Scalar, |a| a.medium.modulus(Modulus::C33);
    "c33_sigma_pa" "" "Pa" "its standard deviation" Scalar, |a| a.medium.stddev(Modulus::C33);
    "ti_c13_pa" "C13" "Pa" "modulus that couples the two" Scalar, |a| a.medium.modulus(Modulus::C13);
    "c13_sigma_pa" "" "Pa" "its standard deviation" Scalar, |a| a.medium.stddev(Modulus::C13);
    "chi_square" "χ²" "1" "misfit of the speeds by their errors" Scalar, |a| a.medium.fitted.as_ref().ok().and_then(|f| f.chi_square);
    "degrees_of_freedom" "" "1" "speeds less combinations of moduli that they determine"
        Scalar, |a| a.medium.fitted.as_ref().ok().map(|f| f.degrees_of_freedom);
    "scatter" "" "1" "root mean square of the relative residuals of the speeds per degree of freedom"
        Scalar, |a| a.medium.fitted.as_ref().ok().and_then(|f| f.scatter());
    "departure" "" "1" "relative scatter of rho v^2 that is due to the packing; half of it is an error of every speed"
        Aside, |a| a.medium.fitted.as_ref().ok().and_then(|f| f.anisotropy_scatter);
};

impl AcousticReport {
    /// From the speeds of a packing of this number of grains, and of this density of all grains, kg/m³.
    pub fn new(grains: u32, bulk_density: f64, reading: WaveSpeedsReading) -> Self {
        let density = Measured { value: reading.density, stddev: reading.density_stddev.unwrap_or(0.0) };
        let conditions = Conditions::at(reading.pressure);
        let medium = WaveModuli::of_speeds(
            &reading.measured(),
            density,
            reading.axis,
            conditions,
            Some(f64::from(grains)),
        );
        Self { measurement: None, reading, bulk_density, medium, modes: Vec::new() }
    }

    /// Moduli about the axis, with their names and those of a network of this stiffness.
    pub fn moduli(&self, network: Option<&Stiffness>) -> [(&'static str, Modulus, Option<f64>); 6] {
        let medium = network.map(|c| c.transverse_isotropy_about(&self.medium.axis));
        [
            ("C33", Modulus::C33, medium.map(|t| t.c33)),
            ("C11", Modulus::C11, medium.map(|t| t.c11)),
            ("C44 = G13", Modulus::G13, medium.map(|t| t.g13)),
            ("C66 = G12", Modulus::G12, medium.map(|t| t.g12)),
            ("C13", Modulus::C13, medium.map(|t| t.c13)),
            ("Theta", Modulus::Theta, network.map(Stiffness::bulk_voigt)),
        ]
    }

    pub(crate) fn method(&self) -> Option<&'static str> {
        let mut methods = self.reading.speeds.iter().map(|s| s.method);
        let first = methods.next()?;
        Some(if methods.all(|m| m == first) { first.word() } else { "several" })
    }

    /// Θ, Pa, if all other moduli are known: in a table Θ follows from the other moduli, which must therefore
    /// be present.
    fn theta(&self) -> Option<f64> {
        let known = |m: &Modulus| self.medium.modulus(*m).is_some();
        Modulus::ALL.iter().all(known).then(|| self.medium.modulus(Modulus::Theta))?
    }

    /// Relative standard deviations of the speeds that have one, in their order.
    pub(crate) fn relative_errors(&self) -> Vec<f64> {
        let speeds = self.reading.speeds.iter().map(|s| s.wave);
        let mut errors: Vec<f64> = speeds.filter_map(|s| Some(s.stddev? / s.speed)).collect();
        errors.sort_by(f64::total_cmp);
        errors
    }

    /// Returns the first note on the speeds, and words on the number of the others.
    pub(crate) fn doubt(&self) -> Option<(Note, String)> {
        let mut notes = self.notes().into_iter();
        let first = notes.next()?;
        let more = match notes.len() {
            0 => String::new(),
            n => format!("; and {} on the speeds", count(n, "further note")),
        };
        Some((first, more))
    }

    /// Returns notes on the speeds and their medium.
    pub fn notes(&self) -> Vec<Note> {
        let medium = &self.medium;
        let no_axis = medium.no_axis.iter().filter(|_| medium.fitted.is_ok());
        let of_medium = match &medium.fitted {
            Ok(fitted) => fitted.conflict.as_ref().map(|conflict| {
                let (chi_square, freedom) =
                    (fitted.chi_square.unwrap_or_default(), fitted.degrees_of_freedom);
                let worst = format!("speeds[{}]", conflict.worst);
                Note::speeds_contradict(worst, chi_square, freedom as f64, conflict.sigma)
            }),
            Err(error) => Some(Note::remark(error.to_string())),
        };
        let of_axis = no_axis.map(|why| Note::no_axis(why.to_string()));
        self.reading.notes.iter().cloned().chain(of_axis).chain(of_medium).collect()
    }
}

impl Serialize for AcousticReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        if let Some(measurement) = &self.measurement {
            map.serialize_entry("measurement", measurement)?;
        }
        entries(&mut map, ACOUSTIC, self)?;
        map.serialize_entry("speeds", &self.reading.speeds.iter().map(speed).collect::<Value>())?;
        map.serialize_entry("modes", &self.modes.iter().map(speed).collect::<Value>())?;
        let notes = self.notes();
        map.serialize_entry("warnings", &texts(&notes))?;
        map.serialize_entry("notes", &notes.iter().map(NoteView).collect::<Vec<_>>())?;
        map.end()
    }
}

/// One speed, m/s and Hz; a frequency that is extrapolated to zero is null.
fn speed(m: &MeasuredWave) -> Value {
    json!({
        "direction": <[f64; 3]>::from(m.wave.direction),
        "polarization": <[f64; 3]>::from(m.wave.polarization),
        "speed": m.wave.speed,
        "stddev": m.wave.stddev,
        "method": m.method.word(),
        "frequency": m.frequency,
        "strain_amplitude": m.strain_amplitude,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::notes::Code;
    use grainlab_core::{TransverseIsotropy, Vec3, WaveMethod, WaveSpeed};

    const MEDIUM: TransverseIsotropy = TransverseIsotropy::of_constants(360e6, 400e6, 70e6, 150e6, 140e6);

    /// Exact speeds of [`MEDIUM`] along these directions, each with an error of 0.3 %.
    fn speeds(directions: &[Vec3]) -> WaveSpeedsReading {
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
            name: String::new(),
            source_step: Some(12),
            grains: None,
            density,
            density_stddev: Some(3.0),
            pressure: 5e4,
            pressure_stddev: 0.0,
            solid_fraction: Some(0.6),
            stress_ratio: Some(0.0),
            stress_ratio_stddev: 0.0,
            size_spread: Some(0.0),
            axis: Some(Vec3::z()),
            grain_shear_modulus: 29e9,
            grain_shear_modulus_stddev: 0.0,
            grain_poisson_ratio: 0.2,
            grain_poisson_ratio_stddev: 0.0,
            contact_law: None,
            smooth: false,
            speeds: directions.iter().flat_map(along).collect(),
            notes: vec![Note::remark("send less")],
        }
    }

    #[test]
    fn the_moduli_are_those_of_the_medium_whose_speeds_were_measured() {
        let diagonal = Vec3::new(1.0, 0.0, 1.0).normalize();
        let report = AcousticReport::new(1000, 1300.0, speeds(&[Vec3::z(), Vec3::x(), diagonal]));
        let json = serde_json::to_value(&report).unwrap();
        for (key, truth) in [
            ("ti_c33_pa", 400e6),
            ("ti_c11_pa", 360e6),
            ("g13_pa", 150e6),
            ("g12_pa", 140e6),
            ("ti_c13_pa", 70e6),
            ("theta_pa", MEDIUM.stiffness().bulk_voigt()),
        ] {
            assert!((json[key].as_f64().unwrap() / truth - 1.0).abs() < 1e-6, "{key}: {json}");
        }
        // A modulus from one speed: twice the error of the speed, and that of the density.
        let one = json["c33_sigma_pa"].as_f64().unwrap() / 400e6;
        assert!(one > 0.002 && one < 0.0064, "{one}");
        assert_eq!((&json["method"], &json["speed_count"]), (&"dispersion".into(), &9.into()));
        assert_eq!(json["degrees_of_freedom"], 4);
        assert!(report.relative_errors().iter().all(|e| (e - 0.003).abs() < 1e-12));
        assert_eq!(report.notes(), [Note::remark("send less")]);
    }

    #[test]
    fn moduli_about_e3_for_want_of_an_axis_are_marked() {
        let unnamed = |directions: &[Vec3]| {
            let reading = WaveSpeedsReading { axis: None, ..speeds(directions) };
            AcousticReport::new(1000, 1300.0, reading)
        };
        let (few, named) = (unnamed(&[Vec3::z()]), AcousticReport::new(1000, 1300.0, speeds(&[Vec3::z()])));
        let found = |report| serde_json::to_value(report).unwrap()["axis_found"].clone();
        assert_eq!((found(&few), found(&named), few.medium.axis), (false.into(), true.into(), Vec3::z()));
        assert!(few.notes()[1].is(Code::NoAxis), "{:?}", few.notes());
        assert_eq!(named.notes().len(), 1);
    }

    #[test]
    fn undetermined_moduli_are_null_and_a_missing_medium_has_a_reason() {
        let one = AcousticReport::new(1000, 1300.0, speeds(&[Vec3::z()])).medium;
        assert!(one.modulus(Modulus::C33).is_some());
        assert!(one.modulus(Modulus::C11).is_none() && one.stddev(Modulus::C11).is_none());
        let none = AcousticReport::new(1000, 1300.0, speeds(&[]));
        assert!(Modulus::ALL.iter().all(|m| none.medium.modulus(*m).is_none()) && none.method().is_none());
        assert_eq!(none.notes().len(), 2, "{:?}", none.notes());
    }
}
