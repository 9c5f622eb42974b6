//! Set-up, serving, tests and benchmarks.
fn main() {}
