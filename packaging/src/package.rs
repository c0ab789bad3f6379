//! `cargo xtask package`: from sources to `dist/`.

use crate::archive::write_whole;
use crate::cargo::Products;
use crate::fmu::{Content, Version};
use crate::licences::{Licences, Runtime};
use crate::platform::Platform;
use crate::toolchain::Toolchain;
use crate::workspace::{Workspace, announce};
use crate::{cargo, imports, modelica, page, parameters, plot, reference, ssp};
use model_description::ModelDescription;
use std::fs;

/// A unit: its crate and its contract.
struct Unit {
    package: &'static str,
    contract: &'static str,
    /// Name of its library, as cargo knows it.
    library: &'static str,
    /// Name of its icon and text in `assets/`.
    art: &'static str,
}

const UNITS: [Unit; 2] = [
    Unit {
        package: "flexarm-fmu-plant",
        library: "flexarm_plant",
        contract: "modelDescription/plant.xml",
        art: "plant",
    },
    Unit {
        package: "flexarm-fmu-controller",
        library: "flexarm_controller",
        contract: "modelDescription/controller.xml",
        art: "controller",
    },
];

/// The platforms that an FMU is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Platforms {
    /// This one, with its own compiler and linker.
    This,
    /// Every one.
    All,
}

/// Builds both units and writes the FMUs, the parameter sets and the system structures.
pub fn run(workspace: &Workspace, platforms: Platforms) -> Result<(), String> {
    announce("Checking the contracts and writing the parameter sets");
    let mut descriptions = Vec::new();
    for unit in &UNITS {
        let text = workspace.read(unit.contract)?;
        descriptions
            .push(model_description::read(&text, unit.contract).map_err(parameters::lines)?);
    }
    parameters::write(workspace, &descriptions)?;

    announce("Building both units and the host");
    let built = build(workspace, platforms)?;
    let mut contents = contents(workspace, descriptions, &built)?;
    let host = cargo::host(workspace)?;
    for content in &contents {
        write(workspace, content)?;
    }

    announce(
        "Running the packaged units for the plot in their documentation and for their reference results",
    );
    let plot = plot::of_a_run(workspace, host.as_os_str())?;
    let reference = reference::of_a_run(workspace, host.as_os_str())?;
    for (unit, content) in UNITS.iter().zip(&mut contents) {
        content.page = page::write(workspace, &content.description, unit.art, &plot)?;
        let name = &content.description.name;
        let files = reference.iter().filter(|(unit, _)| unit == name);
        content.reference = files.flat_map(|(_, files)| files.clone()).collect();
        for path in write(workspace, content)? {
            eprintln!("{path}");
        }
    }
    for path in ssp::write(workspace, host.as_os_str())? {
        eprintln!("{path}");
    }
    if let [plant, controller] = &contents[..] {
        let path = modelica::write(workspace, &plant.description, controller)?;
        eprintln!("{path}");
    }
    Ok(())
}

/// Libraries by platform, and what the linker added to them.
struct Built {
    products: Vec<(Platform, Products)>,
    /// The targets that they are built for.
    triples: Vec<&'static str>,
    runtime: Vec<Runtime>,
}

fn build(workspace: &Workspace, platforms: Platforms) -> Result<Built, String> {
    let packages: Vec<_> = UNITS.iter().map(|u| u.package).collect();
    match platforms {
        Platforms::This => {
            let this = Platform::host()?;
            let products = cargo::build(workspace, &packages, Some(this.native))?;
            Ok(Built {
                products: vec![(this, products)],
                triples: vec![this.native],
                runtime: Vec::new(),
            })
        }
        Platforms::All => {
            let toolchain = Toolchain::prepare(workspace, &Platform::ALL)?;
            Ok(Built {
                products: toolchain.build(workspace, &packages)?,
                triples: Platform::ALL.map(|p| p.portable).to_vec(),
                runtime: toolchain.runtime()?,
            })
        }
    }
}

fn contents(
    workspace: &Workspace,
    descriptions: Vec<ModelDescription>,
    built: &Built,
) -> Result<Vec<Content>, String> {
    let Built {
        products,
        triples,
        runtime,
    } = built;
    let mut contents = Vec::new();
    for (unit, description) in UNITS.iter().zip(descriptions) {
        let mut binaries = Vec::new();
        for (platform, libraries) in products {
            let library = libraries
                .get(unit.library)
                .ok_or_else(|| format!("{} built no shared library", unit.package))?;
            let name = library.display();
            let binary = fs::read(library).map_err(|e| format!("{name}: {e}"))?;
            // What is built for this platform alone may use all that this platform has.
            if products.len() > 1 {
                imports::check(&binary).map_err(|e| format!("{name} {e}"))?;
            }
            binaries.push((*platform, binary));
        }
        let art =
            |kind: &str| workspace.read_bytes(&format!("packaging/assets/{}.{kind}", unit.art));
        contents.push(Content {
            binaries,
            licences: Licences::collect(workspace, triples, unit.package, runtime)?,
            terminals: terminals(workspace, unit.art)?,
            reference: Vec::new(),
            page: page::write(workspace, &description, unit.art, "")?,
            icon_png: art("png")?,
            icon_svg: art("svg")?,
            description,
        });
    }
    Ok(contents)
}

/// Terminals of a unit and their icons, by their names in the FMU.
fn terminals(workspace: &Workspace, unit: &str) -> Result<Vec<(String, Vec<u8>)>, String> {
    let file = format!("modelDescription/{unit}.terminalsAndIcons.xml");
    let mut files = vec![(
        "terminalsAndIcons.xml".to_owned(),
        workspace.read_bytes(&file)?,
    )];
    for icon in ["drive", "flange", "sensor"] {
        for kind in ["png", "svg"] {
            let name = format!("{icon}.{kind}");
            let bytes = workspace.read_bytes(&format!("packaging/assets/{name}"))?;
            files.push((name, bytes));
        }
    }
    Ok(files)
}

/// Writes the FMU of each version; returns their paths in the project.
fn write(workspace: &Workspace, content: &Content) -> Result<Vec<String>, String> {
    let mut paths = Vec::new();
    for version in Version::ALL {
        let path = format!("dist/{}/{}.fmu", version.folder(), content.description.name);
        write_whole(
            &workspace.path(&path),
            &content.archive(version).to_bytes()?,
        )?;
        paths.push(path);
    }
    Ok(paths)
}
