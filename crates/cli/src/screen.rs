//! `squeal screen`: what helps, ranked and confirmed.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use brakes::case::Variant;
use brakes::{AnyBrake, CaseBrake, Purpose};
use output::printable;
use report::{screen_figure, write_screen_page};
use serde_json::{Value, json};
use squeal::cycles::{CycleOptions, check_contacts_of_draws};
use squeal::fingerprint;
use squeal::folder::RunFolder;
use squeal::identity::of_study;
use squeal::screen::{ChangeKind, Confirmation, Criterion, Joined, ScreenOptions, Sizes, confirm, rank};
use squeal::study::{Plan, UncertainBrake, Units};
use squeal::workers;

use super::cycle::has_motion;
use super::mesh_shapes::geometry;
use super::options::{MachineArgs, number, override_run, samples, whole_number};
use super::scene::chosen;
use super::{results_folder, sized};
use crate::Error;
use crate::bar::{Bar, EVALUATED, PREPARED};
use crate::case_file::CaseArgs;
use crate::prepared::PreparedArgs;
use crate::terminal::note;

/// Most draws of the prediction, and most places of a set; chosen.
const MOST_DRAWS: u64 = 10_000;
const MOST_PLACES: u64 = 20;

/// Screen a brake for what helps: constraints, masses, springs, dashpots, contacts taken out, parts scaled, and variants.
///
/// Changes are ranked by a few analyses on the same draws, singly and in sets; the best, and all variants, are confirmed by all scenes of the case on other
/// draws, the same for all, with an interval of each difference. A run that was stopped is continued by the same command.
#[derive(Debug, Default, clap::Args)]
#[command(after_help = "Example: squeal screen brake.toml --kinds constraint,dashpot --out screen")]
pub struct ScreenArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// File (TOML) with variants of the case: what is changed in practice, as a shim, other matrices, a chamfer; docs/screen.md describes it
    #[arg(long, value_name = "FILE")]
    pub variants: Option<PathBuf>,
    /// Kinds of changes: constraint, mass, spring, dashpot, contact, scale (the modulus, damping, mass of a part of given matrices) [default: all; none beside --variants]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub kinds: Option<Vec<String>>,
    /// Places of a set at most; sets are built greedily, of places and of what symmetries of the brake make of a place [default: 2]
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = whole_number)]
    pub up_to: Option<u64>,
    /// Set of constraints that is changed, by name [default: the case's first]
    #[arg(long, value_name = "NAME")]
    pub constraints: Option<String>,
    /// Criterion of the ranking: occurrence (unstable modes in one analysis), probability (anything is unstable), growth-quantile (the growth that 95 % of the draws do not
    /// exceed), loudness (of the motion, likewise; docs/cycles.md) [default: occurrence]
    #[arg(long, value_name = "NAME")]
    pub criterion: Option<String>,
    /// Single changes of each kind to confirm; of each larger size one set is [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole_number)]
    pub confirm: Option<u64>,
    /// Added mass, kg; of a rotation kgm^2 [default: 5 % of the place's own]
    #[arg(long, value_name = "KG", allow_negative_numbers = true, value_parser = number)]
    pub mass: Option<f64>,
    /// Added spring to ground, N/m; of a rotation Nm/rad [default: 5 % of the direction's own stiffness]
    #[arg(long, value_name = "N/m", allow_negative_numbers = true, value_parser = number)]
    pub spring: Option<f64>,
    /// Added dashpot to ground, Ns/m; of a rotation Nms/rad [default: 1 % of critical damping of the direction by itself]
    #[arg(long, value_name = "Ns/m", allow_negative_numbers = true, value_parser = number)]
    pub dashpot: Option<f64>,
    /// Factor by which parts are scaled, up and down [default: 1.1]
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = number)]
    pub factor: Option<f64>,
    /// Draws of the prediction [default: 8]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole_number)]
    pub draws: Option<u64>,
    /// Draws of the confirmation, instead of the case's samples
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = samples)]
    pub samples: Option<u64>,
    /// Seed of the random streams, instead of the case's
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = whole_number)]
    pub seed: Option<u64>,
    /// Folder for tables, figure and page: new, empty, or that of the same screening
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// JSON for machines
    #[arg(long)]
    pub json: bool,
    /// Threads and memory
    #[command(flatten)]
    pub machine: MachineArgs,
}

