//! Numbers as people read them.

/// A typographic minus, so that columns of numbers look right.
pub(crate) fn fixed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        // -0.00 is 0.00.
        Some(rest) if rest.bytes().all(|b| matches!(b, b'0' | b'.')) => rest.to_owned(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

/// A file's size.
pub(crate) fn megabytes(bytes: f64) -> String {
    if bytes < 1e9 {
        format!("{:.1} MB", bytes / 1e6)
    } else {
        format!("{:.1} GB", bytes / 1e9)
    }
}

/// A time to come, no more exact than it is known.
pub(crate) fn duration(seconds: f64) -> String {
    let seconds = seconds.max(0.0);
    if seconds < 1.5 {
        "about a second".to_owned()
    } else if seconds < 90.0 {
        format!("about {} seconds", seconds.round())
    } else {
        format!("about {} minutes", (seconds / 60.0).round())
    }
}
