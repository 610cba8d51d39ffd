use super::not_finite::refuses_non_finite;
use super::structure::{contacts, fabric, stress_decomposition};
use super::{refuses, refuses_values};
use grainlab_core::contact::ContactLaw;
use grainlab_core::results::{
    ElasticStiffness, NoStiffness, PackingReport, StiffnessBounds, StiffnessMethod, StrainRatios,
};
use grainlab_core::stress::Stress;
use grainlab_core::{
    Mat3, Material, Stiffness, SymTensor, Symmetry, TransverseIsotropy, Vec3, min_contacts, symmetry,
};
use grainlab_msgs::boundary::{ModuliReading, packing_report_message};
use grainlab_msgs::msg;
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{from_cdr, stamp, to_cdr};

const INF: f64 = f64::INFINITY;

pub(crate) fn header() -> Header {
    Header { stamp: stamp(0.25), frame_id: "cell".into() }
}

pub(crate) fn report() -> PackingReport {
    PackingReport {
        step: 7,
        material: Material::GLASS,
        law: ContactLaw::default(),
        friction: 0.3,
        solid_fraction: 0.64,
        size_spread: 0.1,
        strain: None,
        stress: Stress { tensor: SymTensor::isotropic(5e4), asymmetry: 0.0 },
        unbalanced_force_ratio: None,
        contacts: contacts(),
        fabric: fabric(),
        stress_decomposition: stress_decomposition(),
        strain_ratios: StrainRatios { total: Some(-0.3), elastic: Some(0.02), contact: None },
        elasticity: Ok(Box::new(stiffness())),
        symmetry: None,
    }
}

fn stiffness() -> ElasticStiffness {
    let relaxed = TransverseIsotropy::of_constants(360e6, 400e6, 70e6, 150e6, 140e6);
    let affine = TransverseIsotropy { c11: 460e6, g13: 200e6, ..relaxed };
    let uniform_rotation = TransverseIsotropy { c11: 460e6, g13: 199e6, ..relaxed };
    ElasticStiffness {
        method: StiffnessMethod::FrozenNetwork,
        smooth: false,
        tensor: relaxed.stiffness(),
        stddev: Stiffness::from_row_major(&[0.5; 36]),
        residual: 1e-9,
        iterations: 91,
        bounds: StiffnessBounds {
            affine: affine.stiffness(),
            uniform_rotation: uniform_rotation.stiffness(),
            bulk_reuss: Some(1.2e8),
        },
    }
}

pub(crate) fn sent() -> msg::PackingReport {
    packing_report_message(header(), &report()).unwrap()
}

pub(crate) fn crossed(report: &PackingReport) -> PackingReport {
    let sent = packing_report_message(header(), report).unwrap();
    PackingReport::try_from(&from_cdr::<msg::PackingReport>(&to_cdr(&sent)).unwrap()).unwrap()
}

#[test]
fn a_report_crosses_the_wire_bit_for_bit() {
    let cubic_axes = Mat3::from_fn(|i, j| (3 * i + j) as f64);
    let symmetry = Symmetry { cubic_axes, ..symmetry(&stiffness().tensor, 1e-6).unwrap() };
    let strain = Some(SymTensor::from_voigt([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]));
    for method in StiffnessMethod::ALL {
        for friction in [0.3, INF] {
            let stiffness = ElasticStiffness { method, smooth: friction == INF, ..stiffness() };
            let elasticity = Ok(Box::new(stiffness));
            let (symmetry, unbalanced_force_ratio) = (Some(symmetry), Some(1e-7));
            let whole =
                PackingReport { friction, strain, symmetry, unbalanced_force_ratio, elasticity, ..report() };
            assert_eq!(crossed(&whole), whole);
        }
    }
    assert_eq!((sent().source_step, sent().header), (7, header()));
}

#[test]
fn a_packing_without_a_stiffness_keeps_the_reason() {
    let needed = min_contacts(report().friction);
    for why in [
        NoStiffness::NoContacts { grains: 500 },
        NoStiffness::OnlyRattlers { grains: 500, needed },
        NoStiffness::Floppy { contacts: 12 },
        NoStiffness::TooDeep,
        NoStiffness::Unsolved,
    ] {
        let gas = PackingReport { elasticity: Err(why), ..report() };
        assert_eq!(crossed(&gas), gas);
    }
}

