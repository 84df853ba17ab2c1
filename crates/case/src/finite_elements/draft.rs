//! Draft of a case of finite elements: what a mesh and the matrices beside it say of a brake.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use formats::{Limits, read_deck};
use study::Units;

use super::FiniteElementCase;
use super::faces::Solids;
use super::facing::{Facing, facing};
use super::nodes::Model;
use crate::CaseError;
use crate::check::Check;
use crate::draft::{Draft, damping_line, is_one_sided, named, quoted, symmetry_line};

/// Ends of the files of mass, stiffness and damping beside a deck, after its stem: of CalculiX, which writes no damping, and of Abaqus; `#` is the number of the step.
const BESIDE: [[&str; 3]; 2] = [[".mas", ".sti", ""], ["_MASS#.mtx", "_STIF#.mtx", "_DMPV#.mtx"]];
/// Most steps whose matrices are looked for; chosen: a digit.
const MOST_STEPS: usize = 9;
/// Most sets that are listed; chosen: some screens.
const MOST_SETS: usize = 60;

/// Files that a draft is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DraftFiles {
    /// The deck.
    pub mesh: PathBuf,
    /// Files, as `FILE` or `FILE:NAME`, with mass and stiffness.
    pub mass_and_stiffness: [PathBuf; 2],
    /// File with the damping, if there is one.
    pub damping: Option<PathBuf>,
}

impl DraftFiles {
    /// The files beside a deck under the names that CalculiX and Abaqus give them, compressed by gzip or not, of the first step that has both mass and stiffness;
    /// `None` without mass or stiffness.
    #[must_use]
    pub fn beside(mesh: &Path) -> Option<Self> {
        let name = mesh.file_name()?.to_str()?;
        let plain = name.strip_suffix(".gz").unwrap_or(name);
        let stem = Path::new(plain).file_stem()?.to_str()?;
        let there = |end: &str| {
            let path = mesh.with_file_name(format!("{stem}{end}"));
            let compressed = mesh.with_file_name(format!("{stem}{end}.gz"));
            [path, compressed].into_iter().find(|path| path.is_file())
        };
        let of_step = |step: usize| {
            BESIDE.iter().find_map(|ends| {
                let [mass, stiffness, damping] = ends.map(|end| there(&end.replace('#', &step.to_string())));
                let damping = damping.filter(|_| !ends[2].is_empty());
                Some(Self { mesh: mesh.to_owned(), mass_and_stiffness: [mass?, stiffness?], damping })
            })
        };
        (1..=MOST_STEPS).find_map(of_step)
    }
}

impl Draft {
    /// The draft of a case file of finite elements at `case`, which need not exist.
    ///
    /// # Errors
    /// A mesh or matrices that cannot be read, or do not belong together.
    pub fn new(case: &Path, files: &DraftFiles) -> Result<Self, CaseError> {
        let check = Check::new(case);
        let deck = read_deck(&files.mesh, &Limits::default());
        let deck = deck.map_err(|source| check.matrix("brake.mesh", &files.mesh, source))?;
        let model = Model::new(&check, Some(deck), Vec::new());
        let contacts = Solids::new(&model, "[[contact]]").map_or_else(|_| Vec::new(), |solids| facing(&solids));
        // The system in which the bodies have the density of a solid; without a word on it where none is, or the mesh has no solids.
        let has_solids = Solids::new(&model, "units").is_ok();
        let systems = || Units::ALL.into_iter().filter(|_| has_solids).map(Some).chain([None]);
        let mut refused = None;
        for is_triangle in [false, true] {
            for units in systems() {
                let text = text(case, files, &model, &contacts, units, is_triangle);
                match FiniteElementCase::parse(case, text.clone()) {
                    Ok(read) => {
                        let found = found(&read, &model, &contacts, units, is_triangle);
                        return Ok(Self { text, found });
                    }
                    Err(error) => refused = Some(error),
                }
            }
            if !refused.as_ref().is_some_and(is_one_sided) {
                break;
            }
        }
        Err(refused.unwrap_or_else(|| check.value("brake.mesh", files.mesh.display(), "a mesh with its matrices")))
    }
}

