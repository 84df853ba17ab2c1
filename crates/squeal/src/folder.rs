//! Folder of a run: it belongs to one study, one process at a time writes into it, and each file appears whole or not at all.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use output::{OutputError, in_words, is_temporary, make_folder, remove_temporary, write};

use crate::Error;

/// Name of the file that holds the identity of the study that the folder belongs to.
const MARKER: &str = "study.txt";
/// Name of the file that is locked while a run works in the folder. It stays there; the lock ends with the process.
const LOCK: &str = "run.lock";
/// Name of the folder in which tables and figures are made before they are published.
const STAGE: &str = "results.partial";

/// A folder in which this process alone works on one study, until it is dropped.
pub struct RunFolder {
    path: PathBuf,
    /// Identity of the study, one line: what tells its counts from the counts of another study.
    identity: String,
    /// Text that this process wrote into the lock file, its number and the time.
    owner: String,
    _lock: File,
}

impl RunFolder {
    /// Refuses a folder of another study, or one in which a run works. Nothing is written or kept locked: [`RunFolder::take`] asks again, after the
    /// work that is done before a folder is needed.
    pub fn check(path: &Path, identity: &str) -> Result<(), Error> {
        holds_study(path, identity)?;
        match File::open(path.join(LOCK)) {
            Ok(file) => try_lock(path, &file).map(drop),
            Err(_) => Ok(()),
        }
    }

    /// Takes a folder for this process: makes it where it is not there, locks it, and marks it with the identity.
    pub fn take(path: &Path, identity: &str) -> Result<Self, Error> {
        make_folder(path)?;
        let lock_path = path.join(LOCK);
        let failed = |source| OutputError::Write { path: lock_path.clone(), source };
        let mut lock = open_lock(&lock_path).map_err(failed)?;
        try_lock(path, &lock)?;
        let since_epoch = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let owner = format!("process {} since {} s after 1970-01-01 UTC\n", std::process::id(), since_epoch.as_secs());
        lock.set_len(0).and_then(|()| lock.write_all(owner.as_bytes())).map_err(failed)?;
        let folder = Self { path: path.to_owned(), identity: identity.to_owned(), owner, _lock: lock };
        // No other process writes here: temporary files are of runs that were killed.
        remove_temporary(path, Duration::ZERO);
        if !holds_study(path, identity)? {
            write(&path.join(MARKER), format!("{identity}\n").as_bytes())?;
        }
        Ok(folder)
    }

    /// Refuses to go on where the folder no longer belongs to this run: removed, or made anew by another.
    fn check_ours(&self) -> Result<(), Error> {
        let holds = |name: &str, text: &str| fs::read_to_string(self.path.join(name)).is_ok_and(|found| found == text);
        if holds(LOCK, &self.owner) && holds(MARKER, &format!("{}\n", self.identity)) {
            Ok(())
        } else {
            Err(Error::FolderLost { path: self.path.clone() })
        }
    }

    /// Writes a file, if the folder still belongs to this run.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), Error> {
        self.check_ours()?;
        Ok(write(&self.path.join(name), contents)?)
    }

    /// Removes a file, if the folder still belongs to this run and has it.
    pub fn remove(&self, name: &str) -> Result<(), Error> {
        self.check_ours()?;
        let path = self.path.join(name);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != ErrorKind::NotFound => Err(OutputError::Write { path, source }.into()),
            _ => Ok(()),
        }
    }

    /// Publishes the files that `make` writes into the folder it is given. When it has succeeded they are renamed into this folder, one after
    /// the other, each only if this folder still belongs to this run; where that fails, those before are published already.
    ///
    /// # Errors
    /// Those of `make`, [`Error::FolderLost`], and files that cannot be written.
    pub fn publish<E: From<Error>>(&self, make: impl FnOnce(&Path) -> Result<(), E>) -> Result<(), E> {
        self.check_ours()?;
        let stage = Stage::new(self.path.join(STAGE))?;
        make(&stage.path)?;
        let unreadable = |source| Error::Read { path: stage.path.clone(), source };
        let entries =
            fs::read_dir(&stage.path).and_then(Iterator::collect::<io::Result<Vec<_>>>).map_err(unreadable)?;
        for entry in entries {
            self.check_ours()?;
            let to = self.path.join(entry.file_name());
            fs::rename(entry.path(), &to).map_err(|source| Error::from(OutputError::Write { path: to, source }))?;
        }
        Ok(())
    }

    /// Gives a folder back that holds nothing but its marks and the file `own`, which are removed, and the folder with them: for a question that has no answer, so
    /// that another one may be asked there. One that holds more stays as it is.
    pub fn give_back(self, own: &str) {
        let is_mark = |entry: io::Result<fs::DirEntry>| {
            entry.is_ok_and(|entry| [LOCK, MARKER, own].iter().any(|mark| entry.file_name() == *mark))
        };
        let holds_more = fs::read_dir(&self.path).map_or(true, |mut entries| !entries.all(is_mark));
        if holds_more || self.check_ours().is_err() {
            return;
        }
        // What cannot be removed is found by whoever takes the folder next.
        for name in [own, MARKER, LOCK] {
            let _ = fs::remove_file(self.path.join(name));
        }
        let _ = fs::remove_dir(&self.path);
    }
}

