//! Answers at points, of `squeal rare` and of `squeal cycle`, kept in a file as soon as they are known, so that a run that was killed does not solve for them again.
//!
//! All that is asked of a point is a function of the point alone. So a run that asks again the same questions, in whatever order its threads do, gets
//! from the file what an earlier run appended to it, solves for the rest, and has the same results.
//!
//! ```text
//! squeal-answers 1 <bytes below> <their CRC-32, hexadecimal>
//! "<program, processor, brake and what is asked>"
//! squeal-answers 1 <bytes below> <their CRC-32, hexadecimal>
//! [["Worst",[<u>, ...],{"margin":...}], ...]
//! ...
//! ```
//!
//! The file ends at its first record that is not whole: one that was being written when the process or the machine stopped.

use std::collections::HashMap;
use std::fmt::Display;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use montecarlo::Sealed;
use output::OutputError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use study::UncertainBrake;
use study::identity::{of_study, rounding_class};

use crate::Error;

/// Version of the program, which all crates share.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Format of a record; the version changes when the answers of an older program can no longer be taken.
const FORMAT: Sealed = Sealed { kind: "squeal-answers", version: 1 };

/// What is asked of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) enum Question {
    /// The mode of the largest margin.
    Worst,
    /// The gradient of the margin of a mode, whose growth and angular frequency are appended to the point.
    Gradient,
    /// The names of the modes that grow.
    Names,
    /// The distance of the onset of the full model, of the design point with these coordinates, slope, growth and angular frequency.
    Moved,
    /// The motion from a state, with the angular frequency of its mode.
    Motion,
    /// The branch of balanced cycles from an onset, by its eigenvalue and the parameter.
    Balances,
    /// The motion in time of a balanced cycle, by its series, angular frequency and parameter.
    InTime,
}

/// A question and the bits of the point.
type Asked = (Question, Vec<u64>);

/// Answers of an earlier run, and the file to which new ones are appended; nothing of either by default.
#[derive(Debug, Default)]
pub(crate) struct Kept {
    known: HashMap<Asked, Box<str>>,
    file: Option<(PathBuf, Mutex<File>)>,
}

impl Kept {
    /// The answers in a file for what is `asked` of a brake; without a file, none. The file is made where it is not there; one of another brake, question, program or
    /// kind of processor, by which numbers are rounded otherwise, is begun anew.
    ///
    /// # Errors
    /// A file that cannot be read or written; something else in its place.
    pub fn open<B: UncertainBrake>(path: Option<&Path>, brake: &B, asked: impl Display) -> Result<Self, Error> {
        let Some(path) = path else { return Ok(Self::default()) };
        let commit = brake.plan().commit.unwrap_or("unknown commit");
        let identity =
            &*format!("{VERSION} ({commit}) on {}: {asked}; {}", rounding_class(), of_study(brake).into_line());
        let failed = |source| Error::Read { path: path.to_owned(), source };
        let mut kept = Self::default();
        let mut file = open(path).map_err(failed)?;
        let whole = kept.read(&mut BufReader::new(&file), identity).map_err(failed)?;
        let unwritten = |source| OutputError::Write { path: path.to_owned(), source };
        file.set_len(whole).and_then(|()| file.seek(SeekFrom::Start(whole))).map_err(unwritten)?;
        if whole == 0 {
            file.write_all(&record(&identity).map_err(unwritten)?).map_err(unwritten)?;
        }
        kept.file = Some((path.to_owned(), Mutex::new(file)));
        Ok(kept)
    }

    /// Takes the answers of a file; the number of bytes of its whole records, 0 of one with another identity.
    fn read(&mut self, from: &mut impl BufRead, identity: &str) -> io::Result<u64> {
        let mut whole = 0;
        while let Some(bytes) = next_record(from)? {
            let Ok(body) = FORMAT.open(&bytes) else { break };
            if whole == 0 {
                if serde_json::from_slice::<String>(body).ok().as_deref() != Some(identity) {
                    break;
                }
            } else {
                let Ok(answers) = serde_json::from_slice::<Vec<(Question, Vec<f64>, Value)>>(body) else { break };
                let answers =
                    answers.into_iter().map(|(question, at, answer)| (asked(question, &at), answer.to_string().into()));
                self.known.extend(answers);
            }
            whole += bytes.len() as u64;
        }
        Ok(whole)
    }

