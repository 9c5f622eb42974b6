//! Trunk and the wasm-bindgen programs: found where their version is the pinned one, else built
//! from source, once, into the user's cache.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};

use anyhow::{Context, Result, ensure};

use crate::{
    cache,
    pins::Pins,
    process::{executable, find_in_path, output_of, program, run},
};

/// A program that the build needs, of exactly one version.
struct Tool {
    /// The package at crates.io.
    package: &'static str,
    /// The program that tells its version; the others of the package lie beside it.
    program: &'static str,
    version: String,
    /// How long a build takes on two cores, to tell whoever waits.
    minutes: u32,
}

/// Where the tools lie.
pub(crate) struct Tools {
    trunk: PathBuf,
    wasm_bindgen: PathBuf,
}

impl Tools {
    /// Finds both tools, or builds what is missing.
    pub(crate) fn ensure() -> Result<Self> {
        let pins = Pins::read()?;
        let trunk = Tool {
            package: "trunk",
            program: "trunk",
            version: pins.trunk,
            minutes: 4,
        };
        Ok(Self {
            trunk: trunk.ensure()?,
            wasm_bindgen: wasm_bindgen(pins.wasm_bindgen).ensure()?,
        })
    }

    /// The directories to put before PATH: Trunk takes the wasm-bindgen it finds there.
    pub(crate) fn directories(&self) -> [&Path; 2] {
        [&self.trunk, &self.wasm_bindgen]
    }

    /// Trunk itself.
    pub(crate) fn trunk(&self) -> PathBuf {
        self.trunk.join(executable("trunk"))
    }
}

/// The program that runs `wasm-bindgen-test`s in a browser.
pub(crate) fn wasm_test_runner() -> Result<PathBuf> {
    let directory = wasm_bindgen(Pins::read()?.wasm_bindgen).ensure()?;
    Ok(directory.join(executable("wasm-bindgen-test-runner")))
}

/// The program that makes JavaScript of a module.
pub(crate) fn wasm_bindgen_program() -> Result<PathBuf> {
    let directory = wasm_bindgen(Pins::read()?.wasm_bindgen).ensure()?;
    Ok(directory.join(executable("wasm-bindgen")))
}

fn wasm_bindgen(version: String) -> Tool {
    Tool {
        package: "wasm-bindgen-cli",
        program: "wasm-bindgen",
        version,
        minutes: 1,
    }
}

impl Tool {
    /// The directory with the tool's programs.
    fn ensure(&self) -> Result<PathBuf> {
        if let Some(directory) = self.find()? {
            return Ok(directory);
        }
        let _lock = cache::lock()?;
        match self.find()? {
            Some(directory) => Ok(directory),
            None => self.build(),
        }
    }

    fn find(&self) -> Result<Option<PathBuf>> {
        let cached = self.home()?.join("bin").join(executable(self.program));
        let candidates = [Some(cached), find_in_path(self.program)];
        let found = candidates
            .into_iter()
            .flatten()
            .find(|candidate| self.is_version_of(candidate));
        Ok(found.and_then(|program| program.parent().map(Path::to_owned)))
    }

    fn is_version_of(&self, candidate: &Path) -> bool {
        candidate.is_file()
            && output_of(Command::new(candidate).arg("--version"))
                .is_some_and(|said| said.split_whitespace().nth(1) == Some(&self.version))
    }

    fn home(&self) -> Result<PathBuf> {
        Ok(cache::directory()?
            .join("tools")
            .join(format!("{}-{}", self.program, self.version)))
    }

    fn build(&self) -> Result<PathBuf> {
        let Self {
            package,
            version,
            minutes,
            ..
        } = self;
        println!("building {package} {version}, once, about {minutes} min on two cores");
        let start = Instant::now();
        let home = self.home()?;
        let scratch = cache::directory()?
            .join("build")
            .join(format!("{package}-{version}"));
        fs::create_dir_all(&scratch)?;

        // A registry may lack one of the versions that the package was published with: withdrawn
        // since, or not yet mirrored. The versions it does offer are then the better choice.
        let built = run(&mut install(
            package,
            version,
            Lock::AsPublished,
            &home,
            &scratch,
        ));
        built
            .or_else(|error| {
                println!("{error}; once more with the newest versions that fit");
                run(&mut install(
                    package,
                    version,
                    Lock::Newest,
                    &home,
                    &scratch,
                ))
            })
            .with_context(|| format!("cannot build {package} {version}"))?;

        let program = home.join("bin").join(executable(self.program));
        ensure!(
            self.is_version_of(&program),
            "{} does not say that it is version {version}",
            program.display()
        );
        // Only now: an interrupted build goes on from here next time.
        fs::remove_dir_all(&scratch).context("cannot clear away the build")?;
        println!(
            "built {package} {version} in {:.0} s",
            start.elapsed().as_secs_f64()
        );
        Ok(home.join("bin"))
    }
}

/// Which versions of a tool's dependencies to build it from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lock {
    /// Those that its authors tested it with.
    AsPublished,
    /// The newest that its manifest allows.
    Newest,
}

/// `cargo install` of a build tool, kept apart from the workspace's own settings.
fn install(package: &str, version: &str, lock: Lock, home: &Path, scratch: &Path) -> Command {
    let mut command = program("cargo");
    command.args(["install", "--force", "--no-default-features"]);
    if lock == Lock::AsPublished {
        command.arg("--locked");
    }
    command
        .arg(format!("{package}@={version}"))
        .arg("--root")
        .arg(home)
        // Away from the workspace, whose .cargo/config.toml is none of the tool's business.
        .current_dir(scratch)
        .env("CARGO_TARGET_DIR", scratch)
        // A tool that runs for a second need not be optimised for minutes.
        .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0")
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "64");
    for setting in [
        "CARGO_BUILD_TARGET",
        "CARGO_BUILD_RUSTFLAGS",
        "CARGO_ENCODED_RUSTFLAGS",
        "RUSTFLAGS",
    ] {
        command.env_remove(setting);
    }
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rustc(version: &str) -> Tool {
        Tool {
            package: "rustc",
            program: "rustc",
            version: version.to_owned(),
            minutes: 0,
        }
    }

    #[test]
    fn another_version_of_a_tool_does_not_count() {
        let path = find_in_path("rustc").unwrap();
        let said = output_of(Command::new(&path).arg("--version")).unwrap();
        let version = said.split_whitespace().nth(1).unwrap();
        assert!(rustc(version).is_version_of(&path));
        assert!(!rustc("0.0.1").is_version_of(&path));
    }

    #[test]
    fn an_empty_place_in_the_cache_does_not_count() {
        assert!(!rustc("1.0.0").is_version_of(Path::new("no/such/rustc")));
    }

    #[test]
    fn flags_for_the_page_do_not_reach_the_tools() {
        let scratch = Path::new("scratch");
        let command = install(
            "trunk",
            "0.21.14",
            Lock::AsPublished,
            Path::new("home"),
            scratch,
        );
        assert_eq!(command.get_current_dir(), Some(scratch));
        let removed = |name: &str| {
            command
                .get_envs()
                .any(|(key, value)| key == name && value.is_none())
        };
        assert!(removed("RUSTFLAGS") && removed("CARGO_ENCODED_RUSTFLAGS"));
    }
}
