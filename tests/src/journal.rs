//! What a page and its workers said and asked for while a test ran.

use serde_json::Value;

use crate::cdp::Event;

/// All lines of the console, uncaught exceptions and Chromium's own complaints among them.
pub(crate) fn console(events: &[Event]) -> Vec<String> {
    events
        .iter()
        .filter_map(|event| {
            let (level, text) = said(event)?;
            Some(format!("[{level}] {text}"))
        })
        .collect()
}

/// What must not happen in a page that works: uncaught exceptions, `console.error`, files that
/// are not there, refused scripts.
pub(crate) fn problems(events: &[Event]) -> Vec<String> {
    events
        .iter()
        .filter_map(said)
        .filter(|(level, _)| ["error", "assert", "exception"].contains(&level.as_str()))
        .map(|(level, text)| format!("[{level}] {text}"))
        .collect()
}

/// Addresses of all requests and connections, also those of workers.
pub(crate) fn requests(events: &[Event]) -> Vec<String> {
    events
        .iter()
        .filter_map(|event| {
            let url = match event.method.as_str() {
                "Network.requestWillBeSent" => &event.params["request"]["url"],
                "Network.webSocketCreated" | "Network.webTransportCreated" => &event.params["url"],
                _ => return None,
            };
            Some(url.as_str()?.to_owned())
        })
        .collect()
}

/// Whether a request stays on this machine: a page on disk is one itself.
pub(crate) fn is_local(url: &str) -> bool {
    let without_network = ["data:", "blob:", "about:", "file:///"];
    let loopback = ["http://127.0.0.1:", "ws://127.0.0.1:"];
    without_network
        .iter()
        .chain(&loopback)
        .any(|prefix| url.starts_with(prefix))
}

fn said(event: &Event) -> Option<(String, String)> {
    let params = &event.params;
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    match event.method.as_str() {
        "Runtime.consoleAPICalled" => Some((text(&params["type"]), arguments(&params["args"]))),
        "Runtime.exceptionThrown" => {
            let details = &params["exceptionDetails"];
            let what = details["exception"]["description"]
                .as_str()
                .map_or_else(|| text(&details["text"]), str::to_owned);
            Some(("exception".to_owned(), what))
        }
        "Log.entryAdded" => {
            let entry = &params["entry"];
            let what = format!("{} {}", text(&entry["text"]), text(&entry["url"]));
            Some((text(&entry["level"]), what))
        }
        _ => None,
    }
}

fn arguments(arguments: &Value) -> String {
    let words = arguments.as_array().into_iter().flatten().map(|argument| {
        match (&argument["value"], argument["description"].as_str()) {
            (Value::String(text), _) => text.clone(),
            (_, Some(description)) => description.to_owned(),
            (value, None) => value.to_string(),
        }
    });
    words.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_loopback_and_addresses_without_a_network_are_local() {
        assert!(is_local("http://127.0.0.1:4000/a.js"));
        assert!(is_local("blob:http://127.0.0.1:4000/1b2c"));
        assert!(is_local("data:,"));
        assert!(!is_local("https://fonts.example/a.woff2"));
        assert!(!is_local("http://127.0.0.1.example/"));
        assert!(!is_local("wss://example/"));
    }
}