/// An instrument measures two or three moduli, pressure and the material; all other fields are unknown.
#[test]
fn fields_unknown_to_an_instrument_are_none() {
    let message = msg::Moduli {
        covariance: vec![4e12, 1e12, 0.0, 1e12, 4e12, 0.0, 0.0, 0.0, 9e12],
        g12: vec![140e6],
        g13: vec![150e6],
        theta: vec![170e6],
        name: "sand 4".to_owned(),
        pressure: 5e4,
        pressure_stddev: 500.0,
        solid_fraction: vec![0.64],
        stress_ratio: vec![0.0],
        stress_ratio_stddev: 0.05,
        size_spread: vec![0.1],
        grain_shear_modulus: 29e9,
        grain_shear_modulus_stddev: 1e9,
        grain_poisson_ratio: 0.2,
        grain_poisson_ratio_stddev: 0.02,
        grain_density: 2500.0,
        smooth: true,
        ..msg::Moduli::default()
    };
    let r = ModuliReading::try_from(&message).unwrap();
    assert_eq!((r.pressure, r.material, r.size_spread), (5e4, Material::GLASS, Some(0.1)));
    assert_eq!((r.pressure_stddev, r.stress_ratio_stddev), (500.0, 0.05));
    assert_eq!((r.shear_modulus_stddev, r.poisson_ratio_stddev, r.smooth), (1e9, 0.02, true));
    assert_eq!(r.contact_law, None);
    assert_eq!((r.grains, r.reference_axis, r.strain_ratios), (None, Vec3::z(), StrainRatios::default()));
    assert_eq!(r.covariance.unwrap().to_vec(), message.covariance);
    let shear_alone = msg::Moduli { theta: vec![], solid_fraction: vec![], ..message };
    let r = ModuliReading::try_from(&shear_alone).unwrap();
    assert_eq!((r.g12, r.g13, r.theta, r.solid_fraction), (Some(140e6), Some(150e6), None, None));
}

#[test]
fn each_fault_of_the_moduli_is_refused_by_name() {
    let good = msg::Moduli {
        header: header(),
        covariance: vec![4e12, 1e12, 0.0, 1e12, 4e12, 0.0, 0.0, 0.0, 9e12],
        g12: vec![140e6],
        g13: vec![150e6],
        theta: vec![170e6],
        pressure: 5e4,
        solid_fraction: vec![0.64],
        stress_ratio: vec![0.0],
        size_spread: vec![0.1],
        strain_ratios: msg::StrainRatios { total: vec![-0.3], ..Default::default() },
        grain_shear_modulus: 29e9,
        grain_poisson_ratio: 0.2,
        grain_density: 2500.0,
        contact_law: "linear".to_owned(),
        contact_law_parameters: vec![1e5, 0.5],
        ..msg::Moduli::default()
    };
    refuses_non_finite(&good, &[], |m| ModuliReading::try_from(m));
    refuses(
        &good,
        &[
            (|m| m.header.stamp.nanosec = u32::MAX, "Moduli.header.stamp.nanosec"),
            (|m| m.theta.push(1.0), "Moduli.theta has 2 entries and is refused: it must have 1"),
            (|m| _ = m.covariance.pop(), "Moduli.covariance has 8 entries and is refused: it must have 9"),
            (|m| m.covariance[3] = 1.0, "Moduli.covariance[3] = 1.0 is refused: it must be symmetric"),
            (
                |m| (m.stress_ratio, m.stress_ratio_stddev) = (vec![], 0.1),
                "Moduli.stress_ratio_stddev = 0.1 is refused: it must be 0 where the quantity is not known",
            ),
            (
                |m| m.contact_law = "hooke".into(),
                "Moduli.contact_law is refused: unknown contact law \"hooke\"",
            ),
            (|m| m.contact_law.clear(), "Moduli.contact_law is refused: unknown contact law \"\""),
            (|m| m.reference_axis.z = 0.5, "Moduli.|reference_axis| = 0.5 is refused: it must be 1"),
            (|m| m.strain_ratios.contact.push(INF), "Moduli.strain_ratios.contact = inf is refused"),
        ],
        |m| ModuliReading::try_from(m),
    );
    refuses_values!(&good, |m| ModuliReading::try_from(m), "Moduli", m:
        m.covariance[4] => -1.0,
        m.pressure => -5e4,
        m.solid_fraction[0] => 0.0,
        m.stress_ratio_stddev => -1.0,
        m.grain_poisson_ratio_stddev => -0.1,
        m.size_spread[0] => -0.1,
        m.grain_shear_modulus => 0.0,
        m.grain_poisson_ratio => 0.51,
        m.grain_density => -1.0,
    );
}

