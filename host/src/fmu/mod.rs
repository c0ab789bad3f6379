//! Imports FMUs: unpacks, reads the description, loads the binary, instantiates and calls it.
//!
//! FMI 2.0 and 3.0 look the same from outside this module: an [`Fmu`] is a file with a [`Description`], an
//! [`Instance`] of it runs as Co-Simulation, [`Signals`] move values in and out without a look-up.
//!
//! ```no_run
//! use host::fmu::{Experiment, Fmu, Signals};
//!
//! # fn main() -> Result<(), host::fmu::Error> {
//! let fmu = Fmu::open("FlexArmPlant.fmu".as_ref())?;
//! let mut plant = fmu.instantiate("plant", false)?;
//! let Ok(angle) = fmu.description().scalar("angle") else { return Ok(()) };
//! let mut outputs = Signals::new(fmu.description(), &[angle]);
//! plant.enter_initialization(&Experiment::default())?;
//! plant.exit_initialization()?;
//! let mut values = [0.0];
//! for k in 0..4000u32 {
//!     plant.do_step(f64::from(k) * 2.5e-4, 2.5e-4)?;
//!     outputs.read(&mut plant, &mut values)?;
//! }
//! plant.terminate()
//! # }
//! ```

pub(crate) mod archive;
mod defects;
mod description;
mod error;
mod fmi2;
mod fmi2_description;
mod fmi3;
mod fmi3_description;
mod instance;
mod interface;
mod log;
mod platform;
mod reader;
mod signals;
mod status;
mod structure;
mod text;
mod value;

pub use archive::{Limits, Problem};
#[cfg(test)]
pub(crate) use description::tests as description_tests;
pub use description::{
    Causality, CoSimulation, DefaultExperiment, Description, Item, NameError, Scalar, Variable,
    Version,
};
pub use error::Error;
pub use instance::{Instance, SavedState};
pub use interface::Experiment;
pub use log::Message;
pub(crate) use reader::describe;
pub use signals::Signals;
pub use status::Status;
pub use structure::{Dependencies, Units};
pub use text::short;
pub(crate) use text::{hint, similar};
pub use value::{Buffer, Kind, Value};

use self::log::Environment;
use self::status::Failed;
use libloading::Library;
use std::ffi::{CStr, CString};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tempfile::TempDir;

/// Categories of both standards for messages that are no debug messages.
const WARNINGS: [&CStr; 4] = [
    c"logStatusWarning",
    c"logStatusDiscard",
    c"logStatusError",
    c"logStatusFatal",
];

/// An FMU: unpacked and described, its binary loaded when it is first instantiated.
///
/// The unpacked folder lives as long as the FMU and all its instances, and is removed with the last of them.
#[derive(Clone, Debug)]
pub struct Fmu {
    unpacked: Arc<Unpacked>,
    /// With the array sizes that follow from `structure`.
    description: Arc<Description>,
    /// Values of structural parameters, which each instance gets in Configuration Mode.
    structure: Arc<[(Scalar, Value)]>,
}

#[derive(Debug)]
struct Unpacked {
    file: PathBuf,
    binary: Mutex<Option<Arc<Binary>>>,
    /// Set when an instance returned Fatal.
    fatal: AtomicBool,
    // Last: the library is unloaded before its folder goes.
    folder: TempDir,
}

struct Binary {
    functions: Functions,
    /// Keeps the functions valid.
    _library: Library,
}

#[derive(Clone, Copy)]
enum Functions {
    V2(fmi2::Functions),
    V3(fmi3::Functions),
}

impl std::fmt::Debug for Binary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Binary")
    }
}

impl Fmu {
    /// Unpacks and reads the FMU. Its binary is not touched yet.
    pub fn open(file: &Path) -> Result<Self, Error> {
        Self::open_within(file, &Limits::default())
    }

    /// The same with other limits on the size of the unpacked FMU.
    pub fn open_within(file: &Path, limits: &Limits) -> Result<Self, Error> {
        Self::open_as(file, file, limits)
    }

    /// The same; messages call it `file`, and it is read from `content`.
    pub(crate) fn open_as(file: &Path, content: &Path, limits: &Limits) -> Result<Self, Error> {
        let folder = tempfile::Builder::new()
            .prefix("flexarm-")
            .tempdir()
            .map_err(Error::TemporaryFolder)?;
        archive::unpack(content, folder.path(), limits).map_err(|problem| Error::Archive {
            file: file.to_owned(),
            problem,
        })?;
        // FMUs may rely on their resources folder even if it is empty.
        fs::create_dir_all(folder.path().join("resources")).map_err(Error::TemporaryFolder)?;
        let description = describe(file, &folder.path().join("modelDescription.xml"))?;
        let unpacked = Unpacked {
            file: file.to_owned(),
            binary: Mutex::new(None),
            fatal: AtomicBool::new(false),
            folder,
        };
        Ok(Self {
            unpacked: Arc::new(unpacked),
            description: Arc::new(description),
            structure: Arc::default(),
        })
    }

