//! Tells the linker where `memory.x` and `riscv.x` are, and the compiler where the golden file is.
fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo:rustc-link-search={here}");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed=riscv.x");
    println!("cargo:rerun-if-env-changed=CEDE_GOLDEN");
}
