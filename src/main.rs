//! The `trackloom` program: everything is in the library.

fn main() -> std::process::ExitCode {
    trackloom::service::cli::main()
}
