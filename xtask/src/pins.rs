//! Which versions of the build tools. `Trunk.toml` is the one place that says so.

use anyhow::{Context, Result};
use toml::Table;

use crate::process::root;

/// The pinned versions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pins {
    pub(crate) trunk: String,
    pub(crate) wasm_bindgen: String,
}

impl Pins {
    /// Reads `Trunk.toml` at the workspace's root.
    pub(crate) fn read() -> Result<Self> {
        Self::parse(&table("Trunk.toml")?)
    }

    fn parse(trunk_toml: &Table) -> Result<Self> {
        let trunk = trunk_toml
            .get("trunk-version")
            .and_then(|value| value.as_str()?.strip_prefix('='))
            .context("Trunk.toml: trunk-version must be one version, such as \"=0.21.14\"")?;
        let wasm_bindgen = trunk_toml
            .get("tools")
            .and_then(|tools| tools.get("wasm_bindgen")?.as_str())
            .context("Trunk.toml: [tools] wasm_bindgen is missing")?;
        Ok(Self {
            trunk: trunk.to_owned(),
            wasm_bindgen: wasm_bindgen.to_owned(),
        })
    }
}

fn table(file: &str) -> Result<Table> {
    let path = root().join(file);
    let text = std::fs::read_to_string(&path)
        .with_context(|| format!("cannot read {}", path.display()))?;
    text.parse().with_context(|| format!("{file} is no TOML"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The wasm-bindgen program refuses a module made by any other version of the crate.
    #[test]
    fn the_wasm_bindgen_crate_and_program_have_one_version() {
        let cargo_toml = table("Cargo.toml").unwrap();
        let requirement = cargo_toml["workspace"]["dependencies"]["wasm-bindgen"]
            .as_str()
            .unwrap();
        let pins = Pins::read().unwrap();
        assert_eq!(requirement, format!("={}", pins.wasm_bindgen));
    }

    #[test]
    fn a_range_of_versions_is_refused() {
        let loose = "trunk-version = \"0.21\"\n[tools]\nwasm_bindgen = \"0.2.130\"";
        let error = Pins::parse(&loose.parse().unwrap()).unwrap_err();
        assert!(error.to_string().contains("trunk-version"), "{error}");
    }
}
