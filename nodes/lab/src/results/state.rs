//! One measured packing, with the stable keys of `grainlab analyze`.

use super::probe::{ProbeView, ScanView};
use super::structure::StructureView;
use super::structure_csv::{STRUCTURE, SYMMETRY, structure_cells, symmetry_cells};
use super::symmetry::SymmetryView;
use crate::output::{Table, exact};
use grainlab_core::{Anisotropy, Fabric, Moduli, Packing, Stiffness, SymTensor, Vec3};
use grainlab_msgs::boundary::ModuliMethod;
use serde::Serialize;

/// What was measured on one packing. Undefined values are null, and `warnings` says why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct State {
    pub(crate) source: String,
    pub(crate) step: u64,
    pub(crate) grains: u32,
    pub(crate) phi: f64,
    pub(crate) pressure_pa: f64,
    /// Voigt order xx, yy, zz, yz, xz, xy, positive in compression.
    pub(crate) stress_pa: [f64; 6],
    pub(crate) k: f64,
    pub(crate) z: f64,
    pub(crate) rattlers: u32,
    pub(crate) contacts: u32,
    /// L, Voigt order, tensor components.
    pub(crate) fabric: [f64; 6],
    /// About the reference axis.
    pub(crate) eps: f64,
    /// The same with every contact weighted by its normal stiffness; null without contacts.
    pub(crate) eps_stiffness: Option<f64>,
    /// The axis found.
    pub(crate) axis: [f64; 3],
    /// What eps, g, G12, G13 and the ti_ moduli are about; the stiffnesses are in the frame of the cell.
    pub(crate) reference_axis: [f64; 3],
    /// Mean net force of the grains that take part over the mean contact force; null without forces.
    pub(crate) unbalanced: Option<f64>,
    pub(crate) g: Ratios,
    /// How the stiffness was found: frozen_network, prestressed_network, probe, affine or acoustic.
    pub(crate) method: Option<&'static str>,
    pub(crate) stiffness_pa: Option<[[f64; 6]; 6]>,
    /// Standard error of each entry, as a measurement of this packing.
    pub(crate) stiffness_stddev_pa: Option<[[f64; 6]; 6]>,
    pub(crate) stiffness_affine_pa: Option<[[f64; 6]; 6]>,
    /// Affine motion with one spin of all grains.
    pub(crate) stiffness_mean_spin_pa: Option<[[f64; 6]; 6]>,
    pub(crate) g12_pa: Option<f64>,
    pub(crate) g13_pa: Option<f64>,
    pub(crate) theta_pa: Option<f64>,
    /// C11, C33 and C13 of the projection on media isotropic about the reference axis.
    pub(crate) ti_c11_pa: Option<f64>,
    pub(crate) ti_c33_pa: Option<f64>,
    pub(crate) ti_c13_pa: Option<f64>,
    pub(crate) grain_shear_modulus_pa: f64,
    pub(crate) poisson: f64,
    pub(crate) theta_reuss_pa: Option<f64>,
    /// Lower bound of theta_reuss_pa by the forces present.
    pub(crate) theta_bound_pa: Option<f64>,
    pub(crate) residual: Option<f64>,
    /// Wall time of the measurement; null where it was read from a recording.
    pub(crate) seconds: Option<f64>,
    pub(crate) warnings: Vec<String>,
    pub(crate) structure: StructureView,
    /// Null without a stiffness.
    pub(crate) symmetry: Option<SymmetryView>,
    /// How the probe went, where the stiffness is a probe's.
    pub(crate) probe: Option<ProbeView>,
    /// Probes of several amplitudes, where these were asked for.
    pub(crate) scan: Option<ScanView>,
}

/// The three ratios gamma/Delta.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Ratios {
    pub(crate) total: Option<f64>,
    pub(crate) elastic: Option<f64>,
    pub(crate) contact: Option<f64>,
}

impl From<&Anisotropy> for Ratios {
    fn from(a: &Anisotropy) -> Self {
        Self { total: a.total, elastic: a.elastic, contact: a.contact }
    }
}

