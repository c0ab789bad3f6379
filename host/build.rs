//! Compiles the logger of FMI 2.0, a variadic function, which stable Rust cannot define.

fn main() {
    println!("cargo:rerun-if-changed=src/fmu/logger.c");
    cc::Build::new()
        .file("src/fmu/logger.c")
        .warnings(true)
        .compile("flexarm_fmi2_logger");
}
