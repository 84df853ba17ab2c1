//! Prepared brakes: pieces of a reduction, each made once and kept under the digest of all that it depends on.
//!
//! A piece is asked for by name ([`Pieces::item`]). Its key is the SHA-256 of the version of the format, the program with its commit, how the processor rounds,
//! the [identity](case::FiniteElementCase::prepared_identity) of the case and the further inputs of the piece. What depends on something else has another key,
//! and is made. Code that is in no commit has no key of its own: a folder keeps the pieces of each build apart, while for a file builds of one commit are one program, as
//! are those of one version whose commit is not known. A piece is looked for in a file that `squeal prepare` wrote, then in a folder, and kept there as soon as it is made, so
//! that a preparation that was killed goes on where it stopped.
//!
//! ```text
//! .squeal/<brake>/brake.txt        program, rounding, case
//! .squeal/<brake>/<key>.piece      one piece, sealed by length and checksum
//! .squeal/<brake>/<key>.interim    one that is there until the brake is made
//! ```

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use case::FiniteElementCase;
use montecarlo::{Damage, Sealed};
use rayon::current_num_threads;
use sha2::{Digest, Sha256};
use study::identity::{difference, rounding_class};
use study::{hexadecimal, memory, solutions_together};

use crate::Error;
use crate::bits::Bits;

/// Form of a file of pieces. The version changes when what a piece holds or means does.
const FILE: Sealed = Sealed { kind: "squeal-prepared", version: 3 };
/// Form of one piece in a folder.
const PIECE: Sealed = Sealed { kind: "squeal-piece", version: FILE.version };
/// Most brakes whose pieces a folder keeps, the brakes used last; chosen: each takes some ten megabytes.
const MOST_BRAKES: usize = 16;
/// File in the folder of a brake that says what it is; writing it anew says that the folder is used.
const OF_BRAKE: &str = "brake.txt";

/// Age from which a file that is half written is of a process that was killed; chosen: no piece takes a day to write.
const ABANDONED: Duration = Duration::from_secs(86_400);

/// Ending of the files of pieces that stay.
const STAYING: &str = "piece";
/// Ending of the files of pieces that are there until the brake is made.
const INTERIM: &str = "interim";

/// SHA-256 of all that something depends on.
type Key = [u8; 32];

/// Places in which pieces of prepared brakes are looked for and kept, none by default; and the memory that the making of missing pieces may take.
#[derive(Debug, Default)]
pub struct Prepared {
    /// A file that was given. Nothing is added to it.
    given: Option<Given>,
    /// The folder that pieces are kept in.
    folder: Option<PathBuf>,
    /// All pieces that were asked for, where a file of them is to be written.
    collected: Option<Mutex<Given>>,
    /// Memory that the making of missing pieces may take, bytes; what the machine has by default. Pieces do not depend on it, nor on the number of threads: both
    /// say how many solutions are under way together, and not what they are.
    memory: Option<u64>,
    counts: Mutex<PreparedCounts>,
}

/// A file of pieces: one that was given, or one that is to be written.
#[derive(Debug, Default)]
struct Given {
    /// Place from which it was read; empty of one that is to be written.
    path: PathBuf,
    /// The program and the rounding that the pieces were made by.
    made: String,
    /// Identity of the brake, whichever scenes of it are chosen. Keys tell pieces apart without it; it is here so that a refusal can say what differs.
    brake: String,
    pieces: BTreeMap<Vec<u8>, Vec<u8>>,
}

/// Counts of the pieces that were asked for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PreparedCounts {
    /// Pieces that were read from a file.
    pub from_file: usize,
    /// Pieces that were read from a folder.
    pub from_folder: usize,
    /// Pieces that were made.
    pub made: usize,
    /// Pieces that were made of which the folder held a damaged copy.
    pub damaged: usize,
    /// Interim pieces that were read, of a preparation that was stopped before: modes of the whole brake at an operating point each, by a complete solution or led to it.
    pub interim: usize,
    /// Why a piece could not be kept, the first time.
    pub not_kept: Option<String>,
}

