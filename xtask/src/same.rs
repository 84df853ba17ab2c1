//! Two commits of this project side by side: the same commands on the same inputs, and all that they say and write compared.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use squeal::output::{make_folder, write};
use squeal_cli::terminal::{note, say};

use crate::error::TaskError;

/// Command that is run for both commits; `{out}` stands for a folder of its own.
struct Run {
    /// Name of the command, and of its folder.
    name: &'static str,
    /// `squeal` or `xtask`.
    program: &'static str,
    /// Arguments, separated by spaces.
    arguments: &'static str,
}

const fn run_of(name: &'static str, program: &'static str, arguments: &'static str) -> Run {
    Run { name, program, arguments }
}

/// The commands: each kind of brake, each command of the program, and each route on which a mode is found. They take some four
/// minutes on two cores, for each commit.
const RUNS: [Run; 22] = [
    run_of("paper", "xtask", "reproduce --smoke --out {out}"),
    run_of("two-by-two", "squeal", "run cases/two-by-two.toml --out {out}"),
    run_of("half-width", "squeal", "run cases/two-by-two.toml --half-width 0.05 --out {out}"),
    run_of("hoffmann", "squeal", "run cases/hoffmann.toml --keep-samples --out {out}"),
    run_of("disc", "squeal", "run cases/wobbling-disc.toml --out {out}"),
    run_of("disk-brake100", "squeal", "run cases/disk-brake100.toml --samples 20 --out {out}"),
    run_of("disc-pad", "squeal", "run cases/disc-pad/disc-pad.toml --samples 3 --out {out}"),
    run_of("check-lattice", "squeal", "check cases/two-by-two.toml"),
    run_of("check-matrices", "squeal", "check cases/disk-brake100.toml"),
    run_of("cea-lattice", "squeal", "cea cases/paper.toml --modes --json"),
    run_of("cea-why", "squeal", "cea cases/two-by-two.toml --why"),
    run_of("cea-disc-pad", "squeal", "cea cases/disc-pad/disc-pad.toml --modes --json"),
    run_of("sweep", "squeal", "sweep cases/paper.toml --over mu=0:1.3 --out {out}"),
    run_of("map", "squeal", "sweep cases/two-by-two.toml --over mu=0:1.3 --over x_damping=50:400 --out {out}"),
    run_of("sweep-disc-pad", "squeal", "sweep cases/disc-pad/disc-pad.toml --over mu=0:0.6 --out {out}"),
    run_of(
        "screen",
        "squeal",
        "screen cases/two-by-two.toml --kinds constraint,dashpot,contact --up-to 2 --samples 50 --out {out}",
    ),
    run_of("influence", "squeal", "influence cases/wobbling-disc.toml --total 500 --out {out}"),
    run_of("eig", "squeal", "eig --mass cases/disk-brake100/M.mtx --stiffness cases/disk-brake100/K1.mtx --json"),
    run_of(
        "eig-matlab",
        "squeal",
        "eig --mass crates/formats/tests/fixtures/matlab/BDLL00.mat --stiffness crates/formats/tests/fixtures/matlab/BDLL00.mat",
    ),
    run_of(
        "eig-calculix",
        "squeal",
        "eig --mass crates/formats/tests/fixtures/calculix/tiny.mas --stiffness crates/formats/tests/fixtures/calculix/tiny.sti",
    ),
    run_of(
        "eig-abaqus",
        "squeal",
        "eig --mass crates/formats/tests/fixtures/abaqus_matrix_input/model_MASS1.mtx --stiffness \
         crates/formats/tests/fixtures/abaqus_matrix_input/model_STIF1.mtx",
    ),
    run_of(
        "eig-box",
        "squeal",
        "eig --mass cases/disc-pad/disc-pad.mas.gz --stiffness cases/disc-pad/disc-pad.sti.gz --box=-1:1,1:12000",
    ),
];

