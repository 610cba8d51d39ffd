//! Lines of the launcher about its run.

use grainlab_msgs::topics::PACKING_REPORT;

/// Begin of the message of a simulator that waits for other processes.
const WAITS: &str = "waiting for";

/// Condition that a run that has not begun waits for, as far as its simulator has said it; `None` once it computes its first step.
/// `joined`: the simulator was discovered.
pub(crate) fn awaited(simulator: Option<&str>, joined: bool, first_step: Option<u64>) -> Option<&str> {
    match (simulator, first_step) {
        (Some(says), _) if says.starts_with(WAITS) => Some(says),
        (Some(_), None) => Some("the simulator has published no state"),
        (None, None) if joined => Some("the simulator starts, or places its grains"),
        (None, None) => Some("the simulator has not been discovered"),
        (_, Some(_)) => None,
    }
}

/// That data about the packing of a step were inverted, or why nothing was inferred from them. `of_start`: step 0 is that of the
/// packing that the run starts from.
pub(crate) fn inverted(source: &str, step: u64, of_start: bool, nothing: Option<&str>) -> String {
    let data = if source == PACKING_REPORT.name { "moduli".to_owned() } else { source.replace('_', " ") };
    let packing = match step {
        0 if of_start => "the packing that the run starts from".to_owned(),
        // Data of an external instrument do not belong to a packing of the run.
        0 => {
            return match nothing {
                None => format!("the {data} of an instrument inverted"),
                Some(why) => format!("nothing inferred from the {data} of an instrument: {why}"),
            };
        }
        _ => format!("packing of step {step}"),
    };
    match nothing {
        None => format!("{packing} measured and inverted, by its {data}"),
        Some(why) => format!("{packing}: nothing inferred from its {data}: {why}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simulator_that_was_not_discovered_is_not_said_to_place_grains() {
        assert_eq!(awaited(None, false, None), Some("the simulator has not been discovered"));
        assert_eq!(awaited(None, true, None), Some("the simulator starts, or places its grains"));
        let waits = "waiting for 2 readers of packing; there are 1";
        assert_eq!(awaited(Some(waits), true, None), Some(waits));
        assert_eq!(awaited(None, true, Some(1)), None);
    }

    #[test]
    fn only_what_has_an_estimate_is_said_to_be_inverted() {
        let of = |step, of_start, nothing| inverted("wave_speeds", step, of_start, nothing);
        assert_eq!(of(7, false, None), "packing of step 7 measured and inverted, by its wave speeds");
        assert_eq!(of(0, false, None), "the wave speeds of an instrument inverted");
        for (step, of_start) in [(7, false), (0, true), (0, false)] {
            let said = of(step, of_start, Some("NaN is refused"));
            assert!(said.ends_with("NaN is refused") && !said.contains("inverted"), "{said}");
        }
    }
}
