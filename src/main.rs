//! The command `etendue`.

fn main() -> std::process::ExitCode {
    etendue::cli::main()
}
