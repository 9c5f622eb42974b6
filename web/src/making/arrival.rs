//! Files that arrive many at once: chosen, dropped, or in folders.

use js_sys::{Array, Function, Promise, Reflect};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    DataTransfer, File, FileList, FileSystemDirectoryEntry, FileSystemEntry, FileSystemFileEntry,
};

/// A file and its path within what was chosen or dropped.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arrived {
    pub(crate) path: String,
    pub(crate) file: File,
}

impl Arrived {
    /// Its name without its folders.
    pub(super) fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or(&self.path)
    }
}

/// The files that were chosen; those of a folder have paths.
pub(crate) fn chosen(list: Option<&FileList>) -> Vec<Arrived> {
    let count = list.map_or(0, FileList::length);
    let files = (0..count).filter_map(|index| list?.get(index));
    files
        .map(|file| {
            let path = Reflect::get(&file, &"webkitRelativePath".into());
            let path = path.ok().and_then(|path| path.as_string());
            Arrived {
                path: path
                    .filter(|path| !path.is_empty())
                    .unwrap_or_else(|| file.name()),
                file,
            }
        })
        .collect()
}

/// What is dropped: to be asked for while the browser tells of it, to be read afterwards.
pub(crate) struct Dropped {
    files: Vec<Arrived>,
    folders: Vec<FileSystemEntry>,
}

impl Dropped {
    pub(crate) fn of(data: &DataTransfer) -> Self {
        let items = data.items();
        let entries = (0..items.length()).filter_map(|index| items.get(index));
        let entries: Vec<FileSystemEntry> = entries
            .filter_map(|item| item.webkit_get_as_entry().ok().flatten())
            .collect();
        if !entries.iter().any(FileSystemEntry::is_directory) {
            return Self {
                files: chosen(data.files().as_ref()),
                folders: Vec::new(),
            };
        }
        Self {
            files: Vec::new(),
            folders: entries,
        }
    }

    /// All files, those in folders too.
    pub(crate) async fn files(self) -> Result<Vec<Arrived>, JsValue> {
        let Self {
            mut files,
            folders: mut open,
        } = self;
        while let Some(entry) = open.pop() {
            if entry.is_directory() {
                open.extend(within(&entry.unchecked_into()).await?);
            } else {
                let path = entry.full_path().trim_start_matches('/').to_owned();
                let entry: FileSystemFileEntry = entry.unchecked_into();
                let file = called_back(|done, failed| {
                    entry.file_with_callback_and_callback(done, failed);
                    Ok(())
                });
                files.push(Arrived {
                    path,
                    file: file.await?.unchecked_into(),
                });
            }
        }
        Ok(files)
    }
}

/// What lies in a folder. A browser gives a hundred entries or so at a time, and none at the end.
async fn within(folder: &FileSystemDirectoryEntry) -> Result<Vec<FileSystemEntry>, JsValue> {
    let reader = folder.create_reader();
    let mut entries = Vec::new();
    loop {
        let some = called_back(|done, failed| {
            reader.read_entries_with_callback_and_callback(done, failed)
        });
        let some: Array = some.await?.unchecked_into();
        if some.length() == 0 {
            return Ok(entries);
        }
        entries.extend(some.iter().map(JsCast::unchecked_into));
    }
}

/// Waits for a function that calls back.
async fn called_back(
    call: impl Fn(&Function, &Function) -> Result<(), JsValue>,
) -> Result<JsValue, JsValue> {
    let promise = Promise::new(&mut |done, failed| {
        if let Err(error) = call(&done, &failed) {
            let _ = failed.call1(&JsValue::NULL, &error);
        }
    });
    JsFuture::from(promise).await
}
