//! The state of a run on disk.
//!
//! ```text
//! montecarlo-checkpoint 2 <bytes below> <their CRC-32, hexadecimal>
//! {"fingerprint": ..., "seed": ..., ...}     the identity of the run
//! {"seed": ..., "samples": ..., ...}         its summary so far
//! ```
//!
//! The format is JSON with exact floats because JSON has field names: a tally whose type has changed is refused, not misread.
//! A new checkpoint is written beside the old one, forced to disk and renamed over it, so that a file with the name of the
//! checkpoint is complete whenever the process or the machine stops.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::error::{Damage, MonteCarloError};
use crate::experiment::{Experiment, Tally};
use crate::sampling::Sampling;
use crate::sealed::Sealed;
use crate::summary::Summary;

const FORMAT: Sealed = Sealed { kind: "montecarlo-checkpoint", version: 2 };

/// File of the state of a run, and how often it is saved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checkpoint {
    /// The file. While it is being written, a file of this name with `.partial` appended stands beside it.
    pub path: PathBuf,
    /// Time between two writes; zero writes after every block.
    pub every: Duration,
    /// Identifies the experiment and the version of its tally, for example by a hash of the case.
    pub fingerprint: String,
}

/// The properties of a run that must agree with those of a checkpoint. They do not include the number of samples, so that a
/// run can be extended, nor the number of samples per block, on which no result depends.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Identity {
    fingerprint: String,
    seed: u64,
    first: u64,
    scenes: usize,
}

impl Checkpoint {
    /// The state in the file, wherever its samples begin: a part of a run, to be put together with others by [`tiled`](crate::tiled). It must
    /// be one of this experiment, seed and number of scenes.
    ///
    /// # Errors
    /// A file that is not there or cannot be read, is damaged, or of another run.
    pub fn state<S: Experiment, T: Tally<S>>(&self, seed: u64, scenes: usize) -> Result<Summary<T>, MonteCarloError> {
        let failed = |source| MonteCarloError::CheckpointIo { action: "read", path: self.path.clone(), source };
        let identity = Store::identity_in(&self.path, &fs::read(&self.path).map_err(failed)?)?;
        let sampling = Sampling { first: identity.first, ..Sampling::new(seed, u64::MAX - identity.first) };
        let state = Store::new(self, &sampling, scenes).load::<S, T>()?;
        state.ok_or_else(|| failed(io::Error::from(io::ErrorKind::NotFound)))
    }

    /// Writes a state as a run leaves it that has come so far.
    ///
    /// # Errors
    /// A file that cannot be written, or is the checkpoint of another run.
    pub fn write<T: Serialize + DeserializeOwned>(&self, state: &Summary<T>) -> Result<(), MonteCarloError> {
        let sampling = Sampling { first: state.first, ..Sampling::new(state.seed, state.samples) };
        Store::new(self, &sampling, state.failures.by_scene().len()).save(state)
    }
}

/// A checkpoint in use by one run.
pub(crate) struct Store<'a> {
    checkpoint: &'a Checkpoint,
    identity: Identity,
    /// Number of samples of the complete run.
    samples: u64,
    saved: Instant,
}

impl<'a> Store<'a> {
    pub(crate) fn new(checkpoint: &'a Checkpoint, sampling: &Sampling, scenes: usize) -> Self {
        let Sampling { seed, first, samples, .. } = *sampling;
        let identity = Identity { fingerprint: checkpoint.fingerprint.clone(), seed, first, scenes };
        Self { checkpoint, identity, samples, saved: Instant::now() }
    }

    /// The identity that a file announces.
    fn identity_in(path: &Path, bytes: &[u8]) -> Result<Identity, MonteCarloError> {
        let damaged = |damage| MonteCarloError::CheckpointDamaged { path: path.to_owned(), damage };
        let body = FORMAT.open(bytes).map_err(damaged)?;
        let cut = body.iter().position(|&byte| byte == b'\n').unwrap_or(body.len());
        serde_json::from_slice(&body[..cut]).map_err(|error| damaged(Damage::Content(error)))
    }

