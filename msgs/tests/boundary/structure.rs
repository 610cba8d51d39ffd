//! The part of a fabric that is its structure.

use super::refuses;
use super::results::{fabric, header};
use grainlab_core::structure::{
    AxisFound, ContactFit, Forces, FourthOrderFabric, Mobilisation, NetworkPart, Orientation, OverlapFit,
    StressForceFabric, StressParts,
};
use grainlab_core::{Fabric, Structure, SymTensor, Vec3};
use grainlab_msgs::boundary::fabric_message;
use grainlab_msgs::{from_cdr, msg, to_cdr};

const INF: f64 = f64::INFINITY;
const NAN: f64 = f64::NAN;

/// Every field differs from every other, so that none is mistaken for another.
pub(crate) fn structure() -> Structure {
    let tensor = |seed: f64| SymTensor::from_voigt(std::array::from_fn(|k| seed + 0.125 * k as f64));
    let network = |contacts, seed| NetworkPart {
        contacts,
        fabric: tensor(seed),
        eps: seed + 0.5,
        stress: tensor(seed + 100.0),
    };
    let mut forces = Forces {
        mean_normal: 4e-3,
        mean_tangential: 3e-4,
        moments: [1.5, 2.8, 6.3],
        largest: 4.1,
        ..Forces::default()
    };
    forces.contacts[3] = 1300;
    let mut mobilisation = Mobilisation { mean: 0.75, ..Mobilisation::default() };
    mobilisation.contacts[9] = 1300;
    Structure {
        reference_axis: Vec3::x(),
        axis: AxisFound { eps: -0.07, eps_stddev: Some(0.018), angle_stddev: Some(0.125), determined: true },
        tangential_fabric: tensor(1.0),
        fourth_order: FourthOrderFabric {
            components: std::array::from_fn(|k| 0.0625 * k as f64),
            magnitude: 0.1875,
        },
        orientation: Orientation {
            contacts: std::array::from_fn(|k| 85 + 10 * k as u32),
            overlap: std::array::from_fn(|k| 1e-8 * (k + 1) as f64),
            sqrt_overlap: std::array::from_fn(|k| 1e-4 * (k + 1) as f64),
            contact_fit: Some(ContactFit { eps: 0.0575, eps_stddev: 0.031, chi2_per_dof: 2.5 }),
            overlap_fit: None,
        },
        stress: StressParts { normal: tensor(2.0), tangential: tensor(3.0) },
        stress_force_fabric: Some(StressForceFabric {
            contacts: tensor(4.0),
            normal_forces: tensor(5.0),
            branches: tensor(6.0),
            tangential_forces: tensor(7.0),
        }),
        strong: network(520, 8.0),
        weak: network(780, 9.0),
        forces: Some(forces),
        mobilisation: Some(mobilisation),
    }
}

/// What is not known arrives as not known, and its zeros are not looked at.
#[test]
fn a_structure_without_forces_or_fits_crosses_the_wire_and_back() {
    let bare = Structure {
        axis: AxisFound { eps: 0.1, ..AxisFound::default() },
        stress_force_fabric: None,
        forces: None,
        mobilisation: None,
        orientation: Orientation { contact_fit: None, ..structure().orientation },
        ..structure()
    };
    let mut f = Fabric { structure: bare, ..fabric() };
    let cross = |f: &Fabric| {
        let sent = fabric_message(header(), 7, f).unwrap();
        Fabric::try_from(&from_cdr::<msg::Fabric>(&to_cdr(&sent)).unwrap()).unwrap()
    };
    assert_eq!(cross(&f), f);
    // The ratio fitted to the contacts and the fit it comes from are one and the same.
    f.anisotropy.contact = Some(0.02);
    f.structure.orientation.overlap_fit = Some(OverlapFit { g: 0.02, g_stddev: Some(0.009) });
    assert_eq!(cross(&f), f);
    f.structure.orientation.overlap_fit = Some(OverlapFit { g: 0.02, g_stddev: None });
    assert_eq!(cross(&f), f);
}

