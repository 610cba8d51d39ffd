//! A scene to start from.

const TEXT: &str = include_str!("template.toml");

/// A short scene of this name, with comments: an isotropic packing at 50 kPa.
pub fn template(name: &str) -> String {
    TEXT.replacen("NAME", name, 1)
}
