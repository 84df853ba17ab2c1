//! Loads that follow from equilibrium with what presses and with friction.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use brakes::case::FiniteElementCase;
use elements::nalgebra::DVector;
use squeal::study::{ModeSource, UncertainBrake};

use super::{Folder, in_equilibrium};

#[test]
fn loads_in_equilibrium_are_those_that_press() {
    let folder = Folder::new();
    let case = folder.parse(in_equilibrium()).unwrap();
    let contact = case.contact.as_ref().unwrap();
    let area = 2.2674787254376315e+03 + 2.8016067404148216e+03;
    for (patch, pressure) in contact.patches.iter().zip([1.5, 1.2]) {
        let total: f64 = patch.shares.iter().map(|share| share * patch.load).sum();
        // Backs have the area of the faces; the median of the factor p of all loads is 2.
        assert!((total / (2.0 * pressure * area) - 1.0).abs() < 1e-10, "{total} {}", pressure * area);
        let least = patch.shares.iter().fold(f64::INFINITY, |least, share| least.min(*share));
        let most = patch.shares.iter().fold(0.0_f64, |most, share| most.max(*share));
        assert!(least < 0.9 * most, "the lining bends, and friction tilts it");
    }
    let note = case.header.notes.iter().find(|note| note.contains("equilibrium")).unwrap();
    println!("{note}");
    assert!(note.contains("of 108 points are closed") && note.contains("unique"), "{note}");
    // Friction tilts a pad towards where its holder pushes back: other forces without it.
    let without = in_equilibrium().replace("value = 0.45", "value = 0.0");
    let without = folder.parse(without).unwrap();
    let shares = |case: &FiniteElementCase| case.contact.as_ref().unwrap().patches[0].shares.clone();
    let without = shares(&without);
    if without.len() == shares(&case).len() {
        assert!(shares(&case).iter().zip(&without).any(|(a, b)| (a - b).abs() > 0.05));
    }
}

/// A brake that is pressed off the middle of its outer pad, by a force that is a parameter, so that points open.
fn pressed_off_the_middle() -> String {
    let old = "[[forces]]\nname = \"OUTER\"\nfaces = \"OUTER\"\npressure = 1.5\n";
    let new = "[[forces]]\nname = \"piston\"\nnodes = \"EDGE\"\nforce = [0.0, 0.0, -2500.0]\ncoefficient = \"p\"\n";
    let inner = "faces = \"INNER\"\npressure = 1.2\n";
    let pressed = in_equilibrium().replace(old, new).replace("load_factor = \"p\"\n", "");
    let pressed = pressed.replace(inner, "nodes = \"INNER\"\nforce = [0.0, 0.0, 3000.0]\n");
    assert!(pressed.contains("coefficient = \"p\"") && pressed.contains("3000.0"));
    pressed.replacen("6e4", "2e3", 2)
}

/// The text of [`pressed_off_the_middle`] for a folder whose mesh gets the set of nodes that is pressed.
pub(super) fn pressed_off_the_middle_in(folder: &Folder) -> String {
    let deck_path = folder.folder.path().join("brake.inp");
    let mut deck = std::fs::read_to_string(&deck_path).unwrap();
    let first = folder.parse(in_equilibrium()).unwrap();
    writeln!(deck, "*NSET, NSET=EDGE").unwrap();
    for node in &first.mesh.as_ref().unwrap().nodes {
        if node.position[2] == 11.0 && node.position[0] > 0.0 {
            writeln!(deck, "{}", node.label).unwrap();
        }
    }
    std::fs::write(&deck_path, deck).unwrap();
    pressed_off_the_middle()
}

pub(super) fn constant(value: f64) -> montecarlo::Distribution {
    montecarlo::Distribution::Constant { value }
}

/// The normal force of each point at the medians: friction across the sliding is `mu N0 / (Omega r)`.
pub(super) fn forces(case: &FiniteElementCase) -> Vec<f64> {
    let contact = case.contact.as_ref().unwrap();
    let (mu, at) = (contact.friction.mu.median(), brakes::at_medians(case).unwrap());
    let speed = 5.0 * contact.own_speed.as_ref().unwrap().factor;
    let of_patch = |patch: &brakes::case::Patch| {
        let across = patch.channels.start + patch.pairs.len();
        let force = |(at_pair, part): (usize, &f64)| at.channels[across + at_pair].slope * speed * part / mu;
        patch.speeds.iter().enumerate().map(force).collect::<Vec<_>>()
    };
    contact.patches.iter().flat_map(of_patch).collect()
}

