//! What a machine needs before the rest can be built: the toolchain's parts, the build tools, a
//! browser. Each is looked for first, so a second run only looks.

use std::path::Path;

use anyhow::{Context, Result};

use crate::{
    axe, browser,
    process::{cargo, output_of, program, run},
    python,
    tools::Tools,
};

/// The target that the page is compiled for.
pub(crate) const WASM: &str = "wasm32-unknown-unknown";

/// Everything that any command needs.
pub(crate) fn everything() -> Result<()> {
    components()?;
    page_tools()?;
    browser::find_or_install()?;
    python::ensure()?;
    axe::ensure()?;
    println!("everything is there");
    Ok(())
}

/// What building the page needs.
pub(crate) fn page_tools() -> Result<Tools> {
    wasm_target()?;
    Tools::ensure()
}

/// The compiler's target for the page. rust-toolchain.toml names it, but rustup does not heed
/// that file where automatic installation is switched off.
pub(crate) fn wasm_target() -> Result<()> {
    let libraries = program("rustc")
        .args(["--print", "target-libdir", "--target", WASM])
        .output()
        .context("cannot start rustc")?;
    let libraries = String::from_utf8_lossy(&libraries.stdout).trim().to_owned();
    if Path::new(&libraries).is_dir() {
        return Ok(());
    }
    println!("adding the compilation target {WASM}");
    run(program("rustup").args(["target", "add", WASM]))
        .with_context(|| format!("the Rust toolchain lacks the target {WASM}"))
}

/// rustfmt and clippy.
pub(crate) fn components() -> Result<()> {
    for (subcommand, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        if output_of(&mut cargo([subcommand, "--version"])).is_none() {
            println!("adding {component}");
            run(program("rustup").args(["component", "add", component]))
                .with_context(|| format!("the Rust toolchain lacks {component}"))?;
        }
    }
    Ok(())
}
