//! Files that benchmarks leave: whole or not at all.

use std::path::Path;

use crate::{Failure, root};

/// Writes `text` to `path`, over what was there only once all of it is on disk.
///
/// # Errors
/// What stopped it, with the path.
pub fn write_whole(path: &Path, text: &str) -> Result<(), Failure> {
    let write = || {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let mut part = path.as_os_str().to_owned();
        part.push(".part");
        std::fs::write(&part, text)?;
        std::fs::rename(&part, path)
    };
    write().map_err(|e| format!("{}: {e}", path.display()).into())
}

/// Writes a figure to `path` or else to dist/benches/`name` in the workspace, and says where.
///
/// # Errors
/// As [`write_whole`].
pub fn save_figure(path: Option<&Path>, name: &str, svg: &str) -> Result<(), Failure> {
    let path = match path {
        Some(path) => path.to_owned(),
        None => root()?.join("dist/benches").join(name),
    };
    write_whole(&path, svg)?;
    println!("\nFigure: {}", path.display());
    Ok(())
}
