//! `cargo xtask test`: every check of the project, in order, each under its heading.

use std::{
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail, ensure};
use lexopt::prelude::*;

use crate::{
    axe, browser, dist, npm, page,
    process::{
        Count, build_directory, cargo, executable, program, root, run as run_to_end, run_tests,
    },
    python,
    setup::{self, WASM},
    tools, tsc, viewer,
};

/// One check. They run in the order of this list: what is quick to fail comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Fmt,
    Clippy,
    Native,
    Exports,
    Wasm,
    Page,
    Npm,
    E2e,
}

impl Step {
    const ALL: [Self; 8] = [
        Self::Fmt,
        Self::Clippy,
        Self::Native,
        Self::Exports,
        Self::Wasm,
        Self::Page,
        Self::Npm,
        Self::E2e,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Fmt => "fmt",
            Self::Clippy => "clippy",
            Self::Native => "native",
            Self::Exports => "exports",
            Self::Wasm => "wasm",
            Self::Page => "page",
            Self::Npm => "npm",
            Self::E2e => "e2e",
        }
    }

    fn heading(self) -> &'static str {
        match self {
            Self::Fmt => "formatting",
            Self::Clippy => "clippy, warnings are errors",
            Self::Native => "native tests",
            Self::Exports => "exports read back by other programs (Python)",
            Self::Wasm => "tests of the core as WebAssembly in headless Chromium",
            Self::Page => "the page, as it is published",
            Self::Npm => "the npm package, in Node",
            Self::E2e => "end-to-end tests of page and companion program in headless Chromium",
        }
    }

    /// The names, for the help text.
    pub(crate) fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }

    fn from_name(name: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|step| step.name() == name)
            .with_context(|| format!("no step `{name}`; there are {}", Self::names()))
    }

    fn run(self, rest: &[OsString]) -> Result<Count> {
        match self {
            Self::Fmt => formatting(),
            Self::Clippy => clippy(),
            Self::Native => native_tests(rest),
            Self::Exports => exports(rest),
            Self::Wasm => wasm_tests(rest),
            Self::Page => page(),
            Self::Npm => npm_tests(rest),
            Self::E2e => end_to_end_tests(rest),
        }
    }
}

/// What the command line may say.
#[derive(Debug)]
pub(crate) struct Options {
    steps: Vec<Step>,
    rest: Vec<OsString>,
}

impl Options {
    pub(crate) fn parse(mut arguments: lexopt::Parser) -> Result<Self> {
        let mut steps = vec![];
        let mut rest = vec![];
        while let Some(argument) = arguments.next()? {
            match argument {
                Long("only") => steps.push(Step::from_name(&arguments.value()?.string()?)?),
                // lexopt swallows `--`: what follows comes as plain values.
                Value(first) if steps.len() == 1 => {
                    rest.push(first);
                    rest.extend(arguments.raw_args()?);
                }
                other => return Err(other.unexpected().into()),
            }
        }
        if steps.is_empty() {
            steps.extend(Step::ALL);
        }
        Ok(Self { steps, rest })
    }
}

