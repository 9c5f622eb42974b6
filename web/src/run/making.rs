//! Making a scan: what the page asks of a worker, which reads and packs, and how that answers.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufReader, Read};
use std::ops::Range;

use js_sys::Array;
use serde::{Deserialize, Serialize};
use snellius::compose::{
    Answers, Composed, Draft, Key, Packer, Pair, Part, Piece, QUESTIONS, Question, QuestionKind,
    picture_size,
};
use snellius::scan::{MANIFEST_NAME, Manifest, Picture, WriteError};
use wasm_bindgen::prelude::*;
use web_sys::{Blob, FileReaderSync};

use super::blob_reader::BlobReader;
use super::develop::thumbnails;
use super::messages::Thumbnail;
use super::problem::Problem;

/// How much of a picture is read at a time.
const READ_AHEAD: usize = 1 << 20;

/// How many pictures without a partner are listed.
const LISTED: usize = 500;

/// What a worker can be asked.
#[derive(Serialize, Deserialize)]
pub(crate) enum MakeRequest {
    /// Take these files: pictures (path and file by turns), a calibration and poses, if there are any.
    /// Answered by `Done`.
    Gather {
        #[serde(with = "serde_wasm_bindgen::preserve")]
        pictures: Array,
        #[serde(with = "serde_wasm_bindgen::preserve")]
        calibration: JsValue,
        #[serde(with = "serde_wasm_bindgen::preserve")]
        poses: JsValue,
    },
    /// Say what is missing with these answers. Answered by `Drafted`.
    Draft(BTreeMap<String, String>),
    /// Tell some of the views that were drafted last. Answered by `Views`.
    Views(Range<usize>),
    /// Decode two of the pictures, small: with the laser on, and with it off. Answered by `Thumbnails`.
    Thumbnails { on: String, off: Option<String> },
    /// Begin to pack what was drafted last. Answered by `ToDo`.
    Pack,
    /// Begin to pack a folder with a manifest: path and file by turns. Answered by `ToDo`.
    PackFolder(#[serde(with = "serde_wasm_bindgen::preserve")] Array),
    /// Pack the next file. Answered by `Done`.
    Next,
    /// Give the archive. Answered by `Archive`.
    Close,
}

/// What it answers.
#[derive(Serialize, Deserialize)]
pub(crate) enum MakeReply {
    Done,
    Drafted(Box<Drafted>),
    Views(Vec<ViewShown>),
    Thumbnails(Thumbnail, Option<Thumbnail>),
    /// How many files there are to be packed.
    ToDo(usize),
    Archive(#[serde(with = "serde_wasm_bindgen::preserve")] Blob),
}

/// A draft as it is shown.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Drafted {
    pub(crate) parts: Vec<PartShown>,
    /// How many views the pictures make.
    pub(crate) view_count: usize,
    /// The first few hundred pictures without a partner, and what each lacks.
    pub(crate) unpaired: Vec<[String; 2]>,
    /// The question whose answer tells the views in air, if it is asked.
    pub(crate) asks_air: Option<String>,
    pub(crate) ready: bool,
}

/// The pictures of a view.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) struct ViewShown {
    pub(crate) id: String,
    pub(crate) on: String,
    pub(crate) off: Option<String>,
}

impl ViewShown {
    fn of(view: &Pair) -> Self {
        Self {
            id: view.id.clone(),
            on: view.on.clone(),
            off: view.off.clone(),
        }
    }
}

/// A part of the form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PartShown {
    pub(crate) id: String,
    pub(crate) title: String,
    /// What its file says.
    pub(crate) found: String,
    pub(crate) questions: Vec<QuestionShown>,
    /// What it lacks.
    pub(crate) gaps: Vec<String>,
    /// What opens it, if it may be left as it is.
    pub(crate) invitation: Option<String>,
}

/// A question of the form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct QuestionShown {
    pub(crate) id: String,
    pub(crate) label: String,
    pub(crate) unit: String,
    pub(crate) meaning: String,
    pub(crate) initial: String,
    /// Words and what they mean, if it is a choice.
    pub(crate) options: Vec<(String, String)>,
    /// How many numbers are wanted; 0 for a text.
    pub(crate) numbers: usize,
}

impl QuestionShown {
    fn of(question: &Question) -> Self {
        let (options, numbers) = match question.kind {
            QuestionKind::Choice(options) => (options, 0),
            QuestionKind::Numbers(count) => (&[][..], count),
            QuestionKind::Optional => (&[][..], 1),
            QuestionKind::Text => (&[][..], 0),
        };
        let options = options.iter();
        Self {
            id: question.id.to_owned(),
            label: question.label.to_owned(),
            unit: question.unit.to_owned(),
            meaning: question.meaning.to_owned(),
            initial: question.initial.to_owned(),
            options: options
                .map(|(word, name)| ((*word).to_owned(), (*name).to_owned()))
                .collect(),
            numbers,
        }
    }
}

