//! `flexarm`: runs, scores and plots pairs of FMUs from the command line.

mod cli;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let code = cli::carry_out(cli::Arguments::parse());
    leave(code);
    #[allow(unreachable_code, reason = "where a process cannot leave at once")]
    ExitCode::from(code)
}

/// Ends the process without the exit handlers of what FMUs have loaded: once their FMU is gone some of them
/// fail (numerical libraries behind Python do), which would turn a finished run into a crash.
#[cfg(unix)]
fn leave(code: u8) -> ! {
    use std::io::Write;
    unsafe extern "C" {
        safe fn _exit(code: std::ffi::c_int) -> !;
        fn fflush(stream: *mut std::ffi::c_void) -> std::ffi::c_int;
    }
    // Standard error is not buffered; nothing can be done if standard output is closed.
    let _ = std::io::stdout().flush();
    // SAFETY: without a stream it flushes all of the C library, into which FMUs may have printed.
    unsafe { fflush(std::ptr::null_mut()) };
    _exit(code.into())
}

#[cfg(not(unix))]
fn leave(_: u8) {}
