//! Keys by name, as the DevTools protocol wants them described.

use anyhow::{Result, bail};
use serde_json::{Value, json};

/// One press, such as `Enter`, `a` or `Shift+Tab`: the parameters of its down and up events.
pub(crate) fn press(name: &str) -> Result<[Value; 2]> {
    let mut modifiers = 0;
    let mut key = name;
    while let Some((modifier, rest)) = key.split_once('+').filter(|(_, rest)| !rest.is_empty()) {
        modifiers |= match modifier {
            "Alt" => 1,
            "Control" => 2,
            "Meta" => 4,
            "Shift" => 8,
            other => bail!("no modifier key `{other}` in `{name}`"),
        };
        key = rest;
    }
    let (key, code, number, text) = describe(key)?;
    let event = |kind: &str| {
        json!({
            "type": kind, "modifiers": modifiers, "key": key, "code": code,
            "windowsVirtualKeyCode": number, "nativeVirtualKeyCode": number,
        })
    };
    let mut down = event(if text.is_empty() {
        "rawKeyDown"
    } else {
        "keyDown"
    });
    if !text.is_empty() {
        down["text"] = text.into();
    }
    Ok([down, event("keyUp")])
}

/// Name, place on the keyboard, Windows' number and the text it writes.
fn describe(key: &str) -> Result<(String, String, u32, String)> {
    let named = match key {
        "Enter" => Some((13, "\r")),
        "Tab" => Some((9, "")),
        "Escape" => Some((27, "")),
        "Backspace" => Some((8, "")),
        "Delete" => Some((46, "")),
        "Home" => Some((36, "")),
        "End" => Some((35, "")),
        "PageUp" => Some((33, "")),
        "PageDown" => Some((34, "")),
        "ArrowLeft" => Some((37, "")),
        "ArrowUp" => Some((38, "")),
        "ArrowRight" => Some((39, "")),
        "ArrowDown" => Some((40, "")),
        _ => None,
    };
    if let Some((number, text)) = named {
        return Ok((key.to_owned(), key.to_owned(), number, text.to_owned()));
    }
    if key == "Space" {
        return Ok((" ".to_owned(), key.to_owned(), 32, " ".to_owned()));
    }
    let mut letters = key.chars();
    let (Some(letter), None) = (letters.next(), letters.next()) else {
        bail!("no key `{key}`");
    };
    let upper = letter.to_ascii_uppercase();
    let code = match upper {
        'A'..='Z' => format!("Key{upper}"),
        '0'..='9' => format!("Digit{upper}"),
        _ => String::new(),
    };
    Ok((letter.to_string(), code, upper.into(), letter.to_string()))
}
