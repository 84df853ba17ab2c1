//! The program: its commands by name, and what it ends with.

use std::ffi::OsString;
use std::io::Write;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;

use crate::{
    CeaArgs, CheckArgs, CompareArgs, CycleArgs, EigArgs, Error, ExplainArgs, InfluenceArgs, MergeArgs, NewArgs,
    PrepareArgs, RareArgs, RunArgs, ScreenArgs, SweepArgs, finish, refuse,
};

/// Which modes of a brake will squeal, how sure are we, and what stops them?
#[derive(Debug, Parser)]
#[command(
    name = "squeal",
    version,
    about,
    after_help = "Exit codes: 0 done; 1 done, but of a reduced brake that does not have the modes of the whole one; 2 an error, \
                  said in one line on standard error: a command line or file that cannot be \
                  used, a folder that cannot be written, or a study of which more than half failed."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    New(NewArgs),
    Run(RunArgs),
    Merge(MergeArgs),
    Prepare(PrepareArgs),
    Cea(CeaArgs),
    Check(CheckArgs),
    Eig(EigArgs),
    Sweep(SweepArgs),
    Cycle(CycleArgs),
    Influence(InfluenceArgs),
    Rare(RareArgs),
    Screen(ScreenArgs),
    Compare(CompareArgs),
    Explain(ExplainArgs),
    /// Print completions of these commands for a shell, to be put where it looks for them.
    #[command(after_help = "Example: squeal completions bash > squeal.bash")]
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Print the manual of all commands, for man.
    #[command(after_help = "Example: squeal man > squeal.1")]
    Man,
}

/// The commands and options of the program, for what is made of them: completions, manuals, tests.
#[must_use]
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the program with these arguments, of which the first is its own name, and returns its exit code.
pub fn program(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => return refuse(&error),
    };
    let mut out = std::io::stdout().lock();
    let result = match &cli.command {
        Command::New(args) => args.run(&mut out),
        Command::Run(args) => args.run(&mut out),
        Command::Merge(args) => args.run(&mut out),
        Command::Prepare(args) => args.run(&mut out),
        Command::Cea(args) => args.run(&mut out),
        Command::Check(args) => args.run(&mut out),
        Command::Eig(args) => args.run(&mut out),
        Command::Sweep(args) => args.run(&mut out),
        Command::Cycle(args) => args.run(&mut out),
        Command::Influence(args) => args.run(&mut out),
        Command::Rare(args) => args.run(&mut out),
        Command::Screen(args) => args.run(&mut out),
        Command::Compare(args) => args.run(&mut out),
        Command::Explain(args) => args.run(&mut out),
        Command::Completions { shell } => completions(*shell, &mut out),
        Command::Man => manual(&mut out).map_err(Error::StandardOutput),
    };
    finish(result.and_then(|()| out.flush().map_err(Error::StandardOutput)))
}

fn completions(shell: Shell, out: &mut dyn Write) -> Result<(), Error> {
    // The generator panics where it cannot write.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command(), "squeal", &mut script);
    out.write_all(&script).map_err(Error::StandardOutput)
}

/// The page of the program, and after it those of its commands.
fn manual(out: &mut dyn Write) -> std::io::Result<()> {
    let mut program = command();
    program.build();
    clap_mangen::Man::new(program.clone()).render(out)?;
    for command in program.get_subcommands().filter(|command| command.get_name() != "help") {
        let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
        clap_mangen::Man::new(command.clone()).title(name).render(out)?;
    }
    Ok(())
}
