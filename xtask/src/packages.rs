//! Packages of the distribution, installed where that is possible without asking anyone.

use anyhow::{Result, bail};

use crate::process::{find_in_path, output_of, program, run};

/// Installs packages by apt; an error where there is no apt or no right to use it.
pub(crate) fn install(names: &[&str]) -> Result<()> {
    let Some(become_root) = way_to_root() else {
        bail!("apt-get cannot be used here");
    };
    println!(
        "installing {} from the distribution's packages",
        names.join(" and ")
    );
    apt_get(&become_root, &["update"])?;
    apt_get(&become_root, &[&["install", "-y"], names].concat())
}

fn apt_get(become_root: &[&str], arguments: &[&str]) -> Result<()> {
    let words = [
        become_root,
        &["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"],
        arguments,
    ]
    .concat();
    run(program(words[0]).args(&words[1..]))
}

/// What to put before `apt-get`: nothing as root, sudo where it asks no password.
fn way_to_root() -> Option<Vec<&'static str>> {
    find_in_path("apt-get")?;
    let user = output_of(program("id").arg("-u"))?;
    if user.trim() == "0" {
        return Some(vec![]);
    }
    output_of(program("sudo").args(["-n", "true"])).map(|_| vec!["sudo", "-n"])
}
