//! A file that arrives: an archive to be measured, or a reconstruction that was passed on.

use wasm_bindgen_futures::JsFuture;
use web_sys::Blob;

use crate::sessions::Origin;
use crate::state::Workbench;

/// Opens a file, whatever it is: what it begins with says what it may be.
pub(crate) fn open_file(workbench: Workbench, file: Blob, name: String) {
    let looked_at = async move { Ok((first_letter(&file).await, file)) };
    workbench.wait_for(name.clone(), looked_at, move |(first, file)| match first {
        Some(b'<' | b'{') => {
            workbench.receive(name, async move |hand| hand.open_passed(file).await);
        }
        // Anything else is an archive, or the archive's reader says why it is none.
        _ => workbench.open(file, name, Origin::File),
    });
}

/// The first byte that is no white space, of the first few.
async fn first_letter(file: &Blob) -> Option<u8> {
    const FEW: i32 = 64;
    let few = file.slice_with_i32_and_i32(0, FEW).ok()?;
    let bytes = JsFuture::from(few.array_buffer()).await.ok()?;
    let bytes = js_sys::Uint8Array::new(&bytes).to_vec();
    let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes);
    text.iter()
        .copied()
        .find(|byte| !byte.is_ascii_whitespace())
}
