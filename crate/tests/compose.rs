//! Scans made of other programs' files: every kind is read as its program writes it, and a sample that is
//! taken apart and put together again gives the same result to the last byte.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::path::PathBuf;

use snellius::compose::{
    Composed, Draft, Key, LengthScale, Packer, Piece, Reading, pair, read_calibration, read_poses,
};
use snellius::geometry::{Flange, Point, Pose, World};
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::{
    Archive, InsideMedium, KnownKind, Manifest, Motion, PoseEntry, Scan, VesselShape,
};
use zip::ZipArchive;

fn calibration(file: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/calibration");
    std::fs::read_to_string(folder.join(file)).unwrap()
}

#[test]
fn every_kind_of_calibration_file_says_the_same() {
    for file in ["opencv.yml", "opencv.xml", "opencv.json", "ros.yaml"] {
        let lens = read_calibration(&calibration(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert_eq!(lens.size, Some([440, 330]), "{file}");
        assert_eq!(lens.focal, [661.5, 661.1], "{file}");
        assert_eq!(lens.centre, [221.9, 162.8], "{file}");
        assert_eq!(
            lens.distortion,
            [-0.112, 0.061, 0.0006, -0.0004, 0.0],
            "{file}"
        );
    }
}

#[test]
fn a_message_of_ros_and_a_header_of_opencv_5_are_read() {
    let message = "header:\n  seq: 1\nheight: 480\nwidth: 640\ndistortion_model: \"rational_polynomial\"\n\
                   d: [1, 2, 3, 4, 5, 6, 7, 8]\nk: [500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0]\n---\n";
    let lens = read_calibration(message).unwrap();
    assert_eq!((lens.size, lens.distortion.len()), (Some([640, 480]), 8));
    let newer = calibration("opencv.yml").replace("%YAML:1.0", "%YAML 1.2");
    assert!(read_calibration(&newer).is_ok());
}

#[test]
fn coefficients_that_are_zero_may_follow() {
    let with = |tail: &str| {
        let text = calibration("opencv.yml");
        let end = "-0.00040000000000000002, 0. ]";
        assert!(text.contains(end));
        read_calibration(&text.replace(end, &format!("-0.0004, 0., 0., 0., 0., {tail} ]")))
    };
    let zeros = "0., 0., 0., 0., 0., 0.";
    assert_eq!(with(zeros).unwrap().distortion.len(), 8);
    let error = with("0.1, 0., 0., 0., 0., 0.").unwrap_err().to_string();
    assert!(
        error.starts_with("distortion_coefficients[8]: thin-prism"),
        "{error}"
    );
}

#[test]
fn a_broken_calibration_file_names_the_place() {
    let broken = |file: &str, from: &str, to: &str| {
        let text = calibration(file);
        assert!(text.contains(from), "{file}: {from}");
        read_calibration(&text.replacen(from, to, 1))
            .unwrap_err()
            .to_string()
    };
    let cases = [
        (
            broken("opencv.yml", "camera_matrix", "matrix"),
            "camera_matrix: missing",
        ),
        (
            broken("opencv.yml", "661.5", "six"),
            "camera_matrix.data[0]: \"six\" is no number",
        ),
        (
            broken("opencv.yml", "661.5", ".Nan"),
            "camera_matrix.data[0]: ",
        ),
        (
            broken("opencv.yml", "661.5, ", ""),
            "camera_matrix: 8 numbers",
        ),
        (
            broken("opencv.yml", "661.5, 0.", "661.5, 2."),
            "camera_matrix: a skew of 2",
        ),
        (
            broken("opencv.yml", "fisheye_model: 0", "fisheye_model: 1"),
            "fisheye_model: \"fisheye\"",
        ),
        (
            broken("opencv.yml", "image_width: 440", "image_width: 440.5"),
            "image_width: 440.5",
        ),
        (broken("opencv.yml", " 661.5", " [661.5"), "line "),
        (
            broken("ros.yaml", "plumb_bob", "equidistant"),
            "distortion_model: \"equidistant\"",
        ),
        (
            broken("ros.yaml", "  data: [-0.112", "  no: [-0.112"),
            "distortion_coefficients.data: missing",
        ),
        (
            broken("ros.yaml", "0.061, 0.0006, ", ""),
            "distortion_coefficients: 3 coefficients",
        ),
        (
            broken("opencv.xml", "</camera_matrix>", "</camera>"),
            "line ",
        ),
        (
            broken("opencv.json", "\"camera_matrix\":", "\"camera_matrix\""),
            "line ",
        ),
    ];
    for (error, start) in cases {
        assert!(
            error.starts_with(start),
            "{error:?} does not start with {start:?}"
        );
    }
    let error = read_calibration("hello").unwrap_err().to_string();
    assert!(error.contains("no calibration file"), "{error}");
}

#[test]
fn no_text_whatsoever_makes_the_readers_panic() {
    let files = ["opencv.yml", "opencv.xml", "opencv.json", "ros.yaml"].map(calibration);
    for text in &files {
        for end in 0..text.len() {
            let _ = read_calibration(&text[..end]);
        }
    }
    let table = "id,x,y,z,qw,qx,qy,qz\n1,0,0,0,1,0,0,0\n";
    let list =
        "[{\"id\": 1, \"t\": [0, 0, 0], \"q\": [1, 0, 0, 0]}, [[1,0,0,0],[0,1,0,0],[0,0,1,0]]]";
    for text in [table, list, "1 2 3 4 0 0 0 1\n2 2 3 4 0 0 0 1"] {
        for end in 0..text.len() {
            let _ = read_poses(&text[..end], Reading::default());
        }
    }
    for piece in [
        "[", "{a: ", "- ", "? ", "<a>", " ", "{\"a\":", "a: ", "*a ", "\u{feff}",
    ] {
        let deep = piece.repeat(100_000);
        let _ = read_calibration(&deep);
        let _ = read_poses(&deep, Reading::default());
    }
}

#[test]
fn a_text_of_aliases_is_refused_before_it_fills_the_memory() {
    let mut text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n".to_owned();
    for level in 1..30 {
        let below = format!("*a{}", level - 1);
        let nine = [below.as_str(); 9].join(", ");
        text += &format!("a{level}: &a{level} [{nine}]\n");
    }
    let error = read_calibration(&text).unwrap_err().to_string();
    assert!(
        error.starts_with("line 2, ") && error.contains("alias"),
        "{error}"
    );
}

/// A quarter turn about z, at (10, 20, 30), in each way of writing.
#[test]
fn every_kind_of_list_says_the_same() {
    let half = 0.5_f64.sqrt();
    let angle = std::f64::consts::FRAC_PI_2;
    let rows = "0,-1,0,10,1,0,0,20,0,0,1,30";
    let columns = "m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23";
    let metres = Reading {
        length: LengthScale::Metre,
        ..Reading::default()
    };
    let centimetres = Reading {
        length: LengthScale::Centimetre,
        ..Reading::default()
    };
    let degrees = Reading {
        degrees: true,
        ..Reading::default()
    };
    let w_last = Reading {
        w_last: true,
        ..Reading::default()
    };
    let mm = Reading::default();
    let lists = [
        (
            format!("id,x,y,z,qw,qx,qy,qz\n7,10,20,30,{half},0,0,{half}\n"),
            mm,
        ),
        (
            format!("id;Tx [cm];Ty [cm];Tz [cm];q_w;q_x;q_y;q_z\n7;1;2;3;{half};0;0;{half}\n"),
            centimetres,
        ),
        (
            format!("\u{feff}# name\tx\ty\tz\trx\try\trz\n7\t10\t20\t30\t0\t0\t{angle}\n"),
            mm,
        ),
        (
            "id,x,y,z,rx,ry,rz\r\n7,10,20,30,0,0,90\r\n".to_owned(),
            degrees,
        ),
        (
            "id,x,y,z,r11,r12,r13,r21,r22,r23,r31,r32,r33\n7,10,20,30,0,-1,0,1,0,0,0,0,1\n"
                .to_owned(),
            mm,
        ),
        (
            format!("id,{columns},m30,m31,m32,m33\n7,{rows},0,0,0,1\n"),
            mm,
        ),
        (
            format!("# t tx ty tz qx qy qz qw\n7 0.01 0.02 0.03 0 0 {half} {half}\n"),
            metres,
        ),
        (rows.replace(',', " "), mm),
        (
            "[[[0,-1,0,10],[1,0,0,20],[0,0,1,30],[0,0,0,1]]]".to_owned(),
            mm,
        ),
        (format!("{{\"7\": {{\"matrix\": [{rows}]}}}}"), mm),
        (
            format!(
                "[{{\"id\": 7, \"translation\": [10,20,30], \"quaternion\": [{half},0,0,{half}]}}]"
            ),
            mm,
        ),
        (
            format!("[{{\"translation\": [10,20,30], \"quaternion\": [0,0,{half},{half}]}}]"),
            w_last,
        ),
        (
            format!(
                "{{\"poses\": [{{\"position\": {{\"x\":0.01,\"y\":0.02,\"z\":0.03}}, \
                 \"orientation\": {{\"x\":0,\"y\":0,\"z\":{half},\"w\":{half}}}}}]}}"
            ),
            metres,
        ),
        (
            "[{\"tvec\": [10,20,30], \"rvec\": [0,0,90]}]".to_owned(),
            degrees,
        ),
    ];
    for (text, reading) in lists {
        let list = read_poses(&text, reading).unwrap_or_else(|e| panic!("{text}: {e}"));
        let [pose] = list.poses.as_slice() else {
            panic!("{text}")
        };
        let moved = Pose::<World, Flange>::new(pose.rotation, pose.translation).unwrap();
        let off = moved
            .point(Point::new(1.0, 2.0, 3.0))
            .distance(Point::new(8.0, 21.0, 33.0));
        assert!(off < 1e-9, "{text}: {off}");
        assert!(
            pose.name.as_deref().is_none_or(|name| name == "7"),
            "{text}"
        );
    }
}

#[test]
fn a_broken_list_names_the_place() {
    let heading = "id,x,y,z,qw,qx,qy,qz\n1,0,0,0,1,0,0,0\n";
    let cases = [
        (
            format!("{heading}2,0,0,0,1,0,0,x\n"),
            "line 3: \"x\" is no number",
        ),
        (format!("{heading}2,0,0,0,1,0,0\n"), "line 3: 7 columns"),
        (
            format!("{heading}2,0,0,0,2,0,0,0\n"),
            "line 3: a quaternion of length 2.000",
        ),
        (
            "id,x,y,z\n1,0,0,0\n".to_owned(),
            "line 1: no columns of a rotation",
        ),
        (
            "id,qw,qx,qy,qz\n1,1,0,0,0\n".to_owned(),
            "line 1: no columns x, y, z",
        ),
        (
            "id,x,y,z,qw,qx,qy,qz,inside\n1,0,0,0,1,0,0,0,oil\n".to_owned(),
            "line 2: \"oil\"",
        ),
        (
            "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0\n".to_owned(),
            "line 2: 7 numbers, not 8",
        ),
        (
            "1 2 3\n".to_owned(),
            "this is no list of poses: its lines have 3 numbers",
        ),
        (
            "1 0 0 5 0 1 0 5 0 0 -1 5\n".to_owned(),
            "line 1: no rotation",
        ),
        (
            "[[[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,5,5,1]]]".to_owned(),
            "[0]: the last row",
        ),
        ("[[1,2],[3]]".to_owned(), "[0]: 2 numbers"),
        (
            "[{\"translation\": [1,2], \"quaternion\": [1,0,0,0]}]".to_owned(),
            "[0].translation: 2 numbers",
        ),
        (
            "[{\"translation\": [1,2,3]}]".to_owned(),
            "[0].quaternion: missing",
        ),
        (
            "[{\"translation\": [1,2,3], \"rotation\": {\"w\": 1}}]".to_owned(),
            "[0].rotation.x: null",
        ),
        ("[1, 2".to_owned(), "line 1, column "),
        (
            "[]".to_owned(),
            "this is no list of poses: there is no pose",
        ),
        (
            "# nothing\n\n".to_owned(),
            "this is no list of poses: it is empty",
        ),
    ];
    for (text, start) in cases {
        let error = read_poses(&text, Reading::default())
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with(start),
            "{error:?} does not start with {start:?}"
        );
    }
}

/// A sample, taken apart.
struct Parts {
    manifest: Manifest,
    files: BTreeMap<String, Vec<u8>>,
}

fn sample(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../samples")
        .join(name)
}

fn take_apart(name: &str) -> Parts {
    let mut zip = ZipArchive::new(File::open(sample(name)).unwrap()).unwrap();
    let mut files = BTreeMap::new();
    for index in 0..zip.len() {
        let mut entry = zip.by_index(index).unwrap();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        files.insert(entry.name().unwrap().to_string(), bytes);
    }
    let manifest = Manifest::from_json(&files.remove("scan.json").unwrap()).unwrap();
    Parts { manifest, files }
}

fn numbers(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    words.join(", ")
}

/// A table of a scan's poses, and what is behind the wall.
fn table(manifest: &Manifest) -> String {
    let mut table = "view,x,y,z,qw,qx,qy,qz,inside\n".to_owned();
    for view in &manifest.views {
        let PoseEntry {
            rotation,
            translation,
            ..
        } = view.world_from_flange.as_ref().unwrap();
        let (translation, rotation) = (numbers(translation), numbers(rotation));
        let inside = format!("{:?}", view.inside).to_lowercase();
        table += &format!("{},{translation},{rotation},{inside}\n", view.id);
    }
    table
}

/// What somebody would type who has a sample's pictures, calibration and poses.
fn draft_of(parts: &Parts) -> Draft {
    let manifest = &parts.manifest;
    let (camera, laser) = (&manifest.camera, &manifest.laser);
    let mut draft = Draft {
        pictures: parts.files.keys().cloned().collect(),
        picture_size: Some([camera.width, camera.height]),
        calibration: Some(format!(
            "%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   \
             data: [ {}, 0., {}, 0., {}, {}, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   \
             rows: 1\n   cols: 5\n   dt: d\n   data: [ {} ]\n",
            camera.fx,
            camera.cx,
            camera.fy,
            camera.cy,
            numbers(&camera.distortion)
        )),
        poses: Some(table(manifest)),
        ..Draft::default()
    };
    let answers = &mut draft.answers;
    answers.set(Key::Name, &manifest.name);
    answers.set(Key::Frames, "world-from-flange");
    answers.set(
        Key::HandRotation,
        numbers(&manifest.flange_from_camera.rotation),
    );
    answers.set(
        Key::HandTranslation,
        numbers(&manifest.flange_from_camera.translation),
    );
    answers.set(Key::LaserOrigin, numbers(&laser.origin));
    match laser.normal {
        Some(normal) => {
            answers.set(Key::LaserKind, "line");
            answers.set(Key::LaserNormal, numbers(&normal));
        }
        None => answers.set(Key::LaserDirection, numbers(&laser.direction.unwrap())),
    }
    answers.set(
        Key::Shape,
        format!("{:?}", manifest.vessel.shape).to_lowercase(),
    );
    answers.set(
        Key::WallThickness,
        manifest.vessel.wall_thickness.to_string(),
    );
    answers.set(Key::IndexWall, manifest.media.wall.to_string());
    match manifest.media.inside {
        Some(n) => answers.set(Key::IndexInside, n.to_string()),
        None => answers.set(Key::IndexKnown, "no"),
    }
    draft
}

fn sentences(composed: &Composed) -> Vec<&str> {
    composed
        .gaps
        .iter()
        .map(|gap| gap.sentence.as_str())
        .collect()
}

/// The archive of a composed scan.
fn pack(composed: &Composed, files: &BTreeMap<String, Vec<u8>>) -> Vec<u8> {
    let mut packer = Packer::new();
    for (name, bytes) in files {
        packer
            .add(name, bytes.len() as u64, &mut bytes.as_slice())
            .unwrap();
    }
    let pieces = packer.finish(composed.manifest.as_ref().unwrap()).unwrap();
    let files: Vec<&Vec<u8>> = files.values().collect();
    let pieces = pieces.iter().map(|piece| match piece {
        Piece::Bytes(bytes) => bytes.as_slice(),
        Piece::File(number) => files[*number].as_slice(),
    });
    pieces.collect::<Vec<_>>().concat()
}

fn result(archive: impl Read + Seek) -> String {
    let mut archive = Archive::open(archive).unwrap();
    let settings = Settings::default();
    let views = 0..archive.scan().stations.len();
    let spots: Vec<_> = views
        .map(|view| observe(&mut archive, view, &settings).unwrap())
        .collect();
    reconstruct(archive.scan(), &spots, &settings)
        .unwrap()
        .result()
        .to_json()
}

#[test]
fn a_sample_taken_apart_and_put_together_is_the_same_scan() {
    for name in ["jar.zip", "line.zip"] {
        let parts = take_apart(name);
        let composed = draft_of(&parts).compose();
        assert_eq!(sentences(&composed), [""; 0], "{name}");
        assert_eq!(composed.manifest.as_ref(), Some(&parts.manifest), "{name}");
        let archive = pack(&composed, &parts.files);
        let mut zip = ZipArchive::new(Cursor::new(&archive)).unwrap();
        for (name, bytes) in &parts.files {
            let mut read = Vec::new();
            zip.by_name(name).unwrap().read_to_end(&mut read).unwrap();
            assert_eq!(&read, bytes, "{name}");
        }
        let direct = result(File::open(sample(name)).unwrap());
        assert!(
            result(Cursor::new(archive)) == direct,
            "{name}: the results differ"
        );
    }
}

#[test]
fn an_empty_draft_says_everything_that_is_missing() {
    let composed = Draft::default().compose();
    assert_eq!(
        sentences(&composed),
        [
            "No pictures: choose those with the laser on and off.",
            "No camera calibration: choose its file.",
            "No poses: choose their file.",
            "Choose what a pose says: its frames.",
            "Origin: missing.",
            "Direction: missing.",
            "Wall thickness: missing.",
            "Index of the wall: missing.",
            "Index in the vessel: missing.",
        ]
    );
    assert_eq!(composed.manifest, None);
}

/// What the jar lacks after a change.
fn gaps_after(change: impl FnOnce(&mut Draft)) -> Vec<String> {
    let mut draft = draft_of(&take_apart("jar.zip"));
    change(&mut draft);
    let composed = draft.compose();
    assert_eq!(composed.manifest.is_some(), composed.gaps.is_empty());
    sentences(&composed)
        .into_iter()
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_gap_is_said() {
    let answer = |key: Key, text: &str| gaps_after(|draft| draft.answers.set(key, text));
    assert_eq!(
        answer(Key::HandRotation, ""),
        ["Camera on the flange: rotation: missing."]
    );
    assert_eq!(
        answer(Key::HandRotation, "2 0 0 0"),
        ["Camera on the flange: a quaternion of length 2.000; a rotation's is 1."]
    );
    assert_eq!(
        answer(Key::LaserOrigin, "1 2"),
        ["Origin: 2 numbers; 3 wanted."]
    );
    assert_eq!(
        answer(Key::LaserDirection, "0 0 0"),
        ["laser.direction: a vector of length zero has no direction."]
    );
    assert_eq!(
        answer(Key::WallThickness, "-1"),
        ["vessel.wall_thickness: -1; it must be greater than 0."]
    );
    assert!(answer(Key::IndexInside, "13.3")[0].starts_with("media.inside: 13.3"));
    assert_eq!(answer(Key::IndexKnown, "no"), [""; 0]);
    assert_eq!(answer(Key::SigmaFocal, "0.7"), [""; 0]);
    assert_eq!(
        gaps_after(|draft| draft.picture_size = Some([441, 330])),
        [""; 0],
        "a calibration file without a size is for the pictures' size"
    );
    assert_eq!(
        gaps_after(|draft| {
            draft.calibration = Some(calibration("opencv.yml"));
            draft.picture_size = Some([880, 660]);
        }),
        ["The calibration is for pictures of 440 x 330 pixels, and these have 880 x 660."]
    );
    let one_less = gaps_after(|draft| draft.pictures.retain(|name| name != "images/0003-off.png"));
    assert_eq!(one_less[0], "1 picture has no partner: images/0003-on.png.");
    let fewer_poses = gaps_after(|draft| {
        let list = draft.poses.take().unwrap();
        draft.poses = Some(list.replace("0003,", "4711,"));
    });
    assert_eq!(
        fewer_poses,
        ["1 view without a pose: 0003.", "1 pose for no view: 4711."]
    );
    let in_order = gaps_after(|draft| {
        draft.poses = Some("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n".to_owned());
    });
    assert_eq!(
        in_order,
        ["27 views, but 2 poses; where the list names no views they are matched by their order."]
    );
    let bare = gaps_after(|draft| {
        let one = "{\"t\": [0, 0, 0], \"q\": [1, 0, 0, 0]}";
        draft.poses = Some(format!("[{}]", [one; 27].join(",")));
    });
    assert_eq!(bare, ["Quaternions: is w first or last?"]);
}

#[test]
fn a_wall_known_beforehand_is_written_down() {
    let draft = |answers: &[(Key, &str)]| {
        let mut draft = draft_of(&take_apart("jar.zip"));
        draft.answers.set(Key::WallKnown, "yes");
        for (key, answer) in answers {
            draft.answers.set(*key, *answer);
        }
        draft.compose()
    };
    let vessel = |answers: &[(Key, &str)]| {
        let composed = draft(answers);
        assert_eq!(sentences(&composed), [""; 0]);
        composed.manifest.unwrap().vessel
    };
    let jar = vessel(&[
        (Key::Shape, "cylinder"),
        (Key::WallAxisPoint, "1 2 300"),
        (Key::WallAxis, "0 1 0"),
        (Key::WallRadius, "60"),
        // Of another shape, and not asked for.
        (Key::WallCentre, "no numbers"),
    ]);
    assert_eq!(jar.shape, VesselShape::Cylinder);
    assert_eq!(jar.axis_point, Some([1.0, 2.0, 300.0]));
    assert_eq!((jar.axis, jar.radius), (Some([0.0, 1.0, 0.0]), Some(60.0)));
    let bowl = vessel(&[
        (Key::Shape, "sphere"),
        (Key::WallCentre, "1 2 300"),
        (Key::WallRadius, "60"),
    ]);
    assert_eq!(
        (bowl.center, bowl.radius),
        (Some([1.0, 2.0, 300.0]), Some(60.0))
    );
    let tank = vessel(&[
        (Key::Shape, "plane"),
        (Key::WallPoint, "0 0 200"),
        (Key::WallNormal, "0 0 -1"),
        (Key::FarWall, "yes"),
        (Key::FarDistance, "80"),
        (Key::FarThickness, "3.5"),
    ]);
    assert_eq!(
        tank.point.zip(tank.normal),
        Some(([0.0, 0.0, 200.0], [0.0, 0.0, -1.0]))
    );
    assert_eq!(tank.axis.or(tank.center), None);
    let far = tank.far_wall.unwrap();
    assert_eq!((far.distance, far.thickness), (80.0, 3.5));

    // What belongs to no wall of that shape is not asked for.
    let auto = draft(&[(Key::Shape, "auto"), (Key::FarWall, "no")]);
    assert!(!auto.asked.contains(&Key::WallKnown));
    assert!(auto.asked.contains(&Key::FarWall) && !auto.asked.contains(&Key::FarDistance));
    assert_eq!(auto.manifest.unwrap().vessel.radius, None);

    let gaps = draft(&[(Key::Shape, "sphere"), (Key::WallRadius, "1")]);
    assert_eq!(sentences(&gaps), ["The middle of the bowl: missing."]);
    let gaps = draft(&[
        (Key::Shape, "sphere"),
        (Key::WallCentre, "1 2 300"),
        (Key::WallRadius, "-60"),
    ]);
    assert_eq!(
        sentences(&gaps),
        ["vessel.radius: -60; it must be greater than 0."]
    );
    let gaps = draft(&[(Key::Shape, "plane"), (Key::FarWall, "yes")]);
    assert_eq!(
        sentences(&gaps),
        [
            "A point of the wall: missing.",
            "The wall's normal: missing.",
            "Between the two walls: missing.",
            "Thickness of the far wall: missing.",
        ]
    );
}

#[test]
fn what_is_known_of_the_object_is_written_down() {
    let mut draft = draft_of(&take_apart("jar.zip"));
    for (key, answer) in [
        (Key::KnownAngle, "90"),
        (Key::KnownEdge, "25,4"),
        (Key::KnownRadius, "12.5"),
        (Key::KnownFlat, "yes"),
    ] {
        draft.answers.set(key, answer);
    }
    let known = draft.compose().manifest.unwrap().known;
    let said = known
        .iter()
        .map(|shape| (shape.kind, shape.degrees.or(shape.mm)));
    assert_eq!(
        said.collect::<Vec<_>>(),
        [
            (KnownKind::PlaneAngle, Some(90.0)),
            (KnownKind::EdgeLength, Some(25.4)),
            (KnownKind::Radius, Some(12.5)),
            (KnownKind::Flatness, None),
        ]
    );
    let answer = |key: Key, text: &str| gaps_after(|draft| draft.answers.set(key, text));
    assert_eq!(
        answer(Key::KnownAngle, "180"),
        ["Angle between two flat faces: 180; it is more than 0 and less than 180."]
    );
    assert_eq!(
        answer(Key::KnownEdge, "0"),
        ["Distance of two parallel faces: 0; it is more than 0."]
    );
}

#[test]
fn views_in_air_are_said_by_their_numbers_or_by_the_poses() {
    let mut draft = draft_of(&take_apart("jar.zip"));
    assert!(
        !draft.compose().asked.contains(&Key::InAir),
        "the poses say it"
    );
    let without: Vec<&str> = draft.poses.as_deref().unwrap().lines().collect();
    let without = without
        .iter()
        .filter_map(|line| Some(line.rsplit_once(',')?.0));
    draft.poses = Some(without.collect::<Vec<_>>().join("\n"));
    draft.answers.set(Key::InAir, "2-3, 27");
    let composed = draft.compose();
    assert!(composed.asked.contains(&Key::InAir));
    let views = composed.manifest.unwrap().views;
    let in_air = views.iter().filter(|view| view.inside == InsideMedium::Air);
    let in_air: Vec<&str> = in_air.map(|view| view.id.as_str()).collect();
    assert_eq!(in_air, ["0001", "0002", "0026"]);
    draft.answers.set(Key::InAir, "28");
    assert_eq!(
        sentences(&draft.compose()),
        ["Views in air: there is no view 28; they go from 1 to 27."]
    );
}

#[test]
fn pictures_without_a_partner_are_left_out_or_measured_alone() {
    let mut draft = draft_of(&take_apart("jar.zip"));
    draft.pictures.retain(|name| name != "images/0003-off.png");
    draft.answers.set(Key::Alone, "skip");
    let skipped = draft.compose().manifest.unwrap();
    assert_eq!(
        (skipped.views.len(), skipped.views[3].id.as_str()),
        (26, "0004")
    );
    draft.answers.set(Key::Alone, "alone");
    let alone = draft.compose().manifest.unwrap();
    assert_eq!((alone.views.len(), alone.views[3].off.as_ref()), (27, None));
}

/// The four ways to say where the rig stood are one scan.
#[test]
fn a_pose_read_the_other_way_is_the_same_station() {
    let parts = take_apart("jar.zip");
    let direct = Scan::new(parts.manifest.clone()).unwrap();
    for frames in [
        "flange-from-world",
        "world-from-camera",
        "camera-from-world",
    ] {
        for motion in ["rig", "vessel"] {
            let mut draft = draft_of(&parts);
            draft.answers.set(Key::Frames, frames);
            draft.answers.set(Key::Motion, motion);
            let mut list = "id,x,y,z,qw,qx,qy,qz\n".to_owned();
            for (view, station) in parts.manifest.views.iter().zip(&direct.stations) {
                let (rotation, translation) = match frames {
                    "flange-from-world" => {
                        let pose = station.world_from_flange.inverse();
                        (pose.quaternion(), pose.translation())
                    }
                    "world-from-camera" => {
                        let pose = station.world_from_camera;
                        (pose.quaternion(), pose.translation())
                    }
                    _ => {
                        let pose = station.world_from_camera.inverse();
                        (pose.quaternion(), pose.translation())
                    }
                };
                let (translation, rotation) = (numbers(translation.as_slice()), numbers(&rotation));
                list += &format!("{},{translation},{rotation}\n", view.id);
            }
            draft.poses = Some(list);
            let composed = draft.compose();
            assert_eq!(sentences(&composed), [""; 0]);
            let manifest = composed.manifest.unwrap();
            assert_eq!(manifest.motion == Motion::Vessel, motion == "vessel");
            let scan = Scan::new(manifest).unwrap();
            for (one, other) in scan.stations.iter().zip(&direct.stations) {
                let probe = Point::new(3.0, -5.0, 400.0);
                let off = one
                    .world_from_camera
                    .point(probe)
                    .distance(other.world_from_camera.point(probe));
                assert!(off < 1e-9, "{frames}, {motion}: {off} mm");
            }
        }
    }
}

#[test]
fn poses_find_their_pictures_by_any_of_their_names() {
    let pictures = [
        "scan/on/view_9.png",
        "scan/on/view_10.png",
        "scan/off/view_9.png",
        "scan/off/view_10.png",
    ];
    let ids: Vec<String> = pair(&pictures)
        .pairs
        .into_iter()
        .map(|pair| pair.id)
        .collect();
    assert_eq!(ids, ["view_9", "view_10"]);
    for names in [
        ["view_10", "view_9"],
        ["view10", "view009"],
        ["scan/on/view_10.png", "scan/on/view_9.png"],
        [
            "/home/somebody/scan/on/view_10.png",
            "/home/somebody/scan/on/view_9.png",
        ],
        ["view_10.jpg", "view_9.jpg"],
    ] {
        let mut draft = draft_of(&take_apart("jar.zip"));
        draft.pictures = pictures.map(str::to_owned).to_vec();
        draft.poses = Some(format!(
            "image,x,y,z,qw,qx,qy,qz\n{},10,0,0,1,0,0,0\n{},9,0,0,1,0,0,0\n",
            names[0], names[1]
        ));
        let composed = draft.compose();
        assert_eq!(sentences(&composed), [""; 0], "{names:?}");
        let views = composed.manifest.unwrap().views;
        let places: Vec<f64> = views
            .iter()
            .map(|view| view.world_from_flange.as_ref().unwrap().translation[0])
            .collect();
        assert_eq!(places, [9.0, 10.0], "{names:?}");
    }
}

/// An archive whose first file is zeros that are nowhere.
struct Hollow {
    /// Where each piece ends, and what is in it.
    pieces: Vec<(u64, Option<Vec<u8>>)>,
    position: u64,
}

impl Hollow {
    fn length(&self) -> u64 {
        self.pieces.last().map_or(0, |(end, _)| *end)
    }
}

impl Read for Hollow {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let mut pieces = self.pieces.iter();
        let Some((end, bytes)) = pieces.find(|(end, _)| self.position < *end) else {
            return Ok(0);
        };
        let left = (end - self.position).min(into.len() as u64) as usize;
        match bytes {
            Some(bytes) => {
                let from = bytes.len() - (end - self.position) as usize;
                into[..left].copy_from_slice(&bytes[from..from + left]);
            }
            None => into[..left].fill(0),
        }
        self.position += left as u64;
        Ok(left)
    }
}

impl Seek for Hollow {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(by) => self.position.checked_add_signed(by),
            SeekFrom::End(by) => self.length().checked_add_signed(by),
        };
        self.position = position.ok_or(std::io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}

#[test]
fn an_archive_beyond_four_gigabytes_is_laid_out_without_its_pictures() {
    const LENGTH: u64 = (5 << 30) + 1;
    let end = b"end";
    let mut packer = Packer::new();
    let mut zeros = std::io::repeat(0).take(LENGTH);
    packer.add("a.png", LENGTH, &mut zeros).unwrap();
    packer.add("b.png", 3, &mut end.as_slice()).unwrap();
    let mut length = 0;
    let pieces = packer.finish_with(b"{}").unwrap().into_iter().map(|piece| {
        let (of_piece, bytes) = match piece {
            Piece::File(0) => (LENGTH, None),
            Piece::File(_) => (3, Some(end.to_vec())),
            Piece::Bytes(bytes) => (bytes.len() as u64, Some(bytes)),
        };
        assert!(of_piece == LENGTH || of_piece < 1000);
        length += of_piece;
        (length, bytes)
    });
    let pieces = pieces.collect();
    let mut zip = ZipArchive::new(Hollow {
        pieces,
        position: 0,
    })
    .unwrap();
    assert_eq!(zip.by_name("a.png").unwrap().size(), LENGTH);
    for (name, content) in [("b.png", "end"), ("scan.json", "{}")] {
        let mut read = String::new();
        zip.by_name(name)
            .unwrap()
            .read_to_string(&mut read)
            .unwrap();
        assert_eq!(read, content);
    }
}

#[test]
fn a_file_that_was_cut_off_meanwhile_is_told() {
    let mut packer = Packer::new();
    let error = packer
        .add("a.png", 10, &mut b"half".as_slice())
        .unwrap_err();
    assert!(
        error
            .to_string()
            .contains("a.png: 4 bytes could be read, not 10"),
        "{error}"
    );
}
