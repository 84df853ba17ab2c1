//! A study in parts: ranges of its samples, each in a folder of its own, by whatever starts processes, and put together to the bytes of
//! one run.

use std::fs;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

use montecarlo::{Checkpoint, MonteCarloError, part_of, tiled, workers};
pub use study::identity::rounding_class;
use study::identity::{Identity, Written};
use study::{Study, StudyTally, UncertainBrake};

use crate::Error;
use crate::folder::RunFolder;
use crate::part_manifest::made_by;
pub use crate::part_manifest::{PartManifest, Shard};
use crate::results::{Manifest, VERSION};
use crate::run::{DrawResults, RunOptions, checkpoint, identity, run_from, sampled};

/// Most missing ranges that a line names; chosen.
const MOST_NAMED: usize = 20;
/// Name of the file that is written last: a part that has it is complete.
const DONE: &str = "shard.json";

/// Digest of what all samples of a study share.
fn prepared<B: UncertainBrake>(study: &Study<'_, B>) -> String {
    let digest = Identity::named("prepared").part("references", |to| {
        to.list(study.references(), |to, reference| {
            for matrix in [&reference.system.m, &reference.system.c, &reference.system.k] {
                to.list(matrix.as_slice(), |to, &entry| to.number(entry));
            }
            to.list(&reference.modes, |to, mode| {
                [mode.lambda.re, mode.lambda.im].into_iter().for_each(|part| to.number(part));
                to.list(mode.shape.as_slice(), |to: &mut Written, entry| {
                    to.number(entry.re);
                    to.number(entry.im);
                });
            });
        });
    });
    digest.into_line()
}

/// Samples one part of a study in a folder of its own. The same command continues a part that was stopped, with the same program and on a
/// processor that rounds alike, and returns at once for one that is complete.
///
/// # Errors
/// As [`run_study`](crate::run_study); a part that has no sample.
pub fn run_part<B: UncertainBrake>(
    brake: &B,
    shard: Shard,
    dir: &Path,
    options: RunOptions<'_>,
) -> Result<PartManifest, Error> {
    let (plan, Shard { number, of, from }) = (brake.plan(), shard);
    // With more parts than samples some would be empty, and nobody would know which.
    let fits = of <= plan.samples.saturating_sub(from);
    let range = part_of(from..plan.samples, number, of).filter(|_| fits).ok_or_else(|| Error::Argument {
        argument: "shard",
        value: format!("{number}/{of}"),
        allowed: format!(
            "1/N to N/N, N at most {}, of the samples {from}..{}",
            plan.samples.saturating_sub(from),
            plan.samples
        ),
    })?;
    let identity = identity(brake, options.keeps_samples);
    let part = format!("{}..{}/{}", range.start, range.end, plan.samples);
    // What a part rests on is of one program and class of processors, from its first sample to its last.
    let made = format!("{}/{}/{}", VERSION, plan.commit.unwrap_or("-"), rounding_class()).replace(' ', "_");
    let of_folder = Identity::read(&plan.name, &identity).given("part", part).given("shard", format!("{number}/{of}"));
    let of_folder = of_folder.given("made", made).into_line();
    // A part that is complete is it everywhere.
    let is_it = |done: &PartManifest| {
        done.identity == identity && (done.from..done.to, done.of) == (range.clone(), plan.samples)
    };
    // One whose samples are lost, or whose manifest is damaged, is not.
    let has_samples = |_: &PartManifest| {
        let state = checkpoint(dir, identity.clone()).state::<Study<'_, B>, StudyTally>(plan.seed, plan.scenes.len());
        state.is_ok_and(|state| state.range() == range)
    };
    if let Some(done) = complete(dir).ok().flatten().filter(is_it).filter(has_samples) {
        return Ok(done);
    }
    RunFolder::check(dir, &of_folder)?;
    let start = Instant::now();
    let pool = workers(options.threads)?;
    let study =
        pool.install(|| Study::with_options(brake, options.solver, options.study, options.progress.preparation))?;
    let folder = RunFolder::take(dir, &of_folder)?;
    let summary = sampled(&study, range.clone(), &options, &checkpoint(dir, identity.clone()))?;
    let done = PartManifest {
        version: VERSION.into(),
        commit: plan.commit.map(Into::into),
        rounding: rounding_class(),
        identity,
        seed: plan.seed,
        from: range.start,
        to: range.end,
        of: plan.samples,
        shard: Some(shard),
        prepared: prepared(&study),
        threads: options.threads,
        seconds: start.elapsed().as_secs_f64(),
        evaluations: summary.samples * plan.scenes.len() as u64,
        failures: summary.failures.total(),
    };
    // Plain numbers and strings: there is nothing that could fail to serialise.
    folder.write(DONE, (serde_json::to_string_pretty(&done).unwrap_or_default() + "\n").as_bytes())?;
    Ok(done)
}

