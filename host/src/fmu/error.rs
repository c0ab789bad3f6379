//! What can go wrong with an FMU.

use super::archive::Problem;
use super::log::Message;
use super::status::Status;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// An FMU that cannot be used, or a call to it that failed.
#[derive(Debug)]
#[allow(missing_docs, reason = "the fields are what Display prints")]
pub enum Error {
    /// The file cannot be unpacked.
    Archive { file: PathBuf, problem: Problem },
    /// No temporary folder could be made to unpack to.
    TemporaryFolder(io::Error),
    /// `modelDescription.xml` is missing or unreadable.
    NoDescription { file: PathBuf, source: io::Error },
    /// `modelDescription.xml` is not what the standard asks for.
    Description { file: PathBuf, reason: String },
    /// `modelDescription.xml` is too large.
    DescriptionSize {
        file: PathBuf,
        size: u64,
        limit: u64,
    },
    /// An array has more elements than the host works with.
    ArraySize {
        file: PathBuf,
        name: String,
        dimensions: Vec<usize>,
        limit: usize,
    },
    /// The FMU is of a version of the standard that the host does not know.
    Version { file: PathBuf, version: String },
    /// The FMU offers no Co-Simulation.
    NoCoSimulation { file: PathBuf },
    /// There is no binary for this platform.
    NoBinary {
        file: PathBuf,
        identifier: String,
        platform: String,
        present: Vec<String>,
    },
    /// The binary cannot be loaded.
    Load {
        file: PathBuf,
        binary: PathBuf,
        reason: String,
        missing: Option<String>,
    },
    /// The binary lacks a function that the standard requires.
    MissingFunction {
        file: PathBuf,
        function: &'static str,
    },
    /// A name or token cannot be handed over, since it contains a zero byte.
    ZeroByte { file: PathBuf, what: &'static str },
    /// The FMU refused to be instantiated.
    Refused {
        file: PathBuf,
        instance: String,
        token: String,
        log: Vec<Message>,
    },
    /// A call failed before the first step: the values that it was given are to blame.
    SetUp {
        instance: String,
        function: &'static str,
        status: Status,
        log: Vec<Message>,
    },
    /// A call failed.
    Call {
        instance: String,
        function: &'static str,
        status: Status,
        time: Option<f64>,
        log: Vec<Message>,
    },
    /// The FMU ended the simulation.
    Terminated {
        instance: String,
        time: f64,
        log: Vec<Message>,
    },
    /// The FMU returned early from a step, which it was not allowed to.
    ReturnedEarly {
        instance: String,
        time: f64,
        asked: f64,
    },
    /// The FMU returned Fatal before: no instance of it may be called.
    AfterFatal { instance: String },
    /// The variable cannot be read or written as it was asked.
    Type {
        instance: String,
        name: String,
        why: &'static str,
    },
    /// A saved state of another instance.
    ForeignState { instance: String },
}

impl Error {
    /// Whether the FMU as a file is to blame, rather than the run.
    pub fn is_input(&self) -> bool {
        !matches!(
            self,
            Self::TemporaryFolder(_)
                | Self::Call { .. }
                | Self::Terminated { .. }
                | Self::ReturnedEarly { .. }
                | Self::AfterFatal { .. }
        )
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Archive { file, problem } => write!(f, "{} {problem}", file.display()),
            Self::TemporaryFolder(source) => {
                write!(f, "no temporary folder to unpack an FMU to: {source}")
            }
            Self::NoDescription { file, source } => {
                write!(
                    f,
                    "{} has no readable modelDescription.xml: {source}",
                    file.display()
                )
            }
            Self::Description { file, reason } => {
                write!(f, "{}: modelDescription.xml: {reason}", file.display())
            }
            Self::DescriptionSize { file, size, limit } => write!(
                f,
                "{}: modelDescription.xml has {size} bytes, at most {limit} are admitted",
                file.display()
            ),
            Self::ArraySize {
                file,
                name,
                dimensions,
                limit,
            } => {
                let size: Vec<_> = dimensions.iter().map(ToString::to_string).collect();
                write!(
                    f,
                    "{}: modelDescription.xml: {name} has {} elements, at most {limit} are admitted",
                    file.display(),
                    size.join(" x ")
                )
            }
            Self::Version { file, version } => write!(
                f,
                "{} is of FMI {version}; FMI 2.0 and 3.x can be imported",
                file.display()
            ),
            Self::NoCoSimulation { file } => {
                write!(
                    f,
                    "{} offers no Co-Simulation, which the host needs",
                    file.display()
                )
            }
            Self::NoBinary {
                file,
                identifier,
                platform,
                present,
            } => {
                let present = if present.is_empty() {
                    "none".to_owned()
                } else {
                    present.join(", ")
                };
                write!(
                    f,
                    "{} has no binary {identifier} for {platform}; platforms in it: {present}",
                    file.display()
                )
            }
            Self::Load {
                file,
                binary,
                reason,
                missing,
            } => {
                if let Some(missing) = missing {
                    write!(
                        f,
                        "{} needs the library {missing}, which is not installed: ",
                        file.display()
                    )?;
                } else {
                    write!(f, "{}: its binary cannot be loaded: ", file.display())?;
                }
                write!(f, "{reason} ({})", binary.display())
            }
            Self::MissingFunction { file, function } => {
                write!(
                    f,
                    "{}: its binary lacks the function {function}",
                    file.display()
                )
            }
            Self::ZeroByte { file, what } => {
                write!(f, "{}: {what} contains a zero byte", file.display())
            }
            Self::Refused {
                file,
                instance,
                token,
                log,
            } => {
                write!(
                    f,
                    "{} refuses to be instantiated as {instance}",
                    file.display()
                )?;
                if log.is_empty() {
                    write!(f, " and logs no reason; it was given the token {token:?}")?;
                }
                lines(f, log)
            }
            Self::SetUp {
                instance,
                function,
                status,
                log,
            } => {
                write!(f, "{instance} cannot be set up: ")?;
                let reasons = reasons(log, function);
                if reasons.is_empty() {
                    write!(f, "{function} returned {status}")
                } else {
                    f.write_str(&reasons.join("; "))
                }
            }
            Self::Call {
                instance,
                function,
                status,
                time,
                log,
            } => {
                write!(f, "{instance}: {function} returned {status}")?;
                if let Some(time) = time {
                    write!(f, " at t = {time} s")?;
                }
                lines(f, log)
            }
            Self::Terminated {
                instance,
                time,
                log,
            } => {
                write!(f, "{instance} ended the simulation at t = {time} s")?;
                lines(f, log)
            }
            Self::ReturnedEarly {
                instance,
                time,
                asked,
            } => write!(
                f,
                "{instance} returned from a step at t = {time} s, though it was to go on to {asked} s"
            ),
            Self::AfterFatal { instance } => {
                write!(
                    f,
                    "{instance} cannot be called: its FMU returned Fatal before"
                )
            }
            Self::Type {
                instance,
                name,
                why,
            } => write!(f, "{instance}: {name} {why}"),
            Self::ForeignState { instance } => {
                write!(f, "{instance}: the saved state is not one of this instance")
            }
        }
    }
}

/// What the log says of a failed call, without the function's name that some FMUs begin with.
fn reasons<'a>(log: &'a [Message], function: &str) -> Vec<&'a str> {
    let text = |message: &'a Message| {
        let rest = message.text.strip_prefix(function);
        rest.and_then(|rest| rest.strip_prefix(": "))
            .unwrap_or(&message.text)
    };
    log.iter()
        .filter(|m| !matches!(m.status, Status::Ok | Status::Warning | Status::Pending))
        .map(text)
        .collect()
}

/// The log, a line for each message.
fn lines(f: &mut fmt::Formatter<'_>, log: &[Message]) -> fmt::Result {
    log.iter()
        .try_for_each(|message| write!(f, "\n  {message}"))
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::TemporaryFolder(source) | Self::NoDescription { source, .. } => Some(source),
            _ => None,
        }
    }
}
