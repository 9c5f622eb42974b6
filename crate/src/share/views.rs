//! The views of a result as columns, and back.

use super::LinkError;
use super::columns::{ColumnError, Columns, Reader};
use super::head::{Head, SIGMA_STEPS_PER_OCTAVE, Steps};
use crate::export::{OneOrMany, ReconstructionResult, Status, ViewResult};

const STATUSES: [Status; 4] = [
    Status::Ok,
    Status::NoVesselSpot,
    Status::NoObjectSpot,
    Status::Rejected,
];

/// Writes all views. The order of the columns is the format.
pub(super) fn write(result: &ReconstructionResult, steps: &Steps, columns: &mut Columns) {
    let views = &result.views;
    columns.number(views.len() as i64);
    let one_row = vec![0; views.len()];
    let status = |view: &ViewResult| STATUSES.iter().position(|s| *s == view.status);
    let per_view: [&dyn Fn(&ViewResult) -> i64; 4] = [
        &|view| i64::from(view.sweep),
        &|view| status(view).unwrap_or(0) as i64,
        &|view| view.object.as_slice().len() as i64,
        &|view| view.vessel.as_slice().len() as i64,
    ];
    for value in per_view {
        columns.rows(&views.iter().map(value).collect::<Vec<_>>(), &one_row);
    }

    let rows = rows(views, |view| view.object.as_slice().len());
    for axis in 0..3 {
        let places = views.iter().flat_map(|view| view.object.iter());
        let places = places.map(|p| in_steps(p[axis], steps.object[axis]));
        columns.rows(&places.collect::<Vec<_>>(), &rows);
    }
    for sigmas in [
        |view: &ViewResult| padded(&view.object_sigma, &view.object, [0.0; 3]),
        |view: &ViewResult| padded(&view.object_sigma_calibration, &view.object, [0.0; 3]),
    ] {
        let levels = views.iter().flat_map(sigmas);
        let levels: Vec<[i64; 3]> = levels.map(|sigma| sigma.map(level)).collect();
        // The depth's deviation is the largest, and the others go with it.
        let columns_of: [fn(&[i64; 3]) -> i64; 3] =
            [|[_, _, z]| *z, |[x, _, z]| x - z, |[_, y, z]| y - z];
        for column in columns_of {
            columns.rows(&levels.iter().map(column).collect::<Vec<_>>(), &rows);
        }
    }
    let distances = views
        .iter()
        .flat_map(|v| padded(&v.ray_distance, &v.object, 0.0));
    let distances = distances.map(|l| in_steps(l, steps.ray_distance));
    // They have nothing to do with one another.
    distances.for_each(|l| columns.number(l));

    write_shown(views, steps, columns);
}

/// What is only looked at: vessel points, and where the object's points would be without refraction.
fn write_shown(views: &[ViewResult], steps: &Steps, columns: &mut Columns) {
    let vessel_rows = rows(views, |view| view.vessel.as_slice().len());
    for axis in 0..3 {
        let places = views.iter().flat_map(|view| view.vessel.iter());
        let places = places.map(|p| in_steps(p[axis], steps.shown));
        columns.rows(&places.collect::<Vec<_>>(), &vessel_rows);
    }
    let unrefracted = |view: &ViewResult| padded(&view.object_unrefracted, &view.object, None);
    let straight: Vec<Option<[f64; 3]>> = views.iter().flat_map(unrefracted).collect();
    for place in &straight {
        columns.number(i64::from(place.is_some()));
    }
    let all_rows = rows(views, |view| view.object.as_slice().len());
    let rows: Vec<usize> = there(&straight, &all_rows);
    for axis in 0..3 {
        let places = straight.iter().flatten();
        let places = places.map(|p| in_steps(p[axis], steps.shown));
        columns.rows(&places.collect::<Vec<_>>(), &rows);
    }
}

/// Reads all views.
pub(super) fn read(head: &Head, columns: &mut Reader) -> Result<Vec<ViewResult>, LinkError> {
    let count = count(columns.number()?, columns.left())?;
    let one_row = vec![0; count];
    let sweeps = columns.rows(&one_row)?;
    let statuses = columns.rows(&one_row)?;
    let object_counts = counts(columns, &one_row, head.line)?;
    let vessel_counts = counts(columns, &one_row, head.line)?;
    let steps = head.steps();

    let rows = rows_of(&sweeps, &object_counts);
    let objects = places(columns, &rows, steps.object)?;
    let noise = sigmas(columns, &rows)?;
    let common = sigmas(columns, &rows)?;
    let mut distances = Vec::with_capacity(rows.len());
    for _ in &rows {
        distances.push(columns.number()? as f64 * steps.ray_distance);
    }
    let vessel_rows = rows_of(&sweeps, &vessel_counts);
    let vessel = places(columns, &vessel_rows, [steps.shown; 3])?;
    let straight = read_straight(columns, &rows, steps.shown)?;

    let mut points = (0, 0);
    (0..count)
        .map(|view| {
            let (object, wall) = (object_counts[view], vessel_counts[view]);
            let of = points.0..points.0 + object;
            let on = points.1..points.1 + wall;
            points = (of.end, on.end);
            let status = usize::try_from(statuses[view]).ok();
            Ok(ViewResult {
                id: head.ids.name(view).ok_or(ColumnError::Short)?,
                sweep: u32::try_from(sweeps[view]).map_err(|_| ColumnError::Large)?,
                status: *status
                    .and_then(|status| STATUSES.get(status))
                    .ok_or(ColumnError::Large)?,
                reason: None,
                inside_proposed: None,
                inside: None,
                vessel: of_laser(&vessel[on], head.line),
                object: of_laser(&objects[of.clone()], head.line),
                object_sigma: of_laser(&noise[of.clone()], head.line),
                object_sigma_calibration: of_laser(&common[of.clone()], head.line),
                ray_distance: of_laser(&distances[of.clone()], head.line),
                object_unrefracted: of_laser(&straight[of], head.line),
                spots: Vec::new(),
                line: None,
            })
        })
        .collect()
}