impl Drafted {
    fn of(composed: &Composed) -> Self {
        let parts = Part::ALL.map(|part| {
            let questions = QUESTIONS
                .iter()
                .filter(|question| question.part == part && composed.asked.contains(&question.key));
            let gaps = composed.gaps.iter().filter(|gap| gap.part == part);
            PartShown {
                id: part.id().to_owned(),
                title: part.title().to_owned(),
                found: found(composed, part),
                questions: questions.map(QuestionShown::of).collect(),
                gaps: gaps.map(|gap| gap.sentence.clone()).collect(),
                invitation: part.invitation().map(str::to_owned),
            }
        });
        let unpaired = composed.pairing.unpaired.iter().take(LISTED);
        Self {
            parts: parts.to_vec(),
            view_count: composed.views.len(),
            unpaired: unpaired
                .map(|one| [one.picture.clone(), one.lack.to_string()])
                .collect(),
            asks_air: composed
                .asked
                .contains(&Key::InAir)
                .then(|| Key::InAir.question().id.to_owned()),
            ready: composed.manifest.is_some(),
        }
    }
}

/// What a part's files say, in a few words.
fn found(composed: &Composed, part: Part) -> String {
    match part {
        Part::Pictures => match composed.pairing.pairs.len() {
            0 => String::new(),
            1 => "1 pair".to_owned(),
            pairs => format!("{pairs} pairs"),
        },
        Part::Camera => composed.lens.as_ref().map_or_else(String::new, |lens| {
            let [fx, fy] = lens.focal;
            let [cx, cy] = lens.centre;
            let coefficients = lens.distortion.len();
            format!(
                "fx {fx:.1}, fy {fy:.1}, cx {cx:.1}, cy {cy:.1} px; {coefficients} distortion coefficients"
            )
        }),
        Part::Poses => match composed.poses {
            None => String::new(),
            Some(1) => "1 pose".to_owned(),
            Some(poses) => format!("{poses} poses"),
        },
        _ => String::new(),
    }
}

/// The worker's desk for it.
#[derive(Default)]
pub(super) struct Maker {
    files: Files,
    draft: Draft,
    views: Vec<Pair>,
    manifest: Option<Manifest>,
    packing: Option<Packing>,
}

/// Files by their paths.
type Files = BTreeMap<String, Blob>;

/// An archive under way.
struct Packing {
    packer: Packer,
    manifest: Vec<u8>,
    files: Vec<(String, Blob)>,
    packed: usize,
}

impl Maker {
    pub(super) fn reply(&mut self, request: MakeRequest) -> Result<MakeReply, Problem> {
        match request {
            MakeRequest::Gather {
                pictures,
                calibration,
                poses,
            } => {
                self.files = files(&pictures);
                self.draft.pictures = self.files.keys().cloned().collect();
                self.draft.picture_size = self.files.values().next().and_then(size_of);
                self.draft.calibration = text(&calibration)?;
                self.draft.poses = text(&poses)?;
                Ok(MakeReply::Done)
            }
            MakeRequest::Draft(answers) => {
                self.draft.answers = Answers::new(answers);
                let composed = self.draft.compose();
                let drafted = Drafted::of(&composed);
                self.views = composed.views;
                self.manifest = composed.manifest;
                Ok(MakeReply::Drafted(Box::new(drafted)))
            }
            MakeRequest::Views(wanted) => {
                let views = self.views.get(wanted).unwrap_or_default();
                Ok(MakeReply::Views(views.iter().map(ViewShown::of).collect()))
            }
            MakeRequest::Thumbnails { on, off } => {
                let on = self.picture(&on)?;
                let off = off.map(|off| self.picture(&off)).transpose()?;
                let (on, off) = thumbnails(&on, off.as_ref());
                Ok(MakeReply::Thumbnails(on, off))
            }
            MakeRequest::Pack => {
                let manifest = self.manifest.as_ref().ok_or_else(out_of_order)?;
                let written = serde_json::to_vec_pretty(manifest);
                let written = written.map_err(|e| Problem::own(e.to_string()))?;
                let packing = Packing::of(manifest, written, &self.files, "");
                Ok(self.begin(packing))
            }
            MakeRequest::PackFolder(pictures) => {
                let packing = of_folder(&files(&pictures))?;
                Ok(self.begin(packing))
            }
            MakeRequest::Next => {
                self.packing.as_mut().ok_or_else(out_of_order)?.next()?;
                Ok(MakeReply::Done)
            }
            MakeRequest::Close => {
                let packing = self.packing.take().ok_or_else(out_of_order)?;
                packing.archive().map(MakeReply::Archive)
            }
        }
    }

