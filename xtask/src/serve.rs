//! `cargo xtask serve`: builds the page and serves it on this machine, rebuilding it on changes.

use std::{
    net::{Ipv4Addr, TcpListener},
    process::Command,
};

use anyhow::{Context, Result};
use lexopt::prelude::*;

use crate::{
    page::{self, Profile},
    process::root,
    setup,
};

const USUAL_PORT: u16 = 8080;

/// What the command line may say.
#[derive(Debug)]
pub(crate) struct Options {
    port: Option<u16>,
    profile: Profile,
}

impl Options {
    pub(crate) fn parse(mut arguments: lexopt::Parser) -> Result<Self> {
        let mut options = Self {
            port: None,
            profile: Profile::Release,
        };
        while let Some(argument) = arguments.next()? {
            match argument {
                Short('p') | Long("port") => options.port = Some(arguments.value()?.parse()?),
                Long("release") => options.profile = Profile::Release,
                Long("debug") => options.profile = Profile::Debug,
                other => return Err(other.unexpected().into()),
            }
        }
        Ok(options)
    }
}

/// Builds once, so that an error ends the command, then hands over to Trunk's server.
pub(crate) fn run(options: &Options) -> Result<()> {
    let tools = setup::page_tools()?;
    // Not `dist/`: Trunk's server adds a reloading script to the page, which has no place in
    // what is published and tested.
    let dist = root().join("target").join("serve");
    page::build(&tools, options.profile, &dist)?;

    let port = free_port(options.port)?;
    println!("\nSnellius is served at http://127.0.0.1:{port}/ (Ctrl-C ends it)\n");
    let mut server = page::trunk(&tools, "serve", options.profile)?;
    server
        .args(["--address", "127.0.0.1", "--disable-address-lookup=true"])
        .args(["--port", &port.to_string(), "--dist"])
        .arg(&dist);
    become_program(&mut server)
}

/// The port asked for, or 8080, or, where that is taken, any free one.
fn free_port(wanted: Option<u16>) -> Result<u16> {
    let bind = |port| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
    let listener = match wanted {
        Some(port) => bind(port).with_context(|| format!("port {port} is taken"))?,
        None => bind(USUAL_PORT)
            .or_else(|_| bind(0))
            .context("no free port on 127.0.0.1")?,
    };
    Ok(listener.local_addr()?.port())
}

/// Lets the server take this process's place, so that whoever ends xtask ends the server.
#[cfg(unix)]
fn become_program(server: &mut Command) -> Result<()> {
    use std::os::unix::process::CommandExt;
    Err(server.exec()).context("cannot start Trunk's server")
}

#[cfg(not(unix))]
fn become_program(server: &mut Command) -> Result<()> {
    crate::process::run(server)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_taken_port_is_an_error_when_it_was_asked_for() {
        let taken = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let port = taken.local_addr().unwrap().port();
        let error = free_port(Some(port)).unwrap_err().to_string();
        assert_eq!(error, format!("port {port} is taken"));
    }

    #[test]
    fn without_a_wish_some_port_is_found_even_when_the_usual_one_is_taken() {
        // Held for the length of the test, unless somebody else holds it already.
        let _usual = TcpListener::bind((Ipv4Addr::LOCALHOST, USUAL_PORT));
        let port = free_port(None).unwrap();
        assert_ne!(port, USUAL_PORT);
        assert_ne!(port, 0);
    }
}
