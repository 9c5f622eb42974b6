//! What a visitor loads, compressed by brotli as hosts send it.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};

/// What the first screen may have: the page, its styles and its program.
const FIRST_SCREEN: usize = 500_000;
/// What there may be in all: beside the first screen what is loaded when a scan is opened (780 kB: the core, the readers
/// of pictures, archives and other programs' calibrations, figures and files), when the lab is entered (215 kB), and
/// when a page of one file is made (its viewer, 240 kB).
///
/// It shall come down to 800 kB. The core for size alone (`opt-level = "z"`) would take some 30 kB away from the
/// workers' program, and measuring would take 1.2 to 1.4 times as long. The four programs have the same libraries in
/// them (the standard library, serde, the core's optics; page and lab also Leptos), as modules of WebAssembly share no
/// code unless they share memory and are linked for it. Beyond that there are formats: JPEG, WebP and TIFF, YAML and
/// XML, LAS and E57.
const ALL: usize = 1_698_000;

/// Prints both sizes and holds them against their limits.
pub(crate) fn check(dist: &Path) -> Result<()> {
    let (mut first, mut all) = (0, 0);
    for file in fs::read_dir(dist).with_context(|| format!("cannot read {}", dist.display()))? {
        let file = file?;
        let name = file.file_name().to_string_lossy().into_owned();
        if !file.file_type()?.is_file() {
            continue;
        }
        let size = compressed(&fs::read(file.path())?)?;
        println!("{size:>9} B  {name}");
        all += size;
        if is_loaded_at_once(&name) {
            first += size;
        }
    }
    println!(
        "compressed by brotli: first screen {first} B (at most {FIRST_SCREEN}), all {all} B (at most {ALL})"
    );
    ensure!(first > 0, "{} holds no page", dist.display());
    ensure!(first <= FIRST_SCREEN, "the first screen is too large");
    ensure!(all <= ALL, "the page is too large");
    Ok(())
}

/// The workers' program comes with the first scan, the lab when it is entered, the viewer with the first page of one
/// file that is made.
fn is_loaded_at_once(name: &str) -> bool {
    let later = [
        "snellius-worker",
        "snellius-lab",
        "viewer",
        "service-worker",
    ];
    !later.iter().any(|start| name.starts_with(start))
}

fn compressed(bytes: &[u8]) -> Result<usize> {
    let mut out = Vec::new();
    let parameters = brotli::enc::BrotliEncoderParams {
        quality: 11,
        lgwin: 24,
        size_hint: bytes.len(),
        ..Default::default()
    };
    brotli::BrotliCompress(&mut &bytes[..], &mut out, &parameters)?;
    Ok(out.len())
}