/// Two commits side by side: builds the programs of both, runs the same commands on the inputs of the first, and compares all
/// that they say and write, but for times and the commit's own name
///
/// A change that moves code leaves everything the same; one that changes a number shows here which ones. What runs once is kept
/// in OUT and not run again.
#[derive(Debug, clap::Args)]
pub struct SameArgs {
    /// The commit to compare with, as git names it
    before: String,
    /// The commit that is compared
    #[arg(default_value = "HEAD")]
    after: String,
    /// Commands to run, by name [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    only: Vec<String>,
    /// Folder for the programs and their results [default: target/same]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs the task.
///
/// # Errors
/// [`TaskError::Differ`] where anything is not the same; a commit that git does not know or that does not build.
pub fn run(args: &SameArgs) -> Result<(), TaskError> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let known = || RUNS.iter().map(|run| run.name).collect::<Vec<_>>().join(", ");
    if let Some(unknown) = args.only.iter().find(|name| RUNS.iter().all(|run| run.name != **name)) {
        return Err(TaskError::Same(format!("--only {unknown}: no such command; there are {}", known())));
    }
    let out = args.out.clone().unwrap_or_else(|| root.join("target/same"));
    make_folder(&out)?;
    let out = out.canonicalize().map_err(TaskError::Start)?;
    let tree = Tree { root: &root, out: &out };
    let commits = [&args.before, &args.after].map(|revision| tree.commit(revision));
    let [before, after] = commits;
    let (before, after) = (before?, after?);
    for commit in [&before, &after] {
        tree.build(commit)?;
    }
    // Both read the inputs of the first commit.
    tree.check_out(&before)?;
    let (mut text, mut differing) = (String::new(), 0);
    for run in RUNS.iter().filter(|run| args.only.is_empty() || args.only.iter().any(|name| name == run.name)) {
        note(run.name);
        let [first, second] = [&before, &after].map(|commit| tree.results(commit, run));
        let different = differences(&first?, &second?, [&before, &after], &out)?;
        differing += usize::from(!different.is_empty());
        let said = if different.is_empty() { "the same".into() } else { different.join("; ") };
        text += &format!("{:<16} {said}\n", run.name);
    }
    say(&text)?;
    if differing > 0 { Err(TaskError::Differ(differing)) } else { Ok(()) }
}

/// A checkout of its own, in which both commits are built one after the other, so that they have their dependencies in common.
struct Tree<'a> {
    root: &'a Path,
    out: &'a Path,
}

impl Tree<'_> {
    fn checkout(&self) -> PathBuf {
        self.out.join("tree")
    }

    /// The full name of a commit.
    fn commit(&self, revision: &str) -> Result<String, TaskError> {
        let name = format!("{revision}^{{commit}}");
        said(
            "git",
            self.root,
            [OsStr::new("rev-parse"), "--verify".as_ref(), "--end-of-options".as_ref(), name.as_ref()],
        )
    }

    fn check_out(&self, commit: &str) -> Result<(), TaskError> {
        let tree = self.checkout();
        let known: [&OsStr; 5] =
            ["worktree".as_ref(), "add".as_ref(), "--detach".as_ref(), tree.as_ref(), commit.as_ref()];
        let again: [&OsStr; 4] = ["checkout".as_ref(), "--quiet".as_ref(), "--detach".as_ref(), commit.as_ref()];
        if tree.join("Cargo.toml").exists() { said("git", &tree, again) } else { said("git", self.root, known) }
            .map(drop)
    }

    fn program(&self, commit: &str, name: &str) -> PathBuf {
        self.out.join("programs").join(commit).join(name)
    }

    /// Builds the programs of a commit, once.
    fn build(&self, commit: &str) -> Result<(), TaskError> {
        if self.program(commit, "xtask").exists() {
            return Ok(());
        }
        note(&format!("building {commit}"));
        self.check_out(commit)?;
        let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
        let target = self.out.join("target");
        let mut command = Command::new(cargo);
        // By the names of the programs: those of their packages are not the same in all commits.
        command.args(["build", "--release", "--locked", "--workspace", "--bin", "squeal", "--bin", "xtask"]);
        command.current_dir(self.checkout()).env("CARGO_TARGET_DIR", &target);
        let status = command.status().map_err(TaskError::Start)?;
        if !status.success() {
            return Err(TaskError::Same(format!("{commit} does not build")));
        }
        for name in ["squeal", "xtask"] {
            let program = fs::read(target.join("release").join(name)).map_err(TaskError::Start)?;
            let place = self.program(commit, name);
            make_folder(place.parent().unwrap_or(self.out))?;
            write(&place, &program)?;
            let mode = fs::metadata(target.join("release").join(name)).map_err(TaskError::Start)?.permissions();
            fs::set_permissions(&place, mode).map_err(TaskError::Start)?;
        }
        Ok(())
    }

    /// The folder with what a command of a commit said and wrote; runs it where it has not been run.
    fn results(&self, commit: &str, run: &Run) -> Result<PathBuf, TaskError> {
        let folder = self.out.join("results").join(commit).join(run.name);
        if folder.join("exit.txt").exists() {
            return Ok(folder);
        }
        if folder.exists() {
            fs::remove_dir_all(&folder).map_err(|source| TaskError::Remove { path: folder.clone(), source })?;
        }
        make_folder(&folder)?;
        let written = folder.join("written");
        let arguments = run.arguments.split(' ').map(|word| match word {
            "{out}" => written.as_os_str().to_owned(),
            word => word.into(),
        });
        let mut command = Command::new(self.program(commit, run.program));
        let output = command.args(arguments).current_dir(self.checkout()).output().map_err(TaskError::Start)?;
        write(&folder.join("standard-output.txt"), &output.stdout)?;
        write(&folder.join("standard-error.txt"), &output.stderr)?;
        write(&folder.join("exit.txt"), format!("{:?}\n", output.status.code()).as_bytes())?;
        Ok(folder)
    }
}