/// Where mu, the piston's force or a stiffness is not that of the medians, the state of the contacts is not either: each is that of an active
/// set found with the whole brake, and its matrices are those of a case that has these numbers from the beginning.
#[test]
fn equilibrium_is_found_anew_where_friction_or_pressure_differ() {
    let folder = Folder::new();
    let text = pressed_off_the_middle_in(&folder);
    let case = folder.parse(text.clone()).unwrap();
    let order = case.dofs.len();
    let structure = {
        let mut at = brakes::at_medians(&case).unwrap();
        at.channels.fill(linsys::ChannelGain::default());
        let patches = case.contact.as_ref().unwrap().patches.len();
        let first = at.coefficients.len() - patches;
        at.coefficients[first..].fill(0.0);
        elements::nalgebra::DMatrix::from(&case.system.assemble(&at).unwrap().k)
    };
    let on = |set: &str, force: f64| {
        let nodes = &case.node_sets[set];
        let row = |dof: &formats::Dof| if dof.direction == 3 && nodes.contains(&dof.node) { 1.0 } else { 0.0 };
        DVector::from_iterator(order, case.dofs.iter().map(row)) * (force / nodes.len() as f64)
    };
    let own_channels =
        |patch: &brakes::case::Patch| case.system.channels()[patch.channels.start..][..patch.pairs.len()].to_vec();
    let all: Vec<linsys::Channel> = case.contact.as_ref().unwrap().patches.iter().flat_map(own_channels).collect();
    // The springs k g: g sums up to 1 along the normal, z, over the nodes of the pad.
    let spring = |channel: &linsys::Channel| {
        let of_pad =
            channel.reading.iter().filter(|(dof, _)| case.dofs[*dof].direction == 3 && case.dofs[*dof].node > 1000);
        of_pad.map(|(_, value)| value).sum::<f64>().abs()
    };
    let dense = |row: &[(usize, f64)]| {
        let mut all: DVector<f64> = DVector::zeros(order);
        row.iter().for_each(|&(dof, value)| all[dof] += value);
        all
    };
    let mut states = std::collections::BTreeSet::new();
    for (mu, p, stiffness) in [(0.45, 2.0, 1.0), (0.1, 2.0, 1.0), (0.7, 3.0, 1.0), (0.3, 1.5, 4.0)] {
        // The structure of the medians, with other numbers.
        let mut changed = folder.parse(text.clone()).unwrap();
        changed.parameters.iter_mut().filter(|own| own.name == "p").for_each(|own| own.distribution = constant(p));
        let contact = changed.contact.as_mut().unwrap();
        contact.friction.mu = constant(mu);
        contact.stiffness_factor = Some(brakes::case::Expression::parse(&stiffness.to_string(), &[]).unwrap());
        let anew = forces(&changed);
        let given = text
            .replace("value = 0.45", &format!("value = {mu}"))
            .replace("\"uniform\"\nfrom = 1.0\nto = 3.0", &format!("\"constant\"\nvalue = {p}"))
            .replace("[all_contacts]", &format!("[all_contacts]\nstiffness_factor = {stiffness}"));
        let fresh = folder.parse(given).unwrap();
        let [a, b] = [&changed, &fresh].map(|case| case.system.assemble(&brakes::at_medians(case).unwrap()).unwrap());
        for (a, b) in [(&a.c, &b.c), (&a.k, &b.k)] {
            let largest = b.values().iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            assert!((a - b).values().iter().all(|value| value.abs() < 1e-9 * largest), "mu {mu}, p {p}");
        }
        let load = on("EDGE", -2500.0 * p) + on("INNER", 3000.0);
        let gaps: Vec<_> = all.iter().map(|channel| dense(&channel.reading) / spring(channel)).collect();
        let mut closed = vec![true; all.len()];
        let found = loop {
            let mut k = structure.clone();
            for channel in all.iter().zip(&closed).filter(|(_, is_closed)| **is_closed).map(|(channel, _)| channel) {
                // (g + mu s) k g^T, entry by entry: few are not zero.
                for &(column, reading) in &channel.reading {
                    let across = stiffness * reading;
                    channel.reading.iter().for_each(|&(row, g)| k[(row, column)] += g / spring(channel) * across);
                    channel.force.iter().for_each(|&(row, s)| k[(row, column)] += mu * s * across);
                }
            }
            let u = k.lu().solve(&load).unwrap();
            let presses: Vec<f64> =
                gaps.iter().zip(&all).map(|(gap, channel)| -spring(channel) * stiffness * gap.dot(&u)).collect();
            let next: Vec<bool> = presses.iter().map(|force| *force > 0.0).collect();
            if next == closed {
                break presses.into_iter().map(|force| force.max(0.0)).collect::<Vec<_>>();
            }
            closed = next;
        };
        let largest = found.iter().fold(0.0_f64, |largest, force| largest.max(*force));
        let distance = found.iter().zip(&anew).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
        println!("mu {mu}, p {p}: {} closed, off by {distance:.1e}", closed.iter().filter(|is| **is).count());
        assert!(distance < 1e-9);
        states.insert(closed);
    }
    assert!(states.len() > 2, "points open and close");
}

