//! Pictures show the packing: sizes, places, contacts and colours.

use grainlab_core::{Cell, Contact, Mat3, Packing, Vec3};
use grainlab_msgs::geometry_msgs::Point;
use grainlab_msgs::sensor_msgs::{PointCloud2, PointField};
use grainlab_msgs::visualization_msgs::{Marker, MarkerArray};
use grainlab_pictures::{Drawn, RATTLER, markers, points};

fn contact(i: u32, j: u32, image: [i8; 3], normal: Vec3, force: f64) -> Contact {
    Contact::pressed([i, j], image, normal, 1e-9, force)
}

/// Three grains along x, the last one held two cells away, in contact across a face of the cell; a fourth without contacts.
fn packing() -> Packing {
    Packing {
        step: 40,
        time: 2.5,
        ids: vec![10, 11, 7, 3],
        contacts: vec![
            contact(0, 1, [0; 3], Vec3::x(), 1.0),
            contact(0, 2, [1, 0, 0], -Vec3::x(), 2.0),
            contact(1, 2, [2, 0, 0], Vec3::x(), 6.0),
        ],
        friction: 0.3,
        ..Packing::at_rest(
            Cell::new(Mat3::new(8.0, 0.0, 0.0, 0.0, 4.0, 1.0, 0.0, 0.0, 4.0)).unwrap(),
            vec![2.0, 1.0, 1.0, 0.5],
            vec![
                Vec3::new(2.0, 1.0, 1.0),
                Vec3::new(5.0, 1.0, 1.0),
                Vec3::new(-9.0, 1.0, 1.0),
                Vec3::new(5.0, 3.0, 3.0),
            ],
        )
    }
}

/// The values of a field, read as its message describes it.
fn field(cloud: &PointCloud2, name: &str) -> Vec<f64> {
    let field = cloud.fields.iter().find(|f| f.name == name).unwrap();
    let value = |point: &[u8]| {
        let bytes = &point[field.offset as usize..];
        let four = || bytes[..4].try_into().unwrap();
        match field.datatype {
            PointField::FLOAT32 => f64::from(f32::from_le_bytes(four())),
            PointField::UINT32 => f64::from(u32::from_le_bytes(four())),
            PointField::UINT8 => f64::from(bytes[0]),
            other => panic!("{other}"),
        }
    };
    cloud.data.chunks_exact(cloud.point_step as usize).map(value).collect()
}

#[test]
fn a_point_has_place_in_the_cell_size_and_state_of_its_grain() {
    let packing = packing();
    let cloud = points(&Drawn::new(&packing));
    assert_eq!((cloud.width, cloud.height, cloud.row_step as usize), (4, 1, cloud.data.len()));
    assert_eq!((cloud.header.frame_id.as_str(), cloud.header.stamp.sec), ("cell", 1_000_000_002));
    assert_eq!(field(&cloud, "x"), [2.0, 5.0, 7.0, 5.0]);
    assert_eq!(field(&cloud, "y"), [1.0, 1.0, 1.0, 3.0]);
    assert_eq!(field(&cloud, "z"), [1.0, 1.0, 1.0, 3.0]);
    assert_eq!(field(&cloud, "radius"), [2.0, 1.0, 1.0, 0.5]);
    assert_eq!(field(&cloud, "id"), [10.0, 11.0, 7.0, 3.0]);
    assert_eq!(field(&cloud, "coordination"), [2.0, 2.0, 2.0, 0.0]);
    assert_eq!(field(&cloud, "normal_force"), [1.5, 3.5, 4.0, 0.0]);
    assert_eq!(field(&cloud, "rattler"), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(field(&cloud, "radii"), field(&cloud, "radius"));
    let [r, g, b] = RATTLER;
    assert_eq!(field(&cloud, "colors")[3], f64::from(u32::from_be_bytes([r, g, b, 255])));
    let ends: Vec<u32> =
        cloud.fields.iter().map(|f| f.offset + if f.name == "rattler" { 1 } else { 4 }).collect();
    assert!(ends.is_sorted() && *ends.last().unwrap() <= cloud.point_step, "{ends:?}");
}

fn of<'a>(all: &'a MarkerArray, ns: &str) -> Vec<&'a Marker> {
    all.markers.iter().filter(|m| m.action == Marker::ADD && m.ns == ns).collect()
}

fn place(p: &Point) -> [f64; 3] {
    [p.x, p.y, p.z]
}

