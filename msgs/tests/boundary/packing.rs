use super::not_finite::refuses_non_finite;
use super::refuses;
use grainlab_core::contact::{ContactLaw, RollingResistance};
use grainlab_core::{
    Cell, Contact, EngineProgram, Mat3, Material, Packing, PathPosition, StrainOrigin, Vec3, contact_search,
};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::{from_cdr, msg, to_cdr};
use proptest::array::{uniform3, uniform9};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;
const NAN: f64 = f64::NAN;

/// Finite numbers of every size and sign, zeros of both signs among them.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>().prop_filter("finite", |x| x.is_finite()), Just(0.0), Just(-0.0)]
}

fn vector() -> impl Strategy<Value = Vec3> {
    uniform3(number()).prop_map(Vec3::from)
}

fn positive() -> impl Strategy<Value = f64> {
    1e-9..1e9f64
}

/// A shear and stretch whose determinant is positive.
fn matrix() -> impl Strategy<Value = Mat3> {
    uniform9(-0.2..0.2f64)
        .prop_map(|m| Mat3::identity() + Mat3::from_row_slice(&m))
        .prop_filter("regular", |m| m.determinant() > 0.05)
}

/// Every contact of these spheres, with a fraction of Hertz's force; none where two centres coincide.
fn contacts(
    cell: &Cell,
    material: &Material,
    (radii, positions): &(Vec<f64>, Vec<Vec3>),
    share: f64,
    [tangential_force, rolling_force]: [Vec3; 2],
) -> Vec<Contact> {
    let force = |r_eff, overlap| share * material.normal_force(r_eff, overlap);
    let found = contact_search::find(cell, positions, radii, force).unwrap_or_default();
    let loaded = |c: Contact| Contact { tangential_force, rolling_force, ..c };
    found.into_iter().filter(|c| c.overlap > 1e-9).map(loaded).collect()
}

fn rolling() -> ContactLaw {
    ContactLaw::default().with_rolling(RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 })
}

prop_compose! {
    fn path()(
        (phase, within_phase, is_known) in (0..9usize, any::<bool>(), any::<bool>()),
        strain_origin in prop_oneof![Just(StrainOrigin::Reference), Just(StrainOrigin::FirstStep), Just(StrainOrigin::Unknown)],
        engine in option::of(("[a-z]{1,9}", "[0-9.]{0,9}", any::<u32>())),
    ) -> Option<PathPosition> {
        let engine = engine.map(|(name, version, ranks)| EngineProgram { name, version, ranks });
        is_known.then(|| PathPosition::new(phase, within_phase, strain_origin, engine))
    }
}

prop_compose! {
    fn packing()(
        grains in vec((0.05..0.3f64, uniform3(-1.0..1.0f64).prop_map(Vec3::from), vector(), vector()), 1..6),
        (step, time, time_step) in (any::<u64>(), number(), positive()),
        (cell, deformation) in (matrix(), matrix()),
        (shear_modulus, poisson_ratio, density) in (positive(), 0.0..=0.5f64, positive()),
        friction in prop_oneof![Just(INF), Just(0.0), positive()],
        (first, share, forces) in (any::<u32>(), -1.0..50.0f64, [vector(), vector()]),
        (resists_rolling, path) in (any::<bool>(), path()),
    ) -> Packing {
        // A cell that is large enough for the five largest spheres.
        let cell = Cell::new(matrix_of(&cell)).unwrap();
        let material = Material { shear_modulus, poisson_ratio, density };
        let spheres: (Vec<f64>, Vec<Vec3>) = grains.iter().map(|g| (g.0, g.1)).unzip();
        Packing {
            step, time, time_step, deformation, friction, cell, material, path,
            law: if resists_rolling { rolling() } else { ContactLaw::default() },
            ids: (0..grains.len() as u32).map(|k| first.wrapping_add(k)).collect(),
            radii: grains.iter().map(|g| g.0).collect(),
            positions: grains.iter().map(|g| g.1).collect(),
            velocities: grains.iter().map(|g| g.2).collect(),
            spins: grains.iter().map(|g| g.3).collect(),
            contacts: contacts(
                &cell, &material, &spheres, share,
                [forces[0], if resists_rolling { forces[1] } else { Vec3::zeros() }],
            ),
        }
    }
}

/// Cell of this shape with the volume of a cube of 0.9.
fn matrix_of(cell: &Mat3) -> Mat3 {
    cell * (0.9 / cell.determinant().cbrt())
}

