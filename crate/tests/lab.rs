//! The refraction lab: its numbers are those of optics, its links come back as they went, and nothing
//! that a link may say makes it panic.
#![allow(
    clippy::print_stdout,
    reason = "what was measured is told with --nocapture"
)]

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use snellius::camera::Pixel;
use snellius::geometry::{Direction, Ray};
use snellius::lab::known_shape::{Experiment, RANGE};
use snellius::lab::link::{LONGEST, LinkError, parameters, read, write};
use snellius::lab::{
    Answer, Bench, CHOICES, End, LESSONS, Lesson, Light, MEDIA, MYSTERIES, Medium, NoMeasurement,
    QUANTITIES, Reply, SUBSTANCES, Sight, quantity,
};

fn set(bench: &mut Bench, key: &str, value: f64) {
    quantity(key).expect("a key of the table").set(bench, value);
}

/// Any bench that can be set by hand.
fn any_bench(random: &mut ChaCha8Rng) -> Bench {
    let mut bench = Bench::default();
    for choice in &CHOICES {
        choice.set(&mut bench, random.random_range(0..choice.options.len()));
    }
    for role in &MEDIA {
        let medium = match random.random_range(0..3) {
            0 => Medium::Named(random.random_range(0..SUBSTANCES.len())),
            1 if role.may_be_hidden => Medium::Mystery(random.random_range(0..MYSTERIES.len())),
            _ => Medium::Index(f64::from(random.random_range(9000..25_000)) / 10_000.0),
        };
        (role.set)(&mut bench, medium);
    }
    for quantity in &QUANTITIES {
        if random.random_bool(0.7) {
            quantity.set(
                &mut bench,
                random.random_range(quantity.low..=quantity.high),
            );
        }
    }
    bench
}

#[test]
fn a_link_gives_the_bench_that_it_was_made_from() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut longest = 0;
    for _ in 0..2000 {
        let bench = any_bench(&mut random);
        let link = write(&bench);
        longest = longest.max(link.len());
        assert_eq!(read(&link), Ok(bench), "{link}");
    }
    assert!(longest < LONGEST, "{longest}");
    println!("longest of 2,000 links: {longest} characters");
}

#[test]
fn what_is_as_at_first_is_left_out() {
    assert_eq!(write(&Bench::default()), "lab/1");
    let mut bench = Bench::default();
    set(&mut bench, "pitch", 20.0);
    assert_eq!(write(&bench), "lab/1?pitch=20");
    for short in ["lab", "lab/", "lab/1", "lab/1?", "lab/1?&"] {
        assert_eq!(read(short), Ok(Bench::default()), "{short}");
    }
}

/// Links are kept in lesson plans for years: what version 1 wrote must open as it was.
#[test]
fn links_of_version_1_open_for_ever() {
    let bench = read(
        "lab/1?view=index&wall=cylinder&thing=card&outside=water&glass=1.49&liquid=mystery3&lesson=2\
         &radius=75.5&thickness=3&lx=-80&lz=-150&cx=60.5&cz=-160&ox=-10&oz=70&aim=12.5&turn=-5\
         &pitch=20&assumed=1.3333&az=-60&el=40&round=-20&above=10&fill=80&divider=30&n=1.7&l=15&noise=0.3&out=0.05\
         &in=0.1",
    )
    .unwrap();
    assert_eq!(bench.liquid, Medium::Mystery(2));
    assert_eq!(bench.glass, Medium::Index(1.49));
    assert_eq!(bench.outside.index(), 1.332);
    assert_eq!(
        (bench.laser, bench.camera),
        ([-80.0, -150.0], [60.5, -160.0])
    );
    assert_eq!((bench.object, bench.aim), ([-10.0, 70.0], Some(12.5)));
    assert_eq!((bench.assumed, bench.lesson), (Some(1.3333), Some(1)));
    let rest = [
        bench.radius,
        bench.thickness,
        bench.turn,
        bench.pitch,
        bench.space_round,
        bench.space_above,
        bench.eye_round,
        bench.eye_above,
        bench.fill,
        bench.divider,
        bench.trial,
        bench.l_turn,
        bench.noise,
        bench.out_of_plane,
        bench.in_plane,
    ];
    let meant = [
        75.5, 3.0, -5.0, 20.0, -60.0, 40.0, -20.0, 10.0, 80.0, 30.0, 1.7, 15.0, 0.3, 0.05, 0.1,
    ];
    assert_eq!(rest, meant);
    assert_eq!(
        parameters(&bench).len(),
        CHOICES.len() + MEDIA.len() + QUANTITIES.len()
    );
}