/// A folder inside another that is there only while files are made in it.
struct Stage {
    path: PathBuf,
}

impl Stage {
    fn new(path: PathBuf) -> Result<Self, Error> {
        // A run that was killed may have left one.
        let removed = match fs::remove_dir_all(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => fs::create_dir(&path),
        };
        match removed {
            Ok(()) => Ok(Self { path }),
            Err(source) => Err(OutputError::Write { path, source }.into()),
        }
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        // The next run removes what cannot be removed now.
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Opens the lock file, or makes it; a link is not followed to a file elsewhere.
fn open_lock(path: &Path) -> io::Result<File> {
    if fs::symlink_metadata(path).is_ok_and(|found| !found.is_file()) {
        return Err(io::Error::new(ErrorKind::AlreadyExists, "something other than a file has this name"));
    }
    OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)
}

/// Locks a folder by its lock file, without waiting; refused where another process has the lock.
fn try_lock(path: &Path, lock: &File) -> Result<(), Error> {
    match lock.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(Error::InUse { path: path.to_owned(), by: owner_in_words(path) }),
        // A file system without locks protects from nothing, but holds results as well as others.
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(()),
        Err(TryLockError::Error(source)) => Err(OutputError::Write { path: path.join(LOCK), source }.into()),
    }
}

/// Owner of the lock of a folder in words: its process number and how long ago it started, or "another run" where the lock file does not tell.
fn owner_in_words(path: &Path) -> String {
    let text = fs::read_to_string(path.join(LOCK)).unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    let [_, process, _, since, ..] = words[..] else { return "another run".into() };
    let (Ok(process), Ok(since)) = (process.parse::<u32>(), since.parse()) else { return "another run".into() };
    let age = SystemTime::UNIX_EPOCH.checked_add(Duration::from_secs(since)).and_then(|start| start.elapsed().ok());
    let age = age.map_or_else(String::new, |age| format!(", started {} ago", in_words(age.as_secs_f64())));
    format!("another run (process {process}{age})")
}

/// True if `dir` is the folder of this study already, false if it is not there or empty; refused where it is of another study or holds other files.
fn holds_study(dir: &Path, identity: &str) -> Result<bool, Error> {
    let other = |found: &str| {
        Err(Error::OtherStudy { path: dir.to_owned(), found: found.to_owned(), wanted: identity.to_owned() })
    };
    let unreadable = |source| Error::Read { path: dir.to_owned(), source };
    match fs::read_to_string(dir.join(MARKER)) {
        Ok(found) if found.trim() == identity => return Ok(true),
        Ok(found) => return other(found.trim()),
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(source) => return Err(unreadable(source)),
    }
    match fs::read_dir(dir) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(source) => Err(unreadable(source)),
        Ok(entries) => {
            for entry in entries {
                // A run that was killed while it wrote the marker leaves the lock, and the temporary file of `output::write` for the marker.
                let name = entry.map_err(unreadable)?.file_name();
                if name != LOCK && !is_temporary(&name) {
                    return other("other files");
                }
            }
            Ok(false)
        }
    }
}
