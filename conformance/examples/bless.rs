//! Writes the goldens anew: `cargo run --release -p etendue-conformance --example bless`.
//!
//! Only the scalar reference produces goldens. Look at the differences before committing them.

use etendue_conformance::golden::{produce, scenes};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("goldens");
    for scene in scenes() {
        let path = folder.join(format!("{}.txt", scene.name));
        std::fs::write(&path, produce(&scene)?)?;
        println!("{}", path.display());
    }
    Ok(())
}