#[test]
fn a_hostile_link_is_an_error_that_names_the_place() {
    let too_long = format!("lab/1?pitch={}", "1".repeat(LONGEST));
    let cases = [
        ("lab/2?pitch=20", "version"),
        ("lab/1/1", "version"),
        ("lab/1?pitch", "pitch"),
        ("lab/1?pitch=", "pitch"),
        ("lab/1?pitch=NaN", "pitch"),
        ("lab/1?pitch=inf", "pitch"),
        ("lab/1?pitch=1e1", "pitch"),
        ("lab/1?pitch=--1", "pitch"),
        ("lab/1?pitch=51", "between -50 and 50"),
        ("lab/1?pitch=1&pitch=1", "twice"),
        ("lab/1?lesson=0", "lesson"),
        ("lab/1?lesson=9", "lesson"),
        ("lab/1?liquid=0.1", "liquid"),
        ("lab/1?liquid=mystery0", "liquid"),
        ("lab/1?liquid=mystery99", "liquid"),
        ("lab/1?glass=mystery1", "glass"),
        ("lab/1?wall=%00", "wall"),
        ("lab/1?<script>alert(1)</script>=1", "<script>"),
        (
            "lab/1?radius=99999999999999999999999999999999999999999999",
            "radius",
        ),
        ("labs", "no link"),
        ("lab1", "no link"),
        ("", "no link"),
        (too_long.as_str(), "characters"),
    ];
    for (link, word) in cases {
        let message = read(link).expect_err(link).to_string();
        assert!(message.contains(word), "{link}: {message}");
        assert!(message.chars().count() < 160, "{message}");
    }
    assert_eq!(
        read("lab/3"),
        Err(LinkError::Version {
            version: "3".to_owned()
        })
    );
}

/// Links cut off, with characters changed, and mere noise: an error or a bench, and the bench's light can
/// be traced.
#[test]
fn no_text_makes_the_lab_panic() {
    const LETTERS: &[u8] = b"lab/1?=&.-0123456789epnithckwm\xc3\xa9%<\0";
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut opened = 0;
    for round in 0..3000 {
        let mut text = match round % 2 {
            0 => write(&any_bench(&mut random)).into_bytes(),
            _ => b"lab/1?".to_vec(),
        };
        text.truncate(random.random_range(0..=text.len()));
        for _ in 0..random.random_range(0..6) {
            let letter = LETTERS[random.random_range(0..LETTERS.len())];
            text.insert(random.random_range(0..=text.len()), letter);
        }
        if let Ok(bench) = read(&String::from_utf8_lossy(&text)) {
            opened += 1;
            let _ = Light::of(&bench);
        }
    }
    assert!(opened > 100, "{opened}");
}

#[test]
fn every_bench_has_light_or_says_why_not() {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let mut measured = 0;
    for _ in 0..3000 {
        let bench = any_bench(&mut random);
        let light = Light::of(&bench);
        for bend in light.beam.bends.iter().chain(&light.sight.bends) {
            assert!(bend.at.coords.iter().all(|c| c.is_finite()), "{bench:?}");
            let sines =
                bend.index_before * bend.sine_before() - bend.index_behind * bend.sine_after();
            assert!(
                bend.thrown_back.is_some() || sines.abs() < 1e-12,
                "{sines} {bench:?}"
            );
        }
        match &light.measurement {
            Ok(measurement) => {
                measured += 1;
                assert!(measurement.meeting.gap().is_finite());
            }
            Err(trouble) => assert!(!trouble.to_string().is_empty()),
        }
    }
    assert!(measured > 500, "{measured}");
}

/// The bench's light is the measurement's: vertices and last ray are those of `Stack::path`.
#[test]
fn the_benchs_path_is_that_of_the_core() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut compared = 0;
    for _ in 0..1000 {
        let bench = any_bench(&mut random);
        let light = Light::of(&bench);
        let path = bench.stack().path(&light.beam.start);
        assert_eq!(path.is_ok(), light.beam.is_inside());
        let Ok(path) = path else { continue };
        compared += 1;
        let bends: Vec<_> = light.beam.bends.iter().map(|bend| bend.at).collect();
        assert_eq!(path.vertices[1..], bends);
        assert_eq!(path.last, light.beam.last());
    }
    assert!(compared > 300, "{compared}");
}

