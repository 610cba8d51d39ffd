//! The `grainlab` binary.

fn main() -> std::process::ExitCode {
    grainlab_command::main(std::env::args_os().collect()).into()
}
