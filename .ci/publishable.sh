# The crates that are meant for crates.io, those before that others depend on.
publishable=(cede-sqrt cede-controller cede-formats cede-nnv-check cede-nnv cede-testing)

# package OPTION...: packs them into .build/package/package and builds each from what was packed. Cargo does so by a
# registry of its own, whose crates it neither unpacks nor compiles twice, not even changed ones: nothing may be left
# of an earlier run, here or in Cargo's home.
package() {
    rm -rf .build/package "${CARGO_HOME:-$HOME/.cargo}"/registry/src/-*/cede-*
    cargo package --locked --target-dir .build/package "$@" "${publishable[@]/#/--package=}"
}