impl Prepared {
    /// Pieces of a file that `squeal prepare` wrote, which is read whole.
    ///
    /// # Errors
    /// A file that cannot be read, that is damaged or none of these.
    pub fn from_file(mut self, path: &Path) -> Result<Self, Error> {
        let bytes = fs::read(path).map_err(|source| Error::PreparedRead { path: path.to_owned(), source })?;
        let damaged = |source| Error::PreparedDamage { path: path.to_owned(), source };
        let ((made, brake), pieces) =
            Bits::whole(FILE.open(&bytes).map_err(damaged)?).ok_or_else(|| damaged(Damage::Header))?;
        self.given = Some(Given { path: path.to_owned(), made, brake, pieces });
        Ok(self)
    }

    /// Also pieces that a folder keeps, and those that are made from now on into it.
    #[must_use]
    pub fn in_folder(self, folder: PathBuf) -> Self {
        Self { folder: Some(folder), ..self }
    }

    /// Also limits the memory of what is made to about `memory` bytes: fewer solutions of a large brake are then under way together.
    #[must_use]
    pub fn within(self, memory: u64) -> Self {
        Self { memory: Some(memory), ..self }
    }

    /// Also all pieces that are asked for together, for [`Prepared::write`].
    #[must_use]
    pub fn collecting(self) -> Self {
        Self { collected: Some(Mutex::default()), ..self }
    }

    /// The folder that pieces are kept in.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// True if there may be pieces of a case: a file was given, or its brake has a folder.
    #[must_use]
    pub fn is_begun(&self, case: &FiniteElementCase) -> bool {
        let has_folder = || self.pieces(case, &made_by(case)).folder.is_some_and(|folder| folder.is_dir());
        self.given.is_some() || self.folder.is_some() && has_folder()
    }

    /// The pieces that were asked for so far.
    #[must_use]
    pub fn counts(&self) -> PreparedCounts {
        locked(&self.counts).clone()
    }

    /// Writes what was collected into one file, under a temporary name first, and removes what killed processes left half written beside it. Returns the number of its
    /// bytes. Only after [`collecting`](Self::collecting): else the file is empty, and refused where it is read.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<usize, Error> {
        let mut body = Vec::new();
        if let Some(collected) = &self.collected {
            let Given { made, brake, pieces, .. } = &*locked(collected);
            [made, brake].into_iter().for_each(|text| text.put(&mut body));
            pieces.put(&mut body);
        }
        let bytes = [FILE.header(&body).into_bytes(), body].concat();
        output::write(path, &bytes).map_err(|source| Error::PreparedWrite(Box::new(source)))?;
        output::remove_temporary(path.parent().filter(|folder| *folder != "").unwrap_or(Path::new(".")), ABANDONED);
        Ok(bytes.len())
    }

    /// The pieces of a case: checks the file that was given, and says by writing in the folder that it is used.
    ///
    /// # Errors
    /// A file that was given and that is of another brake, another program or another rounding.
    pub(crate) fn of(&self, case: &FiniteElementCase) -> Result<Pieces<'_>, Error> {
        if self.given.is_none() && self.folder.is_none() && self.collected.is_none() {
            return Ok(Pieces { all: self, key: None, folder: None, about: String::new() });
        }
        let made = made_by(case);
        if self.given.is_some() || self.collected.is_some() {
            let wanted = case.brake_identity();
            if let Some(Given { path, made: found, brake, .. }) = &self.given {
                if *found != made {
                    return Err(Error::PreparedElsewhere { path: path.clone(), found: found.clone(), expected: made });
                }
                if *brake != wanted {
                    return Err(Error::PreparedOther { path: path.clone(), found: difference(brake, &wanted) });
                }
            }
            if let Some(collected) = &self.collected {
                let mut collected = locked(collected);
                (collected.made, collected.brake) = (made.clone(), wanted);
            }
        }
        let pieces = self.pieces(case, &made);
        if let Some(folder) = pieces.folder.as_ref().filter(|folder| folder.is_dir()) {
            // A folder that cannot be written is still one to read from.
            let _ = fs::write(folder.join(OF_BRAKE), &pieces.about);
        }
        Ok(pieces)
    }

    /// The pieces of a case by a program and a rounding; nothing is read or written.
    fn pieces(&self, case: &FiniteElementCase, made: &str) -> Pieces<'_> {
        let about = format!("{made}\n{}\n", case.prepared_identity());
        let key = digest(format!("{}\n{about}", FILE.version).as_bytes());
        // Two builds may have one commit and different code that was not committed; each has a folder of its own.
        let of_build = digest(format!("{}{}", hexadecimal(&key), this_build()).as_bytes());
        let folder = self.folder.as_ref().map(|folder| folder.join(&hexadecimal(&of_build)[..16]));
        Pieces { all: self, key: Some(key), folder, about }
    }
}