#[test]
fn at_the_right_index_the_rays_meet_in_the_object_point() {
    for wall in 0..3 {
        let mut bench = Bench::default();
        CHOICES[1].set(&mut bench, wall);
        set(&mut bench, "pitch", 20.0);
        set(&mut bench, "turn", -10.0);
        let light = Light::of(&bench);
        assert!(light.ray_distance().unwrap() < 1e-8);
        assert!(light.error().unwrap() < 1e-7);
        assert!(light.spot.unwrap().distance(bench.object_point()) < 1e-8);
    }
}

/// The paper's eq. (3) can only work where the rays do not meet at a wrong index: not in a common plane.
#[test]
fn a_wrong_index_parts_the_rays_of_a_pitched_rig_only() {
    let mut bench = Bench::default();
    // Off the middle: rays at equal angles meet at every index too.
    set(&mut bench, "ox", 30.0);
    set(&mut bench, "assumed", 1.5);
    let level = Light::of(&bench);
    assert!(level.ray_distance().unwrap() < 1e-9);
    assert!(level.error().unwrap() > 5.0);
    set(&mut bench, "pitch", 30.0);
    let pitched = Light::of(&bench);
    assert!(
        pitched.ray_distance().unwrap() > 0.05,
        "{:?}",
        pitched.ray_distance()
    );
}

#[test]
fn beyond_the_critical_angle_light_is_thrown_back_at_the_same_angle() {
    let mut bench = Lesson::bench(2).unwrap();
    let critical = libm::asin(1.0003 / 1.332).to_degrees();
    set(&mut bench, "aim", critical.floor());
    assert_eq!(Light::of(&bench).beam.end, End::Inside);
    set(&mut bench, "aim", critical.ceil());
    let light = Light::of(&bench);
    assert_eq!(light.beam.end, End::ThrownBack { face: 1 });
    let bend = light.beam.bends[1];
    assert!((bend.angle_before() - bend.angle_after()).abs() < 1e-12);
    assert!(bend.after.dot(bend.normal) > 0.0, "it goes back");
    assert_eq!(light.measurement, Err(NoMeasurement::NoSpot));
    assert!(light.beam.trouble().unwrap().contains("inner face"));
}

#[test]
fn a_place_seen_from_above_is_found_on_the_rig_again() {
    let mut bench = Bench::default();
    set(&mut bench, "turn", 25.0);
    set(&mut bench, "pitch", -30.0);
    let place = bench.on_rig(bench.laser).coords;
    let [x, z] = bench.from_above(place.x, place.z);
    assert!((x - bench.laser[0]).abs() < 1e-9 && (z - bench.laser[1]).abs() < 1e-9);
    assert!(
        place.y > 0.0,
        "a rig pitched by a negative angle stands below"
    );
}

#[test]
fn every_lesson_opens_its_bench_and_knows_its_answer() {
    for (place, lesson) in LESSONS.iter().enumerate() {
        let bench = Lesson::bench(place).expect(lesson.title);
        assert_eq!(bench.lesson, Some(place));
        let again = read(&write(&bench)).unwrap();
        assert_eq!(again, bench, "{}", lesson.title);
        match lesson.answer {
            Answer::Number { value, within, .. } => {
                assert_eq!(lesson.judge(&value.to_string()), Reply::Right);
                assert_eq!(
                    lesson.judge(&value.to_string().replace('.', ",")),
                    Reply::Right
                );
                assert_eq!(
                    lesson.judge(&(value + 2.0 * within).to_string()),
                    Reply::Wrong
                );
            }
            Answer::Choice { options, right } => {
                for place in 0..options.len() {
                    let reply = lesson.judge(&place.to_string());
                    assert_eq!(reply == Reply::Right, place == right);
                }
            }
        }
        assert_eq!(lesson.judge("water"), Reply::Unreadable);
        assert_eq!(lesson.judge(""), Reply::Unreadable);
    }
}

