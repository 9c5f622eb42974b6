//! The viewer that one-file pages are made of: `viewer/page` with its styles and scripts put into the page itself, as
//! `target/viewer/viewer.html`, and its WebAssembly beside it. The core puts that into the pages that it makes.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use base64::{Engine, prelude::BASE64_STANDARD};
use sha2::{Digest, Sha256};

use crate::{
    process::{cargo, program, root, run, target_directory},
    setup::WASM,
};

/// Every one-file page carries all of this, the module deflated.
const LIMIT_BYTES: usize = 1_200_000;
/// The page and its module.
pub(crate) const NAMES: [&str; 2] = ["viewer.html", "viewer.wasm"];

/// Where the viewer ends up. Trunk copies it from here into the site (web/index.html).
pub(crate) fn files() -> [PathBuf; 2] {
    NAMES.map(|name| root().join("target").join("viewer").join(name))
}

/// Builds the viewer.
pub(crate) fn build(bindgen: &Path) -> Result<()> {
    run(&mut cargo([
        "build",
        "--package",
        "snellius-viewer",
        "--profile",
        "web",
        "--target",
        WASM,
    ]))?;
    let module = target_directory()?
        .join(WASM)
        .join("web")
        .join("snellius_viewer.wasm");
    let folder = root().join("target").join("viewer");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    run(program(bindgen)
        .args(["--target", "no-modules", "--no-typescript", "--out-dir"])
        .arg(&folder)
        .arg(&module))?;
    let page = root().join("viewer").join("page");
    let html = inlined(&read(&page.join("viewer.html"))?, |name| match name {
        "snellius_viewer.js" => read(&folder.join(name)),
        name => read(&page.join(name)),
    })?;
    let [page, module] = files();
    fs::write(&page, &html)?;
    fs::rename(folder.join("snellius_viewer_bg.wasm"), &module)?;
    let bytes = html.len() + fs::metadata(&module)?.len() as usize;
    ensure!(
        bytes <= LIMIT_BYTES,
        "the viewer has {bytes} bytes; the limit is {LIMIT_BYTES} (xtask/src/viewer.rs)"
    );
    println!("viewer: {} ({:.2} MB)", page.display(), bytes as f64 / 1e6);
    Ok(())
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

/// Puts what a page names into the page: style sheets and scripts. The page's own scripts are the only ones that its
/// content security policy then lets run.
fn inlined(html: &str, file: impl Fn(&str) -> Result<String>) -> Result<String> {
    let mut page = String::new();
    let mut hashes = Vec::new();
    for line in html.lines() {
        let between = |before, after| line.trim().strip_prefix(before)?.strip_suffix(after);
        let style = between(r#"<link rel="stylesheet" href=""#, r#"" />"#);
        let script = between(r#"<script src=""#, r#""></script>"#);
        let put_in = match (style, script) {
            (Some(name), _) => format!("<style>\n{}</style>", file(name)?),
            (_, Some(name)) => {
                let code = format!("\n{}", file(name)?);
                ensure!(
                    !code.contains("</script"),
                    "{name} would end its own script"
                );
                hashes.push(hash(&code));
                format!("<script>{code}</script>")
            }
            _ => line.to_owned(),
        };
        page.push_str(&put_in);
        page.push('\n');
    }
    let policy = format!("script-src {}", hashes.join(" "));
    Ok(page.replacen("script-src 'self'", &policy, 1))
}

/// How a content security policy names a script.
fn hash(code: &str) -> String {
    let digest = Sha256::digest(code.as_bytes());
    format!("'sha256-{}'", BASE64_STANDARD.encode(digest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_page_names_stands_in_it() {
        let page = r#"
            <meta content="script-src 'self' 'wasm-unsafe-eval'" />
            <link rel="icon" href="data:," />
            <link rel="stylesheet" href="a.css" />
            <script src="c.js"></script>
        "#;
        let file = |name: &str| Ok(format!("[{name}]\n"));
        let page = inlined(page, file).unwrap();
        for part in [
            "data:,",
            "<style>\n[a.css]\n</style>",
            "<script>\n[c.js]\n</script>",
            // printf '\n[c.js]\n' | openssl dgst -sha256 -binary | base64
            "script-src 'sha256-3hBZgzd7h2LSnFZ1yMm3Jet8RZyaF3hN4hy3b0XjtTg=' 'wasm-unsafe-eval'",
        ] {
            assert!(page.contains(part), "{part}: {page}");
        }
        assert!(!page.contains("src="));
        assert!(
            inlined(r#"<script src="c.js"></script>"#, |_| Ok(
                "'</script>'".to_owned()
            ))
            .is_err()
        );
    }
}
