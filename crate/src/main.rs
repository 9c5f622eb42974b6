//! The companion program.
use snellius::{pipeline::*, scan::*};
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let t = std::time::Instant::now();
    let mut a = Archive::open(std::io::BufReader::new(std::fs::File::open(path).unwrap())).unwrap();
    let s = Settings::default();
    let n = a.scan().stations.len();
    let t1 = std::time::Instant::now();
    for v in 0..n {
        a.pictures(v).unwrap();
    }
    eprintln!("decode {:?}", t1.elapsed());
    let t2 = std::time::Instant::now();
    let spots: Vec<_> = (0..n).map(|v| observe(&mut a, v, &s).unwrap()).collect();
    eprintln!("observe {:?} {:?}", t2.elapsed(), t.elapsed());
    let t3 = std::time::Instant::now();
    let r = reconstruct(a.scan(), &spots, &s).unwrap();
    eprintln!("rest {:?}", t3.elapsed());
    println!("{}", r.result().to_json());
}
