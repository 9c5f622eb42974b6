//! Sessions: what is being measured is kept in the browser's own file system, and goes on where it was when
//! the page is opened again, whatever ended it.
//!
//! | file | what it does |
//! |---|---|
//! | `folder.rs` | files in the browser |
//! | `record.rs` | what is written down of a session |
//! | `session.rs` | one session's files |
//! | `keeping.rs` | writes down whatever is new, by itself |
//! | `not_kept.rs` | says what cannot be kept |
//! | `shelf.rs` | the list on the start screen |

mod folder;
mod keeping;
mod not_kept;
mod record;
mod session;
mod shelf;

pub(crate) use keeping::Keeping;
pub(crate) use not_kept::NotKeptNote;
pub(crate) use record::{Found, HowFar, Origin, Record};
pub(crate) use session::Session;
pub(crate) use shelf::{Shelf, sweep};
