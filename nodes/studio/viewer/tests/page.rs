//! The page of packings, and the states of a film.

use grainlab_core::{Cell, Packing, Vec3};
use grainlab_viewer::{Film, View, page};

/// Seven grains on the diagonal of their cell.
fn grains() -> Packing {
    let positions = (1..8).map(|n| Vec3::repeat(1e-3 * f64::from(n))).collect();
    Packing::at_rest(Cell::cube(8e-3).unwrap(), vec![0.5e-3; 7], positions)
}

#[test]
fn a_page_loads_nothing_and_has_every_state() {
    let views = [View::new(&grains(), "first <state>"), View::new(&grains(), "second")];
    let text = page("Grains", "seven grains", "grains", &views.iter().collect::<Vec<_>>());
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
        (0..count).for_each(|n| film.push(View::new(&grains(), name(n))));
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