    /// The state in the file, or `None` if there is no file.
    pub(crate) fn load<S: Experiment, T: Tally<S>>(&self) -> Result<Option<Summary<T>>, MonteCarloError> {
        let path = &self.checkpoint.path;
        let bytes = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(MonteCarloError::CheckpointIo { action: "read", path: path.clone(), source }),
        };
        let damaged = |damage| MonteCarloError::CheckpointDamaged { path: path.clone(), damage };
        let body = FORMAT.open(&bytes).map_err(damaged)?;
        let cut = body.iter().position(|&byte| byte == b'\n').unwrap_or(body.len());
        let content = |error| damaged(Damage::Content(error));
        self.check_identity(&serde_json::from_slice(&body[..cut]).map_err(content)?)?;
        let state: Summary<T> = serde_json::from_slice(&body[cut..]).map_err(content)?;
        self.check_state(&state).map_err(|field| damaged(Damage::State { field }))?;
        if state.samples > self.samples {
            let (found, wanted) = (state.samples, self.samples);
            return Err(MonteCarloError::CheckpointLonger { path: path.clone(), found, wanted });
        }
        Ok(Some(state))
    }

    /// Refuses a state that is not one of this identity: the field that does not fit.
    fn check_state<S: Experiment, T: Tally<S>>(&self, state: &Summary<T>) -> Result<(), &'static str> {
        let Identity { seed, first, scenes, .. } = self.identity;
        let samples = state.first..state.first.saturating_add(state.samples);
        for (field, fits) in [
            ("seed", state.seed == seed),
            ("first sample", state.first == first),
            ("number of samples", state.first.checked_add(state.samples).is_some()),
            ("failures", state.failures.may_be_of(scenes, samples.clone())),
            ("tally", state.tally.may_be_of(samples, &state.failures)),
        ] {
            if !fits {
                return Err(field);
            }
        }
        Ok(())
    }

    /// Refuses to write over the checkpoint of another run, which came there meanwhile.
    fn check_what_stands_there(&self) -> Result<(), MonteCarloError> {
        let Ok(file) = File::open(&self.checkpoint.path) else { return Ok(()) };
        let found = BufReader::new(file).lines().nth(1).and_then(Result::ok);
        match found.and_then(|line| serde_json::from_str(&line).ok()) {
            Some(identity) => self.check_identity(&identity),
            None => Ok(()),
        }
    }

    fn check_identity(&self, found: &Identity) -> Result<(), MonteCarloError> {
        let expected = &self.identity;
        for (field, expected, found) in [
            ("experiment", expected.fingerprint.clone(), found.fingerprint.clone()),
            ("seed", expected.seed.to_string(), found.seed.to_string()),
            ("first sample", expected.first.to_string(), found.first.to_string()),
            ("number of scenes", expected.scenes.to_string(), found.scenes.to_string()),
        ] {
            if expected != found {
                let path = self.checkpoint.path.clone();
                return Err(MonteCarloError::CheckpointMismatch { path, field, expected, found });
            }
        }
        Ok(())
    }

    /// Saves a state that is complete, or if the time between two writes has passed.
    pub(crate) fn save_when_due<T: Serialize + DeserializeOwned>(
        &mut self,
        state: &Summary<T>,
        end: u64,
    ) -> Result<(), MonteCarloError> {
        if state.first + state.samples == end || self.saved.elapsed() >= self.checkpoint.every {
            self.save(state)?;
        }
        Ok(())
    }

    pub(crate) fn save<T: Serialize + DeserializeOwned>(&mut self, state: &Summary<T>) -> Result<(), MonteCarloError> {
        self.check_what_stands_there()?;
        let path = &self.checkpoint.path;
        let not_storable = |source| MonteCarloError::NotStorable { path: path.clone(), source };
        let mut body = serde_json::to_vec(&self.identity).map_err(not_storable)?;
        body.push(b'\n');
        let cut = body.len();
        serde_json::to_writer(&mut body, state).map_err(not_storable)?;
        // A state that cannot be read back must not replace one that can.
        serde_json::from_slice::<Summary<T>>(&body[cut..]).map_err(not_storable)?;
        body.push(b'\n');

        let mut name = OsString::from(path);
        name.push(".partial");
        let partial = PathBuf::from(name);
        let written = write_to_disk(&partial, &body).map_err(|source| (partial.clone(), source));
        let replaced = written.and_then(|()| replace(&partial, path).map_err(|source| (path.clone(), source)));
        if let Err((path, source)) = replaced {
            // The run ends with the first error; a second one, in removing the temporary file, is ignored.
            let _ = fs::remove_file(&partial);
            return Err(MonteCarloError::CheckpointIo { action: "write", path, source });
        }
        self.saved = Instant::now();
        Ok(())
    }
}

fn write_to_disk(path: &Path, body: &[u8]) -> io::Result<()> {
    // What a killed run left there goes; the new file is made anew, so that a link is not followed to a file elsewhere.
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let mut file = File::create_new(path)?;
    file.write_all(FORMAT.header(body).as_bytes())?;
    file.write_all(body)?;
    file.sync_all()
}

fn replace(partial: &Path, path: &Path) -> io::Result<()> {
    fs::rename(partial, path)?;
    // The new name is on disk only when its folder is. Folders can be opened as files on Unix only.
    #[cfg(unix)]
    {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}
