//! `cargo xtask`: set-up, serving, tests and benchmarks of the whole workspace.
//!
//! | file | what it does |
//! |---|---|
//! | `setup.rs` | what a machine needs before anything can be built |
//! | `tools.rs` | Trunk and the wasm-bindgen programs, built once into the user's cache |
//! | `pins.rs` | which versions of them, read from `Trunk.toml` |
//! | `browser.rs` | Chromium and chromedriver: find them, or install them |
//! | `python.rs` | other people's readers of our exports, in a virtual environment |
//! | `packages.rs`, `cache.rs` | the distribution's packages; where what was built once is kept |
//! | `dist.rs` | what is published, with every address relative |
//! | `npm.rs`, `typescript.rs` | the core as an npm package, and its types |
//! | `tsc.rs` | the TypeScript compiler, which checks these |
//! | `page.rs`, `finish.rs` | the page through Trunk; its last stroke, which Trunk calls |
//! | `size.rs` | what a visitor loads |
//! | `viewer.rs` | what one-file pages are made of |
//! | `serve.rs`, `test.rs`, `bench.rs` | one sub-command each |
//! | `process.rs` | running other programs |
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command-line tool talks to its terminal"
)]

mod axe;
mod bench;
mod browser;
mod cache;
mod dist;
mod finish;
mod npm;
mod packages;
mod page;
mod pins;
mod process;
mod python;
mod serve;
mod setup;
mod size;
mod test;
mod tools;
mod tsc;
mod typescript;
mod viewer;

use std::process::ExitCode;

use anyhow::{Result, bail};
use lexopt::prelude::*;

const HELP: &str = "\
cargo xtask COMMAND

  serve [--port N] [--release | --debug]   build the page, serve it, print its address
  test [--only STEP]... [-- ARGUMENTS]     every check, in order; ARGUMENTS go to the tests of a single STEP
  dist                                     the page as static files in dist/, for any folder of any host
  viewer                                   the viewer of one-file pages, in target/viewer
  npm                                      the core as an npm package in target/npm/snellius
  bench [SCAN.zip]...                      the core's benchmarks
  bench --large [SIZE]                     the page with an archive of 4.4 GB: memory, main thread, views a second
  setup                                    only install what the others need
  help                                     this text

Steps of `test`: ";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    let mut arguments = lexopt::Parser::from_env();
    let command = match arguments.next()? {
        Some(Value(command)) => command.string()?,
        None | Some(Short('h') | Long("help")) => "help".to_owned(),
        Some(other) => return Err(other.unexpected().into()),
    };
    match command.as_str() {
        "serve" => serve::run(&serve::Options::parse(arguments)?),
        "test" => test::run(&test::Options::parse(arguments)?),
        "dist" => {
            no_more(arguments)?;
            dist::run()
        }
        "finish" => {
            no_more(arguments)?;
            finish::run()
        }
        "npm" => {
            no_more(arguments)?;
            npm::build()
        }
        "viewer" => {
            no_more(arguments)?;
            setup::wasm_target()?;
            viewer::build(&tools::wasm_bindgen_program()?)
        }
        "bench" => bench::run(&bench::Options::parse(arguments)?),
        "setup" => {
            no_more(arguments)?;
            setup::everything()
        }
        "help" => {
            println!("{HELP}{}", test::Step::names());
            Ok(())
        }
        other => bail!("no command `{other}`; `cargo xtask help` lists them"),
    }
}

/// Refuses left-over arguments, so that a typing slip is not silently ignored.
fn no_more(mut arguments: lexopt::Parser) -> Result<()> {
    match arguments.next()? {
        None => Ok(()),
        Some(other) => Err(other.unexpected().into()),
    }
}