/// Standard output of a program that is run in a folder, without white space at its ends.
fn said<'a>(program: &str, folder: &Path, arguments: impl IntoIterator<Item = &'a OsStr>) -> Result<String, TaskError> {
    let output = Command::new(program).args(arguments).current_dir(folder).output().map_err(TaskError::Start)?;
    if !output.status.success() {
        return Err(TaskError::Same(String::from_utf8_lossy(&output.stderr).trim().to_owned()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// The files in which two folders differ, each in words.
fn differences(before: &Path, after: &Path, commits: [&str; 2], out: &Path) -> Result<Vec<String>, TaskError> {
    let mut all = BTreeSet::new();
    for folder in [before, after] {
        files(folder, folder, &mut all)?;
    }
    let mut found = Vec::new();
    for file in all {
        let [first, second] = [(before, commits[0]), (after, commits[1])]
            .map(|(folder, commit)| fs::read(folder.join(&file)).ok().map(|bytes| comparable(&bytes, commit, out)));
        let name = file.display();
        match (first, second) {
            (Some(first), Some(second)) if first == second => {}
            (Some(first), Some(second)) => found.push(format!("{name}{}", first_difference(&first, &second))),
            (None, _) => found.push(format!("{name} is new")),
            (_, None) => found.push(format!("{name} is missing")),
        }
    }
    Ok(found)
}

/// Enters the files below a folder by their path from its root. Locks say who had them and nothing else.
fn files(root: &Path, folder: &Path, into: &mut BTreeSet<PathBuf>) -> Result<(), TaskError> {
    for entry in fs::read_dir(folder).map_err(TaskError::Start)? {
        let path = entry.map_err(TaskError::Start)?.path();
        if path.is_dir() {
            files(root, &path, into)?;
        } else if path.extension() != Some("lock".as_ref()) {
            into.extend(path.strip_prefix(root).map(Path::to_owned));
        }
    }
    Ok(())
}

/// The bytes of a file; of text without the commit, the place of the results, and times: numbers before the unit s, and the
/// fields of a manifest that hold them.
fn comparable(bytes: &[u8], commit: &str, out: &Path) -> Vec<u8> {
    let Ok(text) = std::str::from_utf8(bytes) else { return bytes.to_vec() };
    let place = out.join("results").join(commit);
    let text = text.replace(&*place.to_string_lossy(), "RESULTS").replace(commit, "COMMIT");
    let mut lines = Vec::new();
    let mut is_in_times = false;
    for line in text.split('\n') {
        is_in_times |= line.trim_start().starts_with("\"seconds\": {");
        // How many lines of progress there are follows the clock, too.
        if !is_progress(line) {
            lines.push(if is_in_times || follows_the_clock(line) { String::new() } else { without_times(line) });
        }
        is_in_times &= !line.trim_start().starts_with('}');
    }
    lines.join("\n").into_bytes()
}

/// True of a line of progress, as "5 of 100 in 10 s, roughly 190 s left".
fn is_progress(line: &str) -> bool {
    line.contains(" of ") && line.trim_end().ends_with(" left")
}

/// True if all that a line says follows the clock: seconds in a manifest, how long something takes on this machine.
fn follows_the_clock(line: &str) -> bool {
    line.trim_start().starts_with("\"seconds") || line.trim_end().ends_with(" on this machine")
}

/// A line with a word for each number that stands before the unit s.
fn without_times(line: &str) -> String {
    let words: Vec<&str> = line.split(' ').collect();
    let is_time = |at: usize| {
        let unit = words.get(at + 1).map(|next| next.trim_end_matches([',', ';', '.', ')']));
        unit == Some("s") && words[at].trim_start_matches('(').parse::<f64>().is_ok()
    };
    (0..words.len()).map(|at| if is_time(at) { "TIME" } else { words[at] }).collect::<Vec<_>>().join(" ")
}

/// The first line in which two files differ, in words; nothing of files that are no text.
fn first_difference(before: &[u8], after: &[u8]) -> String {
    let (Ok(before), Ok(after)) = (std::str::from_utf8(before), std::str::from_utf8(after)) else {
        return " (no text)".into();
    };
    let (mut before, mut after) = (before.lines(), after.lines());
    for number in 1.. {
        match (before.next(), after.next()) {
            (None, None) => break,
            (first, second) if first == second => {}
            (first, second) => {
                let shown = |line: Option<&str>| {
                    line.map_or("nothing".into(), |line| line.chars().take(80).collect::<String>())
                };
                return format!(" line {number}: \"{}\", now \"{}\"", shown(first), shown(second));
            }
        }
    }
    String::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_places_and_commits_are_no_difference_and_all_else_is() {
        let out = tempfile::tempdir().unwrap();
        let folder = |commit: &str| out.path().join("results").join(commit).join("run");
        let text = |commit: &str, seconds: &str, hertz: &str| {
            format!(
                "{{\n  \"commit\": \"{commit}\",\n  \"seconds\": {{\n    \"samples\": {seconds}\n  }},\n  \"hz\": {hertz}\n}}\n\
                 40 CEAs in {seconds} s, 0.32 m/s; results in {}\n",
                folder(commit).display()
            )
        };
        let put = |commit: &str, text: &str| {
            fs::create_dir_all(folder(commit).join("written")).unwrap();
            fs::write(folder(commit).join("written/manifest.json"), text).unwrap();
        };
        put("aaa", &text("aaa", "0.5", "6036.9"));
        put("bbb", &text("bbb", "0.7", "6036.9"));
        put("ccc", &text("ccc", "0.5", "6037.0"));
        fs::write(folder("ccc").join("written/new.csv"), "a\n").unwrap();
        let compare = |other: &str| differences(&folder("aaa"), &folder(other), ["aaa", other], out.path()).unwrap();
        assert_eq!(compare("bbb"), Vec::<String>::new());
        assert_eq!(
            compare("ccc"),
            ["written/manifest.json line 6: \"  \"hz\": 6036.9\", now \"  \"hz\": 6037.0\"", "written/new.csv is new"]
        );
    }

    #[test]
    fn lines_that_follow_the_clock_are_no_difference() {
        let text = "  \"seconds\": 0.27067524,\n  time          roughly 4 min on this machine\n\
                    reductions: 5 of 100 in 10.1 s, roughly 190 s left\n5 of 100 draws failed";
        assert_eq!(comparable(text.as_bytes(), "aaa", Path::new("out")), b"\n\n5 of 100 draws failed");
    }

    #[test]
    fn numbers_with_other_units_stay() {
        assert_eq!(without_times("in 0.19 s, 3 m, (2.5 s) at 0.3 m/s"), "in TIME s, 3 m, TIME s) at 0.3 m/s");
    }

    #[test]
    fn each_command_has_a_name_of_its_own() {
        let names: BTreeSet<&str> = RUNS.iter().map(|run| run.name).collect();
        assert_eq!(names.len(), RUNS.len());
    }
}