/// A patch at the end of a pad that is pressed at its other end: at the medians it lifts off, and is no reason to refuse the case. Where a second piston, which
/// is at rest there, presses it down, and where it is in contact alone, matrices are those of a case that has this piston from the beginning.
#[test]
fn a_patch_that_lifts_off_at_the_medians_holds_down_elsewhere() {
    let folder = Folder::new();
    let deck_path = folder.folder.path().join("brake.inp");
    let mut deck = std::fs::read_to_string(&deck_path).unwrap();
    let first = folder.parse(in_equilibrium()).unwrap();
    let nodes = &first.mesh.as_ref().unwrap().nodes;
    let face: BTreeMap<i64, f64> = first.contact.as_ref().unwrap().patches[0]
        .pairs
        .iter()
        .map(|pair| (pair[0], nodes.iter().find(|node| node.label == pair[0]).unwrap().position[0]))
        .collect();
    let [least, most] = [f64::INFINITY, f64::NEG_INFINITY]
        .map(|start| face.values().fold(start, |end: f64, x| if start > 0.0 { end.min(*x) } else { end.max(*x) }));
    let far = least + 0.3 * (most - least);
    let all_of_pad = || nodes.iter().filter(|node| node.label > 1000 && node.position[2] > -1.0);
    for (name, is_in) in [("LEFT", &(|x: f64| x < far) as &dyn Fn(f64) -> bool), ("RIGHT", &|x: f64| x >= far)] {
        writeln!(deck, "*NSET, NSET={name}").unwrap();
        all_of_pad().filter(|node| is_in(node.position[0])).for_each(|node| writeln!(deck, "{}", node.label).unwrap());
    }
    for (name, is_in) in [("EDGE", &(|x: f64| x > 0.0) as &dyn Fn(f64) -> bool), ("END", &|x: f64| x < far)] {
        writeln!(deck, "*NSET, NSET={name}").unwrap();
        let backs = all_of_pad().filter(|node| node.position[2] == 11.0 && is_in(node.position[0]));
        backs.for_each(|node| writeln!(deck, "{}", node.label).unwrap());
    }
    std::fs::write(&deck_path, deck).unwrap();
    let piston = "[[forces]]\nname = \"second\"\nnodes = \"END\"\nforce = [0.0, 0.0, -2500.0]\ncoefficient = \"q\"\n";
    let text = |q: f64| {
        pressed_off_the_middle()
            .replace("slave = \"LINING\"\n", "slave = \"LINING\"\npatches = [\"LEFT\", \"RIGHT\"]\n")
            .replace(
                "[all_contacts]",
                &format!("{piston}[parameters.q]\ndistribution = \"constant\"\nvalue = {q:?}\n[all_contacts]"),
            )
    };
    let case = folder.parse(text(0.0)).unwrap();
    let [lifted, pressed] = [0, 1].map(|patch| case.contact.as_ref().unwrap().patches[patch].load);
    assert!(lifted == 0.0 && pressed > 0.0, "{lifted} {pressed}");
    let note = "\"LEFT\": none of its points is closed at the medians with all patches";
    assert!(case.header.notes.iter().any(|said| said.contains(note)), "{:?}", case.header.notes);
    assert!(brakes::loads_at_medians(&case).unwrap().iter().flatten().all(|load| load.is_finite()));
    let mut changed = folder.parse(text(0.0)).unwrap();
    changed.parameters.iter_mut().filter(|own| own.name == "q").for_each(|own| own.distribution = constant(3.0));
    let fresh = folder.parse(text(3.0)).unwrap();
    assert!(fresh.contact.as_ref().unwrap().patches[0].load > 0.0);
    let [a, b] = [&changed, &fresh].map(|case| case.system.assemble(&brakes::at_medians(case).unwrap()).unwrap());
    for (a, b) in [(&a.c, &b.c), (&a.k, &b.k)] {
        let largest = b.values().iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        assert!((a - b).values().iter().all(|value| value.abs() < 1e-9 * largest));
    }
}