    /// Number of points whose spectrum is known.
    pub fn spectra(&self) -> u64 {
        self.known.keys().filter(|(question, _)| *question == Question::Worst).count() as u64
    }

    /// The answers at `points`, in their order; `find` is asked for the points whose answers are not known yet, in the same order.
    ///
    /// # Errors
    /// Those of `find`; a file that cannot be written.
    pub fn answers<T: Serialize + DeserializeOwned + PartialEq>(
        &self,
        question: Question,
        points: &[&[f64]],
        find: impl FnOnce(&[&[f64]]) -> Result<Vec<T>, Error>,
    ) -> Result<Vec<T>, Error> {
        let known: Vec<Option<T>> = points.iter().map(|at| self.known(question, at)).collect();
        let open = points.iter().zip(&known).filter(|(_, known)| known.is_none());
        let open: Vec<&[f64]> = open.map(|(at, _)| *at).collect();
        if open.is_empty() {
            return Ok(known.into_iter().flatten().collect());
        }
        let found = find(&open)?;
        self.keep(question, &open, &found)?;
        let mut found = found.into_iter();
        Ok(known.into_iter().filter_map(|known| known.or_else(|| found.next())).collect())
    }

    /// The answer at one point, as [`Kept::answers`].
    ///
    /// # Errors
    /// As [`Kept::answers`].
    pub fn answer<T: Serialize + DeserializeOwned + PartialEq>(
        &self,
        question: Question,
        at: &[f64],
        find: impl FnOnce() -> Result<T, Error>,
    ) -> Result<T, Error> {
        if let Some(known) = self.known(question, at) {
            return Ok(known);
        }
        let found = find()?;
        self.keep(question, &[at], std::slice::from_ref(&found))?;
        Ok(found)
    }

    /// The answer at a point as far as it is known.
    fn known<T: DeserializeOwned>(&self, question: Question, at: &[f64]) -> Option<T> {
        serde_json::from_str(self.known.get(&asked(question, at))?).ok()
    }

    /// Appends answers to the file, but for answers that cannot be read back as they are, with NaN or an infinite number.
    fn keep<T: Serialize + DeserializeOwned + PartialEq>(
        &self,
        question: Question,
        points: &[&[f64]],
        answers: &[T],
    ) -> Result<(), Error> {
        let Some((path, file)) = &self.file else { return Ok(()) };
        let is_read_back = |answer: &T| {
            serde_json::to_string(answer)
                .is_ok_and(|text| serde_json::from_str::<T>(&text).is_ok_and(|read| read == *answer))
        };
        let kept = points.iter().zip(answers).filter(|(_, answer)| is_read_back(answer));
        let kept: Vec<(Question, &[f64], &T)> = kept.map(|(at, answer)| (question, *at, answer)).collect();
        let append = |bytes: Vec<u8>| file.lock().unwrap_or_else(PoisonError::into_inner).write_all(&bytes);
        let failed = |source| OutputError::Write { path: path.clone(), source };
        Ok(record(&kept).and_then(append).map_err(failed)?)
    }
}

/// The key of a question.
fn asked(question: Question, at: &[f64]) -> Asked {
    (question, at.iter().map(|u| u.to_bits()).collect())
}

/// Opens the file, or makes it; a link is not followed to a file elsewhere.
fn open(path: &Path) -> io::Result<File> {
    if fs::symlink_metadata(path).is_ok_and(|found| !found.is_file()) {
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, "something other than a file has this name"));
    }
    OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)
}

/// A record with its first line.
fn record(of: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut body = serde_json::to_vec(of)?;
    body.push(b'\n');
    Ok([FORMAT.header(&body).as_bytes(), &body].concat())
}

/// The two lines of the next record, as far as they are there; `None` at the end.
fn next_record(from: &mut impl BufRead) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    for _ in 0..2 {
        from.read_until(b'\n', &mut bytes)?;
    }
    Ok((!bytes.is_empty()).then_some(bytes))
}
