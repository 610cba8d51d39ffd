//! Writes the Rust types of every message file into `src/generated`:
//! `cargo run --release -p grainlab_msgs --example generate`.

mod generator;

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = root.join("src/generated");
    if out.exists() {
        std::fs::remove_dir_all(&out)?;
    }
    for (path, text) in generator::generate(root)? {
        let path = out.join(path);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        std::fs::write(path, text)?;
    }
    Ok(())
}
