//! The campaign that prepares the packings.

use crate::paper::{PAPER, PRESSURE};

/// Size of a reproduction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Grains of each packing.
    pub grains: u32,
    /// Number of seeds, from `first_seed` on.
    pub seeds: u32,
    /// The first seed.
    pub first_seed: u64,
}

/// The file of the campaign: the four samples with each seed.
pub fn campaign_text(size: Size) -> String {
    let scenes: Vec<String> = PAPER.iter().map(|s| format!("{:?}", s.name.to_lowercase())).collect();
    format!(
        "name = \"paper\"\ndescription = \"The sixteen states of the paper\"\nscenes = [{}]\n\
         seeds = {{ first = {}, count = {} }}\nset = {{ grains.count = {} }}\n",
        scenes.join(", "),
        size.first_seed,
        size.seeds,
        size.grains
    )
}

/// Index of the sample of a scene.
pub fn sample_of_scene(scene: &str) -> Option<usize> {
    PAPER.iter().position(|s| s.name.eq_ignore_ascii_case(scene))
}

/// Index of the pressure at the end of a phase such as `settle-50kPa`.
pub fn pressure_of_phase(phase: &str) -> Option<usize> {
    let kpa: f64 = phase.strip_prefix("settle-")?.strip_suffix("kPa")?.parse().ok()?;
    PRESSURE.iter().position(|p| *p == 1e3 * kpa)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_known_by_scene_and_phase() {
        assert_eq!((sample_of_scene("s3"), sample_of_scene("demo")), (Some(2), None));
        assert_eq!(pressure_of_phase("settle-250kPa"), Some(2));
        assert_eq!((pressure_of_phase("load-250kPa"), pressure_of_phase("settle-60kPa")), (None, None));
    }
}
