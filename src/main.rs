//! The program, see `program.rs`, with what is of its process: the signals that it answers.

use std::process::ExitCode;

fn main() -> ExitCode {
    #[cfg(unix)]
    #[allow(unsafe_code)]
    unsafe {
        // A file that may not grow further (RLIMIT_FSIZE) gives an error like a full disk instead of ending the
        // program.
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
        // Rust aborts if an allocation fails that no estimate predicted; this ends like other errors.
        libc::signal(libc::SIGABRT, aborted as extern "C" fn(libc::c_int) as libc::sighandler_t);
    }
    springfit::program::run(std::env::args_os().skip(1))
}

/// Ends the program as an error does. Nothing here allocates memory.
#[cfg(unix)]
#[allow(unsafe_code)]
extern "C" fn aborted(_: libc::c_int) {
    const LINE: &[u8] =
        b"error: the program cannot go on, as the line above says; if memory failed, take a smaller input\n";
    unsafe {
        libc::write(libc::STDERR_FILENO, LINE.as_ptr().cast(), LINE.len());
        libc::_exit(2);
    }
}
