//! Pictures of packings: what is in them, and that they are the same every time.

use grainlab_core::{Cell, Contact, Packing, Vec3};
use grainlab_viewer::{Film, Ground, Parts, Picture, Quantity, Size, View, page};

/// Four grains on a line along x, each touching the next, the last one the image of the first; and one alone.
fn chain() -> Packing {
    let radius = 1e-3;
    let positions: Vec<Vec3> = (0..4)
        .map(|n| Vec3::new(2e-3 * f64::from(n) + 1e-3, 4e-3, 4e-3))
        .chain([Vec3::new(4e-3, 4e-3, 7e-3)])
        .collect();
    let contact = |i: u32, j: u32, image: [i8; 3], toward: f64, force: f64| {
        Contact::pressed([i, j], image, Vec3::x() * toward, 1e-9, force)
    };
    Packing {
        step: 1,
        ids: (1..=5).collect(),
        contacts: vec![
            contact(0, 1, [0; 3], 1.0, 1.0),
            contact(0, 3, [-1, 0, 0], -1.0, 2.0),
            contact(1, 2, [0; 3], 1.0, 3.0),
            contact(2, 3, [0; 3], 1.0, 4.0),
        ],
        friction: 0.3,
        ..Packing::at_rest(Cell::cube(8e-3).unwrap(), vec![radius; 5], positions)
    }
}

const SIZE: Size = Size { width: 320, height: 240 };

/// Every colour of a picture with its number of pixels.
fn colours(picture: &Picture) -> std::collections::BTreeMap<[u8; 4], usize> {
    let mut found = std::collections::BTreeMap::new();
    let pixels = (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y)));
    pixels.for_each(|(x, y)| *found.entry(picture.pixel(x, y).unwrap()).or_default() += 1);
    found
}

#[test]
fn the_same_packing_gives_the_same_bytes() {
    let view = View::new(&chain(), "a chain");
    let png = || Picture::new(&view, Quantity::Force, SIZE, Ground::Light).png().unwrap();
    assert_eq!(png(), png());
    assert!(png().starts_with(b"\x89PNG\r\n\x1a\n"));
}

#[test]
fn grains_cover_some_of_the_picture_and_leave_the_corners_free() {
    let picture = Picture::new(&View::new(&chain(), ""), Quantity::Coordination, SIZE, Ground::Clear);
    for (x, y) in [(0, 0), (SIZE.width - 1, 0), (0, SIZE.height - 1), (SIZE.width - 1, SIZE.height - 1)] {
        assert_eq!(picture.pixel(x, y).unwrap()[3], 0, "({x}, {y}) is transparent");
    }
    let opaque: usize = colours(&picture).iter().filter(|(c, _)| c[3] == 255).map(|(_, n)| n).sum();
    let share = opaque as f64 / (SIZE.width * SIZE.height) as f64;
    assert!((0.03..0.6).contains(&share), "{share}");
    assert_eq!(picture.pixel(SIZE.width, 0), None);
}

#[test]
fn a_rattler_is_grey_and_a_grain_that_carries_force_is_not() {
    let greys = |packing: &Packing| {
        let picture = Picture::new(&View::new(packing, ""), Quantity::Rattlers, SIZE, Ground::Clear);
        // The letters are darker.
        let grey =
            |c: &[u8; 4]| c[3] == 255 && c[0] > 150 && c[0].abs_diff(c[1]) < 12 && c[2].abs_diff(c[1]) < 16;
        colours(&picture).iter().filter(|(c, _)| grey(c)).map(|(_, n)| *n).sum::<usize>()
    };
    let mut loose = chain();
    loose.contacts.clear();
    let (one, all) = (greys(&chain()), greys(&loose));
    assert!(all > 3 * one && one > 100, "one rattler has {one} grey pixels, five have {all}");
}

#[test]
fn the_colour_follows_what_is_asked_for() {
    let view = View::new(&chain(), "");
    let of = |quantity| Picture::new(&view, quantity, SIZE, Ground::Clear).png().unwrap();
    let all = Quantity::ALL.map(of);
    assert!(all[0] != all[1] && all[1] != all[2] && all[0] != all[2]);
}