/// Manifest of the part that is complete in a folder; `None` where none is.
///
/// # Errors
/// A file that cannot be read, or says something else.
pub fn complete(dir: &Path) -> Result<Option<PartManifest>, Error> {
    let path = dir.join(DONE);
    let unreadable = |source| Error::Read { path: path.clone(), source };
    match fs::read(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(source) => Err(unreadable(source)),
        Ok(bytes) => serde_json::from_slice(&bytes).map(Some).map_err(|error| unreadable(error.into())),
    }
}

/// Manifest of the part in a folder, which must be complete.
///
/// # Errors
/// As [`complete`]; a part that is not complete.
pub fn completed(dir: &Path) -> Result<PartManifest, Error> {
    complete(dir)?.ok_or_else(|| incomplete(dir))
}

/// Samples that no part has, ascending, each range with the shard that it is, as 3/8, where the parts are shards of one number.
#[must_use]
pub fn missing(parts: &[PartManifest]) -> Vec<(Range<u64>, Option<String>)> {
    let samples = parts.iter().map(|part| part.of).max().unwrap_or(0);
    let mut ranges: Vec<Range<u64>> = parts.iter().map(|part| part.from..part.to).collect();
    ranges.sort_by_key(|range| range.start);
    let (mut gaps, mut next) = (Vec::new(), 0);
    for range in ranges.into_iter().chain(std::iter::once(samples..samples)) {
        if range.start > next {
            gaps.push(next..range.start);
        }
        next = next.max(range.end);
    }
    let numbered = |part: &PartManifest| part.shard.map(|shard| (shard.of, shard.from, part.of));
    let shards = parts.first().and_then(numbered).filter(|all| parts.iter().all(|part| numbered(part) == Some(*all)));
    let in_shards = |gap: Range<u64>| -> Vec<(Range<u64>, Option<String>)> {
        let of_number = |(of, from, samples): (u64, u64, u64)| {
            (1..=of)
                .filter_map(move |number| Some((part_of(from..samples, number, of)?, Some(format!("{number}/{of}")))))
        };
        let within = |(range, _): &(Range<u64>, Option<String>)| gap.start <= range.start && range.end <= gap.end;
        let found: Vec<_> = shards.into_iter().flat_map(of_number).filter(within).collect();
        let is_all = found.iter().map(|(range, _)| range.end - range.start).sum::<u64>() == gap.end - gap.start;
        if is_all { found } else { vec![(gap, None)] }
    };
    gaps.into_iter().flat_map(in_shards).collect()
}

/// An error where parts lack samples, with all that are missing.
///
/// # Errors
/// [`Error::PartsMissing`].
pub fn whole(parts: &[PartManifest]) -> Result<(), Error> {
    let missing = missing(parts);
    if missing.is_empty() {
        return Ok(());
    }
    let words = missing.iter().take(MOST_NAMED).map(|(Range { start, end }, shard)| match shard {
        Some(shard) => format!("{start}..{end} (shard {shard})"),
        None => format!("{start}..{end}"),
    });
    let mut words: Vec<String> = words.collect();
    if missing.len() > MOST_NAMED {
        words.push(format!("{} more ranges", missing.len() - MOST_NAMED));
    }
    let samples = parts.iter().map(|part| part.of).max().unwrap_or(0);
    Err(Error::PartsMissing { missing: words.join(", "), samples })
}

/// An error where parts do not belong together: before anything is made, and without the brake. With `mixed`, parts of other programs and processors
/// pass.
///
/// # Errors
/// Parts of two studies, or seeds; samples that two parts have which are not the same; parts of other programs or processors; [`whole`].
pub fn consistent(parts: &[PathBuf], manifests: &[PartManifest], mixed: bool) -> Result<(), Error> {
    let Some((first, own)) = parts.first().zip(manifests.first()) else { return Ok(()) };
    for (part, manifest) in parts.iter().zip(manifests).skip(1) {
        if manifest.identity != own.identity {
            let (found, wanted) = (manifest.identity.clone(), own.identity.clone());
            return Err(Error::OtherStudy { path: part.clone(), found, wanted });
        }
        let differs = |difference| Err(Error::PartDiffers { path: part.clone(), difference });
        let first = first.display();
        if !mixed && manifest.maker() != own.maker() {
            return differs(format!("was made by {}, {first} by {}", manifest.maker(), own.maker()));
        }
        if !mixed && manifest.rounding != own.rounding {
            return differs(format!("was sampled on {}, {first} on {}", manifest.rounding, own.rounding));
        }
    }
    let mut ranges: Vec<(Range<u64>, &PathBuf)> = manifests.iter().map(|part| part.from..part.to).zip(parts).collect();
    ranges.sort_by_key(|(range, _)| (range.start, range.end));
    ranges.dedup_by(|later, earlier| later.0 == earlier.0);
    let mut neighbours = ranges.iter().zip(ranges.iter().skip(1));
    if let Some(((earlier, other), (later, part))) = neighbours.find(|((a, _), (b, _))| b.start < a.end) {
        let (from, to) = (later.start, earlier.end.min(later.end));
        let [part, other] = [part, other].map(|path| path.display().to_string());
        return Err(MonteCarloError::PartsOverlap { part, other, from, to }.into());
    }
    whole(manifests)
}