    /// The same FMU whose structural parameters have those of `values` that are theirs (FMI 3.0 sec 2.3.3): its
    /// arrays have the sizes that follow, and its instances are configured before anything else.
    pub fn configured(&self, values: &[(Scalar, Value)]) -> Result<Self, Error> {
        let structural = |(scalar, _): &&(Scalar, Value)| {
            self.description.variable(*scalar).causality == Causality::StructuralParameter
        };
        let structure: Vec<_> = values.iter().filter(structural).cloned().collect();
        if structure.is_empty() {
            return Ok(self.clone());
        }
        let description = self.description.resized(&structure);
        reader::check_sizes(self.file(), &description)?;
        Ok(Self {
            unpacked: Arc::clone(&self.unpacked),
            description: Arc::new(description),
            structure: structure.into(),
        })
    }

    /// The file it was opened from.
    pub fn file(&self) -> &Path {
        &self.unpacked.file
    }

    /// What the FMU says of itself.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The folder it is unpacked to.
    pub fn folder(&self) -> &Path {
        self.unpacked.folder.path()
    }

    /// Platforms that it has a folder for.
    pub fn platforms(&self) -> Vec<String> {
        platform::present(self.folder())
    }

    /// Makes an instance for Co-Simulation. `logging` asks for debug messages too. Warnings and errors are
    /// asked for anyway, if the FMU declares the standard's categories for them.
    pub fn instantiate(&self, name: &str, logging: bool) -> Result<Instance, Error> {
        let description = self.description();
        if description.co_simulation.is_none() {
            return Err(Error::NoCoSimulation {
                file: self.file().to_owned(),
            });
        }
        if self.unpacked.fatal.load(Ordering::Relaxed) {
            return Err(Error::AfterFatal {
                instance: name.to_owned(),
            });
        }
        let binary = self.binary()?;
        let environment = Arc::new(Environment::new());
        let mut interface = self.interface(&binary, name, logging, &environment)?;
        if interface.is_none() && environment.log.all().is_empty() {
            // Some FMUs say why only when they are asked to log.
            interface = self.interface(&binary, name, true, &environment)?;
        }
        if let (false, Some(made)) = (logging, &mut interface) {
            match self.ask_for_warnings(made.as_mut()) {
                Ok(()) => {}
                Err(Failed::Status(function, status @ Status::Fatal)) => {
                    self.unpacked.fatal.store(true, Ordering::Relaxed);
                    if let Some(made) = interface {
                        made.abandon();
                    }
                    // Unloading would run code of the binary too.
                    std::mem::forget(binary);
                    return Err(Error::Call {
                        instance: name.to_owned(),
                        function,
                        status,
                        time: None,
                        log: environment.log.last(10),
                    });
                }
                // It may be in an error state now: a fresh one without that call.
                Err(_) => {
                    drop(interface.take());
                    interface = self.interface(&binary, name, false, &environment)?;
                }
            }
        }
        match interface {
            Some(interface) => {
                let mut instance =
                    Instance::new(name, self.clone(), binary, environment, interface);
                instance.configure()?;
                Ok(instance)
            }
            None => Err(Error::Refused {
                file: self.file().to_owned(),
                instance: name.to_owned(),
                token: description.token.clone(),
                log: environment.log.last(10),
            }),
        }
    }

    /// FMUs that were instantiated without logging may keep their warnings to themselves (FMI 2.0.4 sec
    /// 2.1.5, FMI 3.0 sec 2.3.1): asked for by category they come without the debug messages.
    fn ask_for_warnings(&self, instance: &mut dyn interface::Interface) -> Result<(), Failed> {
        let declared = &self.description().log_categories;
        let categories: Vec<_> = WARNINGS
            .iter()
            .filter(|category| declared.iter().any(|d| d.as_bytes() == category.to_bytes()))
            .map(|&category| category.to_owned())
            .collect();
        if categories.is_empty() {
            return Ok(());
        }
        match instance.log_only(&categories) {
            Err(Failed::Missing(_)) => Ok(()),
            outcome => outcome,
        }
    }