fn found(
    read: &FiniteElementCase,
    model: &Model<'_>,
    contacts: &[Facing],
    units: Option<Units>,
    is_triangle: bool,
) -> Vec<(&'static str, String)> {
    let (nodes, sets) = (model.mesh.as_ref().map_or(0, |mesh| mesh.nodes.len()), model.sets.len());
    let counts = format!("{nodes} nodes, {sets} node sets, {} surfaces", model.surfaces.len());
    let triangle = if is_triangle { ", taken as a triangle: look at `symmetry`" } else { "" };
    let mut found = vec![("mesh", counts), ("matrices", format!("{} degrees of freedom{triangle}", read.dofs.len()))];
    found.push(match units {
        Some(units) => ("units", format!("{}, by the density of the solids", units.name())),
        None => ("units", "not known: by no system the mesh has the density of a solid".into()),
    });
    for Facing { slave, master, faces, patches, .. } in contacts {
        let patches = if patches.is_empty() { String::new() } else { format!(", {} patches", patches.len()) };
        found.push(("contact", format!("{slave} on {master}: {faces} faces{patches}; to be filled in")));
    }
    if contacts.is_empty() {
        found.push(("contact", "no sets of two bodies look at each other; to be filled in".into()));
    }
    found
}

fn text(
    case: &Path,
    files: &DraftFiles,
    model: &Model<'_>,
    contacts: &[Facing],
    units: Option<Units>,
    is_triangle: bool,
) -> String {
    let name = |path: &Path| quoted(&named(path, case));
    let stem = files.mesh.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let stem = stem.split('.').next().unwrap_or_default().to_owned();
    let (damping, symmetry) = (damping_line(files.damping.as_deref(), case), symmetry_line(is_triangle));
    let system = match units {
        Some(units) => format!(
            "[units]\nsystem = {:<30} # in it the solids of the mesh have the density of a solid\n",
            quoted(units.name())
        ),
        None => "#[units]\n#system = \"?\"                        # \"SI\" or \"mm-t-s\"\n".to_owned(),
    };
    let unit = |si: &'static str| units.unwrap_or_default().of(si);
    format!(
        r#"# Draft by `squeal new`: what the mesh and its matrices say stands here, and `squeal check` takes it as it is.
#
# What they cannot know is commented out, without a blank after the #: remove the # and put a value in place of each ?.
# docs/case-files.md, "Finite elements", explains every field.

[study]
name = {study}
#laws = ["amontons-coulomb"]           # with a contact, below
samples = 100                          # draws of what is uncertain
seed = 1

{system}
[brake]
kind = "finite-elements"
mesh = {mesh}

[[terms]]
name = "structure"
mass = {mass}
stiffness = {stiffness}
{damping}{symmetry}#rayleigh = {{ mass = ?, stiffness = ? }}  # damping C = mass M + stiffness K, 1/s and s; or loss_factor = ?

{sets}
#[[holders]]                           # springs to ground in place of parts that hold a body and are not in the mesh
#name = "caliper"
#nodes = "?"                           # one of the node sets above
#stiffness = [?, ?, ?]                 # {n_per_m} in x, y and z, of all its nodes together

{contacts}#[[speeds]]                            # of the sliding
#name = "low"
#from = ?                              # {speed}
#to = ?

#[friction]                            # measured values: {{ distribution = "empirical", file = "mu.csv", column = "mu" }}
#mu = {{ distribution = "normal", mean = ?, deviation = ?, at_least = 0.02 }}

[reduction]
frequencies = [1000.0, 8000.0]         # Hz: the band that is studied; chosen, where brakes squeal
growth = [-500.0, 3000.0]              # 1/s: more strongly damped modes than the first are left out
"#,
        study = quoted(&stem),
        mesh = name(&files.mesh),
        mass = name(&files.mass_and_stiffness[0]),
        stiffness = name(&files.mass_and_stiffness[1]),
        sets = sets(model),
        contacts = contact_tables(contacts, units.unwrap_or_default()),
        n_per_m = unit("N/m"),
        speed = unit("m/s"),
    )
}

