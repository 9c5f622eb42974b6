//! Folders and files of the browser's own file system (OPFS), which belongs to this page alone.

use js_sys::Uint8Array;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    Blob, File, FileSystemDirectoryHandle, FileSystemFileHandle, FileSystemGetDirectoryOptions,
    FileSystemGetFileOptions, FileSystemRemoveOptions, FileSystemWritableFileStream,
    StorageEstimate,
};

/// How much more may be written, bytes, as far as the browser says it.
pub(super) async fn room() -> Option<f64> {
    let estimate = web_sys::window()?.navigator().storage().estimate().ok()?;
    let estimate: StorageEstimate = JsFuture::from(estimate).await.ok()?.unchecked_into();
    Some(estimate.get_quota()? - estimate.get_usage()?)
}

/// A folder.
#[derive(Clone)]
pub(super) struct Folder(FileSystemDirectoryHandle);

impl Folder {
    /// The page's outermost folder; an error where the browser keeps nothing (in a private window, say).
    pub(super) async fn outermost() -> Result<Self, JsValue> {
        let window = web_sys::window().ok_or("no window")?;
        let storage = js_sys::Reflect::get(&window.navigator(), &"storage".into())?;
        if storage.is_undefined() {
            return Err("this browser keeps no files".into());
        }
        let root = JsFuture::from(window.navigator().storage().get_directory()).await?;
        Ok(Self(root.unchecked_into()))
    }

    /// A folder in it, made if it is not there.
    pub(super) async fn folder(&self, name: &str) -> Result<Self, JsValue> {
        let create = FileSystemGetDirectoryOptions::new();
        create.set_create(true);
        let folder = self.0.get_directory_handle_with_options(name, &create);
        Ok(Self(JsFuture::from(folder).await?.unchecked_into()))
    }

    /// What lies in it, in the order of the names.
    pub(super) async fn names(&self) -> Result<Vec<String>, JsValue> {
        let mut names = Vec::new();
        let keys = self.0.keys();
        loop {
            let next: js_sys::IteratorNext = JsFuture::from(keys.next()?).await?.unchecked_into();
            if next.done() {
                names.sort();
                return Ok(names);
            }
            names.extend(next.value().as_string());
        }
    }

    /// A file in it.
    pub(super) async fn file(&self, name: &str) -> Result<File, JsValue> {
        let handle = JsFuture::from(self.0.get_file_handle(name)).await?;
        let handle: FileSystemFileHandle = handle.unchecked_into();
        Ok(JsFuture::from(handle.get_file()).await?.unchecked_into())
    }

    /// A file's text.
    pub(super) async fn text(&self, name: &str) -> Result<String, JsValue> {
        let text = JsFuture::from(self.file(name).await?.text()).await?;
        text.as_string().ok_or_else(|| "no text".into())
    }

    /// A file's bytes.
    pub(super) async fn bytes(&self, name: &str) -> Result<Uint8Array, JsValue> {
        let bytes = JsFuture::from(self.file(name).await?.array_buffer()).await?;
        Ok(Uint8Array::new(&bytes))
    }

    /// Writes a file. Until it is whole, what was there before stays.
    pub(super) async fn write(&self, name: &str, content: &Blob) -> Result<(), JsValue> {
        let create = FileSystemGetFileOptions::new();
        create.set_create(true);
        let handle = JsFuture::from(self.0.get_file_handle_with_options(name, &create)).await?;
        let handle: FileSystemFileHandle = handle.unchecked_into();
        let stream = JsFuture::from(handle.create_writable()).await?;
        let stream: FileSystemWritableFileStream = stream.unchecked_into();
        JsFuture::from(stream.write_with_blob(content)?).await?;
        JsFuture::from(stream.close()).await?;
        Ok(())
    }

    /// Writes a file of text.
    pub(super) async fn write_text(&self, name: &str, text: &str) -> Result<(), JsValue> {
        let content = Blob::new_with_str_sequence(&js_sys::Array::of1(&text.into()))?;
        self.write(name, &content).await
    }

    /// Removes a file, or a folder with all that lies in it.
    pub(super) async fn remove(&self, name: &str) -> Result<(), JsValue> {
        let all = FileSystemRemoveOptions::new();
        all.set_recursive(true);
        JsFuture::from(self.0.remove_entry_with_options(name, &all)).await?;
        Ok(())
    }
}
