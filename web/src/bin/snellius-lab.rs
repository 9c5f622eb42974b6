//! The refraction lab.

fn main() {
    snellius_web::lab();
}