#[test]
fn a_packing_without_a_reference_state_has_no_deformation() {
    let message = msg::Packing { deformation: [NAN; 9], ..pair() };
    let packing = Packing::try_from(&message).unwrap();
    assert!(packing.deformation.iter().all(|v| v.is_nan()));
    assert_eq!(to_cdr(&packing_message(&packing, "pair", vec![1, 2])), to_cdr(&message));
}

/// Recordings of versions 0.2.0 and before.
#[test]
fn the_path_of_a_recording_without_one_is_in_its_run_state() {
    let path = |run_state: &[u8]| {
        let message = msg::Packing { run_state: run_state.to_vec(), ..pair() };
        Packing::try_from(&message).unwrap().path
    };
    let version_4 = br#"{"version":4,"phase":2,"time":0.1,"strain_origin":"first_step","within_phase":true,
        "engine":{"program":{"name":"lammps","version":"2025","ranks":2},"state":"AA=="}}"#;
    let program = EngineProgram { name: "lammps".into(), version: "2025".into(), ranks: 2 };
    assert_eq!(path(version_4), Some(PathPosition::new(2, true, StrainOrigin::FirstStep, Some(program))));
    let mut words = [0u64; 26];
    (words[0], words[3], words[8]) = (3, 2, 1);
    let version_3: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    assert_eq!(path(&version_3), Some(PathPosition::new(2, false, StrainOrigin::Reference, None)));
    assert_eq!((path(&version_3[..200]), path(b"")), (None, None));
}

#[test]
fn a_path_with_an_unknown_origin_of_strain_is_refused_by_its_field() {
    let with = |strain_origin| {
        let path = msg::PathPosition { strain_origin, ..msg::PathPosition::default() };
        Packing::try_from(&msg::Packing { path: vec![path], ..pair() })
    };
    assert!(with(msg::PathPosition::UNKNOWN).is_ok());
    let refused = with(3).unwrap_err().to_string();
    assert!(refused.contains("Packing.path[0].strain_origin = 3"), "{refused}");
}

proptest! {
    #[test]
    fn a_packing_crosses_the_wire_and_back_bit_for_bit(packing in packing(), state in vec(any::<u8>(), 0..20)) {
        let packing = packing.validated().unwrap();
        let message = packing_message(&packing, "demo", state);
        let bytes = to_cdr(&message);
        let received: msg::Packing = from_cdr(&bytes).unwrap();
        let back = Packing::try_from(&received).unwrap();
        prop_assert_eq!(&back, &packing);
        // Equality does not distinguish -0 from 0; bytes do.
        prop_assert_eq!(to_cdr(&packing_message(&back, &received.scene, received.run_state.clone())), bytes);
    }

    #[test]
    fn arbitrary_numbers_are_refused_or_are_a_packing(
        radius in vec(any::<f64>(), 0..4),
        position in vec(any::<f64>(), 0..13),
        contact_pair in vec(0..4u32, 0..5),
        contact_overlap in vec(any::<f64>(), 0..3),
    ) {
        let message = msg::Packing { radius, position, contact_pair, contact_overlap, ..pair() };
        if let Ok(packing) = Packing::try_from(&message) {
            prop_assert!(packing.validated().is_ok());
        }
    }
}

#[path = "../../../nodes/kernels/core/src/packing/pair.rs"]
mod grains;

fn pair() -> msg::Packing {
    let packing = Packing { step: 7, time: 0.125, ids: vec![4, 9], time_step: 1e-8, ..grains::pair() };
    packing_message(&packing, "pair", vec![1, 2])
}

#[test]
fn the_header_is_simulated_time_after_the_epoch_in_the_frame_of_the_cell() {
    let message = pair();
    assert_eq!((message.header.stamp.sec, message.header.stamp.nanosec), (1_000_000_000, 125_000_000));
    assert_eq!(message.header.frame_id, "cell");
}

