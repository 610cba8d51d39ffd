//! The structure of a packing in a `PackingReport` message.

use super::results::{crossed, report, sent};
use super::{refuses, refuses_values};
use grainlab_core::results::{
    ContactStatistics, Fabric, ForceStatistics, FourthOrderFabric, MobilisedFriction, OrientationFit,
    OrientationHistogram, OverlapAnisotropyFit, PackingReport, PrincipalAxis, StressDecomposition,
    StressForceFabric, SubNetwork,
};
use grainlab_core::{SymTensor, Vec3};
use grainlab_msgs::msg;

fn tensor(seed: f64) -> SymTensor {
    SymTensor::from_voigt(std::array::from_fn(|k| seed + 0.125 * k as f64))
}

// All fields have different values, so that a mix-up is detected.

pub(crate) fn contacts() -> ContactStatistics {
    let mut forces = ForceStatistics {
        mean_normal: 4e-3,
        mean_tangential: 3e-4,
        moments: [1.5, 2.8, 6.3],
        largest: 4.1,
        ..ForceStatistics::default()
    };
    forces.histogram[3] = 1300;
    let mut friction = MobilisedFriction { mean: 0.75, ..MobilisedFriction::default() };
    friction.histogram[9] = 1300;
    ContactStatistics {
        grains: 500,
        contacts: 1300,
        rattlers: 20,
        coordination: 5.2,
        mechanical_coordination: 5.4,
        sliding_fraction: 0.125,
        forces: Some(forces),
        friction: Some(friction),
    }
}

pub(crate) fn fabric() -> Fabric {
    Fabric {
        reference_axis: Vec3::x(),
        contact_fabric: SymTensor::from_voigt([0.33, 0.32, 0.35, 0.001, -0.002, 0.003]),
        normal_force_fabric: SymTensor::isotropic(1.0 / 3.0),
        tangential_force_fabric: tensor(1.0),
        stiffness_fabric: SymTensor::from_voigt([0.3, 0.3, 0.4, 0.0, 0.0, 0.0]),
        contact_anisotropy: 0.0625,
        p4_coefficient: -0.01,
        fourth_order: FourthOrderFabric {
            components: std::array::from_fn(|k| 0.0625 * k as f64),
            magnitude: 0.1875,
        },
        principal_axis: PrincipalAxis {
            direction: Vec3::z(),
            contact_anisotropy: -0.07,
            contact_anisotropy_stddev: Some(0.018),
            angle_stddev: Some(0.125),
            determined: true,
        },
        orientation: OrientationHistogram {
            contacts: std::array::from_fn(|k| 85 + 10 * k as u32),
            overlap: std::array::from_fn(|k| 1e-8 * (k + 1) as f64),
            sqrt_overlap: std::array::from_fn(|k| 1e-4 * (k + 1) as f64),
            contact_fit: Some(OrientationFit { eps: 0.0575, eps_stddev: 0.031, chi2_per_dof: 2.5 }),
            overlap_fit: None,
        },
    }
}

pub(crate) fn stress_decomposition() -> StressDecomposition {
    let network = |contacts, seed| SubNetwork {
        contacts,
        fabric: tensor(seed),
        contact_anisotropy: seed + 0.5,
        stress: tensor(seed + 100.0),
    };
    StressDecomposition {
        normal: tensor(2.0),
        tangential: tensor(3.0),
        strong: network(520, 8.0),
        weak: network(780, 9.0),
        stress_force_fabric: Some(StressForceFabric {
            contacts: tensor(4.0),
            normal_forces: tensor(5.0),
            branches: tensor(6.0),
            tangential_forces: tensor(7.0),
        }),
    }
}

/// Unknown quantities stay unknown.
#[test]
fn a_structure_without_forces_or_fits_crosses_the_wire_and_back() {
    let mut r = report();
    let axis = &mut r.fabric.principal_axis;
    (axis.contact_anisotropy_stddev, axis.angle_stddev, axis.determined) = (None, None, false);
    r.fabric.orientation.contact_fit = None;
    r.stress_decomposition.stress_force_fabric = None;
    (r.contacts.forces, r.contacts.friction) = (None, None);
    assert_eq!(crossed(&r), r);
    // The ratio fitted to the contacts is that of the fit.
    r.strain_ratios.contact = Some(0.02);
    for g_stddev in [Some(0.009), None] {
        r.fabric.orientation.overlap_fit = Some(OverlapAnisotropyFit { g: 0.02, g_stddev });
        assert_eq!(crossed(&r), r);
    }
}

#[test]
fn each_fault_of_a_structure_is_refused_by_name() {
    refuses(
        &sent(),
        &[
            (
                |m| m.fabric.reference_axis.x = 0.0,
                "PackingReport.fabric.|reference_axis| = 0.0 is refused: it must be 1",
            ),
            (
                |m| m.fabric.reference_axis.y = 1.0,
                "PackingReport.fabric.|reference_axis| = 1.4142135623730951 is refused",
            ),
            (
                |m| m.fabric.orientation.contacts[4] += 1,
                "PackingReport.fabric.sum of orientation.contacts = 1301.0 is refused: it must be the number of contacts",
            ),
            (
                |m| m.fabric.orientation.contact_fit[0].eps = 1.1,
                "PackingReport.fabric.orientation.contact_fit.eps = 1.1 is refused: it must be between -1/2 and 1",
            ),
            (
                |m| {
                    m.fabric
                        .orientation
                        .overlap_fit
                        .push(msg::OverlapAnisotropyFit { g: 0.0, g_stddev: vec![-1.0] })
                },
                "PackingReport.fabric.orientation.overlap_fit.g_stddev = -1.0 is refused",
            ),
            (
                |m| m.contacts.forces.push(msg::ForceStatistics::default()),
                "PackingReport.contacts.forces has 2 entries and is refused: it must have 1",
            ),
            (
                |m| m.stress_decomposition.strong.contacts = 521,
                "PackingReport.stress_decomposition.sum of strong.contacts and weak.contacts = 1301.0 is refused",
            ),
            (
                |m| m.contacts.forces[0].histogram[0] = u32::MAX,
                "PackingReport.contacts.sum of forces.histogram = 4294968595.0 is refused",
            ),
            (
                |m| m.contacts.friction[0].histogram[9] = 0,
                "PackingReport.contacts.sum of friction.histogram = 0.0 is refused",
            ),
        ],
        |m| PackingReport::try_from(m),
    );
    refuses_values!(&sent(), |m| PackingReport::try_from(m), "PackingReport", m:
        m.fabric.principal_axis.contact_anisotropy_stddev[0] => -0.1,
        m.fabric.fourth_order_magnitude => -1.0,
        m.fabric.orientation.overlap[9] => -1e-9,
        m.fabric.orientation.contact_fit[0].chi2_per_dof => -1.0,
        m.contacts.forces[0].mean_normal => 0.0,
        m.contacts.forces[0].mean_tangential => -1.0,
        m.contacts.forces[0].moments[0] => 0.0,
        m.contacts.friction[0].mean => 1.01,
    );
}
