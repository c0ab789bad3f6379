//! The licences that a binary carries along: ours and those of what is linked into it.

use crate::archive::Archive;
use crate::cargo;
use crate::workspace::Workspace;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Folder of licences in both versions of the standard.
const FOLDER: &str = "documentation/licenses";

/// A library that a linker adds to binaries.
pub struct Runtime {
    /// Name, platforms and licence.
    pub title: &'static str,
    /// The text of its licence, if binaries must carry it.
    pub notice: Option<String>,
}

/// The licence files of one unit, by name.
pub struct Licences(BTreeMap<String, Vec<u8>>);

impl Licences {
    /// Collects the licences of `package` and of everything linked into it for these targets.
    pub fn collect(
        workspace: &Workspace,
        triples: &[&str],
        package: &str,
        runtime: &[Runtime],
    ) -> Result<Self, String> {
        let metadata = cargo::metadata(workspace, triples)?;
        let mut files = BTreeMap::new();
        for own in ["LICENSE-MIT", "LICENSE-APACHE"] {
            files.insert(format!("{own}.txt"), workspace.read_bytes(own)?);
        }
        // Most crates share a text word for word: each text stands once, under those that carry it.
        let mut notices: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        let mut list = String::new();
        for Runtime { title, notice } in runtime {
            list += &format!("  {title}\n");
            if let Some(text) = notice {
                let titles = notices.entry(text.clone()).or_default();
                titles.insert((*title).to_owned());
            }
        }
        for linked in linked(&metadata, package)? {
            // Crates of this workspace have no source; they share our licence.
            if linked["source"].is_null() {
                continue;
            }
            let text = |key: &str| linked[key].as_str().unwrap_or_default();
            let licence = linked["license"].as_str().unwrap_or("see its licence file");
            let title = format!("{} {} ({licence})", text("name"), text("version"));
            list += &format!("  {title}\n");
            let folder = Path::new(text("manifest_path")).parent();
            for text in folder.map(texts).unwrap_or_default() {
                notices.entry(text).or_default().insert(title.clone());
            }
        }
        let entry = format!(
            "This unit is licensed under MIT OR Apache-2.0, at your choice: see LICENSE-MIT.txt and\n\
             LICENSE-APACHE.txt.\n\n\
             Its binary contains the Rust standard library (MIT OR Apache-2.0) and these libraries, whose\n\
             notices are in third-party.txt:\n\n{list}"
        );
        let rule = "=".repeat(80);
        let notice = |(text, crates): (&String, &BTreeSet<String>)| {
            let crates: Vec<_> = crates.iter().map(String::as_str).collect();
            format!("{rule}\n{}\n{rule}\n\n{text}\n\n", crates.join("\n"))
        };
        let notices: String = notices.iter().map(notice).collect();
        files.insert("license.txt".to_owned(), entry.into_bytes());
        files.insert("third-party.txt".to_owned(), notices.into_bytes());
        Ok(Self(files))
    }

    /// Puts the files into an FMU.
    pub fn add_to(&self, archive: &mut Archive) {
        for (name, content) in self.files() {
            archive.add(format!("{FOLDER}/{name}"), content);
        }
    }

    /// Names and contents.
    pub fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        let files = self.0.iter();
        files.map(|(name, content)| (name.as_str(), content.as_slice()))
    }
}

/// The packages that are linked into `package`: its normal dependencies and theirs, procedural
/// macros excepted, by name.
fn linked<'a>(metadata: &'a Value, package: &str) -> Result<Vec<&'a Value>, String> {
    let by_id = |list: &'a Value| -> BTreeMap<&'a str, &'a Value> {
        let items = list.as_array().into_iter().flatten();
        items.filter_map(|v| Some((v["id"].as_str()?, v))).collect()
    };
    let packages = by_id(&metadata["packages"]);
    let nodes = by_id(&metadata["resolve"]["nodes"]);
    let start = packages.values().find(|p| p["name"] == package);
    let start = start.and_then(|p| p["id"].as_str());
    let mut open = vec![start.ok_or_else(|| format!("cargo metadata knows no package {package}"))?];
    let mut seen = BTreeSet::new();
    while let Some(id) = open.pop() {
        let is_macro = |p: &&&Value| {
            let targets = p["targets"].as_array().into_iter().flatten();
            targets
                .filter_map(|t| t["kind"].as_array())
                .any(|k| k.contains(&Value::from("proc-macro")))
        };
        if packages.get(id).filter(is_macro).is_some() || !seen.insert(id) {
            continue;
        }
        let dependencies = nodes.get(id).and_then(|n| n["deps"].as_array());
        for dependency in dependencies.into_iter().flatten() {
            let kinds = dependency["dep_kinds"].as_array();
            let normal = kinds.is_some_and(|k| k.iter().any(|k| k["kind"].is_null()));
            open.extend(dependency["pkg"].as_str().filter(|_| normal));
        }
    }
    let mut linked: Vec<_> = seen
        .iter()
        .filter_map(|id| packages.get(id).copied())
        .collect();
    linked.sort_by_key(|p| (p["name"].as_str(), p["version"].as_str()));
    Ok(linked)
}

/// The licence texts in a crate's folder.
fn texts(folder: &Path) -> BTreeSet<String> {
    let mut texts = BTreeSet::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().to_uppercase();
        let is_notice = ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"]
            .iter()
            .any(|word| name.starts_with(word));
        if is_notice && let Ok(text) = fs::read_to_string(entry.path()) {
            let lines: Vec<_> = text.lines().map(str::trim_end).collect();
            texts.insert(lines.join("\n").trim().to_owned());
        }
    }
    texts
}
