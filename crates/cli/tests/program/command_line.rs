//! A command line that cannot be understood gets one line and exit code 2.

use std::process::Command;

#[test]
fn what_is_wrong_with_the_command_line_is_one_line() {
    for (arguments, part) in [
        (&["cea", "case.toml", "--speed", "fast"][..], "invalid value 'fast' for '--speed <V>'"),
        (&["cea", "case.toml", "--fast"], "unexpected argument '--fast'"),
        (&["run", "case.toml"], "--out <DIR>"),
        (&["sing"], "unrecognized subcommand 'sing'"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_squeal")).args(arguments).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), message.lines().count(), output.stdout.len()), (Some(2), 1, 0), "{message}");
        assert!(message.starts_with("error: ") && message.contains(part), "{message}");
    }
}

#[test]
fn help_and_version_are_no_errors() {
    for argument in ["--help", "--version"] {
        let output = Command::new(env!("CARGO_BIN_EXE_squeal")).arg(argument).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty() && !output.stdout.is_empty());
    }
}
