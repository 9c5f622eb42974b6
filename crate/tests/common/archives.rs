//! A small scene, its archive, what a reconstruction makes of it, and archives taken apart.

use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;
use snellius::export::ReconstructionResult;
use snellius::pipeline::{PipelineError, Settings, observe, reconstruct};
use snellius::scan::{Archive, ArchiveWriter};
use snellius::simulate::{Brightness, Scene, Simulation, Sweep, Truth, Turntable};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// A box in a tank of water, four rows of five stations; the laser is on the left.
pub fn scene() -> Scene {
    let scene = r#"
        name = "A box in a tank"
        seed = 1
        camera = { model = "opencv", width = 320, height = 240, fx = 480.0, fy = 479.5, cx = 161.2, cy = 118.3, distortion = [-0.11, 0.06, 0.0006, -0.0004, 0.0] }
        laser = { kind = "spot", origin = [-160.0, 3.0, 4.0], direction = [0.336, -0.006, 0.942] }
        flange_from_camera = { rotation = [0.7071, 0.0, 0.0, 0.7071], translation = [28.0, -41.5, 63.2] }
        vessel = { wall_thickness = 2.1, centre = [0.0, 0.0, 0.0], rotation = [-1.5, 2.0, 0.0], half_size = [200.0, 160.0] }
        media = { outside = 1.0, wall = 1.5, inside = 1.33 }

        [[object]]
        kind = "box"
        centre = [4.0, 0.0, 112.0]
        half = [50.0, 140.0, 50.0]
        rotation = [0.0, 45.0, 0.0]
    "#;
    let mut scene =
        Scene::from_toml(&format!("{scene}{}", rows(&[-60.0, -20.0, 20.0, 60.0]))).unwrap();
    scene.brightness.inner_face = 0.0;
    scene
}

/// A ball in a round jar, seen in two rows of stations by a rig that stands still: the turntable about the
/// vertical `axis` turns by `degrees` either way, and the jar stands in the world's origin at angle 0.
pub fn jar_on_a_turntable(axis: [f64; 3], heights: [f64; 2], degrees: f64, views: usize) -> Scene {
    let jar = r#"
        name = "A ball in a jar on a turntable"
        seed = 5
        camera = { model = "opencv", width = 320, height = 240, fx = 480.0, fy = 479.5, cx = 161.2, cy = 118.3, distortion = [-0.11, 0.06, 0.0006, -0.0004, 0.0] }
        laser = { kind = "spot", origin = [-160.0, 3.0, 4.0], direction = [0.336, -0.006, 0.942] }
        flange_from_camera = { rotation = [0.7071, 0.0, 0.0, 0.7071], translation = [28.0, -41.5, 63.2] }
        vessel = { shape = "cylinder", wall_thickness = 2.5, centre = [0.0, 0.0, 0.0], half_size = [75.0, 150.0], radius = 75.0 }
        media = { outside = 1.0, wall = 1.5, inside = 1.333 }
        sweep = []
        object = [{ kind = "sphere", centre = [6.0, 0.0, 4.0], radius = 30.0 }]
    "#;
    let mut scene = Scene::from_toml(jar).unwrap();
    scene.turntable = Some(Turntable {
        point: axis,
        axis: [0.0, 1.0, 0.0],
    });
    let row = |y: f64| Sweep {
        from: [0.0, y, -440.0],
        to: [0.0, y, -440.0],
        views,
        rotation: [0.0; 3],
        turn: [-degrees, degrees],
    };
    scene.sweeps = heights.map(row).to_vec();
    scene
}

/// Rows of five stations at these heights.
fn rows(heights: &[f64]) -> String {
    let row = |y: &f64| {
        format!("[[sweep]]\nfrom = [-70.0, {y}, -400.0]\nto = [30.0, {y}, -400.0]\nviews = 5\n")
    };
    heights.iter().map(row).collect()
}

/// Without the glow of the wall's inner face, which merges with the outer one's.
pub fn both_faces_glow() -> Brightness {
    Brightness::default()
}

/// A scan archive in memory, and what is true of it.
pub struct Simulated {
    pub archive: Vec<u8>,
    pub truth: Truth,
}

pub fn simulate(scene: Scene) -> Simulated {
    let simulation = Simulation::new(scene).unwrap();
    let mut writer = ArchiveWriter::new(Cursor::new(Vec::new()));
    for (view, entry) in simulation.manifest().views.iter().enumerate() {
        writer
            .add_pictures(entry, &simulation.pictures(view))
            .unwrap();
    }
    Simulated {
        archive: writer.finish(simulation.manifest()).unwrap().into_inner(),
        truth: simulation.truth(),
    }
}

pub fn measure(archive: &[u8]) -> Result<ReconstructionResult, PipelineError> {
    measure_with(archive, &Settings::default())
}

pub fn measure_with(
    archive: &[u8],
    settings: &Settings,
) -> Result<ReconstructionResult, PipelineError> {
    let mut archive = Archive::open(Cursor::new(archive))?;
    let views = 0..archive.scan().stations.len();
    let spots = views
        .map(|view| observe(&mut archive, view, settings))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(reconstruct(archive.scan(), &spots, settings)?.result())
}

/// The message with which an archive is refused.
#[track_caller]
pub fn refusal(archive: &[u8]) -> String {
    match measure(archive) {
        Ok(result) => panic!("measured: {}", result.to_json()),
        Err(error) => error.to_string(),
    }
}

/// The entries of an archive, taken apart to be changed and put together again.
#[derive(Clone)]
pub struct Entries(pub Vec<(String, Vec<u8>)>);

impl Entries {
    pub fn of(archive: &[u8]) -> Self {
        let mut zip = ZipArchive::new(Cursor::new(archive)).unwrap();
        let count = zip.len();
        let one = |index| {
            let mut entry = zip.by_index(index).unwrap();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).unwrap();
            (entry.name().unwrap().into_owned(), bytes)
        };
        Self((0..count).map(one).collect())
    }

    pub fn entry(&mut self, name: &str) -> &mut Vec<u8> {
        let found = self.0.iter_mut().find(|(n, _)| n == name);
        &mut found.expect("an entry of that name").1
    }

    pub fn without(mut self, name: &str) -> Self {
        self.0.retain(|(n, _)| n != name);
        self
    }

    pub fn manifest(&mut self) -> Value {
        serde_json::from_slice(self.entry("scan.json")).unwrap()
    }

    /// The same with the manifest changed.
    pub fn with_manifest(mut self, change: impl FnOnce(&mut Value)) -> Self {
        let mut manifest = self.manifest();
        change(&mut manifest);
        *self.entry("scan.json") = manifest.to_string().into_bytes();
        self
    }

    pub fn zipped(&self) -> Vec<u8> {
        self.zipped_by(CompressionMethod::Stored)
    }

    pub fn zipped_by(&self, method: CompressionMethod) -> Vec<u8> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in &self.0 {
            zip.start_file(
                name.as_str(),
                SimpleFileOptions::default().compression_method(method),
            )
            .unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.finish().unwrap().into_inner()
    }
}

/// A folder of its own, deleted in the end.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("snellius-test-{}-{count}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}