/// Puts parts of a study together in `dir`, in any order, and finishes it there: every file but the manifest and the lock has the bytes of
/// one run. The plan has as many samples as all parts together. With `mixed`, parts of other programs and processors pass, and the manifest
/// says so.
///
/// # Errors
/// A part that is not complete, or of another study, program or processor; samples that no part has, or two have; as [`run_study`](crate::run_study).
pub fn merge_parts<B: UncertainBrake, E: From<Error> + Send>(
    brake: &B,
    parts: &[PathBuf],
    mixed: bool,
    dir: &Path,
    options: RunOptions<'_>,
    draw: &mut DrawResults<'_, B, E>,
) -> Result<Manifest, E> {
    let identity = identity(brake, options.keeps_samples);
    let manifests = parts.iter().map(|part| checked(part, &identity)).collect::<Result<Vec<_>, _>>()?;
    whole(&manifests)?;
    let mut begin = |study: &Study<'_, B>, merged: &Checkpoint| {
        if !mixed {
            alike(parts, &manifests, study.plan().commit, &prepared(study))?;
        }
        let (scenes, wanted) = (study.plan().scenes.len(), study.plan().samples);
        if let Ok(state) = merged.state::<Study<'_, B>, StudyTally>(study.plan().seed, scenes)
            && state.samples > wanted
        {
            let (path, found) = (merged.path.clone(), state.samples);
            return Err(MonteCarloError::CheckpointLonger { path, found, wanted }.into());
        }
        let read = |(part, manifest): (&PathBuf, &PartManifest)| {
            let state = checkpoint(part, identity.clone()).state::<Study<'_, B>, StudyTally>(manifest.seed, scenes)?;
            match state.range() == (manifest.from..manifest.to) {
                true => Ok((part.display().to_string(), state)),
                false => Err(incomplete(part)),
            }
        };
        let states = parts.iter().zip(&manifests).map(read).collect::<Result<Vec<_>, Error>>()?;
        Ok((manifests.clone(), Some(tiled(states, wanted)?)))
    };
    run_from(brake, dir, options, &mut begin, draw)
}

/// The manifest of a part that is complete and of this study.
fn checked(part: &Path, identity: &str) -> Result<PartManifest, Error> {
    let manifest = completed(part)?;
    match manifest.identity == identity {
        true => Ok(manifest),
        false => {
            let (path, found, wanted) = (part.to_owned(), manifest.identity, identity.to_owned());
            Err(Error::OtherStudy { path, found, wanted })
        }
    }
}

fn incomplete(part: &Path) -> Error {
    let text = fs::read_to_string(part.join("study.txt")).unwrap_or_default();
    let given = |key: &str| text.split_once(key).and_then(|(_, rest)| rest.split_whitespace().next());
    let range = given(" part=").and_then(|part| part.split('/').next()).unwrap_or_default();
    let state = fs::read_to_string(part.join("checkpoint.json")).unwrap_or_default();
    let state: Option<serde_json::Value> = state.lines().nth(2).and_then(|line| serde_json::from_str(line).ok());
    let found = match (state.and_then(|state| state["samples"].as_u64()), range) {
        (_, "") => "is no part of a study".to_owned(),
        (None, range) => format!("holds none of its samples {range}"),
        (Some(samples), range) => format!("holds {samples} of its samples {range}"),
    };
    let command = match given(" shard=") {
        Some(shard) => format!("squeal run CASE --shard {shard} --out {}", part.display()),
        None => "the command that made it".to_owned(),
    };
    Error::PartIncomplete { path: part.to_owned(), found, command }
}

/// An error unless all parts are of this program, of which `commit` is one, and of processors that round as this one does.
fn alike(parts: &[PathBuf], manifests: &[PartManifest], commit: Option<&str>, prepared: &str) -> Result<(), Error> {
    let own = made_by(VERSION, commit);
    for (part, manifest) in parts.iter().zip(manifests) {
        let differs = |difference| Err(Error::PartDiffers { path: part.clone(), difference });
        let maker = manifest.maker();
        if maker != own {
            return differs(format!("was made by {maker}, this program is {own}"));
        }
        if manifest.rounding != rounding_class() {
            return differs(format!("was sampled on {}, this machine is {}", manifest.rounding, rounding_class()));
        }
        if manifest.prepared != prepared {
            return differs(
                "rests on reference modes that differ from those of this machine in their last bits".into(),
            );
        }
    }
    Ok(())
}