/// Node sets with their sizes, and where they are; surfaces; sets of elements. As comments.
fn sets(model: &Model<'_>) -> String {
    let positions: HashMap<i64, [f64; 3]> =
        model.mesh.iter().flat_map(|mesh| &mesh.nodes).map(|node| (node.label, node.position)).collect();
    let range = |nodes: &[i64], axis: usize| {
        let all = || nodes.iter().filter_map(|node| Some(positions.get(node)?[axis]));
        let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        format!("{}..{}", output::significant(least, 4), output::significant(most, 4))
    };
    let of_nodes = model.sets.iter().map(|(name, nodes)| {
        let [x, y, z] = [0, 1, 2].map(|axis| range(nodes, axis));
        format!("# {:<24} {:>7} nodes     {x:<20} {y:<20} {z}", output::printable(name), nodes.len())
    });
    let surfaces = model.surfaces.keys().map(|name| format!("# {:<24} a surface", output::printable(name)));
    let elements = model
        .element_sets
        .iter()
        .map(|(name, elements)| format!("# {:<24} {:>7} elements", output::printable(name), elements.len()));
    let all: Vec<String> = of_nodes.chain(surfaces).chain(elements).collect();
    let more = if all.len() > MOST_SETS { format!("# and {} more\n", all.len() - MOST_SETS) } else { String::new() };
    let lines: String = all.iter().take(MOST_SETS).map(|line| format!("{line}\n")).collect();
    let heads = format!("# {:<24} {:>7}           {:<20} {:<20} {}\n", "Sets of the mesh", "", "x", "y", "z");
    if lines.is_empty() { "# The mesh has no sets.\n".to_owned() } else { heads + &lines + &more }
}

/// A table for each pair of sets that look at each other, or one for which the sets are to be filled in.
fn contact_tables(contacts: &[Facing], units: Units) -> String {
    let table = |slave: &str, master: &str, reach: &str, patches: &[String]| {
        let listed: Vec<String> = patches.iter().map(|patch| quoted(patch)).collect();
        let patches = match listed.is_empty() {
            true => String::new(),
            false => format!("#patches = [{}]\n", listed.join(", ")),
        };
        format!(
            "#[[contact]]\n#name = {name}\n#slave = {name:<29} # the pad's face\n#master = {:<28} # the disc's face\n\
             #reach = {reach:<29} # {}: the largest gap or overlap of the two faces at a point; `squeal check` says how large it really is\n\
             #sliding = {{ axis = [?, ?, ?] }}         # the disc turns about it, positive by the right hand, through = [?, ?, ?]\n\
             #stiffness = {{ per_area = ? }}          # {}\n\
             #load = ?                              # {}; or {{ pressure = ? }}, {{ pressures = \"FILE\" }}, \"equilibrium\" with [[forces]]\n{patches}\n",
            quoted(master),
            units.of("m"),
            units.of("N/m^3"),
            units.of("N"),
            name = quoted(slave),
        )
    };
    let tables = contacts.iter().map(|Facing { slave, master, reach, patches, .. }| {
        table(slave, master, &format!("{:?}", rounded(*reach)), patches)
    });
    if contacts.is_empty() { table("?", "?", "?", &[]) } else { tables.collect() }
}