/// What a lesson calls right is what doing its task on the bench shows.
#[test]
fn the_lessons_answers_are_what_the_bench_shows() {
    let number = |place: usize| match LESSONS[place].answer {
        Answer::Number { value, within, .. } => (value, within),
        Answer::Choice { .. } => panic!("{} asks for no number", LESSONS[place].title),
    };
    let holds = |place: usize, shown: f64| {
        let (value, within) = number(place);
        assert!(
            (shown - value).abs() < 0.5 * within,
            "{}: {shown}",
            LESSONS[place].title
        );
    };
    let inside = |bench: &Bench| Light::of(bench).beam.bends[1].angle_after().to_degrees();

    let mut snell = Lesson::bench(0).unwrap();
    set(&mut snell, "aim", 60.0);
    holds(0, inside(&snell));

    let mut slab = Lesson::bench(1).unwrap();
    let thin = inside(&slab);
    set(&mut slab, "thickness", 20.0);
    (MEDIA[1].set)(&mut slab, Medium::Index(1.7));
    assert!((inside(&slab) - thin).abs() < 1e-9);

    let thrown = Light::of(&Lesson::bench(2).unwrap());
    let glass = 1.5215 / 1.332;
    let critical = thrown.beam.bends[1].critical().unwrap();
    holds(2, libm::asin(libm::sin(critical) * glass).to_degrees());

    let depth = Light::of(&Lesson::bench(3).unwrap()).measurement.unwrap();
    holds(3, depth.apparent.unwrap().coords.z);

    holds(5, Lesson::bench(5).unwrap().liquid.index());

    let shape = Experiment::new(&Lesson::bench(6).unwrap());
    holds(6, shape.estimate().by_angle.unwrap());
}

/// A card through a full jar: wider by far, hardly higher.
#[test]
fn a_jar_magnifies_across_its_axis() {
    let bench = Lesson::bench(4).unwrap();
    let empty = Bench {
        liquid: bench.outside,
        ..bench
    };
    let size = |bench: &Bench| {
        let sight = Sight::new(bench, 800.0, 600.0);
        let at = |x, y| {
            let place = sight.middle + nalgebra::Vector3::new(x, y, 0.0);
            sight.pixel(place).unwrap()
        };
        [
            at(-8.0, 0.0).distance(at(8.0, 0.0)),
            at(0.0, -8.0).distance(at(0.0, 8.0)),
        ]
    };
    let ([wide, high], [wide_empty, high_empty]) = (size(&bench), size(&empty));
    println!(
        "wider {:.2}, higher {:.2}",
        wide / wide_empty,
        high / high_empty
    );
    assert!(wide / wide_empty > 1.25);
    assert!(high / high_empty < 1.10);
}

#[test]
fn the_eye_sees_a_place_where_its_ray_reaches_it() {
    for wall in 0..3 {
        let mut bench = Bench::default();
        CHOICES[1].set(&mut bench, wall);
        let sight = Sight::new(&bench, 800.0, 600.0);
        let pixel = Pixel::new(390.0, 330.0);
        let inside = sight.stack.trace(&sight.ray(pixel)).unwrap();
        assert!(sight.off_by(pixel, inside.at(60.0)).unwrap() < 1e-9);
        // A place a little beside the ray is told from it.
        let beside = inside.at(60.0) + nalgebra::Vector3::new(0.2, 0.0, 0.0);
        assert!(sight.off_by(pixel, beside).unwrap() > 0.1);
    }
}

fn index_bench(pitch: f64) -> Bench {
    let mut bench = Bench::default();
    set(&mut bench, "pitch", pitch);
    bench
}

#[test]
fn without_noise_both_equations_find_the_index() {
    let estimate = Experiment::new(&index_bench(20.0)).estimate();
    assert!(
        (estimate.by_angle.unwrap() - 1.332).abs() < 1e-3,
        "{estimate:?}"
    );
    assert!(
        (estimate.by_ray_distance - 1.332).abs() < 1e-3,
        "{estimate:?}"
    );
}

#[test]
fn the_l_closes_and_opens_as_in_the_papers_figure() {
    let experiment = Experiment::new(&index_bench(0.0));
    assert!(experiment.spots().len() > 30);
    let angles = [0.9, 1.332, 1.7].map(|index| experiment.angle(index).unwrap());
    println!("angles at 0.9, 1.332 and 1.7: {angles:?}");
    assert!((angles[1] - 90.0).abs() < 1e-6);
    // By -(180/pi)/n degrees per unit of n, to first order.
    assert!(angles[0] > 105.0 && angles[2] < 78.0, "{angles:?}");
}

