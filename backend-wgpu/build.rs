//! Lists the shader files, so that a new one needs no entry anywhere.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

const ROOT: &str = "src/shaders/wgsl";

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|e| e == "wgsl") {
            files.push(path);
        }
    }
    Ok(())
}

fn main() -> io::Result<()> {
    let mut files = Vec::new();
    collect(Path::new(ROOT), &mut files)?;
    files.sort();
    let mut out = String::from(
        "/// Every shader file: its path without ending, its text.\npub(crate) const FILES: &[(&str, &str)] = &[\n",
    );
    for file in &files {
        let name = file.strip_prefix(ROOT).unwrap_or(file).with_extension("");
        let name: Vec<_> = name.iter().map(|part| part.to_string_lossy()).collect();
        let whole = Path::new(&env::var("CARGO_MANIFEST_DIR").unwrap_or_default()).join(file);
        out += &format!("    ({:?}, include_str!({:?})),\n", name.join("/"), whole);
    }
    out += "];\n";
    fs::write(Path::new(&env::var("OUT_DIR").unwrap_or_default()).join("files.rs"), out)
}