fn read_straight(
    columns: &mut Reader,
    rows: &[usize],
    step: f64,
) -> Result<Vec<Option<[f64; 3]>>, LinkError> {
    let mut are_there = Vec::with_capacity(rows.len());
    for _ in rows {
        are_there.push((columns.number()? != 0).then_some(()));
    }
    let mut places = places(columns, &there(&are_there, rows), [step; 3])?.into_iter();
    Ok(are_there
        .iter()
        .map(|is| is.and_then(|()| places.next()))
        .collect())
}

/// A number that counts what follows: each takes a byte at least.
fn count(value: i64, left: usize) -> Result<usize, ColumnError> {
    let count = usize::try_from(value).map_err(|_| ColumnError::Large)?;
    if count > left {
        return Err(ColumnError::Short);
    }
    Ok(count)
}

fn counts(columns: &mut Reader, one_row: &[usize], line: bool) -> Result<Vec<usize>, ColumnError> {
    let counts = columns.rows(one_row)?;
    let counts: Vec<usize> = counts
        .into_iter()
        .map(|value| match count(value, columns.left())? {
            many if many > 1 && !line => Err(ColumnError::Large),
            few => Ok(few),
        })
        .collect::<Result<_, _>>()?;
    let all = counts
        .iter()
        .try_fold(0_usize, |sum, n| sum.checked_add(*n));
    match all {
        Some(all) if all <= columns.left() => Ok(counts),
        _ => Err(ColumnError::Short),
    }
}

/// The row of each point: the sweep of a spot laser, the view of a line laser.
fn rows(views: &[ViewResult], count: impl Fn(&ViewResult) -> usize) -> Vec<usize> {
    let sweeps: Vec<i64> = views.iter().map(|view| i64::from(view.sweep)).collect();
    rows_of(&sweeps, &views.iter().map(count).collect::<Vec<_>>())
}

fn rows_of(sweeps: &[i64], counts: &[usize]) -> Vec<usize> {
    let is_line = counts.iter().any(|count| *count > 1);
    let views = sweeps.iter().zip(counts).enumerate();
    views
        .flat_map(|(view, (sweep, count))| {
            let row = if is_line { view } else { *sweep as usize };
            std::iter::repeat_n(row, *count)
        })
        .collect()
}

/// The rows of those that are there.
fn there<T>(values: &[Option<T>], rows: &[usize]) -> Vec<usize> {
    let pairs = values.iter().zip(rows);
    pairs
        .filter(|(value, _)| value.is_some())
        .map(|(_, row)| *row)
        .collect()
}

/// As many values as a view has points, whatever a file from elsewhere has.
fn padded<T: Copy, P>(values: &OneOrMany<T>, points: &OneOrMany<P>, missing: T) -> Vec<T> {
    let values = values.iter().copied().chain(std::iter::repeat(missing));
    values.take(points.as_slice().len()).collect()
}

fn of_laser<T: Copy>(values: &[T], line: bool) -> OneOrMany<T> {
    if line {
        OneOrMany::Many(values.to_vec())
    } else {
        OneOrMany::One(values.first().copied())
    }
}

fn in_steps(value: f64, step: f64) -> i64 {
    (value / step).round() as i64
}

fn places(
    columns: &mut Reader,
    rows: &[usize],
    steps: [f64; 3],
) -> Result<Vec<[f64; 3]>, LinkError> {
    let [x, y, z] = steps.map(|step| (columns.rows(rows), step));
    let scaled = |(column, step): (Result<Vec<i64>, ColumnError>, f64)| {
        column.map(|values| values.into_iter().map(move |v| v as f64 * step))
    };
    let (x, y, z) = (scaled(x)?, scaled(y)?, scaled(z)?);
    Ok(x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect())
}

fn sigmas(columns: &mut Reader, rows: &[usize]) -> Result<Vec<[f64; 3]>, LinkError> {
    let (z, x, y) = (
        columns.rows(rows)?,
        columns.rows(rows)?,
        columns.rows(rows)?,
    );
    let levels = z.into_iter().zip(x).zip(y);
    let triple =
        |((z, x), y): ((i64, i64), i64)| [x.wrapping_add(z), y.wrapping_add(z), z].map(sigma);
    Ok(levels.map(triple).collect())
}

/// A standard deviation as a logarithm; below a hundredth of a micrometre it is none.
fn level(sigma: f64) -> i64 {
    (libm::log2(sigma.max(1e-5) / 1e-5) * SIGMA_STEPS_PER_OCTAVE).round() as i64
}

fn sigma(level: i64) -> f64 {
    // 128 octaves above a hundredth of a micrometre hold whatever is measured.
    let level = level.clamp(0, 256);
    if level == 0 {
        return 0.0;
    }
    1e-5 * libm::exp2(level as f64 / SIGMA_STEPS_PER_OCTAVE)
}