impl ScreenArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// Faults of the case or of an option.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let mut case = self.case.read()?;
        let mut variants = self.read_variants()?;
        for case in [&mut case].into_iter().chain(variants.iter_mut().map(|variant| &mut variant.case)) {
            override_run(case.header_mut(), self.samples, self.seed, self.machine.threads)?;
            if self.criterion.as_deref() == Some(Criterion::Loudness.name()) {
                let (option, value) = ("--criterion", Criterion::Loudness.name());
                has_motion(case, option, value)?;
            }
        }
        // What is wrong with an option is said before brakes are made.
        self.options(&case.constraint_sets(), case.header().units)?;
        let brake = sized::brake(case, Purpose::Screen, self.machine, &self.case.prepared)?;
        // A file of pieces is of one brake.
        let beside = PreparedArgs { prepared: None, no_cache: self.case.prepared.no_cache };
        let made = |Variant { name, case }| -> Result<(String, AnyBrake), Error> {
            Ok((name, sized::brake(case, Purpose::Screen, self.machine, &beside)?))
        };
        let variants = variants.into_iter().map(made).collect::<Result<Vec<_>, Error>>()?;
        let case = &self.case.case;
        sized::answer(out, &self.screen(&brake, &variants)?, &brake, case)?;
        variants.iter().try_for_each(|(_, variant)| sized::trusted(variant, case))
    }

    /// The variants of the case.
    fn read_variants(&self) -> Result<Vec<Variant>, Error> {
        let Some(path) = &self.variants else { return Ok(Vec::new()) };
        let variants = Variant::read_all(path, &self.case.case, &self.case.set)?;
        for Variant { name, case } in &variants {
            case.header().notes.iter().for_each(|text| note(&format!("{name}: {text}")));
        }
        Ok(variants)
    }

    /// The options of the screening of a brake with these sets of constraints.
    fn options(&self, sets: &[&str], units: Units) -> Result<ScreenOptions, Error> {
        let within = |option, given: Option<u64>, default: u64, allowed: std::ops::RangeInclusive<u64>| {
            let value = given.unwrap_or(default);
            let refused = || {
                let allowed = format!("{} to {}", allowed.start(), allowed.end());
                Error::Option { option, value: value.to_string(), allowed }
            };
            if allowed.contains(&value) { Ok(value) } else { Err(refused()) }
        };
        let size = |option, given: Option<f64>, unit: &str| match given {
            Some(value) if !(value.is_finite() && value > 0.0) => {
                Err(Error::Option { option, value: value.to_string(), allowed: format!("a number > 0, {unit}") })
            }
            given => Ok(given),
        };
        let mut options = ScreenOptions::default();
        if self.variants.is_some() {
            options.kinds.clear();
        }
        if let Some(given) = &self.kinds {
            options.kinds.clear();
            for name in given {
                let names = ChangeKind::ALL.map(ChangeKind::name);
                let kind = ChangeKind::ALL[chosen("--kinds", Some(name), &names)?];
                if !options.kinds.contains(&kind) {
                    options.kinds.push(kind);
                }
            }
        }
        let criteria = Criterion::ALL.map(Criterion::name);
        options.criterion = Criterion::ALL[chosen("--criterion", self.criterion.as_deref(), &criteria)?];
        options.constraints = chosen("--constraints", self.constraints.as_deref(), sets)?;
        options.sizes = Sizes {
            mass: size("--mass", self.mass, units.of("kg"))?,
            spring: size("--spring", self.spring, units.of("N/m"))?,
            dashpot: size("--dashpot", self.dashpot, units.of("Ns/m"))?,
            factor: match self.factor {
                Some(value) if !(value.is_finite() && value > 1.0) => {
                    let allowed = "a number > 1".to_owned();
                    return Err(Error::Option { option: "--factor", value: value.to_string(), allowed });
                }
                given => given,
            },
        };
        options.up_to = within("--up-to", self.up_to, options.up_to as u64, 1..=MOST_PLACES)? as usize;
        options.draws = within("--draws", self.draws, options.draws, 1..=MOST_DRAWS)?;
        options.confirmed =
            within("--confirm", self.confirm, options.confirmed as u64, 0..=u64::from(u16::MAX))? as usize;
        Ok(options)
    }

    /// Screens a brake, which need not be one of a case file, and variants of it by their names, and says what was found.
    ///
    /// # Errors
    /// As [`ScreenArgs::run`].
    pub fn screen<B: CaseBrake>(&self, brake: &B, variants: &[(String, B)]) -> Result<String, Error> {
        let labels = &brake.plan().labels;
        let sets: Vec<&str> = labels.constraints.iter().map(String::as_str).collect();
        let mut options = self.options(&sets, brake.plan().units)?;
        options.variants = variants.len();
        if variants.is_empty() {
            return self.screen_joined(brake, brake, &options, &[]);
        }
        let described: Vec<Value> = variants.iter().map(|(name, variant)| described(name, variant.plan())).collect();
        let variants: Vec<(&str, &B)> = variants.iter().map(|(name, variant)| (name.as_str(), variant)).collect();
        let joined = Joined::new(brake, &variants, options.constraints).map_err(|source| match &self.variants {
            Some(path) => Error::Variants { path: path.clone(), source: Box::new(source) },
            None => source.into(),
        })?;
        self.screen_joined(brake, &joined, &options, &described)
    }

    /// Screens a brake that is `joined` with its variants.
    fn screen_joined<B: CaseBrake, J: UncertainBrake>(
        &self,
        brake: &B,
        joined: &J,
        options: &ScreenOptions,
        variants: &[Value],
    ) -> Result<String, Error> {
        let (plan, start) = (joined.plan(), Instant::now());
        if plan.samples < 2 {
            let (value, allowed) = (plan.samples.to_string(), "2 or more, for an interval".into());
            return Err(Error::Option { option: "--samples", value, allowed });
        }
        let mut identity = of_study(joined).part("screen", |to| options.written(to)).given("samples", plan.samples);
        if options.criterion == Criterion::Loudness {
            let (_, contacts) = check_contacts_of_draws(joined, CycleOptions::default().stick)?;
            identity = identity.given("contacts", contacts);
        }
        let identity = identity.into_line();
        if let Some(dir) = &self.out {
            RunFolder::check(dir, &identity)?;
        }
        let ranking =
            workers(self.machine.threads)?.install(|| rank(joined, options, &Bar::of("combinations of changes")))?;
        let predicted = start.elapsed().as_secs_f64();
        let folder = self.out.as_ref().map(|dir| RunFolder::take(dir, &identity)).transpose()?;
        let (preparation, evaluation) = (Bar::of(PREPARED), Bar::of(EVALUATED));
        let how = Confirmation::new(plan.samples)
            .with_threads(self.machine.threads)
            .with_checkpoint(self.out.as_ref().map(|dir| dir.join("checkpoint.json")))
            .with_progress(&preparation, &evaluation);
        let screen = confirm(joined, ranking, options, &how)?;
        let seconds = start.elapsed().as_secs_f64();
        let what =
            format!("{}: what helps, constraints \"{}\"", plan.name, plan.labels.constraints[options.constraints]);
        if let Some(folder) = &folder {
            folder.publish(|stage| -> Result<(), Error> {
                for table in screen.tables() {
                    table.write(stage)?;
                }
                let figure = screen_figure(&screen, &what, &screen.rests_on().join("; "))?;
                if let Some(figure) = &figure {
                    figure.save_pictures(stage, "screen")?;
                }
                let figure = figure.as_ref();
                Ok(write_screen_page(plan, &screen, options.constraints, &geometry(brake), figure, &what, stage)?)
            })?;
            let own = json!({
                "constraints": plan.labels.constraints[options.constraints],
                "variants": variants,
                "kinds": options.kinds,
                "criterion": options.criterion,
                "up_to": options.up_to,
                "confirmed_singles": options.confirmed,
                "mass": options.sizes.mass,
                "spring": options.sizes.spring,
                "dashpot": options.sizes.dashpot,
                "factor": options.sizes.factor,
                "seed": plan.seed,
                "counts": screen.counts(),
                "seconds_of_prediction": predicted,
            });
            results_folder::write_manifest(folder, plan, self.machine.threads, seconds, own)?;
        }
        if self.json {
            return Ok(format!("{:#}\n", screen.json()));
        }
        let place = results_folder::place(self.out.as_deref());
        let sizes = options.sizes.in_proportion(&options.kinds);
        let sizes = if sizes.is_empty() { sizes } else { sizes + "\n" };
        Ok(format!(
            "{}\n\n{}{sizes}{seconds:.2} s, {predicted:.2} s of it for the prediction{place}\n",
            printable(&what),
            screen.text(),
        ))
    }
}

/// A variant, for the manifest: its case, what was set in it, and the digest of both together.
fn described(name: &str, plan: &Plan) -> Value {
    let file = plan.source_file.as_ref();
    json!({
        "name": name,
        "case": file.map(|file| file.path.display().to_string()),
        "set": file.map(|file| &file.set),
        "sha256": file.map(|file| fingerprint(&file.text)),
    })
}
