//! The last stroke of a build of the page. Trunk calls it (`[[hooks]]` in `Trunk.toml`) with the folder in which
//! it has put everything: the programs that are fetched later get a name of their content, like every other file, and the
//! service worker a list of what it must keep for a visit without a network.

use std::{
    collections::BTreeSet,
    env, fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};

/// What Trunk calls the programs that are fetched later and what the page asks for, and a style of their own.
const FETCHED_LATER: [(&str, Option<&str>); 2] =
    [("snellius-worker", None), ("snellius-lab", Some("lab.css"))];
const SERVICE_WORKER: &str = "service-worker.js";
/// What stands in the service worker for the list of files, and for the name of the build.
const FILES_MARK: &str = "[/* files */]";
const BUILD_MARK: &str = "/* build */";
/// What the service worker does not know of by name.
const NOT_LISTED: [&str; 2] = ["samples", SERVICE_WORKER];
/// Fetched when somebody makes a one-file page, and kept then, as samples are when somebody opens one.
const KEPT_LATER: [&str; 2] = ["viewer.html", "viewer.wasm"];

/// Finishes the page in the folder that Trunk names.
pub(crate) fn run() -> Result<()> {
    let folder = env::var_os("TRUNK_STAGING_DIR").map(PathBuf::from);
    finish(&folder.context("only Trunk calls this: TRUNK_STAGING_DIR is not set")?)
}

fn finish(folder: &Path) -> Result<()> {
    for (program, style) in FETCHED_LATER {
        name_by_content(folder, program, style)?;
    }
    list_files(folder)
}

/// A new build has new file names: no browser mixes a page with programs of another build.
fn name_by_content(folder: &Path, program: &str, style: Option<&str>) -> Result<()> {
    let code = [".js", "_bg.wasm"].map(|end| (end, folder.join(format!("{program}{end}"))));
    let style = style.map(|name| (".css", folder.join(name)));
    let parts: Vec<_> = code.into_iter().chain(style).collect();
    let mut hasher = DefaultHasher::new();
    for (_, path) in &parts {
        read(path)?.hash(&mut hasher);
    }
    let name = format!("{program}-{:016x}", hasher.finish());
    for (end, path) in parts {
        fs::rename(&path, folder.join(format!("{name}{end}")))?;
    }
    replace(
        &folder.join("index.html"),
        &format!("content=\"{program}\""),
        &format!("content=\"{name}\""),
    )
}

fn list_files(folder: &Path) -> Result<()> {
    let mut files = BTreeSet::new();
    let mut hasher = DefaultHasher::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if !NOT_LISTED.contains(&name.as_str()) && entry.file_type()?.is_file() {
            files.insert(name);
        }
    }
    for name in &files {
        (name, read(&folder.join(name))?).hash(&mut hasher);
    }
    files.retain(|name| !KEPT_LATER.contains(&name.as_str()));
    let script = folder.join(SERVICE_WORKER);
    replace(&script, FILES_MARK, &serde_json::to_string(&files)?)?;
    replace(&script, BUILD_MARK, &format!("{:016x}", hasher.finish()))
}

fn replace(path: &Path, mark: &str, by: &str) -> Result<()> {
    let text = String::from_utf8(read(path)?).with_context(|| path.display().to_string())?;
    ensure!(
        text.contains(mark),
        "{} does not hold {mark:?}",
        path.display()
    );
    fs::write(path, text.replace(mark, by))?;
    Ok(())
}

fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).with_context(|| format!("cannot read {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A page as Trunk leaves it, in a folder of the test's own.
    fn built(name: &str, code: &str) -> PathBuf {
        let folder = env::temp_dir().join(format!("snellius-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("samples")).unwrap();
        let files = [
            (
                "index.html",
                "<meta content=\"snellius-worker\" /><meta content=\"snellius-lab\" />",
            ),
            ("snellius-worker.js", "script"),
            ("snellius-worker_bg.wasm", code),
            ("snellius-lab.js", "script"),
            ("snellius-lab_bg.wasm", code),
            ("lab.css", "style"),
            (
                SERVICE_WORKER,
                "const FILES = [/* files */], BUILD = \"/* build */\";",
            ),
            ("samples/a.zip", "a"),
        ];
        for (file, text) in files {
            fs::write(folder.join(file), text).unwrap();
        }
        folder
    }

    fn finished(name: &str, code: &str) -> (String, String) {
        let folder = built(name, code);
        finish(&folder).unwrap();
        let text = |file: &str| fs::read_to_string(folder.join(file)).unwrap();
        let texts = (text("index.html"), text(SERVICE_WORKER));
        fs::remove_dir_all(folder).unwrap();
        texts
    }

    #[test]
    fn the_page_and_the_list_name_the_later_programs_by_their_content() {
        let (index, service) = finished("finish", "code");
        let names: Vec<_> = index.split('"').skip(1).step_by(2).collect();
        assert_eq!(names.len(), FETCHED_LATER.len());
        for (name, (program, style)) in names.iter().zip(FETCHED_LATER) {
            assert_eq!(name.len(), program.len() + "-0123456789abcdef".len());
            let ends = ["_bg.wasm", ".js"].into_iter().chain(style.map(|_| ".css"));
            for end in ends {
                assert!(service.contains(&format!("\"{name}{end}\"")), "{service}");
            }
        }
        assert!(!service.contains("samples"), "{service}");
        let (other, _) = finished("finish-other", "other code");
        assert_ne!(index, other);
    }

    #[test]
    fn a_page_without_a_place_for_the_name_is_an_error() {
        let folder = built("finish-nameless", "code");
        fs::write(folder.join("index.html"), "<html>").unwrap();
        let error = finish(&folder).unwrap_err().to_string();
        fs::remove_dir_all(folder).unwrap();
        assert!(error.contains("index.html"), "{error}");
    }
}