#[test]
fn the_face_of_a_cut_has_exactly_the_colour_of_the_legend_and_a_cut_through_nothing_leaves_none() {
    let view = View::new(&chain(), "");
    let of = |slice: &str| {
        let parts = Parts { slice: Some(slice.parse().unwrap()), ..Parts::default() };
        Picture::of(&view, Quantity::Rattlers, SIZE, Ground::Clear, &parts)
    };
    let carrier = |picture: &Picture| colours(picture).get(&[46, 104, 150, 255]).copied().unwrap_or(0);
    let [whole, cut] =
        [Picture::new(&view, Quantity::Rattlers, SIZE, Ground::Clear), of("z")].map(|p| carrier(&p));
    assert!(cut > whole + 500, "{cut} pixels, {whole} without the cut");
    // The grains lie at the middle of z, and the viewer looks from above.
    let grains = |p: &Picture| {
        colours(p)
            .iter()
            .filter(|(c, _)| c[3] == 255 && c[2].saturating_sub(c[0]) > 30)
            .map(|(_, n)| n)
            .sum::<usize>()
    };
    assert!(grains(&of("z=0.3")) < grains(&of("z=0.5")) / 4);
}

#[test]
fn a_force_chain_has_the_colours_of_the_forces_between_small_grains() {
    let view = View::new(&chain(), "");
    let parts = Parts { chains: true, ..Parts::default() };
    let of = |parts: &Parts| Picture::of(&view, Quantity::Rattlers, SIZE, Ground::Clear, parts);
    let blue = |c: &[u8; 4]| c[3] == 255 && c[2].saturating_sub(c[0]) > 60;
    let share = |parts: &Parts, is: &dyn Fn(&[u8; 4]) -> bool| -> usize {
        colours(&of(parts)).iter().filter(|(c, _)| is(c)).map(|(_, n)| n).sum()
    };
    assert!(2 * share(&parts, &blue) < share(&Parts::default(), &blue), "the grains are small");
    let warm = |c: &[u8; 4]| c[3] == 255 && c[0].saturating_sub(c[2]) > 40;
    let [with, without] = [share(&parts, &warm), share(&Parts::default(), &warm)];
    assert!(with > 50 + without, "{with} {without}");
}

#[test]
fn a_picture_without_room_for_its_texts_has_none() {
    let of = |label: &str, size: &str| {
        let (view, size) = (View::new(&chain(), label), size.parse().unwrap());
        Picture::new(&view, Quantity::Coordination, size, Ground::Light).png().unwrap()
    };
    assert!(of("one", "640x480") != of("two", "640x480"));
    ["200x150", "16x16", "1600x100"].iter().for_each(|small| assert!(of("one", small) == of("two", small)));
}

#[test]
fn a_size_is_two_numbers_of_pixels() {
    assert_eq!("640x480".parse::<Size>().unwrap(), Size { width: 640, height: 480 });
    for wrong in ["640", "640x", "x480", "0x480", "640x99999", "6.4x480", "-640x480"] {
        let error = wrong.parse::<Size>().unwrap_err().to_string();
        assert!(error.contains("WIDTHxHEIGHT"), "{wrong}: {error}");
    }
}

#[test]
fn a_page_loads_nothing_and_has_every_state() {
    let views = [View::new(&chain(), "first <state>"), View::new(&chain(), "second")];
    let text = page("A chain", "five grains", "chain", &views.iter().collect::<Vec<_>>()).unwrap();
    assert!(
        text.contains("viewer-state-0")
            && text.contains("viewer-state-1")
            && !text.contains("viewer-state-2")
    );
    assert!(
        text.contains("first <state>") && text.contains("{\"label\":\"first <state>\""),
        "labels are JSON, not markup"
    );
    for loads in ["src=\"http", "href=\"http", "@import", "fetch(", "XMLHttpRequest", "import("] {
        let ours = text.replace(grainlab_viewer::SCRIPTS[0], "");
        assert!(!ours.contains(loads), "{loads}");
    }
    assert!(!grainlab_viewer::SCRIPTS[0].contains("https://"), "the library has no address but namespaces");
    // Each script and style ends where it was meant to.
    assert_eq!(text.matches("<script").count(), text.matches("</script>").count());
}

#[test]
fn a_film_that_is_too_long_keeps_its_first_and_last_states_in_order() {
    let name = |n: usize| format!("state {n}");
    for count in [1, 2, 3, 10, 63, 64, 65, 100] {
        let mut film = Film::within(4000);
        (0..count).for_each(|n| film.push(View::new(&chain(), name(n))));
        let labels: Vec<&str> = film.states().iter().map(|v| v.label.as_str()).collect();
        assert_eq!(
            (film.count(), labels[0], labels[labels.len() - 1]),
            (count, "state 0", name(count - 1).as_str())
        );
        let numbers: Vec<usize> = labels.iter().map(|l| l[6..].parse().unwrap()).collect();
        assert!(numbers.is_sorted_by(|a, b| a < b), "{numbers:?}");
        assert!(labels.len() <= 32, "{count}: {}", labels.len());
    }
}
