//! Prepared brakes: what is read is what was made, to the last bit, and what is damaged or of another brake is not taken.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime};

use brakes::case::{CaseFile, FiniteElementCase};
use brakes::{FiniteElementBrake, Prepared, PreparedCounts, Purpose};
use nalgebra::Complex;
use squeal::montecarlo::Progress;
use squeal::study::{ModeSource, UncertainBrake};

/// The disc and pad in little: a narrow band, one arrangement or two, a bristle law, two full checks.
fn case(replaced: &[(&str, &str)]) -> FiniteElementCase {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
    let mut text = fs::read_to_string(folder.join("disc-pad.toml")).unwrap();
    let shorter = [
        ("in_contact = [9, 8]", "arrangements = [[1, 2, 3, 4, 5, 6, 7, 8, 9], [2, 3, 4, 5, 6, 7, 8]]"),
        ("\"velocity-dependent\", ", ""),
        ("[500.0, 8000.0]", "[2600.0, 3200.0]"),
        ("full_checks = 100", "training = 3\nfull_checks = 2"),
    ];
    for (from, to) in shorter.iter().chain(replaced) {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    match CaseFile::parse(&folder.join("little.toml"), text).unwrap() {
        CaseFile::FiniteElements(case) => *case,
        other => panic!("{other:?}"),
    }
}

fn made(prepared: &Prepared, purpose: Purpose<'_>) -> FiniteElementBrake {
    FiniteElementBrake::prepared(case(&[]), purpose, prepared, &()).unwrap()
}

/// All numbers of a brake that results depend on, as text that tells every bit of them.
fn all_of(brake: &FiniteElementBrake) -> String {
    let mut text = format!("{:?}", brake.full_checks());
    for set in &brake.sets {
        text += &format!("{:?} {:?} {:?} {:?}", set.basis, set.modes, set.held_out, set.held_out_residual);
    }
    for part in &brake.parts {
        text += &format!("{:?} {:?} {:?}", part.within, part.first, part.reduced);
    }
    for scene in &brake.plan.scenes {
        let point = brake.operating_point(scene, &brake.median()).unwrap();
        let modes = brake.band_modes(scene, &[point]).remove(0).unwrap();
        let lambdas: Vec<Complex<f64>> = modes.iter().map(|mode| mode.lambda).collect();
        text += &format!("{lambdas:?} {:?}", brake.relative_error(scene));
    }
    text
}

fn pieces(folder: &Path) -> Vec<PathBuf> {
    files(folder, "piece")
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let brakes = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir());
    let files = brakes.flat_map(|brake| fs::read_dir(brake).unwrap().map(|entry| entry.unwrap().path()));
    let mut found: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|end| end == ending)).collect();
    found.sort();
    found
}

/// Progress that wants no more after a number of advances.
struct Until {
    most: u64,
    made: AtomicU64,
}

impl Progress for Until {
    fn begin(&self, _total: u64, _done: u64) {}

    fn advance(&self, more: u64) {
        self.made.fetch_add(more, Ordering::Relaxed);
    }

    fn end(&self) {}

    fn is_cancelled(&self) -> bool {
        self.made.load(Ordering::Relaxed) >= self.most
    }
}

