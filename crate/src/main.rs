//! The companion program; see [`snellius::cli`].

fn main() -> std::process::ExitCode {
    snellius::cli::run()
}
