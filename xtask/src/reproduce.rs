//! The paper's study: figures, their data, the scorecard and a manifest.

use std::path::{Path, PathBuf};

use brakes::LatticeBrake;
use brakes::case::{Alternative, LatticeCase};
use report::{Geometry, write_page};
use reproduction::{Claim, Holds, Judgement, Subject, claims, claims_judged, claims_markdown, draw_paper};
use squeal::output::write;
use squeal::results::Manifest;
use squeal::{RunOptions, run_study_with};
use squeal_cli::bar::RunBars;
use squeal_cli::terminal::{note, say};
use squeal_cli::{commit, override_run};

use crate::error::TaskError;

/// Number of samples of a smoke run; chosen.
const SMOKE_SAMPLES: u64 = 16;

/// Reproduce the paper: its real study, figures 4 to 9 with their data, and a scorecard of its claims
#[derive(Debug, clap::Args)]
pub struct ReproduceArgs {
    /// A few samples only, within 30 s, to check that everything works
    #[arg(long)]
    smoke: bool,
    /// Samples per arrangement, law and speed range [default: the case's, 1000]
    #[arg(long, value_name = "N")]
    samples: Option<u64>,
    /// Seed of the random streams [default: the case's]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Worker threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "T")]
    threads: Option<usize>,
    /// Also the scorecard under each other choice of the readings R1, R3, R4, R7, R8, R9
    #[arg(long)]
    readings: bool,
    /// Folder for the results [default: target/reproduce, or target/reproduce-smoke]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// A scorecard under one choice of readings.
struct Scorecard {
    reading: String,
    choice: String,
    claims: Vec<Claim>,
}

/// Runs the task.
pub fn run(args: &ReproduceArgs) -> Result<(), TaskError> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut case = LatticeCase::read(&root.join("cases/paper.toml")).map_err(brakes::Error::from)?;
    let samples = args.samples.or(args.smoke.then_some(SMOKE_SAMPLES));
    case.header.commit = commit();
    override_run(&mut case.header, samples, args.seed, args.threads)?;
    let default = root.join("target").join(if args.smoke { "reproduce-smoke" } else { "reproduce" });
    let out = args.out.clone().unwrap_or(default);

    let mut cards = Vec::new();
    let brake = LatticeBrake::new(case.clone())?;
    let bars = RunBars::default();
    let options = RunOptions::default().with_threads(args.threads).with_progress(bars.progress());
    let manifest = run_study_with::<_, TaskError>(&brake, &out, options, &mut |_, results, dir| {
        draw_paper(results, &brake, dir)?;
        let own = claims(results, &brake)?;
        write_claims(&own, dir)?;
        let grid = brake.case.lattice.grid;
        write_page(results, None, &Geometry::lattice(grid.rows(), grid.columns()), dir)?;
        cards.push(Scorecard { reading: "default".into(), choice: "the case's own".into(), claims: own });
        // An alternative that only renames modes needs no further run.
        for alternative in &case.alternatives {
            if let Alternative::ModeNaming(labels) = alternative {
                let named = results.labelled(*labels);
                cards.push(card(alternative, claims(&named, &brake)?));
                let numbered = claims_judged(&named, &brake, Judgement::ByLimits, Subject::Numbered(*labels))?;
                let choice = format!("{}, the modes with the paper's numbers", alternative.choice());
                cards.push(Scorecard { choice, ..card(alternative, numbered) });
            }
        }
        Ok(())
    })?;
    say(&claims_markdown(&cards[0].claims))?;
    report(&manifest, &out)?;

    if args.readings {
        let others = case.alternatives.iter().filter(|a| !matches!(a, Alternative::ModeNaming(_)));
        for (number, alternative) in others.enumerate() {
            note(&format!("reading {}: {}", alternative.reading(), alternative.choice()));
            let dir = out.join("readings").join(format!("{}-{}", alternative.reading(), number + 1));
            let brake = LatticeBrake::new(case.with(alternative))?;
            let mut found = Vec::new();
            let bars = RunBars::default();
            let options = options.with_progress(bars.progress());
            let manifest = run_study_with::<_, TaskError>(&brake, &dir, options, &mut |_, results, dir| {
                found = claims(results, &brake)?;
                write_claims(&found, dir)
            })?;
            report(&manifest, &dir)?;
            cards.push(card(alternative, found));
        }
        let table = readings_markdown(&cards);
        write(&out.join("readings.md"), table.as_bytes())?;
        say(&format!("\n{table}"))?;
    }
    Ok(())
}

fn card(alternative: &Alternative, claims: Vec<Claim>) -> Scorecard {
    Scorecard { reading: alternative.reading().into(), choice: alternative.choice(), claims }
}

fn write_claims(claims: &[Claim], dir: &Path) -> Result<(), TaskError> {
    write(&dir.join("claims.md"), claims_markdown(claims).as_bytes())?;
    Ok(write(&dir.join("claims.json"), reproduction::claims_json(claims).as_bytes())?)
}

fn report(manifest: &Manifest, out: &Path) -> Result<(), TaskError> {
    let seconds = manifest.seconds;
    Ok(say(&format!(
        "\n{} CEAs, {} solved, {} of them by a certificate of stability, {} failures; {:.1} s for reference modes, {:.1} s \
         for samples, {:.1} s for the report; results in {}\n",
        manifest.analyses,
        manifest.solved,
        manifest.certified,
        manifest.failures,
        seconds.references,
        seconds.samples,
        seconds.report,
        out.display()
    ))?)
}

/// The table of the scorecards: a row for each choice of a reading, and a column for each claim with whether it holds.
fn readings_markdown(cards: &[Scorecard]) -> String {
    let mut text = String::from("| reading | choice |");
    for claim in &cards[0].claims {
        text += &format!(" {} |", claim.id);
    }
    text += " yes |\n| --- | --- |";
    text += &" --- |".repeat(cards[0].claims.len() + 1);
    for card in cards {
        text += &format!("\n| {} | {} |", card.reading, card.choice);
        for claim in &card.claims {
            let holds = match claim.holds {
                Holds::Yes => "yes",
                Holds::No => "no",
                Holds::NotDetermined => "?",
            };
            text += &match claim.ours {
                Some(ours) => format!(" {holds} ({ours:.3}) |"),
                None => format!(" {holds} |"),
            };
        }
        let yes = card.claims.iter().filter(|claim| claim.holds == Holds::Yes).count();
        text += &format!(" {yes} |");
    }
    text + "\n"
}