/// Runs the steps until one fails, then says how long each took and how many tests there were.
pub(crate) fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    let mut lines = vec![];
    let mut total = Count::default();
    for &step in &options.steps {
        println!("\n==> {}: {}", step.name(), step.heading());
        let step_start = Instant::now();
        let count = step.run(&options.rest).with_context(|| {
            let name = step.name();
            format!("step `{name}` failed (alone: cargo xtask test --only {name})")
        })?;
        lines.push(summary_line(step, count, step_start.elapsed()));
        total.passed += count.passed;
        total.ignored += count.ignored;
    }
    println!("\n{}", lines.join("\n"));
    println!(
        "all green: {} of {} steps, {} tests passed, 0 failed, {} ignored, in {:.0} s",
        options.steps.len(),
        Step::ALL.len(),
        total.passed,
        total.ignored,
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

fn summary_line(step: Step, count: Count, time: Duration) -> String {
    let tests = match count.passed {
        0 => String::new(),
        passed => format!("{passed} tests"),
    };
    let (name, seconds) = (step.name(), time.as_secs_f64());
    format!("{name:<8} ok {seconds:8.1} s  {tests}")
        .trim_end()
        .to_owned()
}

fn formatting() -> Result<Count> {
    setup::components()?;
    run_to_end(&mut cargo(["fmt", "--all", "--check"]))?;
    Ok(Count::default())
}

/// The core is held against clippy three times: with everything it has, as the page uses it,
/// and within the page.
fn clippy() -> Result<Count> {
    setup::components()?;
    setup::wasm_target()?;
    let native = "--workspace --exclude snellius-web --all-targets --all-features";
    let core =
        format!("--package snellius --lib --test wasm* --no-default-features --target {WASM}");
    let web = format!("--package snellius-web --target {WASM}");
    for which in [native, &core, &web] {
        let words = ["clippy"].into_iter().chain(which.split(' '));
        run_to_end(cargo(words).args(["--", "--deny", "warnings"]))?;
    }
    Ok(Count::default())
}

fn native_tests(rest: &[OsString]) -> Result<Count> {
    let packages =
        "test --no-fail-fast --workspace --exclude snellius-web --exclude snellius-tests";
    run_tests(cargo(packages.split(' ')).args(rest))
}

/// Every export, read by a program that is not ours.
fn exports(rest: &[OsString]) -> Result<Count> {
    let python = python::ensure()?;
    let companion = companion()?;
    let mut tests = program(python);
    tests
        .arg(python::tests().join("read_back.py"))
        .args(rest)
        .env("SNELLIUS_CLI", companion);
    run_tests(&mut tests)
}

/// Builds the companion program, with the viewer beside it.
pub(crate) fn companion() -> Result<PathBuf> {
    run_to_end(&mut cargo([
        "build",
        "--package",
        "snellius",
        "--bin",
        "snellius",
    ]))?;
    let companion = build_directory()?.join(executable("snellius"));
    ensure!(
        companion.is_file(),
        "no companion program at {}",
        companion.display()
    );
    if !viewer::files().iter().all(|file| file.is_file()) {
        setup::wasm_target()?;
        viewer::build(&tools::wasm_bindgen_program()?)?;
    }
    for (file, name) in viewer::files().iter().zip(viewer::NAMES) {
        let beside = companion.with_file_name(name);
        fs::copy(file, &beside).with_context(|| format!("cannot write {}", beside.display()))?;
    }
    Ok(companion)
}

/// The core's test files named `wasm…`, in the browser that people will use it in.
fn wasm_tests(rest: &[OsString]) -> Result<Count> {
    setup::wasm_target()?;
    let runner = tools::wasm_test_runner()?;
    let browser = browser::find_or_install()?;
    // chromedriver is ended in a way that leaves it no time to clear away its browser's profile.
    let scratch = build_directory()?.join("wasm-tests");
    fs::create_dir_all(&scratch).with_context(|| format!("cannot make {}", scratch.display()))?;
    let capabilities = scratch.join("webdriver.json");
    fs::write(&capabilities, webdriver_json(&browser))
        .with_context(|| format!("cannot write {}", capabilities.display()))?;

    let mut tests = cargo(["test", "--package", "snellius", "--no-default-features"]);
    tests
        .args(["--target", WASM, "--test", "wasm*"])
        .args(rest)
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER", runner)
        .env("CHROMEDRIVER", browser.chromedriver)
        .env("WASM_BINDGEN_TEST_WEBDRIVER_JSON", capabilities)
        .env("TMPDIR", &scratch);
    let outcome = run_tests(&mut tests);
    // Should a helper of the browser still be writing, the next run clears away.
    let _ = fs::remove_dir_all(&scratch);
    outcome
}

/// What chromedriver is to start. Chromium refuses its sandbox to root, which is what
/// containers run as; the tests only load what was built here.
fn webdriver_json(browser: &browser::Browser) -> String {
    let chromium = browser.chromium.display().to_string().replace('\\', "\\\\");
    let arguments = [
        "--headless=new",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
    ];
    let arguments = arguments
        .map(|argument| format!("\"{argument}\""))
        .join(", ");
    format!(r#"{{ "goog:chromeOptions": {{ "binary": "{chromium}", "args": [{arguments}] }} }}"#)
}

fn page() -> Result<Count> {
    dist::run()?;
    Ok(Count::default())
}

/// The npm package, used from Node. It is built wherever the tests run, as the end-to-end tests use it in the
/// browser; Node itself is not installed for its sake.
fn npm_tests(rest: &[OsString]) -> Result<Count> {
    npm::build()?;
    let Some(node) = npm::node() else {
        println!("NOT RUN: there is no Node here; the package is tested in the browser alone");
        return Ok(Count::default());
    };
    let companion = companion()?;
    let folder = root().join("target").join("npm").join("test");
    npm::install_into(&folder)?;
    types(&node, &folder)?;
    let test = folder.join("node.test.mjs");
    fs::copy(root().join("npm").join("test").join("node.mjs"), &test)?;
    let mut tests = program(node);
    tests
        .args(["--test", "--test-reporter=tap"])
        .args(rest)
        .arg(test)
        .env("SNELLIUS_CLI", companion)
        .env("SNELLIUS_SAMPLE", root().join("samples").join("jar.zip"));
    run_tests(&mut tests)
}

/// The package's declarations, read by the TypeScript compiler with a program that uses all of them.
fn types(node: &Path, folder: &Path) -> Result<()> {
    let Some(compiler) = tsc::ensure()? else {
        println!("NOT RUN: there is no npm here; the declarations were not checked");
        return Ok(());
    };
    let uses = folder.join("types.mts");
    fs::copy(root().join("npm").join("test").join("types.ts"), &uses)?;
    let options = "--noEmit --strict --target es2022 --module nodenext --lib es2022,dom";
    run_to_end(
        program(node)
            .arg(compiler)
            .args(options.split(' '))
            .arg(uses),
    )
}

fn end_to_end_tests(rest: &[OsString]) -> Result<Count> {
    let dist = page::dist();
    if !dist.join("index.html").is_file() {
        bail!(
            "there is no page in {}; run `cargo xtask test --only page` first",
            dist.display()
        );
    }
    let package = npm::package();
    if !package.join("package.json").is_file() {
        npm::build()?;
    }
    let axe = axe::ensure()?;
    let browser = browser::find_or_install()?;
    let companion = companion()?;
    let mut tests: Command = cargo(["test", "--no-fail-fast", "--package", "snellius-tests"]);
    tests
        .args(rest)
        .env("SNELLIUS_DIST", dist)
        .env("SNELLIUS_CLI", companion)
        .env("SNELLIUS_NPM", package)
        .env("SNELLIUS_AXE", axe)
        .env(
            "SNELLIUS_SCREENSHOTS",
            root().join("target").join("e2e-screenshots"),
        )
        .env("CHROME", browser.chromium);
    run_tests(&mut tests)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(words: &[&str]) -> Result<Options> {
        Options::parse(lexopt::Parser::from_args(words.iter().copied()))
    }

    #[test]
    fn every_step_is_run_unless_some_are_named() {
        assert_eq!(options(&[]).unwrap().steps, Step::ALL);
        let some = options(&["--only", "fmt", "--only", "e2e"]).unwrap();
        assert_eq!(some.steps, [Step::Fmt, Step::E2e]);
    }

    #[test]
    fn what_follows_a_double_dash_goes_to_the_tests_of_the_one_step() {
        let one = options(&["--only", "e2e", "--", "--test", "harness", "--", "drop"]).unwrap();
        assert_eq!(one.rest, ["--test", "harness", "--", "drop"]);
        assert!(options(&["--", "drop"]).is_err());
    }

    #[test]
    fn an_unknown_step_is_told_the_known_ones() {
        let error = options(&["--only", "lint"]).unwrap_err().to_string();
        assert!(
            error.contains("lint") && error.contains("clippy"),
            "{error}"
        );
    }
}