#[test]
fn each_fault_of_a_structure_is_refused_by_name() {
    refuses(
        &fabric_message(header(), 7, &fabric()).unwrap(),
        &[
            (|m| m.reference_axis.x = 0.0, "Fabric.|reference_axis| = 0.0 is refused: it must be 1"),
            (|m| m.reference_axis.y = 1.0, "Fabric.|reference_axis| = 1.4142135623730951 is refused"),
            (|m| m.axis_eps = NAN, "Fabric.axis_eps = NaN is refused"),
            (|m| m.axis_eps_stddev = -0.1, "Fabric.axis_eps_stddev = -0.1 is refused"),
            (|m| m.axis_angle_stddev = INF, "Fabric.axis_angle_stddev = inf is refused"),
            (|m| m.tangential_fabric.xy = NAN, "Fabric.tangential_fabric.xy = NaN is refused"),
            (|m| m.fourth_order_fabric[14] = NAN, "Fabric.fourth_order_fabric[14] = NaN is refused"),
            (|m| m.fourth_order_magnitude = -1.0, "Fabric.fourth_order_magnitude = -1.0 is refused"),
            (|m| m.stress_normal.xx = INF, "Fabric.stress_normal.xx = inf is refused"),
            (|m| m.stress_tangential.zz = NAN, "Fabric.stress_tangential.zz = NaN is refused"),
            (|m| m.anisotropy_contacts.xx = NAN, "Fabric.anisotropy_contacts.xx = NaN is refused"),
            (|m| m.anisotropy_normal_forces.xx = NAN, "Fabric.anisotropy_normal_forces.xx = NaN is refused"),
            (|m| m.anisotropy_branches.yz = INF, "Fabric.anisotropy_branches.yz = inf is refused"),
            (
                |m| m.anisotropy_tangential_forces.xx = NAN,
                "Fabric.anisotropy_tangential_forces.xx = NaN is refused",
            ),
            (
                |m| m.orientation_contacts[4] += 1,
                "Fabric.sum of orientation_contacts = 1301.0 is refused: it must be the number of contacts",
            ),
            (|m| m.orientation_overlap[9] = -1e-9, "Fabric.orientation_overlap[9] = -1e-9 is refused"),
            (|m| m.orientation_sqrt_overlap[0] = NAN, "Fabric.orientation_sqrt_overlap[0] = NaN is refused"),
            (
                |m| m.orientation_eps = 1.1,
                "Fabric.orientation_eps = 1.1 is refused: it must be between -1/2 and 1",
            ),
            (|m| m.orientation_eps_stddev = NAN, "Fabric.orientation_eps_stddev = NaN is refused"),
            (|m| m.orientation_chi2 = -1.0, "Fabric.orientation_chi2 = -1.0 is refused"),
            (
                |m| {
                    (m.gamma_over_delta_contact_known, m.gamma_over_delta_contact_stddev_known) =
                        (true, true);
                    m.gamma_over_delta_contact_stddev = -1.0;
                },
                "Fabric.gamma_over_delta_contact_stddev = -1.0 is refused",
            ),
            (|m| m.strong_contacts = 1301, "Fabric.strong_contacts = 1301.0 is refused: it must be at most"),
            (|m| m.strong_fabric.xx = NAN, "Fabric.strong_fabric.xx = NaN is refused"),
            (|m| m.weak_fabric.yy = NAN, "Fabric.weak_fabric.yy = NaN is refused"),
            (|m| m.strong_eps = NAN, "Fabric.strong_eps = NaN is refused"),
            (|m| m.weak_eps = INF, "Fabric.weak_eps = inf is refused"),
            (|m| m.strong_stress.xy = NAN, "Fabric.strong_stress.xy = NaN is refused"),
            (|m| m.weak_stress.xy = NAN, "Fabric.weak_stress.xy = NaN is refused"),
            (|m| m.force_mean_normal = 0.0, "Fabric.force_mean_normal = 0.0 is refused"),
            (|m| m.force_mean_tangential = -1.0, "Fabric.force_mean_tangential = -1.0 is refused"),
            (|m| m.force_moments[0] = 0.0, "Fabric.force_moments[0] = 0.0 is refused"),
            (|m| m.force_moments[2] = NAN, "Fabric.force_moments[2] = NaN is refused"),
            (|m| m.force_largest = NAN, "Fabric.force_largest = NaN is refused"),
            (|m| m.force_contacts[0] = u32::MAX, "Fabric.sum of force_contacts = 4294968595.0 is refused"),
            (|m| m.mobilisation_mean = 1.01, "Fabric.mobilisation_mean = 1.01 is refused"),
            (|m| m.mobilisation_contacts[9] = 0, "Fabric.sum of mobilisation_contacts = 0.0 is refused"),
        ],
        |m| Fabric::try_from(m),
    );
}