    fn picture(&self, name: &str) -> Result<Picture, Problem> {
        let file = self.files.get(name).ok_or_else(out_of_order)?;
        let broken = |why: String| Problem::input(format!("{name}: {why}."), "Choose it again.");
        let [width, height] = size_of(file).ok_or_else(|| broken("no picture".to_owned()))?;
        let mut bytes = Vec::new();
        let read = reader(file)?.read_to_end(&mut bytes);
        read.map_err(|error| broken(error.to_string()))?;
        Picture::decode(&bytes, width, height).map_err(|error| broken(error.to_string()))
    }

    fn begin(&mut self, packing: Packing) -> MakeReply {
        let files = packing.files.len();
        self.packing = Some(packing);
        MakeReply::ToDo(files)
    }
}

impl Packing {
    /// The pictures that a manifest names, as far as they are there: of those that are not, whoever opens
    /// the archive says where they are missing.
    fn of(manifest: &Manifest, written: Vec<u8>, files: &Files, folder: &str) -> Self {
        let views = manifest.views.iter();
        let mut names = BTreeSet::<&String>::new();
        names.extend(views.flat_map(|view| view.off.iter().chain([&view.on])));
        let there = names.into_iter().filter_map(|name| {
            let file = files.get(&format!("{folder}{name}"))?;
            Some((name.clone(), file.clone()))
        });
        Self {
            packer: Packer::new(),
            manifest: written,
            files: there.collect(),
            packed: 0,
        }
    }

    fn next(&mut self) -> Result<(), Problem> {
        let (name, file) = self.files.get(self.packed).ok_or_else(out_of_order)?;
        let mut reader = reader(file)?;
        let length = file.size() as u64;
        self.packer
            .add(name, length, &mut reader)
            .map_err(unpacked)?;
        self.packed += 1;
        Ok(())
    }

    /// The archive; its pictures stay where they are.
    fn archive(self) -> Result<Blob, Problem> {
        let pieces = self.packer.finish_with(&self.manifest).map_err(unpacked)?;
        let parts = Array::new();
        for piece in pieces {
            match piece {
                Piece::Bytes(bytes) => parts.push(&js_sys::Uint8Array::from(bytes.as_slice())),
                Piece::File(number) => parts.push(&self.files[number].1),
            };
        }
        Blob::new_with_blob_sequence(&parts)
            .map_err(|_| Problem::own("The browser could not join the parts of the file."))
    }
}

/// A folder's manifest is the outermost one; pictures are named from where it lies.
fn of_folder(files: &Files) -> Result<Packing, Problem> {
    let is_manifest = |path: &&String| path.rsplit('/').next() == Some(MANIFEST_NAME);
    let manifests = files.keys().filter(is_manifest);
    let path = manifests.min_by_key(|path| path.matches('/').count());
    let path = path.ok_or_else(out_of_order)?;
    let folder = &path[..path.len() - MANIFEST_NAME.len()];
    let written = text(&files[path])?.unwrap_or_default().into_bytes();
    let manifest = Manifest::from_json(&written)?;
    Ok(Packing::of(&manifest, written, files, folder))
}

/// Path and file by turns.
fn files(list: &Array) -> Files {
    let list: Vec<JsValue> = list.iter().collect();
    let pairs = list.chunks_exact(2);
    let mut files = Files::new();
    files.extend(pairs.filter_map(|pair| {
        let file = pair[1].dyn_ref::<Blob>()?;
        Some((pair[0].as_string()?, file.clone()))
    }));
    files
}

fn reader(file: &Blob) -> Result<BufReader<BlobReader>, Problem> {
    let reader = BlobReader::new(file.clone())
        .map_err(|e| Problem::own(format!("The browser gives no file reader: {e:?}")))?;
    Ok(BufReader::with_capacity(READ_AHEAD, reader))
}

fn size_of(file: &Blob) -> Option<[u32; 2]> {
    picture_size(reader(file).ok()?)
}

/// A file's text, if there is a file.
fn text(file: &JsValue) -> Result<Option<String>, Problem> {
    const MOST: f64 = (64 << 20) as f64;
    let Some(file) = file.dyn_ref::<Blob>() else {
        return Ok(None);
    };
    if file.size() > MOST {
        return Err(Problem::input(
            "This text is larger than 64 MB.",
            "Choose the file with the calibration, or with the poses.",
        ));
    }
    let read = FileReaderSync::new().and_then(|reader| reader.read_as_text(file));
    read.map(Some).map_err(|_| {
        Problem::input(
            "The browser can no longer read a file: it was changed or moved.",
            "Choose it again.",
        )
    })
}

fn unpacked(error: WriteError) -> Problem {
    Problem::input(
        format!("A picture cannot be packed: {error}."),
        "Check the picture, and choose it again.",
    )
}

fn out_of_order() -> Problem {
    Problem::own("A worker was asked to pack before it had what belongs into the archive.")
}
