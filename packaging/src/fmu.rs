//! What an FMU holds, for each version of the standard.

use crate::archive::Archive;
use crate::licences::Licences;
use crate::platform::Platform;
use crate::reference;
use model_description::{ModelDescription, fmi2, fmi3};

/// A version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0
    Fmi2,
    /// FMI 3.0
    Fmi3,
}

impl Version {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Fmi2, Self::Fmi3];

    /// Folder in `dist/`.
    pub fn folder(self) -> &'static str {
        match self {
            Self::Fmi2 => "fmi2",
            Self::Fmi3 => "fmi3",
        }
    }
}

/// A unit, ready to be packaged.
pub struct Content {
    /// Its contract.
    pub description: ModelDescription,
    /// Shared libraries by platform.
    pub binaries: Vec<(Platform, Vec<u8>)>,
    /// Licences of it and of what it links.
    pub licences: Licences,
    /// Files of `terminalsAndIcons/`, which FMI 2.0 does not have, by name.
    pub terminals: Vec<(String, Vec<u8>)>,
    /// Reference results, by path.
    pub reference: reference::Files,
    /// `documentation/index.html`.
    pub page: String,
    /// The icon, 200 × 200.
    pub icon_png: Vec<u8>,
    /// The icon as drawn.
    pub icon_svg: Vec<u8>,
}

impl Content {
    /// The FMU for one version (FMI 2.0 sec 2.3, FMI 3.0 sec 2.5).
    pub fn archive(&self, version: Version) -> Archive {
        let mut fmu = Archive::default();
        let name = &self.description.name;
        match version {
            Version::Fmi2 => {
                fmu.add("modelDescription.xml", fmi2::write(&self.description));
                fmu.add("model.png", self.icon_png.clone());
            }
            Version::Fmi3 => {
                fmu.add("modelDescription.xml", fmi3::write(&self.description));
                for (file, content) in &self.terminals {
                    fmu.add(format!("terminalsAndIcons/{file}"), content.clone());
                }
                fmu.add("terminalsAndIcons/icon.png", self.icon_png.clone());
                fmu.add("terminalsAndIcons/icon.svg", self.icon_svg.clone());
            }
        }
        for (platform, binary) in &self.binaries {
            let folder = match version {
                Version::Fmi2 => platform.fmi2,
                Version::Fmi3 => platform.fmi3,
            };
            let path = format!("binaries/{folder}/{name}{}", platform.suffix);
            fmu.add(path, binary.clone());
        }
        fmu.add("documentation/index.html", self.page.clone());
        for (path, content) in &self.reference {
            fmu.add(path, content.as_str());
        }
        self.licences.add_to(&mut fmu);
        fmu
    }
}
