use std::io::{Read, Seek};

use zip::ZipArchive;
use zip::result::ZipError;

use super::append::{Tail, append};
use super::{Limits, Manifest, Picture, PicturePair, Place, Scan, ScanError};

/// The manifest's name within an archive.
pub const MANIFEST_NAME: &str = "scan.json";
/// How the names of notes begin that are no part of the scan.
const SESSION_NAME: &str = "session-";

/// A scan archive, read as needed: opening it reads the ZIP's central directory and the manifest, and
/// each view's pictures are read when asked for. The archive may be larger than memory.
#[derive(Debug)]
pub struct Archive<R> {
    zip: ZipArchive<R>,
    /// `""` or the only top-level folder with its slash.
    folder: String,
    scan: Scan,
    limits: Limits,
}

impl<R: Read + Seek> Archive<R> {
    /// Opens an archive and checks its manifest. The pictures are not touched, but their entries must
    /// be there.
    pub fn open(reader: R) -> Result<Self, ScanError> {
        let mut zip = ZipArchive::new(reader).map_err(|e| ScanError::NotAnArchive {
            problem: e.to_string(),
        })?;
        let folder = manifest_folder(&zip)?;
        let limits = Limits::default();
        let json = read_entry(
            &mut zip,
            &format!("{folder}{MANIFEST_NAME}"),
            MANIFEST_NAME,
            &Place::key(MANIFEST_NAME),
            limits.manifest_bytes,
        )?;
        let scan = Scan::new(Manifest::from_json(&json)?)?;
        let archive = Self {
            zip,
            folder,
            scan,
            limits,
        };
        archive.check_entries()?;
        Ok(archive)
    }

    /// What the archive holds.
    pub const fn scan(&self) -> &Scan {
        &self.scan
    }

    /// Reads and decodes the pictures of a view.
    ///
    /// # Panics
    ///
    /// If `view` is not below the number of the scan's stations.
    pub fn pictures(&mut self, view: usize) -> Result<PicturePair, ScanError> {
        let entry = self.scan.manifest.views[view].clone();
        let on = self.picture(&entry.on, Place::view(view, "on"))?;
        let off = entry
            .off
            .map(|name| self.picture(&name, Place::view(view, "off")))
            .transpose()?;
        Ok(PicturePair { on, off })
    }

    /// What was added last with [`Archive::with_session`], if anything was.
    pub fn session(&mut self) -> Option<String> {
        let path = self.sessions().max()?;
        let place = Place::key(SESSION_NAME);
        let limit = self.limits.manifest_bytes;
        let text = read_entry(&mut self.zip, &path, SESSION_NAME, &place, limit);
        String::from_utf8(text.ok()?).ok()
    }

    /// The archive with a note of how it is being measured, which is no part of the scan: an entry
    /// `session-NNNN.json` beside the manifest, numbered upwards. Readers of scans pass it over.
    pub fn with_session(self, note: &str) -> Result<Tail, ScanError> {
        let name = format!(
            "{}{SESSION_NAME}{:04}.json",
            self.folder,
            self.sessions().count()
        );
        let reader = self.zip.into_inner();
        append(reader, &name, note.as_bytes()).map_err(|e| ScanError::NotAnArchive {
            problem: e.to_string(),
        })
    }

    fn sessions(&self) -> impl Iterator<Item = String> {
        let start = format!("{}{SESSION_NAME}", self.folder);
        let names = self.zip.file_names().filter_map(Result::ok);
        names
            .filter(move |name| name.starts_with(&start))
            .map(Into::into)
    }

    fn picture(&mut self, name: &str, place: Place) -> Result<Picture, ScanError> {
        let path = format!("{}{name}", self.folder);
        let bytes = read_entry(
            &mut self.zip,
            &path,
            name,
            &place,
            self.limits.picture_bytes,
        )?;
        let camera = &self.scan.manifest.camera;
        Picture::decode(&bytes, camera.width, camera.height).map_err(|problem| ScanError::Entry {
            place,
            name: name.to_owned(),
            problem: problem.to_string(),
        })
    }

    fn check_entries(&self) -> Result<(), ScanError> {
        for (view, entry) in self.scan.manifest.views.iter().enumerate() {
            let named = [("on", Some(&entry.on)), ("off", entry.off.as_ref())];
            for (key, name) in named.into_iter().filter_map(|(k, n)| n.map(|n| (k, n))) {
                let path = format!("{}{name}", self.folder);
                if self.zip.index_for_name(&path).is_none() {
                    return Err(ScanError::NoEntry {
                        place: Place::view(view, key),
                        name: name.clone(),
                    });
                }
            }
        }
        Ok(())
    }
}

/// Where the manifest lies: at the root, or in the folder that holds everything else.
fn manifest_folder<R: Read + Seek>(zip: &ZipArchive<R>) -> Result<String, ScanError> {
    if zip.index_for_name(MANIFEST_NAME).is_some() {
        return Ok(String::new());
    }
    // Names that are no text cannot be named by a manifest either.
    let names = || zip.file_names().filter_map(Result::ok);
    let missing = || ScanError::NoManifest {
        entries: zip.len(),
        first: names().next().map(Into::into),
    };
    // Folders that a macOS archiver adds by itself are not the scan's.
    let mut own = names().filter(|name| !name.starts_with("__MACOSX/"));
    let top = own
        .next()
        .and_then(|first| first.split_once('/').map(|(top, _)| format!("{top}/")))
        .ok_or_else(missing)?;
    let only = own.all(|name| name.starts_with(&top));
    let there = zip
        .index_for_name(&format!("{top}{MANIFEST_NAME}"))
        .is_some();
    if only && there {
        Ok(top)
    } else {
        Err(missing())
    }
}

fn read_entry<R: Read + Seek>(
    zip: &mut ZipArchive<R>,
    path: &str,
    name: &str,
    place: &Place,
    limit: u64,
) -> Result<Vec<u8>, ScanError> {
    let fail = |problem: String| ScanError::Entry {
        place: place.clone(),
        name: name.to_owned(),
        problem,
    };
    let entry = zip.by_name(path).map_err(|e| match e {
        ZipError::FileNotFound => ScanError::NoEntry {
            place: place.clone(),
            name: name.to_owned(),
        },
        other => fail(other.to_string()),
    })?;
    let too_big = || fail(format!("larger than {} MB", limit >> 20));
    // The directory may lie about the size, so the bytes are counted as well.
    if entry.size() > limit {
        return Err(too_big());
    }
    let mut bytes = Vec::with_capacity(entry.size() as usize);
    let read = entry
        .take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| fail(e.to_string()))?;
    if read as u64 > limit {
        return Err(too_big());
    }
    Ok(bytes)
}
