use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::{Failure, views};
use crate::scan::ArchiveWriter;
use crate::simulate::{Scene, SceneError, Simulation};

/// Arguments of `snellius simulate`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scene
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,
    /// The scan archive to write; the truth is written beside it as NAME.truth.json
    #[arg(long, short, value_name = "SCAN.zip")]
    output: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let in_scene = |error: SceneError| Failure::Scene {
        path: arguments.scene.clone(),
        error,
    };
    let text =
        fs::read_to_string(&arguments.scene).map_err(|e| Failure::file(&arguments.scene, e))?;
    let scene = Scene::from_toml(&text).map_err(in_scene)?;
    let simulation = Simulation::new(scene).map_err(in_scene)?;
    write_archive(&arguments.output, &simulation)?;
    let truth = arguments.output.with_extension("truth.json");
    fs::write(&truth, simulation.truth().to_json()).map_err(|e| Failure::file(&truth, e))
}

/// Renders a few views at a time on all cores and writes them in order, so that memory stays small.
fn write_archive(path: &Path, simulation: &Simulation) -> Result<(), Failure> {
    let fail = |e: &dyn std::fmt::Display| Failure::file(path, e);
    let file = File::create(path).map_err(|e| fail(&e))?;
    let mut archive = ArchiveWriter::new(BufWriter::new(file));
    let bar = views::progress_bar(simulation.views(), "views");
    let views: Vec<usize> = (0..simulation.views()).collect();
    for batch in views.chunks(2 * rayon::current_num_threads()) {
        let pictures: Vec<_> = batch
            .par_iter()
            .map(|view| simulation.pictures(*view))
            .collect();
        for (view, pair) in batch.iter().zip(&pictures) {
            let entry = &simulation.manifest().views[*view];
            archive.add_pictures(entry, pair).map_err(|e| fail(&e))?;
            bar.inc(1);
        }
    }
    archive
        .finish(simulation.manifest())
        .map_err(|e| fail(&e))?;
    bar.finish_and_clear();
    Ok(())
}