/// Pieces of one case.
#[derive(Debug)]
pub(crate) struct Pieces<'a> {
    all: &'a Prepared,
    /// Digest of what all of them depend on; `None` where nothing is kept.
    key: Option<Key>,
    /// The folder of the brake.
    folder: Option<PathBuf>,
    /// The text of [`OF_BRAKE`].
    about: String,
}

impl Pieces<'_> {
    /// Number of complete solutions of a brake of an order that are made together, by memory and threads: what is made is the same with any number.
    pub fn solutions_together(&self, order: usize) -> usize {
        solutions_together(order, self.all.memory.unwrap_or_else(memory::of_machine)).min(current_num_threads())
    }

    /// A piece: read where it is kept, else made and kept. `inputs` writes what it depends on beside the case.
    ///
    /// # Errors
    /// Errors of its making.
    pub fn item<T: Bits>(
        &self,
        name: &str,
        inputs: impl FnOnce(&mut Vec<u8>),
        make: impl FnOnce() -> Result<T, Error>,
    ) -> Result<T, Error> {
        let Some(key) = self.key_of(name, inputs) else { return make() };
        if let Some((bytes, found)) = self.known(&key) {
            self.collect(&key, bytes);
            return Ok(found);
        }
        let made = make()?;
        let bytes = made.bytes();
        self.keep(&key, STAYING, &bytes);
        locked(&self.all.counts).made += 1;
        self.collect(&key, bytes);
        Ok(made)
    }

    /// An interim piece: as [`item`](Self::item), but kept in a folder alone, until [`end_interim`](Self::end_interim). So a preparation that was stopped goes on
    /// within a piece that takes long. Of a brake that is never made they stay until its folder is removed.
    ///
    /// # Errors
    /// Errors of its making.
    pub fn interim<T: Bits>(
        &self,
        name: &str,
        inputs: impl FnOnce(&mut Vec<u8>),
        make: impl FnOnce() -> Result<T, Error>,
    ) -> Result<T, Error> {
        let Some(key) = self.key_of(name, inputs) else { return make() };
        if let Some((_, found)) = self.path(&key, INTERIM).and_then(|path| read(&path, &key)).flatten() {
            locked(&self.all.counts).interim += 1;
            return Ok(found);
        }
        let made = make()?;
        self.keep(&key, INTERIM, &made.bytes());
        Ok(made)
    }

    /// Removes the interim pieces of the brake, which is made, and what processes that were killed left half written.
    pub fn end_interim(&self) {
        let Some(folder) = &self.folder else { return };
        output::remove_temporary(folder, ABANDONED);
        let Ok(files) = fs::read_dir(folder) else { return };
        for file in files.flatten().map(|file| file.path()) {
            if file.extension().is_some_and(|ending| ending == INTERIM) {
                // One that stays is only larger than it need be.
                let _ = fs::remove_file(file);
            }
        }
    }

    /// The key of a piece; `None` where nothing is kept.
    fn key_of(&self, name: &str, inputs: impl FnOnce(&mut Vec<u8>)) -> Option<Key> {
        let mut all = self.key?.to_vec();
        name.to_owned().put(&mut all);
        inputs(&mut all);
        Some(digest(&all))
    }

    /// A piece that is kept, or was collected before, with its bytes.
    fn known<T: Bits>(&self, key: &Key) -> Option<(Vec<u8>, T)> {
        let collected = self.all.collected.as_ref().and_then(|all| locked(all).pieces.get(&key[..]).cloned());
        if let Some((bytes, found)) = collected.and_then(|bytes| T::whole(&bytes).map(|found| (bytes, found))) {
            return Some((bytes, found));
        }
        let given = self.all.given.as_ref().and_then(|given| given.pieces.get(&key[..]));
        if let Some((bytes, found)) = given.and_then(|bytes| Some((bytes.clone(), T::whole(bytes)?))) {
            locked(&self.all.counts).from_file += 1;
            return Some((bytes, found));
        }
        let found = read(&self.path(key, STAYING)?, key)?;
        let mut counts = locked(&self.all.counts);
        *if found.is_some() { &mut counts.from_folder } else { &mut counts.damaged } += 1;
        found
    }

    /// Puts a piece into the folder, unless one could not be written before: a disk that is full is asked once.
    fn keep(&self, key: &Key, ending: &str, bytes: &[u8]) {
        let Some((folder, path)) = self.folder.as_ref().zip(self.path(key, ending)) else { return };
        if locked(&self.all.counts).not_kept.is_some() {
            return;
        }
        if let Err(source) = self.write_piece(folder, &path, [key, bytes].concat()) {
            locked(&self.all.counts).not_kept.get_or_insert_with(|| source.to_string());
        }
    }

    /// Writes a piece, its key before its bytes, under a temporary name first.
    fn write_piece(&self, folder: &Path, path: &Path, body: Vec<u8>) -> io::Result<()> {
        if !folder.is_dir() {
            self.make_folder(folder)?;
        }
        output::replace(path, &[PIECE.header(&body).into_bytes(), body].concat())
    }

    /// Makes the folder of the brake, in a folder that git does not see, and removes the folders of brakes that have not been used for longest.
    fn make_folder(&self, folder: &Path) -> io::Result<()> {
        fs::create_dir_all(folder)?;
        fs::write(folder.join(OF_BRAKE), &self.about)?;
        let Some(all) = folder.parent() else { return Ok(()) };
        fs::write(all.join(".gitignore"), "*\n")?;
        let mut brakes: Vec<(SystemTime, PathBuf)> = Vec::new();
        for entry in fs::read_dir(all)? {
            let path = entry?.path();
            // A folder without such a file is not the folder of a brake.
            if let Ok(used) = fs::metadata(path.join(OF_BRAKE)).and_then(|file| file.modified()) {
                brakes.push((used, path));
            }
        }
        brakes.sort();
        let oldest = brakes.iter().take(brakes.len().saturating_sub(MOST_BRAKES));
        // One that cannot be removed stays. One that another process uses may go: used last means here begun last, and what is lost is made again.
        oldest.for_each(|(_, path)| drop(fs::remove_dir_all(path)));
        Ok(())
    }

    /// The file of a piece, by the ending that says how long it is kept.
    fn path(&self, key: &Key, ending: &str) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(format!("{}.{ending}", &hexadecimal(key)[..32])))
    }

    fn collect(&self, key: &Key, bytes: Vec<u8>) {
        if let Some(collected) = &self.all.collected {
            locked(collected).pieces.insert(key.to_vec(), bytes);
        }
    }
}

