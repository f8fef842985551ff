fn main() -> std::process::ExitCode {
    rattlebench::cli::main()
}
