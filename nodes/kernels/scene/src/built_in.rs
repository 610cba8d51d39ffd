//! The scenes that come with the crate.

/// Names and texts of the built-in scenes.
pub const BUILT_IN: [(&str, &str); 8] = [
    ("demo", include_str!("../../../scenes/demo.toml")),
    ("s1", include_str!("../../../scenes/s1.toml")),
    ("s2", include_str!("../../../scenes/s2.toml")),
    ("s3", include_str!("../../../scenes/s3.toml")),
    ("s4", include_str!("../../../scenes/s4.toml")),
    ("uniaxial", include_str!("../../../scenes/uniaxial.toml")),
    ("literal", include_str!("../../../scenes/literal.toml")),
    ("rolling", include_str!("../../../scenes/rolling.toml")),
];

/// The text of a built-in scene.
pub fn built_in(name: &str) -> Option<&'static str> {
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
