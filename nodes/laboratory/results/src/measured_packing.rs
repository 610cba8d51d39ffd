//! One measured packing: the output of `grainlab analyze`, and an entry of `summary.json`.

use crate::probe::ProbeView;
use crate::quantities::{NoteView, entries};
use grainlab_core::notes::{Note, texts};
use grainlab_core::quantities;
use grainlab_core::quantity::{Quantity, Shape::Scalar};
use grainlab_core::results::{PackingReport, QUANTITIES, warnings};
use grainlab_core::{Packing, PathPosition};
use serde::ser::{Serialize, SerializeMap, Serializer};

/// A report, and its source.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredPacking {
    /// File, recording or topic.
    pub source: String,
    /// Step of the packing in its source.
    pub step: u64,
    /// Measured structure, stress and stiffness.
    pub report: PackingReport,
    /// Position on the loading path; `None` if no simulator recorded it.
    pub position: Option<PathPosition>,
    /// Wall time of the measurement, s; `None` if it was read from a recording.
    pub seconds: Option<f64>,
    /// Notes on the packing and its measurement.
    pub notes: Vec<Note>,
    /// Details of the probe, if the stiffness was measured by one.
    pub probe: Option<ProbeView>,
}

/// Quantities that precede those of the packing.
pub static ORIGIN: &[Quantity<MeasuredPacking>] = quantities! { MeasuredPacking:
    "source" "" "" "file, recording or topic" Scalar, |m| m.source.clone();
    "step" "" "1" "solver step of the packing" Scalar, |m| m.step;
    "phase" "" "1" "number of the phase of the scene, from 1; 0 for the packing that a run started from"
        Scalar, |m| m.position.as_ref().map(|p| p.phase as u64);
    "end_of_phase" "" "" "whether the phase met its end conditions; a packing within a phase need not be at rest"
        Scalar, |m| m.position.as_ref().map(|p| p.end_of_phase);
    "wall_time_s" "" "s" "wall time of the measurement" Scalar, |m| m.seconds;
};

impl MeasuredPacking {
    /// The report of a packing of this source; the other fields are empty.
    pub fn new(source: String, report: PackingReport) -> Self {
        let step = report.step;
        Self { source, step, report, position: None, seconds: None, notes: Vec::new(), probe: None }
    }

    /// Adds the position of the packing, the notes of its reader, and the warnings about the packing and its measurement, each
    /// once.
    #[must_use]
    pub fn doubted(mut self, packing: &Packing, remarks: &[String]) -> Self {
        self.position.clone_from(&packing.path);
        let found = warnings(packing, &self.report).into_iter();
        self.notes.extend(remarks.iter().cloned().map(Note::remark));
        self.notes.extend(found.filter(|note| !remarks.contains(&note.to_string())));
        self
    }
}

impl Serialize for MeasuredPacking {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        entries(&mut map, ORIGIN, self)?;
        entries(&mut map, QUANTITIES, &self.report)?;
        map.serialize_entry("warnings", &texts(&self.notes))?;
        map.serialize_entry("notes", &self.notes.iter().map(NoteView).collect::<Vec<_>>())?;
        map.serialize_entry("probe", &self.probe)?;
        map.end()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::printer::Printed;
    use grainlab_core::{Cell, Contact, StrainOrigin, Vec3};
    use grainlab_micromechanics::{Settings, analyze};

    /// One grain touching its own images along the three edges, or none of them.
    pub(crate) fn lattice(touching: bool) -> Packing {
        let contact = |axis: usize| {
            let (mut image, mut normal) = ([0; 3], Vec3::zeros());
            (image[axis], normal[axis]) = (1, 1.0);
            Contact::pressed([0, 0], image, normal, 1e-8, 1e-3)
        };
        Packing {
            step: 12,
            time: 0.5,
            contacts: if touching { [2, 1, 0].map(contact).to_vec() } else { Vec::new() },
            friction: 0.3,
            ..Packing::at_rest(Cell::cube(2e-4 - 1e-8).unwrap(), vec![1e-4], vec![Vec3::zeros()])
        }
    }

    pub(crate) fn measured(packing: &Packing) -> MeasuredPacking {
        MeasuredPacking::new("lattice".into(), analyze(packing, &Settings::default()).unwrap().report)
    }

    #[test]
    fn the_text_of_a_lattice_has_its_structure_and_symmetry() {
        let s = serde_json::to_value(measured(&lattice(true))).unwrap();
        assert_eq!(s["symmetry"], "cubic");
        assert_eq!(s["orientation_contacts"], serde_json::json!([2, 0, 0, 0, 0, 0, 0, 0, 0, 1]));
        assert_eq!(s["orientation_overlap_m"][9], 1e-8);
        assert!(s["orientation_overlap_m"][4].is_null());
        assert_eq!(s["weak_share_of_pressure"], 1.0);
        assert!(s["weak_share_of_deviator"].is_null());
        assert_eq!(s["mobilised_contacts"][0], 3);
        assert!(s["axis_eps_stddev"].is_null() && s["stiffness_pa"][5][5].is_f64());
    }

    #[test]
    fn quantities_undefined_for_a_gas_are_null() {
        let s = serde_json::to_value(measured(&lattice(false))).unwrap();
        for key in [
            "symmetry",
            "stiffness_pa",
            "anisotropy_contacts",
            "force_contacts",
            "mobilised_mean",
            "orientation_eps",
            "eps",
            "axis_eps",
            "p4",
        ] {
            assert!(s[key].is_null(), "{key}");
        }
    }

    #[test]
    fn a_strain_that_was_not_counted_is_unknown() {
        let at = |strain_origin| {
            let path = Some(PathPosition::new(1, false, strain_origin, None));
            serde_json::to_value(measured(&Packing { path, ..lattice(true) })).unwrap()["strain"].clone()
        };
        assert!(at(StrainOrigin::Unknown).is_null());
        for origin in [StrainOrigin::FirstStep, StrainOrigin::Reference] {
            assert_eq!(at(origin), serde_json::json!([0.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
        }
    }

    /// Equal springs along the edges of a cube are isotropic in their second moments.
    #[test]
    fn contacts_of_equal_stiffness_weigh_alike() {
        let r = measured(&lattice(true)).report;
        assert!(r.fabric.contact_anisotropy.abs() < 1e-12 && r.stiffness_anisotropy().unwrap().abs() < 1e-12);
        assert!(measured(&lattice(false)).report.stiffness_anisotropy().is_none());
        let t = r.projected().unwrap();
        assert!((t.c11 / t.c33 - 1.0).abs() < 0.5 && t.c13.abs() < t.c11);
    }

    #[test]
    fn every_row_is_as_long_as_the_header() {
        let table = MeasuredPacking::table(&[measured(&lattice(true)), measured(&lattice(false))]).csv();
        let rows: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(rows[0][..5], ["source", "step", "phase", "end_of_phase", "wall_time_s"]);
        assert!(rows.iter().all(|r| r.len() == rows[0].len()), "{table}");
        let at = |name: &str| rows[0].iter().position(|c| *c == name).unwrap();
        assert_eq!((rows[1][at("symmetry")], rows[2][at("symmetry")]), ("cubic", ""));
        assert_eq!((rows[1][at("k")], rows[2][at("affine_c66_pa")]), ("6", ""));
        assert!(!table.contains("NaN"));
    }
}
