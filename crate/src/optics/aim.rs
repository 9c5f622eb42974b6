use nalgebra::{Matrix2, Vector2};

use super::{Stack, TraceError};
use crate::geometry::{Direction, Point, Ray, World};

/// No ray from the eye to the target was found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AimError {
    /// Light towards the target does not get through.
    #[error(transparent)]
    Blocked(#[from] TraceError),
    /// The search did not settle.
    #[error("no ray through the faces reaches the point; the closest passes {miss:.3e} mm off")]
    NotReached {
        /// How far off the best ray passes, mm.
        miss: f64,
    },
}

const CLOSE_ENOUGH: f64 = 1e-10;
const STEPS: usize = 60;

/// The direction in which an eye at `eye` sees the point `target` behind the stack: the forward
/// projection, for any faces.
///
/// Newton's method on the two angles of the outgoing ray, halving the step while it does not help. It
/// drives the traced ray's offset from the target to below 1e-10 mm.
pub fn aim_through(
    stack: &Stack,
    eye: Point<World>,
    target: Point<World>,
) -> Result<Direction<World>, AimError> {
    let straight = Direction::new(target - eye).map_err(|_| AimError::NotReached { miss: 0.0 })?;
    let (mut aim, mut miss) = start(stack, eye, straight, target)?;
    for _ in 0..STEPS {
        if miss.norm() < CLOSE_ENOUGH {
            return Ok(aim);
        }
        let step = newton_step(stack, eye, aim, target, miss)?;
        let Some((better, smaller)) = shorten_until_better(step, miss, |step| {
            let next = aim.tilted(step.x, step.y);
            offset(stack, eye, next, target)
                .map(|miss| (next, miss))
                .ok()
        }) else {
            break;
        };
        (aim, miss) = (better, smaller);
    }
    // What rounding leaves at long distances is good enough; anything above is not an answer.
    if miss.norm() < 1e-7 {
        Ok(aim)
    } else {
        Err(AimError::NotReached { miss: miss.norm() })
    }
}

/// The ray to start from: straight at the target or, where that is thrown back by a thinner medium, the
/// first of some ever squarer to the first face that gets through.
fn start(
    stack: &Stack,
    eye: Point<World>,
    straight: Direction<World>,
    target: Point<World>,
) -> Result<(Direction<World>, Vector2<f64>), TraceError> {
    const PARTS: i32 = 16;
    let try_aim = |aim| offset(stack, eye, aim, target).map(|miss| (aim, miss));
    let first = try_aim(straight);
    let thrown_back = |e: &TraceError| matches!(e.problem, super::TraceProblem::TotalReflection(_));
    if !first.as_ref().is_err_and(thrown_back) {
        return first;
    }
    let entry = stack
        .interfaces
        .first()
        .and_then(|face| face.surface.hit(&Ray::new(eye, straight)));
    let squarer = |part: i32| {
        let part = f64::from(part) / f64::from(PARTS);
        let blend = straight * (1.0 - part) - entry?.normal * part;
        try_aim(Direction::new(blend).ok()?).ok()
    };
    (1..=PARTS).find_map(squarer).map_or(first, Ok)
}

/// How far the traced ray passes from the target, across two directions fixed to the ray aimed at it.
fn offset(
    stack: &Stack,
    eye: Point<World>,
    aim: Direction<World>,
    target: Point<World>,
) -> Result<Vector2<f64>, TraceError> {
    let light = stack.trace(&Ray::new(eye, aim))?;
    let to_target = target - light.origin;
    let (u, v) = light.direction.tangents();
    Ok(Vector2::new(to_target.dot(&u), to_target.dot(&v)))
}

fn newton_step(
    stack: &Stack,
    eye: Point<World>,
    aim: Direction<World>,
    target: Point<World>,
    miss: Vector2<f64>,
) -> Result<Vector2<f64>, AimError> {
    const H: f64 = 1e-6;
    let along = |a: f64, b: f64| {
        let ahead = offset(stack, eye, aim.tilted(a, b), target)?;
        let back = offset(stack, eye, aim.tilted(-a, -b), target)?;
        Ok::<_, TraceError>((ahead - back) / (2.0 * H))
    };
    let jacobian = Matrix2::from_columns(&[along(H, 0.0)?, along(0.0, H)?]);
    let inverse = jacobian
        .try_inverse()
        .ok_or(AimError::NotReached { miss: miss.norm() })?;
    Ok(-(inverse * miss))
}

fn shorten_until_better<T>(
    mut step: Vector2<f64>,
    miss: Vector2<f64>,
    try_step: impl Fn(Vector2<f64>) -> Option<(T, Vector2<f64>)>,
) -> Option<(T, Vector2<f64>)> {
    for _ in 0..30 {
        match try_step(step) {
            Some((found, next)) if next.norm() < miss.norm() => return Some((found, next)),
            _ => step *= 0.5,
        }
    }
    None
}