/// G12 and G13 about the unit vector `axis`, and Theta of a stiffness, Pa.
pub(crate) fn three_moduli(c: &Stiffness, axis: &Vec3) -> [f64; 3] {
    let t = c.transverse_isotropy_about(axis);
    [t.g12, t.g13, c.bulk_voigt()]
}

/// ε about the reference axis of the contacts weighted by their normal stiffness: of the fabric `stiffness_fabric`. `None`
/// without contacts.
pub(crate) fn eps_stiffness(fabric: &Fabric) -> Option<f64> {
    let weighted = &fabric.stiffness_fabric;
    (fabric.contacts > 0)
        .then(|| grainlab_micromechanics::fabric::eps(weighted, &fabric.structure.reference_axis))
}

impl State {
    /// Puts together what was measured.
    pub(crate) fn new(source: String, packing: &Packing, fabric: &Fabric, moduli: Option<&Moduli>) -> Self {
        let stress = grainlab_core::stress::stress(packing).tensor;
        let axis = fabric.structure.reference_axis;
        let three = moduli.map(|m| three_moduli(&m.stiffness, &axis));
        let projected = moduli.map(|m| m.stiffness.transverse_isotropy_about(&axis));
        let rows = |c: &Stiffness| std::array::from_fn(|i| std::array::from_fn(|j| c.0[(i, j)]));
        Self {
            source,
            step: packing.step,
            grains: fabric.grains,
            phi: packing.solid_fraction(),
            pressure_pa: stress.mean(),
            stress_pa: stress.voigt(),
            k: fabric.k,
            z: fabric.z,
            rattlers: fabric.rattlers,
            contacts: fabric.contacts,
            fabric: fabric.contact_fabric.voigt(),
            eps: fabric.eps,
            eps_stiffness: eps_stiffness(fabric),
            axis: fabric.axis.into(),
            reference_axis: axis.into(),
            unbalanced: grainlab_micromechanics::balance::unbalanced(
                packing,
                &grainlab_micromechanics::rattlers::participating(packing),
            ),
            g: Ratios::from(&fabric.anisotropy),
            method: moduli.map(|m| ModuliMethod::from(m.method).word()),
            stiffness_pa: moduli.map(|m| rows(&m.stiffness)),
            stiffness_stddev_pa: moduli.map(|m| rows(&m.stddev)),
            stiffness_affine_pa: moduli.map(|m| rows(&m.affine)),
            stiffness_mean_spin_pa: moduli.map(|m| rows(&m.mean_spin)),
            g12_pa: three.map(|m| m[0]),
            g13_pa: three.map(|m| m[1]),
            theta_pa: three.map(|m| m[2]),
            ti_c11_pa: projected.map(|t| t.c11),
            ti_c33_pa: projected.map(|t| t.c33),
            ti_c13_pa: projected.map(|t| t.c13),
            grain_shear_modulus_pa: packing.material.shear_modulus,
            poisson: packing.material.poisson_ratio,
            theta_reuss_pa: moduli.and_then(|m| m.stiffness.bulk_reuss()),
            theta_bound_pa: moduli.and_then(|m| m.reuss_bound),
            residual: moduli.map(|m| m.residual),
            seconds: None,
            warnings: Vec::new(),
            structure: StructureView::from(fabric),
            symmetry: moduli.and_then(|m| {
                let axis = Some(&fabric.axis).filter(|_| fabric.structure.axis.determined);
                SymmetryView::new(&m.stiffness, fabric.grains, axis)
            }),
            probe: None,
            scan: None,
        }
    }

    /// q/p; `None` without pressure.
    pub(crate) fn stress_ratio(&self) -> Option<f64> {
        let q = SymTensor::from_voigt(self.stress_pa).deviatoric_invariant();
        (self.pressure_pa > 0.0).then(|| q / self.pressure_pa)
    }

    /// The relaxed stiffness.
    pub(crate) fn stiffness(&self) -> Option<Stiffness> {
        self.stiffness_pa.as_ref().map(of_rows)
    }