/// Centre, diameter and colour of each sphere.
fn spheres(all: &MarkerArray) -> Vec<([f64; 3], f64, [f32; 3])> {
    let mut found = Vec::new();
    for m in of(all, "grains") {
        let centres = match m.r#type {
            Marker::SPHERE => vec![m.pose.position],
            Marker::SPHERE_LIST => m.points.clone(),
            other => panic!("{other}"),
        };
        assert!(m.scale.x == m.scale.y && m.scale.x == m.scale.z && m.pose.orientation.w == 1.0);
        assert!(m.color.a == 1.0 && m.colors.is_empty());
        let colour = [m.color.r, m.color.g, m.color.b];
        found.extend(centres.iter().map(|c| (place(c), m.scale.x, colour)));
    }
    found.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap());
    found
}

#[test]
fn every_grain_is_a_sphere_of_its_own_size_however_sizes_repeat() {
    let packing = packing();
    let all = markers(&Drawn::new(&packing));
    let found = spheres(&all);
    let sizes: Vec<_> = found.iter().map(|(centre, diameter, _)| (*centre, *diameter)).collect();
    assert_eq!(
        sizes,
        [([2.0, 1.0, 1.0], 4.0), ([5.0, 1.0, 1.0], 2.0), ([5.0, 3.0, 3.0], 1.0), ([7.0, 1.0, 1.0], 2.0)]
    );
    assert_eq!(found[2].2, RATTLER.map(|c| f32::from(c) / 255.0), "a rattler is grey");
    assert_ne!(found[0].2, found[2].2);
    // The two equal ones are one list.
    let lists = of(&all, "grains").into_iter().filter(|m| m.r#type == Marker::SPHERE_LIST);
    assert_eq!(lists.map(|m| m.points.len()).collect::<Vec<_>>(), [2]);
}

#[test]
fn a_contact_through_a_face_is_drawn_at_both_grains_and_larger_forces_are_wider() {
    let packing = packing();
    let all = markers(&Drawn::new(&packing));
    let chains = of(&all, "contacts");
    let lines: Vec<_> = chains.iter().map(|m| m.points.iter().map(place).collect::<Vec<_>>()).collect();
    let from = |x: f64| [x, 1.0, 1.0];
    assert_eq!(
        lines,
        [
            vec![from(2.0), from(5.0)],
            // The grains touch in the face x = 0, which is the face x = 8, too.
            vec![from(2.0), from(0.0), from(7.0), from(8.0)],
            vec![from(5.0), from(7.0)]
        ]
    );
    assert!(chains.iter().all(|m| m.r#type == Marker::LINE_LIST && m.scale.x > 0.0));
    assert!(chains.is_sorted_by(|a, b| a.scale.x < b.scale.x && a.color != b.color), "1 N, 2 N, 6 N");
}

#[test]
fn the_cell_has_its_twelve_edges_and_a_state_deletes_the_one_before() {
    let packing = packing();
    let all = markers(&Drawn::new(&packing));
    assert_eq!(all.markers[0].action, Marker::DELETEALL);
    let [cell] = of(&all, "cell")[..] else { panic!() };
    let mut edges: Vec<[f64; 3]> =
        cell.points.chunks_exact(2).map(|p| [p[1].x - p[0].x, p[1].y - p[0].y, p[1].z - p[0].z]).collect();
    edges.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let expected = [[[0.0, 1.0, 4.0]; 4], [[0.0, 4.0, 0.0]; 4], [[8.0, 0.0, 0.0]; 4]].concat();
    assert_eq!(edges, expected, "the cell is sheared");
    let mut names: Vec<_> = all.markers[1..].iter().map(|m| (m.ns.clone(), m.id)).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), all.markers.len() - 1, "no marker replaces another of its state");
    assert!(all.markers.iter().all(|m| m.header == all.markers[0].header && m.header.frame_id == "cell"));
}

#[test]
fn no_grains_and_no_forces_are_a_picture_of_the_cell() {
    let empty = Packing {
        ids: vec![],
        radii: vec![],
        positions: vec![],
        velocities: vec![],
        spins: vec![],
        contacts: vec![],
        ..packing()
    };
    let drawn = Drawn::new(&empty);
    assert_eq!((points(&drawn).data.len(), markers(&drawn).markers.len()), (0, 2));
    let mut unloaded = packing();
    unloaded.contacts.iter_mut().for_each(|c| c.normal_force = 0.0);
    let all = markers(&Drawn::new(&unloaded));
    assert_eq!(of(&all, "contacts").len(), 1);
    assert!(of(&all, "contacts")[0].scale.x.is_finite());
}