#[test]
fn what_is_read_is_what_was_made_to_the_last_bit() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, file) = (dir.path().join(".squeal"), dir.path().join("brake.prepared"));
    let collected = Prepared::default().collecting();
    let expected = all_of(&made(&collected, Purpose::Study));
    let first = Prepared::default().in_folder(folder.clone()).collecting();
    assert_eq!(all_of(&made(&first, Purpose::Study)), expected);
    // Two sets with two parts each, the whole modes and the held out draws of both sets, two checks, at least: draws may be trained on.
    let PreparedCounts { made: count, .. } = first.counts();
    assert_eq!(first.counts(), PreparedCounts { made: count, ..PreparedCounts::default() });
    assert!(count >= 12 && pieces(&folder).len() == count, "{count}");
    assert_eq!(fs::read_to_string(folder.join(".gitignore")).unwrap(), "*\n");
    first.write(&file).unwrap();

    // All of it again, from the folder and from the file.
    let again = Prepared::default().in_folder(folder.clone());
    assert_eq!(all_of(&made(&again, Purpose::Study)), expected);
    assert_eq!(again.counts(), PreparedCounts { from_folder: count, ..PreparedCounts::default() });
    let of_file = Prepared::default().from_file(&file).unwrap();
    assert_eq!(all_of(&made(&of_file, Purpose::Study)), expected);
    assert_eq!(of_file.counts(), PreparedCounts { from_file: count, ..PreparedCounts::default() });

    // Without a folder, what was made for one purpose is there for the next.
    assert_eq!(all_of(&made(&collected, Purpose::Study)), expected);
    assert_eq!(collected.counts().made, count);

    // A preparation that was killed: the pieces that are not there are made, others are not; nor is one that is cut or changed taken.
    let all = pieces(&folder);
    fs::remove_file(&all[1]).unwrap();
    let bytes = fs::read(&all[3]).unwrap();
    fs::write(&all[3], &bytes[..bytes.len() - 9]).unwrap();
    let mut bytes = fs::read(&all[4]).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&all[4], bytes).unwrap();
    // One whose bytes are those of another piece.
    fs::copy(&all[0], &all[5]).unwrap();
    let killed = Prepared::default().in_folder(folder.clone());
    assert_eq!(all_of(&made(&killed, Purpose::Study)), expected);
    let counts = PreparedCounts { from_folder: count - 4, made: 4, damaged: 3, ..PreparedCounts::default() };
    assert_eq!(killed.counts(), counts);

    // An analysis takes the same bases, a screen that of each set and parts of its own, and another seed none.
    let analysis = Prepared::default().in_folder(folder.clone());
    made(&analysis, Purpose::Analysis);
    assert_eq!(analysis.counts().made, 0);
    let screen = Prepared::default().in_folder(folder.clone());
    let of_screen = made(&screen, Purpose::Screen);
    assert_eq!((screen.counts().from_folder, screen.counts().made), (2, 6));
    assert_eq!(of_screen.sets[0].basis, made(&again, Purpose::Analysis).sets[0].basis);
    let other = Prepared::default().in_folder(folder.clone()).from_file(&file).unwrap();
    let changed = case(&[("seed = 1", "seed = 2")]);
    FiniteElementBrake::prepared(changed, Purpose::Analysis, &other, &()).unwrap();
    assert_eq!((other.counts().from_folder, other.counts().from_file), (0, 0));

    // A file of another brake or program, or one that is cut or changed, is refused; each in one line.
    let refused = |case: FiniteElementCase, path: &Path, expected: &str| {
        let prepared = Prepared::default().from_file(path);
        let error = prepared
            .and_then(|prepared| FiniteElementBrake::prepared(case, Purpose::Analysis, &prepared, &()).map(drop))
            .unwrap_err()
            .to_string();
        assert!(error.contains(expected) && error.lines().count() == 1, "{error}");
        assert!(error.starts_with(&path.display().to_string()), "{error}");
    };
    refused(case(&[("4.05e8", "4.06e8")]), &file, "holds the study \"Disc and pad\" with other terms");
    refused(case(&[("mean = 0.50", "mean = 0.49")]), &file, "with other contact; allowed: what squeal prepare writes");
    let mut another = case(&[]);
    another.header.commit = Some("0123abc");
    refused(another, &file, "prepared by squeal ");
    let (bytes, path) = (fs::read(&file).unwrap(), dir.path().join("changed"));
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    refused(case(&[]), &path, "bytes follow its header");
    let mut changed = bytes.clone();
    changed[bytes.len() / 2] ^= 1;
    fs::write(&path, changed).unwrap();
    refused(case(&[]), &path, "its checksum is ");
    fs::write(&path, "no such file").unwrap();
    refused(case(&[]), &path, "it does not begin with the header");
    refused(case(&[]), &dir.path().join("none"), "cannot be read");
}

/// The basis of a set takes long: stopped within it, the next preparation takes over the complete solutions that are made, and nothing of them is left after it.
#[test]
fn a_preparation_goes_on_within_the_basis_of_a_set() {
    let dir = tempfile::tempdir().unwrap();
    let expected = all_of(&FiniteElementBrake::new(case(&[]), &()).unwrap());
    for most in [3, 15] {
        let folder = dir.path().join(most.to_string());
        let stopped = Prepared::default().in_folder(folder.clone());
        let progress = Until { most, made: AtomicU64::new(0) };
        let error = FiniteElementBrake::prepared(case(&[]), Purpose::Analysis, &stopped, &progress).unwrap_err();
        assert!(error.to_string().contains("cancelled"), "{error}");
        let kept = files(&folder, "interim").len();
        assert!(kept >= most.min(8) as usize, "{kept} of {most}");
        // One that is damaged is made again.
        let first = &files(&folder, "interim")[0];
        let bytes = fs::read(first).unwrap();
        fs::write(first, &bytes[..bytes.len() / 2]).unwrap();
        // What processes left half written: one that was killed long ago, and one that may be writing.
        let half = ["17-0", "18-3"].map(|of| first.with_extension(format!("interim.{of}.partial")));
        for (path, days) in half.iter().zip([2, 0]) {
            let time = SystemTime::now() - Duration::from_secs(86_400 * days);
            fs::File::create(path).unwrap().set_modified(time).unwrap();
        }
        let again = Prepared::default().in_folder(folder.clone());
        let brake = made(&again, Purpose::Analysis);
        assert_eq!(half.map(|path| path.exists()), [false, true]);
        let PreparedCounts { interim, .. } = again.counts();
        // Of a set whose basis was made before no solution is asked for.
        assert!(interim < kept && (most > 8 || interim == kept - 1), "{interim} of {kept}");
        assert!(files(&folder, "interim").is_empty());
        assert_eq!(all_of(&brake), expected);
    }
}

/// A folder that cannot be made is no fault, but is told; nothing is tried again.
#[test]
fn a_folder_that_cannot_be_written_is_told_once() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    fs::write(&file, "").unwrap();
    let prepared = Prepared::default().in_folder(file.join(".squeal"));
    let only = case(&[
        ("[[constraints]]\nname = \"ends-of-backplate\"", "# [[constraints]]\n# name"),
        ("fixed = [\"BACKENDS.z\"]", ""),
    ]);
    FiniteElementBrake::prepared(only, Purpose::Analysis, &prepared, &()).unwrap();
    let PreparedCounts { made, not_kept, .. } = prepared.counts();
    assert!(made > 0 && not_kept.is_some_and(|why| !why.is_empty()));
}
