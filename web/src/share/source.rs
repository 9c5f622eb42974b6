//! `#src=URL`: a file that lies on another host. Nothing goes there but the request for it.

use leptos::prelude::window;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    Blob, ReferrerPolicy, Request, RequestCredentials, RequestInit, RequestMode, Response, Url,
};

use super::arrival::open_file;
use crate::run::Problem;
use crate::state::Workbench;

/// Fetches the file, saying from where meanwhile, and opens it.
pub(super) fn open(workbench: Workbench, address: &str) {
    match url(address) {
        Ok(url) => {
            let (host, href) = (url.host(), url.href());
            let name = url.pathname();
            let name = name.rsplit('/').next().unwrap_or_default().to_owned();
            workbench.wait_for(
                format!("Fetching from {host}: {href}"),
                async move { fetched(&host, &href).await },
                move |file| open_file(workbench, file, name),
            );
        }
        Err(problem) => workbench.fail(problem),
    }
}

/// The address of a link, which may be written with or without `%3A` and the like.
fn url(address: &str) -> Result<Url, Problem> {
    let decoded = js_sys::decode_uri_component(address).map(String::from);
    let page = window().location().href().unwrap_or_default();
    // An address without a host is one beside the page.
    let url = decoded.and_then(|text| Url::new_with_base(&text, &page));
    let cause = match url {
        Ok(url) if ["http:", "https:"].contains(&url.protocol().as_str()) => return Ok(url),
        Ok(url) => format!("\"{}\" is no address of the web.", url.protocol()),
        Err(_) => "What follows #src= is no address.".to_owned(),
    };
    Err(Problem::input(
        cause,
        "Check the link: it opens addresses that begin with https:// or http://.",
    ))
}

async fn fetched(host: &str, href: &str) -> Result<Blob, Problem> {
    let Ok(response) = request(href, RequestMode::Cors).await else {
        return Err(unreadable(host, href).await);
    };
    if !response.ok() {
        return Err(Problem::input(
            format!(
                "{host} has no such file: it answers {} {}.",
                response.status(),
                response.status_text()
            ),
            "Check the address in the link.",
        ));
    }
    let broken = || {
        Problem::input(
            format!("The connection to {host} broke off."),
            "Load this page again to try once more.",
        )
    };
    let blob = response.blob().map_err(|_| broken())?;
    let blob = JsFuture::from(blob).await.map_err(|_| broken())?;
    blob.dyn_into().map_err(|_| broken())
}

/// Browsers do not say whether a host is silent or forbids reading: one that answers a request whose answer
/// nobody may read forbids it.
async fn unreadable(host: &str, href: &str) -> Problem {
    if request(href, RequestMode::NoCors).await.is_ok() {
        Problem::input(
            format!(
                "{host} forbids pages of other hosts to read this file (it sends no \
                 Access-Control-Allow-Origin)."
            ),
            "Download the file yourself and drop it here, or ask the host's owner to allow it.",
        )
    } else {
        Problem::input(
            format!("{host} does not answer."),
            "Check the address in the link and the connection, and load this page again.",
        )
    }
}

/// A request that says nothing of who asks.
async fn request(href: &str, mode: RequestMode) -> Result<Response, JsValue> {
    let options = RequestInit::new();
    options.set_mode(mode);
    options.set_credentials(RequestCredentials::Omit);
    options.set_referrer_policy(ReferrerPolicy::NoReferrer);
    let request = Request::new_with_str_and_init(href, &options)?;
    JsFuture::from(window().fetch_with_request(&request))
        .await?
        .dyn_into()
}
