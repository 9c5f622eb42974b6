//! Running other programs from the workspace's root.

use std::{
    ffi::{OsStr, OsString},
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use anyhow::{Context, Result, bail, ensure};

/// The workspace's root directory.
pub(crate) fn root() -> PathBuf {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask
        .parent()
        .expect("xtask/ lies in the workspace")
        .to_owned()
}

/// Where this very program was built to, `target/debug`; other programs of the same profile
/// end up beside it, wherever the user's settings put the target directory.
pub(crate) fn build_directory() -> Result<PathBuf> {
    let this = std::env::current_exe().context("cannot find out where xtask itself lies")?;
    let directory = this.parent().context("xtask lies in no directory")?;
    Ok(directory.to_owned())
}

/// `target`, which lies two levels above where xtask itself was built to.
pub(crate) fn target_directory() -> Result<PathBuf> {
    let profile = build_directory()?;
    let target = profile
        .parent()
        .context("xtask lies in no target directory")?;
    Ok(target.to_owned())
}

/// A program to be run in the workspace's root, freed of what `cargo run` told xtask about itself.
pub(crate) fn program(name: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(name);
    command.current_dir(root());
    // Build scripts are run again when such variables change, so a build started by xtask
    // and one started by hand would spoil each other's results.
    for (key, _) in std::env::vars_os() {
        if key.to_str().is_some_and(describes_a_package) {
            command.env_remove(key);
        }
    }
    command
}

/// `cargo`, of the toolchain that runs xtask (rustup passes its choice on in RUSTUP_TOOLCHAIN).
pub(crate) fn cargo<'a>(arguments: impl IntoIterator<Item = &'a str>) -> Command {
    let mut command = program("cargo");
    command.args(arguments);
    command
}

/// Variables that cargo sets for the program it runs, as against settings of the user's.
fn describes_a_package(key: &str) -> bool {
    let prefixes = ["CARGO_PKG_", "CARGO_MANIFEST_", "CARGO_BIN_"];
    prefixes.iter().any(|prefix| key.starts_with(prefix))
        || ["CARGO_CRATE_NAME", "CARGO_PRIMARY_PACKAGE", "OUT_DIR"].contains(&key)
}

/// PATH with more directories put before it.
pub(crate) fn path_with<'a>(first: impl IntoIterator<Item = &'a Path>) -> Result<OsString> {
    let before = std::env::var_os("PATH").unwrap_or_default();
    let all = first
        .into_iter()
        .map(Path::to_owned)
        .chain(std::env::split_paths(&before));
    std::env::join_paths(all).context("a tool's directory cannot stand in PATH")
}

/// The first file of this name in PATH.
pub(crate) fn find_in_path(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path)
        .map(|directory| directory.join(executable(name)))
        .find(|candidate| candidate.is_file())
}

/// A program's file name on this system.
pub(crate) fn executable(name: &str) -> String {
    format!("{name}{}", std::env::consts::EXE_SUFFIX)
}

/// Runs a program to its end; anything but success is an error that names it.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    let status = command
        .stdin(Stdio::null())
        .status()
        .with_context(|| format!("cannot start {}", shown(command)))?;
    ensure!(status.success(), "{} ended with {status}", shown(command));
    Ok(())
}

/// What a program prints, or nothing when it cannot be run or fails.
pub(crate) fn output_of(command: &mut Command) -> Option<String> {
    let output = command.stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    output.status.success().then_some(text)
}

/// How many tests ran.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Count {
    pub(crate) passed: usize,
    pub(crate) failed: usize,
    pub(crate) ignored: usize,
}

impl Count {
    /// Adds what a closing line of `cargo test`, or one of `node --test`, says; other lines add nothing.
    pub(crate) fn add_line(&mut self, line: &str) {
        let number_after = |word: &str| line.strip_prefix(word)?.trim().parse::<usize>().ok();
        self.passed += number_after("# pass ").unwrap_or(0);
        self.failed += number_after("# fail ").unwrap_or(0);
        self.ignored += number_after("# skipped ").unwrap_or(0);
        let Some((_, results)) = line.split_once("test result: ") else {
            return;
        };
        for part in results.split(['.', ';']) {
            let mut words = part.split_whitespace();
            let Some(Ok(number)) = words.next().map(str::parse::<usize>) else {
                continue;
            };
            match words.next() {
                Some("passed") => self.passed += number,
                Some("failed") => self.failed += number,
                Some("ignored") => self.ignored += number,
                _ => {}
            }
        }
    }
}

/// Runs a test program, shows what it prints, and counts its tests. No test at all is an error:
/// it is how a mistyped filter or a lost file shows.
pub(crate) fn run_tests(command: &mut Command) -> Result<Count> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start {}", shown(command)))?;
    let mut count = Count::default();
    let output = child.stdout.take().context("no output to read")?;
    for line in BufReader::new(output).split(b'\n') {
        let line = line.context("cannot read the tests' output")?;
        let line = String::from_utf8_lossy(&line);
        println!("{line}");
        count.add_line(&line);
    }
    let status = child
        .wait()
        .with_context(|| format!("cannot wait for {}", shown(command)))?;
    ensure!(status.success(), "{} ended with {status}", shown(command));
    if count.passed == 0 {
        bail!("{} ran no test", shown(command));
    }
    Ok(count)
}

/// A command as one would type it.
fn shown(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<_> = words.map(OsStr::to_string_lossy).collect();
    format!("`{}`", words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_lines_of_tests_are_added_up() {
        let mut count = Count::default();
        count.add_line("test geometry::tests::parallel ... ok");
        count.add_line("test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 3 filtered out; finished in 0.40s");
        count.add_line("test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 filtered out");
        let expected = Count {
            passed: 14,
            failed: 1,
            ignored: 1,
        };
        assert_eq!(count, expected);
    }

    #[test]
    fn closing_lines_of_node_count_as_well() {
        let mut count = Count::default();
        for line in [
            "# tests 8",
            "# pass 6",
            "# fail 1",
            "# skipped 1",
            "ok 1 - # pass 3",
        ] {
            count.add_line(line);
        }
        let expected = Count {
            passed: 6,
            failed: 1,
            ignored: 1,
        };
        assert_eq!(count, expected);
    }

    #[test]
    fn a_run_without_tests_is_an_error() {
        let error = run_tests(Command::new("rustc").arg("--version")).unwrap_err();
        assert!(error.to_string().contains("ran no test"), "{error}");
    }

    #[test]
    fn a_failing_program_is_named() {
        let error = run(Command::new("rustc")
            .arg("--no-such-option")
            .stderr(Stdio::null()))
        .unwrap_err()
        .to_string();
        assert!(error.contains("rustc --no-such-option"), "{error}");
    }

    #[test]
    fn settings_of_the_user_survive_and_package_variables_do_not() {
        assert!(!describes_a_package("CARGO_HOME"));
        assert!(!describes_a_package("CARGO_TARGET_DIR"));
        assert!(!describes_a_package("CARGO_NET_OFFLINE"));
        assert!(describes_a_package("CARGO_PKG_VERSION"));
        assert!(describes_a_package("CARGO_MANIFEST_DIR"));
    }
}