#[test]
fn squarely_before_the_tank_the_sum_of_ray_distances_is_flat() {
    let spread = |pitch: f64| {
        let experiment = Experiment::new(&index_bench(pitch));
        let sums = [0.95, 1.1, 1.332, 1.5, 1.75].map(|n| experiment.sum_of_ray_distances(n));
        sums.iter().fold(0.0_f64, |most, sum| most.max(*sum))
    };
    assert!(spread(0.0) < 1e-9, "{}", spread(0.0));
    assert!(spread(20.0) > 10.0, "{}", spread(20.0));
}

/// Squarely, the least sum lies at an end of the range, whatever the noise; pitched, round the truth.
#[test]
fn ray_distances_find_the_index_only_if_the_rig_is_pitched() {
    let tries = |pitch: f64| -> Vec<f64> {
        let mut bench = index_bench(pitch);
        set(&mut bench, "noise", 0.2);
        let experiment = Experiment::new(&bench);
        let by = |number| experiment.disturbed(number).estimate().by_ray_distance;
        (0..12).map(by).collect()
    };
    for n in tries(0.0) {
        assert!(
            n - RANGE.0 < 0.02 || RANGE.1 - n < 0.02,
            "{n} is no end of the range"
        );
    }
    let pitched = tries(35.0);
    let mean = pitched.iter().sum::<f64>() / 12.0;
    let squares: f64 = pitched.iter().map(|n| (n - mean) * (n - mean)).sum();
    let deviation = (squares / 11.0).sqrt();
    println!("pitched by 35 degrees: n = {mean:.3} with a standard deviation of {deviation:.3}");
    assert!(deviation < 0.02, "{pitched:?}");
    assert!((mean - 1.332).abs() < 0.02, "{pitched:?}");
}

#[test]
fn the_same_number_gives_the_same_try() {
    let mut bench = index_bench(20.0);
    set(&mut bench, "noise", 0.5);
    set(&mut bench, "out", 0.05);
    let experiment = Experiment::new(&bench);
    let pixels = |number| -> Vec<f64> {
        let disturbed = experiment.disturbed(number);
        disturbed.spots().iter().map(|spot| spot.pixel.u).collect()
    };
    assert_eq!(pixels(4), pixels(4));
    assert_ne!(pixels(4), pixels(5));
    let of_four = pixels(4);
    let exact = experiment.spots().iter().map(|spot| spot.pixel.u);
    let squares: f64 = exact.zip(&of_four).map(|(a, b)| (a - b) * (a - b)).sum();
    let deviation = (squares / of_four.len() as f64).sqrt();
    assert!((0.35..0.65).contains(&deviation), "{deviation}");
}

/// A ray that is thrown back can be followed again: the reflection is the law's, not a drawing's.
#[test]
fn the_thrown_back_ray_is_the_mirror_image() {
    let mut bench = Lesson::bench(2).unwrap();
    set(&mut bench, "aim", 60.0);
    let bend = Light::of(&bench).beam.bends[1];
    let back = Direction::new(-bend.after.vector()).unwrap();
    let again = Ray::new(bend.at, back);
    let normal = bend.normal.vector();
    let mirrored =
        again.direction.vector() - normal * (2.0 * again.direction.vector().dot(&normal));
    assert!((mirrored + bend.before.vector()).norm() < 1e-12);
}

/// The table of link parameters is documented, key by key.
#[test]
fn the_documentation_names_every_parameter() {
    let page = include_str!("../../docs/refraction-lab.md");
    let keys = CHOICES.iter().map(|c| c.key);
    let keys = keys
        .chain(MEDIA.iter().map(|m| m.key))
        .chain(QUANTITIES.iter().map(|q| q.key));
    for key in keys {
        assert!(
            page.contains(&format!("| `{key}` |")),
            "{key} is not documented"
        );
    }
    for quantity in &QUANTITIES {
        let range = format!("{} to {}", quantity.low, quantity.high).replace('-', "\u{2212}");
        assert!(
            page.contains(&range),
            "{}: {range} is not documented",
            quantity.key
        );
    }
    for substance in &SUBSTANCES {
        assert!(
            page.contains(&format!("`{}`", substance.key)),
            "{}",
            substance.name
        );
    }
}