/// The piece of a file, with its bytes: `None` without a file, and within that where it is damaged or another one. It is made then, whatever the reason.
#[allow(clippy::option_option)] // Whether there is a file, and what is in it.
fn read<T: Bits>(path: &Path, key: &Key) -> Option<Option<(Vec<u8>, T)>> {
    let sealed = fs::read(path).ok()?;
    let body = PIECE.open(&sealed).ok().and_then(|body| body.strip_prefix(&key[..]));
    Some(body.and_then(|body| Some((body.to_vec(), T::whole(body)?))))
}

/// The value behind a lock: what another thread left there before it panicked is right all the same.
fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

fn digest(bytes: &[u8]) -> Key {
    Sha256::digest(bytes).into()
}

/// The program and the rounding, by which numbers are the same to the last bit.
fn made_by(case: &FiniteElementCase) -> String {
    let commit = case.header.commit.map_or_else(String::new, |commit| format!(" ({commit})"));
    format!("{}{commit} on {}", env!("CARGO_PKG_VERSION"), rounding_class())
}

/// Size and time of the file of this program; empty where the system does not tell.
fn this_build() -> String {
    let file = std::env::current_exe().and_then(fs::metadata);
    let time = |file: &fs::Metadata| file.modified().ok()?.duration_since(UNIX_EPOCH).ok();
    file.map_or_else(|_| String::new(), |file| format!("{} {:?}", file.len(), time(&file)))
}
