//! The FMI 3.0 model description that goes into an FMU: the hand-written text with its token.

use crate::ModelDescription;
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// What the hand-written text has in place of the token.
pub(crate) const EMPTY_TOKEN: &str = "instantiationToken=\"\"";

/// The text with `instantiationToken` filled in.
pub fn write(description: &ModelDescription) -> String {
    let filled = format!("instantiationToken=\"{}\"", description.token);
    description.source.replacen(EMPTY_TOKEN, &filled, 1)
}

/// Identity of a description: SHA-256 of its lines in hexadecimal, whatever ends the lines.
pub(crate) fn token(text: &str) -> String {
    let mut hash = Sha256::new();
    for line in text.lines() {
        hash.update(line);
        hash.update("\n");
    }
    hash.finalize().iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}
