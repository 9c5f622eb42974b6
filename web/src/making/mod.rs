//! Making a scan of pictures in the page, and opening a folder as if it were an archive. The files stay where
//! they are: a worker reads them once, and the archive is their bytes with a few others between.

mod arrival;
mod form;
mod state;
mod views;

use leptos::html;
use leptos::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_sys::{Blob, DataTransfer};

use self::arrival::{Arrived, Dropped, chosen};
pub(crate) use self::form::MakingScreen;
pub(crate) use self::state::Making;
use self::state::{Kind, by_turns, packed};
use crate::files;
use crate::run::{Hand, MakeRequest, Problem};
use crate::sessions::Origin;
use crate::share::open_file;
use crate::state::Workbench;

/// Opens what was dropped.
pub(crate) fn open_dropped(workbench: Workbench, data: &DataTransfer) {
    let dropped = Dropped::of(data);
    spawn_local(async move {
        match dropped.files().await {
            Ok(files) => open(workbench, files),
            Err(_) => workbench.fail(Problem::input(
                "The browser could not read what was dropped.",
                "Check that the folder may be read, and drop it again.",
            )),
        }
    });
}

/// Opens what was chosen in an input.
pub(crate) fn open_chosen(workbench: Workbench, input: NodeRef<html::Input>) {
    open(workbench, taken_from(input));
}

/// What was chosen in an input, which is emptied: choosing the same file again is to count as a choice.
fn taken_from(input: NodeRef<html::Input>) -> Vec<Arrived> {
    let Some(input) = input.get_untracked() else {
        return Vec::new();
    };
    let files = chosen(input.files().as_ref());
    input.set_value("");
    files
}

/// Opens files, whatever they are: an archive, a folder with a manifest, or what a scan is made of.
pub(crate) fn open(workbench: Workbench, mut files: Vec<Arrived>) {
    let making = workbench.making;
    let has = |kind: Kind| files.iter().any(|file| Kind::of(file.name()) == kind);
    let is_manifest = |file: &Arrived| file.name() == snellius::scan::MANIFEST_NAME;
    let is_for_the_form = files
        .iter()
        .any(|file| Kind::of(file.name()) != Kind::Other);
    match files.len() {
        0 => {}
        2.. if files.iter().any(is_manifest) => open_folder(workbench, files),
        _ if has(Kind::Picture) || (making.shown.get_untracked() && is_for_the_form) => {
            workbench.problem.set(None);
            making.take(files);
            making.show();
        }
        1 => {
            let Arrived { path, file } = files.remove(0);
            workbench.comes_by_address(false);
            open_file(workbench, file.into(), path);
        }
        many => workbench.fail(Problem::input(
            format!("{many} files, and neither pictures nor a scan.json among them."),
            "Choose one archive, a folder with scan.json and its pictures, or the pictures to make a scan of.",
        )),
    }
}

/// Opens a folder with a manifest.
fn open_folder(workbench: Workbench, files: Vec<Arrived>) {
    let open = move |archive, name| workbench.open(archive, name, Origin::Folder);
    pack_folder(workbench, files, Box::new(open));
}

/// Makes an archive of a folder that was chosen once more.
pub(crate) fn pack_chosen(
    workbench: Workbench,
    input: NodeRef<html::Input>,
    then: impl FnOnce(Blob, String) + 'static,
) {
    pack_folder(workbench, taken_from(input), Box::new(then));
}

/// Makes an archive of a folder with a manifest, and then does something with it and its name.
fn pack_folder(workbench: Workbench, files: Vec<Arrived>, then: Box<dyn FnOnce(Blob, String)>) {
    let name = files.first().and_then(|file| file.path.split_once('/'));
    let name = name.map_or("scan.json", |(folder, _)| folder).to_owned();
    let told = name.clone();
    let packed = async move {
        let hand = Hand::start().await?;
        let list = by_turns(files.iter().map(|file| (file.path.as_str(), &file.file)));
        packed(
            &hand,
            MakeRequest::PackFolder(list),
            reading(workbench, told),
        )
        .await
    };
    workbench.wait_for(name.clone(), packed, move |archive| then(archive, name));
}

/// Measures the scan that is being made. The form stays as it is until there is a result.
fn measure(workbench: Workbench) {
    let making = workbench.making;
    let name = making.file_name();
    let told = name.clone();
    let archive = async move { making.archive(reading(workbench, told)).await };
    workbench.wait_for(name.clone(), archive, move |archive| {
        workbench.open(archive, name, Origin::Pictures);
    });
}

/// Says how far the reading of the pictures is.
fn reading(workbench: Workbench, name: String) -> impl Fn([usize; 2]) {
    move |[done, files]| {
        workbench
            .file_name
            .set(format!("{name}: picture {} of {files}", done + 1));
    }
}

/// Saves the archive of the scan that is being made.
fn save(workbench: Workbench) {
    let making = workbench.making;
    if making.saving.get_untracked().is_some() {
        return;
    }
    making.saving.set(Some([0, 0]));
    spawn_local(async move {
        let archive = making.archive(|done| making.saving.set(Some(done))).await;
        making.saving.set(None);
        let saved = archive.and_then(|archive| {
            files::save_blob(&archive, &making.file_name())
                .map_err(|_| Problem::own("The browser did not save the archive."))
        });
        if let Err(problem) = saved {
            workbench.fail(problem);
        }
    });
}
