//! What a person says of a spot is done, and everything after it follows.

use std::fs::File;
use std::io::BufReader;

use snellius::export::{Status, ViewResult};
use snellius::pipeline::{Correction, Settings, correct, observe, reconstruct};
use snellius::scan::{Archive, Scan};
use snellius::spots::{SpotRole, Spots};

const VIEW: usize = 13;

fn jar() -> (Scan, Vec<Spots>) {
    sample("jar.zip")
}

fn sample(name: &str) -> (Scan, Vec<Spots>) {
    let path = format!("{}/../samples/{name}", env!("CARGO_MANIFEST_DIR"));
    let mut archive = Archive::open(BufReader::new(File::open(path).unwrap())).unwrap();
    let views = 0..archive.scan().stations.len();
    let spots = views.map(|view| observe(&mut archive, view, &Settings::default()).unwrap());
    let spots = spots.collect();
    (archive.scan().clone(), spots)
}

fn measured(scan: &Scan, spots: &[Spots]) -> Vec<ViewResult> {
    let settings = Settings::default();
    reconstruct(scan, spots, &settings).unwrap().result().views
}

fn pixel_of(view: &ViewResult, role: SpotRole) -> [f64; 2] {
    let spot = view.spots.iter().find(|spot| spot.role == role);
    spot.unwrap().pixel
}

fn say(pixel: [f64; 2], role: SpotRole) -> Correction {
    Correction::of_spot(VIEW, pixel, role)
}

#[test]
fn a_spot_that_is_called_stray_gives_no_point_until_it_is_taken_back() {
    let (scan, mut spots) = jar();
    let before = measured(&scan, &spots);
    assert_eq!(before[VIEW].status, Status::Ok);

    let object = pixel_of(&before[VIEW], SpotRole::Object);
    correct(&mut spots, &[say(object, SpotRole::Stray)]);
    let corrected = measured(&scan, &spots);
    assert_eq!(corrected[VIEW].status, Status::NoObjectSpot);
    let count = |views: &[ViewResult]| views.iter().filter(|v| v.status == Status::Ok).count();
    assert_eq!(count(&corrected), count(&before) - 1);

    correct(&mut spots, &[]);
    assert_eq!(measured(&scan, &spots), before);
}

#[test]
fn a_wall_spot_that_is_called_stray_carries_the_wall_no_more() {
    let (scan, mut spots) = jar();
    let wall = pixel_of(&measured(&scan, &spots)[VIEW], SpotRole::Vessel);
    correct(&mut spots, &[say(wall, SpotRole::Stray)]);
    let corrected = measured(&scan, &spots);
    assert_eq!(corrected[VIEW].vessel.first(), None);
    assert_eq!(
        corrected[VIEW].status,
        Status::Ok,
        "the object's spot is still there"
    );
}

/// A faint spot a little off the true one is refused for its ray distance; a person may know better.
#[test]
fn a_refused_spot_that_is_called_the_objects_is_taken() {
    let (scan, mut spots) = jar();
    let object = pixel_of(&measured(&scan, &spots)[VIEW], SpotRole::Object);
    let mut ghost = *spots[VIEW]
        .spots
        .iter()
        .find(|spot| [spot.u, spot.v] == object)
        .unwrap();
    ghost.v += 12.0;
    ghost.brightness *= 0.5;
    spots[VIEW].spots.push(ghost);
    let refused = measured(&scan, &spots);
    assert_eq!(pixel_of(&refused[VIEW], SpotRole::Object), object);

    let place = [ghost.u, ghost.v];
    correct(&mut spots, &[say(place, SpotRole::Object)]);
    let corrected = measured(&scan, &spots);
    assert_eq!(pixel_of(&corrected[VIEW], SpotRole::Object), place);
    assert_eq!(pixel_of(&corrected[VIEW], SpotRole::Stray), object);
}

/// How many of some pixels lie within a circle.
fn within(pixels: &[[f64; 2]], [u, v]: [f64; 2], reach: f64) -> usize {
    let near = |pixel: &&[f64; 2]| {
        let [across, along] = [pixel[0] - u, pixel[1] - v];
        across * across + along * along <= reach * reach
    };
    pixels.iter().filter(near).count()
}

/// What was found in the view: the points of wall and object.
fn line_of(view: &ViewResult) -> [Vec<[f64; 2]>; 2] {
    let line = view.line.clone().unwrap();
    [line.vessel, line.object]
}

#[test]
fn a_part_of_a_line_is_what_a_person_says_and_the_rest_stays() {
    const REACH: f64 = 12.0;
    let (scan, mut spots) = sample("line.zip");
    let before = measured(&scan, &spots);
    let [wall, object] = line_of(&before[VIEW]);
    let say_around = |pixel: [f64; 2], role| Correction {
        reach: REACH,
        ..say(pixel, role)
    };

    // A part of the object is called stray: its points are gone, and no others.
    let there = object[object.len() / 2];
    let meant = within(&object, there, REACH);
    assert!(
        (5..object.len()).contains(&meant),
        "{meant} points are meant"
    );
    correct(&mut spots, &[say_around(there, SpotRole::Stray)]);
    let [wall_after, object_after] = line_of(&measured(&scan, &spots)[VIEW]);
    assert_eq!(within(&object_after, there, REACH), 0);
    assert_eq!(object_after.len(), object.len() - meant);
    assert_eq!(wall_after, wall);

    // A part of the wall likewise.
    let on_wall = wall[wall.len() / 2];
    let meant = within(&wall, on_wall, REACH);
    correct(&mut spots, &[say_around(on_wall, SpotRole::Stray)]);
    let [wall_after, _] = line_of(&measured(&scan, &spots)[VIEW]);
    assert_eq!(within(&wall_after, on_wall, REACH), 0);
    assert!(wall_after.len() + meant <= wall.len() + 1 && meant > 5);

    // What is said last counts: part of the object is the wall's, and is the object's again.
    let to_and_fro = [
        say_around(there, SpotRole::Vessel),
        say_around(there, SpotRole::Object),
    ];
    correct(&mut spots, &to_and_fro[..1]);
    let [wall_after, object_after] = line_of(&measured(&scan, &spots)[VIEW]);
    assert_eq!(within(&object_after, there, REACH), 0);
    assert!(within(&wall_after, there, REACH) > 5);
    correct(&mut spots, &to_and_fro);
    let [_, object_after] = line_of(&measured(&scan, &spots)[VIEW]);
    assert_eq!(object_after, object);

    correct(&mut spots, &[]);
    assert_eq!(measured(&scan, &spots), before);
}
