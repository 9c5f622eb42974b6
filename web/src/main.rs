//! The page.

fn main() {
    snellius_web::page();
}