    /// G12, G13 and Theta: relaxed and affine, Pa.
    pub(crate) fn moduli(&self) -> Option<([f64; 3], [f64; 3])> {
        let affine = self.stiffness_affine_pa.as_ref().map(of_rows)?;
        let axis = Vec3::from(self.reference_axis);
        Some((three_moduli(&self.stiffness()?, &axis), three_moduli(&affine, &axis)))
    }
}

fn of_rows(rows: &[[f64; 6]; 6]) -> Stiffness {
    Stiffness::from_row_major(&std::array::from_fn(|n| rows[n / 6][n % 6]))
}

const VOIGT: [&str; 6] = ["xx", "yy", "zz", "yz", "xz", "xy"];

/// States as CSV, one a line, at full precision.
pub(crate) fn csv(states: &[State]) -> String {
    table(states).csv()
}

/// States as a table, one a row, at full precision.
pub(crate) fn table(states: &[State]) -> Table {
    let of = |prefix: &'static str| VOIGT.iter().map(move |c| format!("{prefix}_{c}"));
    let entries =
        |prefix: &'static str| (0..36).map(move |n| format!("{prefix}{}{}_pa", n / 6 + 1, n % 6 + 1));
    let mut header: Vec<String> =
        ["source", "step", "grains", "phi", "pressure_pa"].map(String::from).to_vec();
    header.extend(of("stress_pa"));
    header.extend(["k", "z", "rattlers", "contacts"].map(String::from));
    header.extend(of("fabric"));
    let rest = ["eps", "axis_x", "axis_y", "axis_z", "g_total", "g_elastic", "g_contact", "g12_pa", "g13_pa"];
    header.extend(rest.map(String::from));
    header.extend(["theta_pa", "theta_reuss_pa", "residual", "seconds", "method"].map(String::from));
    header.extend(entries("c"));
    header.extend(entries("affine_c"));
    header.extend(STRUCTURE.map(String::from));
    header.extend(SYMMETRY.map(String::from));
    header.push("theta_bound_pa".to_owned());
    header.extend(entries("stddev_c"));
    header.extend(entries("mean_spin_c"));
    header.extend(["eps_stiffness", "ti_c11_pa", "ti_c33_pa", "ti_c13_pa"].map(String::from));
    header.extend(["grain_shear_modulus_pa", "poisson"].map(String::from));
    let about = ["reference_axis_x", "reference_axis_y", "reference_axis_z", "unbalanced"];
    header.extend(about.map(String::from));
    let mut t = Table::new(header);
    for s in states {
        let number = |v: f64| exact(Some(v));
        let mut cells = vec![s.source.clone(), s.step.to_string(), s.grains.to_string()];
        cells.extend([s.phi, s.pressure_pa].map(number));
        cells.extend(s.stress_pa.map(number));
        cells.extend([number(s.k), number(s.z), s.rattlers.to_string(), s.contacts.to_string()]);
        cells.extend(s.fabric.map(number));
        cells.push(number(s.eps));
        cells.extend(s.axis.map(number));
        cells.extend([s.g.total, s.g.elastic, s.g.contact].map(exact));
        cells.extend([s.g12_pa, s.g13_pa, s.theta_pa, s.theta_reuss_pa, s.residual, s.seconds].map(exact));
        cells.push(s.method.unwrap_or_default().to_owned());
        for matrix in [&s.stiffness_pa, &s.stiffness_affine_pa] {
            cells.extend((0..36).map(|n| exact(matrix.as_ref().map(|m| m[n / 6][n % 6]))));
        }
        cells.extend(structure_cells(&s.structure));
        cells.extend(symmetry_cells(s.symmetry.as_ref()));
        cells.push(exact(s.theta_bound_pa));
        for matrix in [&s.stiffness_stddev_pa, &s.stiffness_mean_spin_pa] {
            cells.extend((0..36).map(|n| exact(matrix.as_ref().map(|m| m[n / 6][n % 6]))));
        }
        cells.extend([s.eps_stiffness, s.ti_c11_pa, s.ti_c33_pa, s.ti_c13_pa].map(exact));
        cells.extend([s.grain_shear_modulus_pa, s.poisson].map(number));
        cells.extend(s.reference_axis.map(number));
        cells.push(exact(s.unbalanced));
        t.row(cells);
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::{Cell, Contact, Mat3, Material};

    /// One grain touching its own images along the three edges, or none.
    fn lattice(touching: bool) -> Packing {
        let contact = |axis: usize| {
            let (mut image, mut normal) = ([0; 3], Vec3::zeros());
            (image[axis], normal[axis]) = (1, 1.0);
            let tangential_force = Vec3::zeros();
            Contact { i: 0, j: 0, image, overlap: 1e-8, normal, normal_force: 1e-3, tangential_force }
        };
        Packing {
            step: 12,
            time: 0.5,
            cell: Cell::cube(2e-4 - 1e-8).unwrap(),
            deformation: Mat3::identity(),
            ids: vec![0],
            radii: vec![1e-4],
            positions: vec![Vec3::zeros()],
            velocities: vec![Vec3::zeros()],
            spins: vec![Vec3::zeros()],
            contacts: if touching { [2, 1, 0].map(contact).to_vec() } else { Vec::new() },
            material: Material::GLASS,
            law: Default::default(),
            friction: 0.3,
            time_step: 0.0,
        }
    }

    fn state(packing: &Packing) -> State {
        let a =
            grainlab_micromechanics::analyse(packing, &grainlab_micromechanics::Settings::default()).unwrap();
        State::new("lattice".into(), packing, &a.fabric, a.moduli.as_ref().ok())
    }

    #[test]
    fn a_lattice_says_its_structure_and_its_symmetry() {
        let s = serde_json::to_value(state(&lattice(true))).unwrap();
        assert_eq!(s["symmetry"]["class"], "cubic");
        assert_eq!(
            s["structure"]["orientation"]["contacts"],
            serde_json::json!([2, 0, 0, 0, 0, 0, 0, 0, 0, 1])
        );
        assert_eq!(s["structure"]["orientation"]["overlap_m"][9], 1e-8);
        assert!(s["structure"]["orientation"]["overlap_m"][4].is_null());
        assert_eq!(s["structure"]["weak"]["share_of_pressure"], 1.0);
        assert!(s["structure"]["weak"]["share_of_deviator"].is_null());
        assert_eq!(s["structure"]["friction"]["contacts"][0], 3);
        assert!(s["structure"]["axis"]["eps_stddev"].is_null());
    }

    #[test]
    fn what_a_gas_has_not_is_null() {
        let s = serde_json::to_value(state(&lattice(false))).unwrap();
        assert!(s["symmetry"].is_null() && s["stiffness_pa"].is_null());
        for key in ["stress_force_fabric", "forces", "friction"] {
            assert!(s["structure"][key].is_null(), "{key}");
        }
        assert!(s["structure"]["orientation"]["eps"].is_null());
    }

    /// Equal springs along the edges of a cube are isotropic in their second moments.
    #[test]
    fn contacts_of_equal_stiffness_weigh_alike() {
        let s = state(&lattice(true));
        assert!(s.eps.abs() < 1e-12 && s.eps_stiffness.unwrap().abs() < 1e-12);
        assert!(state(&lattice(false)).eps_stiffness.is_none());
        let t = s.ti_c11_pa.unwrap();
        assert!((t / s.ti_c33_pa.unwrap() - 1.0).abs() < 0.5 && s.ti_c13_pa.unwrap().abs() < t);
    }

    /// The columns that were there first stay first, and every row is as long as the header.
    #[test]
    fn new_columns_are_appended() {
        let table = csv(&[state(&lattice(true)), state(&lattice(false))]);
        let rows: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(rows[0][..5], ["source", "step", "grains", "phi", "pressure_pa"]);
        assert!(rows.iter().all(|r| r.len() == rows[0].len()), "{table}");
        let at = |name: &str| rows[0].iter().position(|c| *c == name).unwrap();
        assert!(at("axis_eps") > at("affine_c66_pa") && at("symmetry") > at("axis_eps"));
        assert_eq!((rows[1][at("symmetry")], rows[2][at("symmetry")]), ("cubic", ""));
        assert!(!table.contains("NaN"));
    }
}
