# The crates that are meant for crates.io, those before that others depend on.
# shellcheck disable=SC2034
publishable=(cede-sqrt cede-controller cede-formats cede-nnv-check cede-nnv cede-testing)