    fn interface(
        &self,
        binary: &Binary,
        name: &str,
        logging: bool,
        environment: &Arc<Environment>,
    ) -> Result<Option<Box<dyn interface::Interface>>, Error> {
        let c_string = |text: &str, what| {
            CString::new(text).map_err(|_| Error::ZeroByte {
                file: self.file().to_owned(),
                what,
            })
        };
        let name = c_string(name, "the instance name")?;
        let token = c_string(&self.description().token, "the instantiation token")?;
        let resources = self.folder().join("resources");
        let environment = Arc::clone(environment);
        Ok(match binary.functions {
            Functions::V2(functions) => {
                let uri = c_string(&platform::file_uri(&resources), "the resource location")?;
                fmi2::Instance::new(functions, &name, &token, &uri, logging, environment)
                    .map(|instance| Box::new(instance) as _)
            }
            Functions::V3(functions) => {
                // The path ends with a separator (FMI 3.0 sec 2.3.1).
                let path = resources.join("");
                let path = c_string(&path.to_string_lossy(), "the resource path")?;
                fmi3::Instance::new(functions, &name, &token, &path, logging, environment)
                    .map(|instance| Box::new(instance) as _)
            }
        })
    }

    fn binary(&self) -> Result<Arc<Binary>, Error> {
        let mut slot = self
            .unpacked
            .binary
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        if let Some(binary) = &*slot {
            return Ok(Arc::clone(binary));
        }
        let binary = Arc::new(self.load()?);
        *slot = Some(Arc::clone(&binary));
        Ok(binary)
    }

    fn load(&self) -> Result<Binary, Error> {
        let identifier = self
            .description()
            .co_simulation
            .as_ref()
            .map_or("", |c| c.model_identifier.as_str());
        let path =
            platform::find_binary(self.folder(), identifier).ok_or_else(|| Error::NoBinary {
                file: self.file().to_owned(),
                identifier: identifier.to_owned(),
                platform: platform::names(),
                present: self.platforms(),
            })?;
        let library = open_library(&path).map_err(|error| {
            let reason = reason(&error);
            Error::Load {
                file: self.file().to_owned(),
                missing: missing_library(&reason, &path),
                binary: path,
                reason,
            }
        })?;
        let functions = match self.description().version {
            Version::V2 => fmi2::Functions::load(&library).map(Functions::V2),
            Version::V3 => fmi3::Functions::load(&library).map(Functions::V3),
        };
        match functions {
            Ok(functions) => Ok(Binary {
                functions,
                _library: library,
            }),
            Err(function) => Err(Error::MissingFunction {
                file: self.file().to_owned(),
                function,
            }),
        }
    }
}

/// All symbols are resolved at once, so that a missing one is an error here rather than the end of the
/// process later; only if that fails lazily, for FMUs that never use what they lack.
#[cfg(unix)]
fn open_library(path: &Path) -> Result<Library, libloading::Error> {
    use libloading::os::unix::{Library, RTLD_LAZY, RTLD_LOCAL, RTLD_NOW};
    // SAFETY: running an FMU is running its code; the user chose it.
    let now = unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) };
    now.or_else(|error| {
        if !reason(&error).contains("undefined symbol") {
            return Err(error);
        }
        // SAFETY: as above.
        unsafe { Library::open(Some(path), RTLD_LAZY | RTLD_LOCAL) }
    })
    .map(Into::into)
}

/// Libraries beside the binary are found too.
#[cfg(windows)]
fn open_library(path: &Path) -> Result<Library, libloading::Error> {
    use libloading::os::windows::{
        LOAD_LIBRARY_SEARCH_DEFAULT_DIRS, LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR, Library,
    };
    let flags = LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR | LOAD_LIBRARY_SEARCH_DEFAULT_DIRS;
    // SAFETY: running an FMU is running its code; the user chose it.
    unsafe { Library::load_with_flags(path, flags) }.map(Into::into)
}

/// What the loader says; the error itself only names the function that failed.
fn reason(error: &libloading::Error) -> String {
    std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string)
}

/// The library that the loader missed, from its message `libx.so.1: cannot open shared object file: …`.
fn missing_library(reason: &str, binary: &Path) -> Option<String> {
    let (name, _) = reason.split_once(": cannot open shared object file")?;
    (!binary.ends_with(name)).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_missing_library_is_named() {
        let binary = Path::new("/x/binaries/linux64/m.so");
        let reason = "libgfortran.so.3: cannot open shared object file: No such file or directory";
        assert_eq!(
            missing_library(reason, binary).as_deref(),
            Some("libgfortran.so.3")
        );
        assert_eq!(missing_library("m.so: invalid ELF header", binary), None);
    }
}
