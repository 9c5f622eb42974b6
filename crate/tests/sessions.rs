//! A note beside a scan: the archive stays the scan that it was, and the note is found again.

use std::io::Cursor;
use std::path::Path;

use snellius::scan::Archive;

fn sample() -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../samples/tank-paper.zip");
    std::fs::read(path).unwrap()
}

fn opened(bytes: &[u8]) -> Archive<Cursor<&[u8]>> {
    Archive::open(Cursor::new(bytes)).unwrap()
}

fn with_note(bytes: &[u8], note: &str) -> Vec<u8> {
    let tail = opened(bytes).with_session(note).unwrap();
    [&bytes[..tail.keep as usize], &tail.bytes].concat()
}

#[test]
fn a_note_is_found_again_and_the_scan_is_unchanged() {
    let bytes = sample();
    assert_eq!(opened(&bytes).session(), None);
    let noted = with_note(&bytes, "{\"n\":1}");
    let (mut before, mut after) = (opened(&bytes), opened(&noted));
    assert_eq!(after.session().as_deref(), Some("{\"n\":1}"));
    assert_eq!(after.scan(), before.scan());
    assert_eq!(after.pictures(3).unwrap(), before.pictures(3).unwrap());
}

#[test]
fn the_last_note_counts() {
    let once = with_note(&sample(), "first");
    let twice = with_note(&once, "second");
    assert_eq!(opened(&twice).session().as_deref(), Some("second"));
    // A note and a directory more, and nothing of the pictures.
    let more = twice.len() - once.len();
    assert!(more < 10_000, "{more} bytes more");
}
