//! What computes, in the page's workers.

fn main() {
    snellius_web::worker();
}
