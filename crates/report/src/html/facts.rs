//! The end of the page: from what the results came, enough to make them again.

use squeal::results::{Manifest, Results, Times, VERSION};
use squeal::study::{ModeIdentity, ModeNaming, Plan, StudySource};

use super::text::escaped;

/// Assumptions of every study.
const ASSUMPTIONS: [&str; 6] = [
    "The brake is linear about steady sliding. An unstable mode grows at first; amplitude and loudness of the squeal that follows do not \
     follow from that: squeal cycle, and squeal run --cycles, compute them, or say what of the brake they do not cover.",
    "A mode is unstable where its eigenvalue surely has a positive real part, beyond its error bound; an undecided one counts as stable, and so \
     does one on the imaginary axis. A real eigenvalue that is positive, divergence, is instability as well.",
    "Intervals are at 95 % for each number by itself and not for all at once: of 100 of them about five do not enclose the truth.",
    "Intervals say what chance in the draws leaves open. That distributions, springs or dampers may be other than the case file says is \
     not in them.",
    "Mode shapes are at the point where modes have their names, without the growth or decay.",
    "The picture of a moving mode is made of rounded numbers: displacements to a 32767th of the mode's largest, places of the nodes of a \
     mesh to a 32767th of half its largest side. Tables, and the files of shapes beside the page, have all digits.",
];

/// The assumption of a study of several arrangements, laws, speed ranges or sets of constraints.
const SAME_DRAWS: &str = "Every arrangement of contacts, law, speed range and set of constraints is evaluated with the same draws, so that \
                          differences are not blurred by chance.";

/// Assumptions, counts, versions and case of a study, as HTML.
pub(super) fn of_study(results: &Results) -> String {
    let plan = results.plan();
    // Without times and threads: the page has the same bytes whatever these were.
    let manifest = Manifest::new(results, None, Times::default());
    let naming = match (results.labels, plan.mode_identity) {
        (ModeNaming::Tracked, ModeIdentity::Continuation) => {
            format!("by frequency rank {}, then followed by continuation", plan.labels.named_at)
        }
        (ModeNaming::Tracked, ModeIdentity::Mac) => format!("by frequency rank {}, then by MAC", plan.labels.named_at),
        (ModeNaming::Rank, _) => "by frequency rank in each sample".into(),
        (ModeNaming::Pair, _) => "by place among all eigenvalues in each sample".into(),
        (ModeNaming::RankDown, _) => "by frequency rank in each sample, from the highest down".into(),
        (ModeNaming::PairDown, _) => "by place among all eigenvalues in each sample, from the highest down".into(),
    };
    let arrangements: Vec<String> =
        manifest.arrangements.iter().map(|(number, count)| format!("{count} with {number} in contact")).collect();
    let list = |names: Vec<&str>| names.join(", ");
    let mut facts = vec![
        ("Laws", list(plan.labels.laws.iter().map(|law| law.name.as_str()).collect())),
        ("Sets of constraints", list(plan.labels.constraints.iter().map(String::as_str).collect())),
        ("Speed ranges", list(plan.labels.speeds.iter().map(|speed| speed.description.as_str()).collect())),
        ("Arrangements", arrangements.join(", ")),
        ("Names of modes", naming),
        ("Draws", manifest.samples.to_string()),
        ("Seed", manifest.seed.to_string()),
        ("Analyses that the results stand for", manifest.analyses.to_string()),
        ("Solved", format!("{}, of them {} by a certificate of stability", manifest.solved, manifest.certified)),
        (
            "Unstable modes",
            format!("{}, of them {} with an open name", manifest.unstable_modes, manifest.ambiguous_modes),
        ),
        ("Real eigenvalues that diverge", manifest.divergent.to_string()),
        ("Undecided verdicts", manifest.undecided.to_string()),
        ("Eigenvalues on the imaginary axis", manifest.marginal.to_string()),
        ("Failures", manifest.failures.to_string()),
    ];
    facts.retain(|(name, value)| !value.is_empty() && (*name != "Arrangements" || !results.has_one_arrangement()));
    if !plan.threshold.is_axis() {
        facts.insert(0, ("Counts as unstable", format!("a mode with {}", plan.threshold)));
    }
    assumptions(plan.scenes.len() > 1)
        + &described(&facts)
        + &program(plan)
        + &case(plan.source_file.as_ref(), manifest.source.case_sha256.as_deref())
}

fn assumptions(has_several_scenes: bool) -> String {
    let items: String = ASSUMPTIONS
        .iter()
        .chain(has_several_scenes.then_some(&SAME_DRAWS))
        .map(|text| format!("<li>{}</li>\n", escaped(text)))
        .collect();
    format!("<h3>Assumptions</h3>\n<ul>\n{items}</ul>\n<h3>Counts</h3>\n")
}

/// Names and values as a list of descriptions.
pub(super) fn described(facts: &[(&str, String)]) -> String {
    let items = facts.iter().map(|(name, value)| format!("<dt>{name}</dt><dd>{}</dd>\n", escaped(value)));
    format!("<dl>\n{}</dl>\n", items.collect::<String>())
}

/// The version of this program.
pub(super) fn program(plan: &Plan) -> String {
    let commit = plan.commit.unwrap_or("not known");
    let facts = [("squeal", VERSION.to_owned()), ("Commit", commit.to_owned())];
    format!("<h3>Version</h3>\n{}", described(&facts))
}

/// The case file as it was given.
pub(super) fn case(source: Option<&StudySource>, sha256: Option<&str>) -> String {
    let Some(StudySource { path, text, .. }) = source else { return String::new() };
    let facts = [("File", path.display().to_string()), ("SHA-256", sha256.unwrap_or_default().to_owned())];
    format!(
        "<h3>Case file</h3>\n{}<pre tabindex=\"0\" aria-label=\"Text of the case file\">{}</pre>\n",
        described(&facts),
        escaped(text)
    )
}
