//! The yardstick u: what one predict and update of a 4-state Kalman filter costs here and now.

use nalgebra::{Matrix2, Matrix2x4, Matrix4, Vector2, Vector4};
use std::hint::black_box;
use std::time::Instant;

/// u in nanoseconds: the least of many short runs, for what other programs do only ever adds, and some of these runs it misses.
pub fn yardstick_ns() -> f64 {
    const ROUNDS: u32 = 5_000;
    let once = |_| {
        let start = Instant::now();
        kalman_rounds(ROUNDS);
        start.elapsed().as_secs_f64() * 1e9 / f64::from(ROUNDS)
    };
    (0..600).map(once).fold(f64::INFINITY, f64::min)
}

/// Rounds of the textbook filter, written the plain way. Its matrices are hidden from the compiler, which else would leave out
/// the zeros and ones in them in one benchmark and not in another.
#[inline(never)]
fn kalman_rounds(rounds: u32) {
    let dt = 8.0;
    let f = Matrix4::new(
        1.0, 0.0, dt, 0.0, 0.0, 1.0, 0.0, dt, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    );
    let h = Matrix2x4::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0);
    let (q, r) = (Matrix4::identity() * 0.5, Matrix2::identity() * 100.0);
    let (f, h, q, r) = black_box((f, h, q, r));
    let (mut x, mut p) = (Vector4::zeros(), Matrix4::identity() * 1e4);
    for round in 0..rounds {
        let z = Vector2::new(f64::from(round % 7), f64::from(round % 5));
        x = f * x;
        p = f * p * f.transpose() + q;
        let s = h * p * h.transpose() + r;
        let gain = p * h.transpose() * s.try_inverse().expect("S is positive definite");
        x += gain * (z - h * x);
        p = (Matrix4::identity() - gain * h) * p;
        black_box((&x, &p));
    }
}