#[test]
fn each_fault_of_a_report_is_refused_by_name() {
    let symmetry = symmetry(&stiffness().tensor, 1e-6);
    let (strain, unbalanced_force_ratio) = (Some(SymTensor::default()), Some(1e-7));
    let whole = PackingReport { symmetry, strain, unbalanced_force_ratio, ..report() };
    refuses_non_finite(&packing_report_message(header(), &whole).unwrap(), &["friction"], |m| {
        PackingReport::try_from(m)
    });
    refuses(
        &packing_report_message(header(), &whole).unwrap(),
        &[
            (|m| m.header.stamp.nanosec = u32::MAX, "PackingReport.header.stamp.nanosec"),
            (|m| m.contact_law = "hooke".into(), "PackingReport.contact_law is refused"),
            (|m| m.jamming = 3, "PackingReport.jamming = 3 is refused: it must be one of 0 (jammed) with"),
            (
                |m| m.stiffness.clear(),
                "PackingReport.jamming = 0 is refused: it must be one of 0 (jammed) with",
            ),
            (
                |m| m.symmetry[0].symmetry_class = 9,
                "PackingReport.symmetry.symmetry_class = 9 is refused: it must be one of 0 (isotropic)",
            ),
            (|m| m.symmetry[0].axis.z = 2.0, "PackingReport.symmetry.|axis|"),
            (
                |m| m.stiffness[0].method = 1,
                "PackingReport.stiffness.method = 1 is refused: it must be one of 0 (frozen network)",
            ),
            // Numbers that contradict each other.
            (
                |m| m.stiffness[0].stiffness[1] *= 1.5,
                "PackingReport.stiffness.stiffness[1] = 120000000.0 is refused: it must be that of the",
            ),
            (
                |m| m.stiffness[0].affine.fill(0.0),
                "PackingReport.stiffness.affine (bulk modulus) = 0.0 is refused: it must be at least",
            ),
            (|m| m.symmetry[0].moduli.c11 *= 1.5, "PackingReport.symmetry.moduli (bulk modulus) = "),
            (
                |m| m.stiffness.push(Default::default()),
                "PackingReport.stiffness has 2 entries and is refused: it must have 1 (or none, if it is not known)",
            ),
            (
                |m| m.contacts.rattlers = 501,
                "PackingReport.contacts.rattlers = 501.0 is refused: it must be at most the number of grains",
            ),
            (
                |m| m.fabric.principal_axis.direction.x = 1.0,
                "PackingReport.fabric.|principal_axis.direction| = 1.4142135623730951 is refused",
            ),
            (
                |m| m.contacts.sliding_fraction = 1.5,
                "PackingReport.contacts.sliding_fraction = 1.5 is refused: it must be between 0 and 1",
            ),
        ],
        |m| PackingReport::try_from(m),
    );
    refuses_values!(&packing_report_message(header(), &whole).unwrap(), |m| PackingReport::try_from(m), "PackingReport", m:
        m.grain_density => 0.0,
        m.solid_fraction => 0.0,
        m.size_spread => -0.1,
        m.stress_asymmetry => -1.0,
        m.symmetry[0].cubic => -0.1,
        m.stiffness[0].stddev[3] => -1.0,
        m.stiffness[0].bulk_reuss_bound[0] => -1.0,
        m.contacts.mechanical_coordination => -1.0,
    );
    let mut broken = report();
    broken.fabric.contact_anisotropy = f64::NAN;
    assert!(packing_report_message(header(), &broken).is_err(), "nor is it written");
}

#[test]
fn a_run_state_is_read_and_its_faults_are_refused_by_name() {
    let good =
        msg::RunState { state: msg::RunState::FINISHED, progress: 1.0, step: 9, ..msg::RunState::default() };
    assert_eq!((good.checked().unwrap(), good.last_packing()), (&good, None));
    let with_packing = msg::RunState { packings: 2, last_packing_step: 8, ..good.clone() };
    assert_eq!(with_packing.last_packing(), Some(8));
    refuses(
        &good,
        &[
            (|m| m.state = 9, "RunState.state = 9 is refused: it must be one of 0 (running)"),
            (|m| m.progress = 1.5, "RunState.progress = 1.5 is refused: it must be between 0 and 1"),
        ],
        |m| m.checked().cloned(),
    );
}
