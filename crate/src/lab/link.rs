//! A bench as the part of an address behind the `#`, and back.
//!
//! ```text
//! lab/1                             the bench as it is at first
//! lab/1?wall=cylinder&liquid=ethanol&pitch=20
//! ```
//!
//! The 1 is the version: a link of version 1 opens for ever. What is as it is at first is left out.
//! Keys and ranges stand in [`CHOICES`], [`MEDIA`] and [`QUANTITIES`].

use super::{Bench, CHOICES, Choice, MEDIA, Medium, MediumRole, QUANTITIES, Quantity};

/// The version of the links that are written.
pub const VERSION: &str = "1";

/// The longest link that is read, characters: what can be pasted anywhere.
pub const LONGEST: usize = 2000;

/// Why a link cannot be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// It is not a link to the lab.
    #[error("this is no link to the refraction lab")]
    NotTheLab,
    /// It is longer than links are.
    #[error("the link has {length} characters, and links have at most {LONGEST}")]
    TooLong {
        /// How long it is.
        length: usize,
    },
    /// It was made by another version of the page.
    #[error("the link is of version \u{201c}{version}\u{201d}; this page reads version {VERSION}")]
    Version {
        /// The version that it names.
        version: String,
    },
    /// A part of it is not of the form key=value.
    #[error("\u{201c}{part}\u{201d} is not of the form key=value")]
    NoPair {
        /// The part.
        part: String,
    },
    /// A key means nothing.
    #[error("there is no parameter \u{201c}{key}\u{201d}")]
    UnknownKey {
        /// The key.
        key: String,
    },
    /// A key stands twice.
    #[error("\u{201c}{key}\u{201d} stands twice")]
    Twice {
        /// The key.
        key: &'static str,
    },
    /// A value is not a plain decimal number.
    #[error("{key}: \u{201c}{value}\u{201d} is not a number")]
    NotANumber {
        /// The key.
        key: &'static str,
        /// The value.
        value: String,
    },
    /// A number is too small or too large.
    #[error("{key}: {value} is not between {low} and {high}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// The value.
        value: f64,
        /// The least it may be.
        low: f64,
        /// The greatest it may be.
        high: f64,
    },
    /// A word is none of those that are known.
    #[error("{key}: \u{201c}{value}\u{201d} is not one of {known}")]
    UnknownWord {
        /// The key.
        key: &'static str,
        /// The word.
        value: String,
        /// Those that are known.
        known: String,
    },
}

/// Whether what stands behind the `#` of an address means the lab.
pub fn is_lab(fragment: &str) -> bool {
    fragment == "lab" || fragment.starts_with("lab/") || fragment.starts_with("lab?")
}

/// The link of a bench, without the `#`.
pub fn write(bench: &Bench) -> String {
    let parameters = parameters(bench);
    if parameters.is_empty() {
        return format!("lab/{VERSION}");
    }
    let pairs: Vec<String> = parameters
        .into_iter()
        .map(|(key, value)| format!("{key}={value}"))
        .collect();
    format!("lab/{VERSION}?{}", pairs.join("&"))
}

/// What of a bench is not as it is at first: keys and values, in the order of links.
pub fn parameters(bench: &Bench) -> Vec<(&'static str, String)> {
    let first = Bench::default();
    let choices = CHOICES.iter().filter_map(|choice| {
        let place = (choice.get)(bench);
        (place != (choice.get)(&first)).then(|| (choice.key, choice.options[place].0.to_owned()))
    });
    let media = MEDIA.iter().filter_map(|role| {
        let medium = (role.get)(bench);
        (medium != (role.get)(&first)).then(|| (role.key, medium.key()))
    });
    let quantities = QUANTITIES.iter().filter_map(|quantity| {
        let value =
            (quantity.get)(bench).filter(|_| (quantity.get)(bench) != (quantity.get)(&first));
        Some((quantity.key, value?.to_string()))
    });
    choices.chain(media).chain(quantities).collect()
}