#[test]
fn each_fault_of_a_packing_is_refused_by_name() {
    refuses_non_finite(&pair(), &["friction"], |m| Packing::try_from(m));
    refuses(
        &pair(),
        &[
            (
                |m| m.header.stamp.nanosec = 1_000_000_000,
                "Packing.header.stamp.nanosec = 1000000000.0 is refused",
            ),
            (|m| m.cell[8] = -1.0, "Packing.cell (volume) = -1.0 is refused"),
            (|m| m.cell = [0.0; 9], "Packing.cell (volume) = 0.0 is refused"),
            (|m| m.deformation[1..].fill(NAN), "Packing is refused: deformation[0] is not finite (NaN)"),
            (|m| m.deformation[0] = -1.0, "Packing is refused: deformation[0] = -1e0 is out of range"),
            (|m| m.time_step = -1e-8, "Packing is refused: time_step[0] = -1e-8 is out of range"),
            (|m| m.friction = -0.1, "Packing is refused: friction[0] = -1e-1 is out of range"),
            (|m| m.poisson_ratio = 0.6, "Packing is refused: poisson_ratio[0] = 6e-1 is out of range"),
            (|m| m.shear_modulus = 0.0, "Packing is refused: shear_modulus[0] = 0e0 is out of range"),
            (|m| m.radius[1] = -0.1, "Packing is refused: radius[1] = -1e-1 is out of range"),
            (
                |m| m.contact_pair[1] = 2,
                "Packing is refused: contact 0 names grain 2, but there are 2 grains",
            ),
            (|m| m.contact_pair[0] = u32::MAX, "Packing is refused: contact 0 names grain 4294967295"),
            (|m| m.contact_pair.swap(0, 1), "Packing is refused: contact 0 is out of order"),
            (|m| m.contact_overlap[0] = 0.0, "Packing is refused: contact_overlap[0] = 0e0 is out of range"),
            (|m| m.contact_normal[2] = -0.9, "Packing is refused: contact_normal[0] = 9e-1 is out of range"),
            (|m| m.id[1] = 4, "Packing is refused: grains 0 and 1 have the same id 4"),
            (|m| m.radius = vec![0.7, 0.7], "Packing is refused: solid_fraction[0] = 2.8"),
            (
                |m| m.contact_overlap[0] = 1e-4,
                "Packing is refused: overlap (m) of the contact of grains 4 and 9 is 1e-4, but positions and radii give",
            ),
            (
                |m| m.contact_normal.copy_from_slice(&[0.0, 1.0, 0.0]),
                "Packing is refused: angle of the normal (rad) of the contact of grains",
            ),
            (
                |m| m.contact_normal_force[0] = 1e12,
                "Packing is refused: the normal force of the contact of grains 4 and 9, 1.0000e12 N, is",
            ),
        ],
        |m| Packing::try_from(m),
    );
}

#[test]
fn each_array_of_the_wrong_length_is_refused_by_name() {
    fn drop_last<T>(v: &mut Vec<T>) {
        v.pop();
    }
    refuses(
        &pair(),
        &[
            (|m| drop_last(&mut m.id), "Packing is refused: id has 1 entries, but there are 2 grains"),
            (|m| drop_last(&mut m.position), "Packing.position has 5 entries and is refused: it must have 6"),
            (|m| drop_last(&mut m.velocity), "Packing.velocity has 5 entries and is refused: it must have 6"),
            (|m| drop_last(&mut m.angular_velocity), "Packing.angular_velocity has 5 entries and is refused"),
            (
                |m| drop_last(&mut m.contact_pair),
                "Packing.contact_pair has 1 entries and is refused: it must have 2",
            ),
            (
                |m| drop_last(&mut m.contact_image),
                "Packing.contact_image has 2 entries and is refused: it must have 3",
            ),
            (|m| drop_last(&mut m.contact_normal), "Packing.contact_normal has 2 entries and is refused"),
            (
                |m| drop_last(&mut m.contact_normal_force),
                "Packing.contact_normal_force has 0 entries and is refused",
            ),
            (
                |m| drop_last(&mut m.contact_tangential_force),
                "Packing.contact_tangential_force has 2 entries and is",
            ),
            (
                |m| drop_last(&mut m.contact_overlap),
                "Packing.contact_pair has 2 entries and is refused: it must have 0",
            ),
            (
                |m| m.contact_rolling_force.push(0.0),
                "Packing.contact_rolling_force has 1 entries and is refused: it must have 0",
            ),
            (
                |m| m.contact_law_parameters = vec![1e4, 0.0, 0.1],
                "Packing.contact_rolling_force has 0 entries and is refused: it must have 3",
            ),
            (|m| m.radius.push(0.1), "Packing.position has 6 entries and is refused: it must have 9"),
        ],
        |m| Packing::try_from(m),
    );
}
