//! Passing a reconstruction on, and opening what was passed on: links, one-file pages, archives elsewhere.

mod address;
mod arrival;
mod link;
mod one_file;
mod source;

use leptos::prelude::*;

pub(crate) use address::{follow as follow_address, forget as forget_address};
pub(crate) use arrival::open_file;

use self::link::LinkMaker;
use self::one_file::PageMaker;
use crate::run::About;
use crate::state::Workbench;

/// Links and one-file pages, in the section of what can be done with a result.
#[component]
pub(crate) fn PassOn() -> impl IntoView {
    view! {
        <LinkMaker />
        <PageMaker />
    }
}

/// Says of a reconstruction without its archive what it is.
#[component]
pub(crate) fn GuestNote() -> impl IntoView {
    let workbench = Workbench::get();
    move || {
        let About { notes, rounding } = workbench.guest.get()?;
        let came = match rounding {
            Some(rounding) => format!(
                "Opened from a link: the points are rounded by at most {} mm along each axis, which is less \
                 than their standard deviations.",
                link::rounded_up(rounding)
            ),
            None => "Opened from a file that was passed on.".to_owned(),
        };
        Some(view! {
            <section class="guest panel" data-testid="guest-note">
                <p>
                    {came} " Its pictures are not in it: to measure anew, open the scan's archive."
                </p>
                {(!notes.is_empty()).then(|| view! { <p class="guest-notes">{notes}</p> })}
            </section>
        })
    }
}