/// The number rounded to one significant digit.
fn rounded(value: f64) -> f64 {
    format!("{value:.0e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::CaseFile;

    const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

    /// The draft of a mesh of the project, for a case file beside it.
    fn draft(mesh: &str) -> (PathBuf, Draft) {
        let mesh = Path::new(ROOT).join(mesh);
        let case = mesh.with_file_name("new.toml");
        let draft = Draft::new(&case, &DraftFiles::beside(&mesh).unwrap()).unwrap();
        (case, draft)
    }

    /// The draft with all that waits taken in: `?` one after the other in a line, by the name of the field.
    fn filled(draft: &str, values: &BTreeMap<&str, &[&str]>) -> String {
        let line = |line: &str| {
            let Some(field) =
                line.strip_prefix('#').filter(|rest| rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '['))
            else {
                return format!("{line}\n");
            };
            let mut field = field.split('#').next().unwrap_or_default().to_owned();
            let name = field.split(' ').next().unwrap_or_default().to_owned();
            for value in values.get(name.as_str()).copied().unwrap_or_default() {
                field = field.replacen('?', value, 1);
            }
            assert!(!field.contains('?'), "{field}");
            field + "\n"
        };
        draft.lines().map(line).collect()
    }

    #[test]
    fn every_mesh_with_matrices_gives_a_case_that_is_accepted_as_it_is_and_filled_in() {
        let values = BTreeMap::from([
            ("rayleigh", &["20.0", "1e-7"][..]),
            ("stiffness", &["1e3", "1e3", "1e3"]),
            ("sliding", &["0", "0", "1"]),
            ("load", &["1000.0"]),
            ("from", &["0.1"]),
            ("to", &["1.0"]),
            ("mu", &["0.5", "0.1"]),
        ]);
        for (mesh, holder, units, contacts) in [
            ("cases/disc-pad/disc-pad.inp", "PADBACK", "SI", &[("PADFACE", "DISCFACE", 9)][..]),
            (
                "cases/two-pads/two-pads.inp",
                "BACK_OUTER",
                "mm-t-s",
                &[("FACE_INNER", "BOTTOM", 0), ("FACE_OUTER", "TOP", 0)],
            ),
        ] {
            let (path, Draft { text, found }) = draft(mesh);
            assert!(text.contains(&format!("\nsystem = \"{units}\"")), "{text}");
            let CaseFile::FiniteElements(case) = CaseFile::parse(&path, text.clone()).unwrap() else { unreachable!() };
            assert!(case.contact.is_none());
            let mut values = values.clone();
            let holder = [holder];
            values.insert("nodes", &holder);
            let text = filled(&text, &values);
            let CaseFile::FiniteElements(case) = CaseFile::parse(&path, text).unwrap() else { unreachable!() };
            let patches = case.contact.unwrap().patches;
            let expected: usize = contacts.iter().map(|(_, _, patches)| (*patches).max(1)).sum();
            assert_eq!(patches.len(), expected, "{found:?}");
            let said: Vec<&str> =
                found.iter().filter(|(name, _)| *name == "contact").map(|(_, words)| words.as_str()).collect();
            for ((slave, master, _), words) in contacts.iter().zip(said) {
                assert!(words.starts_with(&format!("{slave} on {master}: ")), "{words}");
            }
        }
        // Beams without faces, whose matrices are triangles that say so nowhere.
        let (path, Draft { text, found }) = draft("crates/formats/tests/fixtures/abaqus_matrix_input/model.inp");
        assert!(text.contains("\nsymmetry = \"triangle\"") && text.contains("\n#[units]"), "{text}");
        assert!(found.iter().any(|(_, words)| words.contains("look at `symmetry`")), "{found:?}");
        CaseFile::parse(&path, text).unwrap();
    }

    #[test]
    fn matrices_beside_a_mesh_are_those_of_the_first_step_that_has_both() {
        let dir = tempfile::tempdir().unwrap();
        let mesh = dir.path().join("brake.v2.inp.gz");
        assert_eq!(DraftFiles::beside(&mesh), None);
        for name in
            ["brake.v2_MASS2.mtx", "brake.v2_STIF2.mtx", "brake.v2_DMPV2.mtx", "brake.v2_STIF1.mtx", "brake.v2.sti"]
        {
            std::fs::write(dir.path().join(name), "").unwrap();
        }
        let found = DraftFiles::beside(&mesh).unwrap();
        assert_eq!(found.mass_and_stiffness[1], dir.path().join("brake.v2_STIF2.mtx"));
        assert_eq!(found.damping, Some(dir.path().join("brake.v2_DMPV2.mtx")));
        std::fs::write(dir.path().join("brake.v2.mas.gz"), "").unwrap();
        let found = DraftFiles::beside(&mesh).unwrap();
        assert_eq!(found.mass_and_stiffness[0], dir.path().join("brake.v2.mas.gz"));
        assert_eq!(found.damping, None);
    }
}
