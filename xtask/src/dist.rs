//! `cargo xtask dist`: the page as it is published, a folder of static files in `dist/`.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};

use crate::{
    page::{self, Profile},
    setup,
};

/// Builds the page and makes sure that it needs no place of its own: whatever host and folder it is put on,
/// every address in it leads beside it.
pub(crate) fn run() -> Result<()> {
    let tools = setup::page_tools()?;
    let dist = page::dist();
    page::build(&tools, Profile::Release, &dist)?;
    addresses_are_relative(&dist)?;
    println!("the site is in {}", dist.display());
    Ok(())
}

/// Refuses addresses that begin at the host's root, or at another host.
pub(crate) fn addresses_are_relative(dist: &Path) -> Result<()> {
    let index = dist.join("index.html");
    let html =
        fs::read_to_string(&index).with_context(|| format!("cannot read {}", index.display()))?;
    for address in addresses(&html) {
        let leads_beside = !address.starts_with('/') && !address.contains("://");
        ensure!(
            leads_beside,
            "index.html: {address:?} is no relative address"
        );
    }
    Ok(())
}

/// What stands in quotes after `src=`, `href=`, `from` or `module_or_path:`.
fn addresses(html: &str) -> Vec<&str> {
    const BEFORE: [&str; 4] = ["src=", "href=", "from ", "module_or_path: "];
    let mut found = Vec::new();
    for mark in BEFORE {
        for (at, _) in html.match_indices(mark) {
            let rest = &html[at + mark.len()..];
            let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''));
            let inside = quote.and_then(|quote| rest[1..].split(quote).next());
            found.extend(inside);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(html: &str) -> Result<()> {
        let folder = std::env::temp_dir().join(format!("snellius-dist-{}", std::process::id()));
        fs::create_dir_all(&folder)?;
        fs::write(folder.join("index.html"), html)?;
        let outcome = addresses_are_relative(&folder);
        fs::remove_dir_all(&folder)?;
        outcome
    }

    #[test]
    fn only_addresses_beside_the_page_are_let_through() {
        checked(r#"<link href="./a.css"><script>import init from './b.js';</script>"#).unwrap();
        for bad in [
            r#"<link href="/a.css">"#,
            "<script>import init from '/b.js'</script>",
            r#"<img src="https://example.org/c.png">"#,
            "init({ module_or_path: '/d.wasm' })",
        ] {
            assert!(checked(bad).is_err(), "{bad}");
        }
    }
}