/// The bench of a link (without the `#`). Whatever is wrong with the link, it is an error that says so.
pub fn read(fragment: &str) -> Result<Bench, LinkError> {
    let length = fragment.chars().count();
    if length > LONGEST {
        return Err(LinkError::TooLong { length });
    }
    let (path, query) = fragment.split_once('?').unwrap_or((fragment, ""));
    match path.strip_prefix("lab") {
        Some("" | "/") => {}
        Some(version) if version.strip_prefix('/') == Some(VERSION) => {}
        Some(version) if version.starts_with('/') => {
            let version = excerpt(&version[1..]);
            return Err(LinkError::Version { version });
        }
        _ => return Err(LinkError::NotTheLab),
    }
    read_parameters(query)
}

/// The bench of a link's parameters: `key=value`, joined by `&`.
pub(super) fn read_parameters(query: &str) -> Result<Bench, LinkError> {
    let mut bench = Bench::default();
    let mut seen: Vec<&str> = Vec::new();
    for part in query.split('&').filter(|part| !part.is_empty()) {
        let (key, value) = part.split_once('=').ok_or_else(|| LinkError::NoPair {
            part: excerpt(part),
        })?;
        let key = read_parameter(&mut bench, key, value)?;
        if seen.contains(&key) {
            return Err(LinkError::Twice { key });
        }
        seen.push(key);
    }
    Ok(bench.tidied())
}

fn read_parameter(bench: &mut Bench, key: &str, value: &str) -> Result<&'static str, LinkError> {
    if let Some(choice) = CHOICES.iter().find(|choice| choice.key == key) {
        read_choice(bench, choice, value)?;
        return Ok(choice.key);
    }
    if let Some(role) = MEDIA.iter().find(|role| role.key == key) {
        (role.set)(bench, read_medium(role, value)?);
        return Ok(role.key);
    }
    if let Some(quantity) = super::quantity(key) {
        read_quantity(bench, quantity, value)?;
        return Ok(quantity.key);
    }
    Err(LinkError::UnknownKey { key: excerpt(key) })
}

fn read_choice(bench: &mut Bench, choice: &Choice, value: &str) -> Result<(), LinkError> {
    let words = || choice.options.iter().map(|option| option.0);
    let place = words()
        .position(|word| word == value)
        .ok_or_else(|| LinkError::UnknownWord {
            key: choice.key,
            value: excerpt(value),
            known: words().collect::<Vec<_>>().join(", "),
        })?;
    choice.set_alone(bench, place);
    Ok(())
}

fn read_medium(role: &MediumRole, value: &str) -> Result<Medium, LinkError> {
    if let Some(medium) = Medium::named(value)
        && (role.may_be_hidden || !medium.is_mystery())
    {
        return Ok(medium);
    }
    let index = number(role.key, value)?;
    let (low, high) = Medium::RANGE;
    Medium::of_index(index).ok_or(LinkError::OutOfRange {
        key: role.key,
        value: index,
        low,
        high,
    })
}

fn read_quantity(bench: &mut Bench, quantity: &Quantity, value: &str) -> Result<(), LinkError> {
    let &Quantity { key, low, high, .. } = quantity;
    let value = number(key, value)?;
    if !quantity.allows(value) {
        return Err(LinkError::OutOfRange {
            key,
            value,
            low,
            high,
        });
    }
    quantity.set_alone(bench, value);
    Ok(())
}

/// A plain decimal number: no exponents, infinities or NaN, which Rust would read too.
fn number(key: &'static str, text: &str) -> Result<f64, LinkError> {
    let plain = text
        .bytes()
        .all(|byte| byte.is_ascii_digit() || matches!(byte, b'-' | b'.'));
    let value = plain.then(|| text.parse::<f64>().ok()).flatten();
    value
        .filter(|value| value.is_finite())
        .ok_or_else(|| LinkError::NotANumber {
            key,
            value: excerpt(text),
        })
}

/// As much of a hostile text as a message can bear.
fn excerpt(text: &str) -> String {
    const MOST: usize = 24;
    let mut excerpt: String = text
        .chars()
        .take(MOST)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    if text.chars().nth(MOST).is_some() {
        excerpt.push('\u{2026}');
    }
    excerpt
}