/// A piston that pulls in two of five draws: contact alone holds its pad along the axis, so that these have no equilibrium. They fail as samples and
/// among the draws of the whole brake, and bases are made of the others.
#[test]
fn draws_without_equilibrium_are_counted_and_end_no_study() {
    let folder = Folder::new();
    let text = in_equilibrium()
        .replace("load_factor = \"p\"\n", "")
        .replace("pressure = 1.5\n", "pressure = 1.5\ncoefficient = \"p\"\n")
        .replace("from = 1.0\nto = 3.0", "from = -2.0\nto = 3.0")
        .replace("samples = 10", "samples = 20")
        .replace("frequencies = [1000.0, 8000.0]", "frequencies = [1000.0, 3000.0]\ntraining = 3\nfull_checks = 8");
    let case = folder.parse(text).unwrap();
    let p = case.parameters.iter().position(|own| own.name == "p").unwrap();
    let brake = brakes::FiniteElementBrake::checked(case, &()).unwrap();
    let checks = brake.full_checks().unwrap();
    assert!(checks.samples == 8 && checks.failed > 0 && checks.failed < 8 && checks.modes > 0, "{checks:?}");
    let divergence = checks.divergence_where(|_| true);
    assert!(divergence.draws == 8 && divergence.open >= checks.failed, "{divergence:?}");
    let pulls = (0..20).filter(|&n| brake.draw(&mut montecarlo::stream(1, n)).unwrap().values[p] < 0.0).count();
    let study = squeal::study::Study::new(&brake, &cea::BatchSolver).unwrap();
    let results = squeal::results::Results::sampled(&study).unwrap();
    assert_eq!(results.summary.failures.by_scene(), [pulls as u64]);
    assert!(pulls > 0 && results.summary.failures.listed()[0].message.contains("there is no equilibrium"));
}

/// Pistons with the wrong sign, which lift pads off that springs hold: what was found quiet has no contact, and says so before all else.
#[test]
fn a_brake_in_which_nothing_rubs_says_it_first() {
    let folder = Folder::new();
    let held = ["OUTER", "INNER"].map(|set| {
        format!("[[springs]]\nname = \"{set} z\"\nnodes = \"{set}\"\ndirection = [0.0, 0.0, 1.0]\nstiffness = 6e4\n")
    });
    let text = in_equilibrium()
        .replace("[all_contacts]", &format!("{}[all_contacts]", held.concat()))
        .replace("frequencies = [1000.0, 8000.0]", "frequencies = [1000.0, 2000.0]\ntraining = 2\nfull_checks = 0");
    let doubts = |text: &str| {
        let brake = brakes::FiniteElementBrake::new(folder.parse(text.into()).unwrap(), &()).unwrap();
        brake.plan().doubts.clone()
    };
    assert!(doubts(&text).is_empty());
    let lifted = doubts(&text.replace("pressure = ", "pressure = -"));
    assert!(lifted.len() == 1 && lifted[0].contains("NOTHING RUBS at the medians in 1 of 1"), "{lifted:?}");
}
