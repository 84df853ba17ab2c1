//! The figures of cycles: what they show is what they were given.

use figures::{
    ContactDoes, ContactPoint, ContactsOfCycle, CycleBranch, CycleBranchesFigure, CycleContactsFigure, CyclePoint,
    CycleSpectrumFigure, FigureError, LocusBranch, SpectrumOfCycle, cycle_branches_figure, cycle_contacts_figure,
    cycle_spectrum_figure,
};

use crate::{Picture, check};

/// Points of a path or a line of an object, by its class and the begin of its title.
fn points(svg: &str, class: &str, title: &str) -> Vec<Vec<[f64; 2]>> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let is_meant = |node: &roxmltree::Node| {
        let of = node.children().find(|child| child.has_tag_name("title")).and_then(|title| title.text());
        node.attribute("class") == Some(class) && of.is_some_and(|text| text.starts_with(title))
    };
    let group = document.descendants().find(is_meant).unwrap();
    let number = |text: &str| text.trim_start_matches(['M', 'L']).parse::<f64>().unwrap();
    let paths = group.descendants().filter(|node| node.has_tag_name("path"));
    paths
        .map(|path| {
            let text = path.attribute("d").unwrap().replace(['M', 'L', 'Z', ','], " ");
            let numbers: Vec<f64> = text.split_whitespace().map(number).collect();
            numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
        })
        .collect()
}

fn says(picture: &Picture, text: &str) -> bool {
    picture.texts.iter().any(|other| other.contains(text))
}

/// Eight steps of two contacts: one is open for two of them, the other sticks for three.
fn two_contacts() -> CycleContactsFigure {
    let point = |normal_force, sliding_velocity, does| ContactPoint { normal_force, sliding_velocity, does };
    let (slides, sticks, open) = (ContactDoes::Slides, ContactDoes::Sticks, ContactDoes::Open);
    let first = (0..8).map(|i| match i {
        3 | 4 => point(0.0, 2.5, open),
        i => point(200.0 + 10.0 * f64::from(i), 2.0, slides),
    });
    let second = (0..8).map(|i| match i {
        5.. => point(90.0, 0.0, sticks),
        _ => point(90.0, 1.0, slides),
    });
    CycleContactsFigure {
        title: "Two contacts".into(),
        contacts: vec!["A".into(), "B".into()],
        cycles: vec![ContactsOfCycle { name: "From mode 2".into(), contacts: vec![first.collect(), second.collect()] }],
        note: "a note".into(),
    }
}

#[test]
fn contacts_over_a_period_are_lines_with_bars_where_they_open_or_stick() {
    let data = two_contacts();
    let figure = cycle_contacts_figure(&data).unwrap();
    let picture = check(&figure, "cycle_contacts");
    assert_eq!((picture.count("contact"), picture.count("state")), (4, 2));
    for text in ["normal force (N)", "sliding velocity (m/s)", "contact A", "open", "closed, sticks", "a note"] {
        assert!(says(&picture, text), "{text} is missing from {:?}", picture.texts);
    }
    let svg = figure.svg();
    assert!(svg.contains("contact A: open in 0.250 of the steps, sticks in 0.000"), "{svg}");
    assert!(svg.contains("contact B: open in 0.000 of the steps, sticks in 0.375"), "{svg}");
    // The line of the normal force ends as it begins, and its highest point is the largest force.
    let line = &points(&svg, "contact", "contact A: 0.0000 to 270.0000 N")[0];
    assert_eq!((line.len(), line[0][1]), (9, line[8][1]));
    let highest = line.iter().enumerate().min_by(|a, b| a.1[1].total_cmp(&b.1[1])).unwrap().0;
    assert_eq!(highest, 7);
    let part = |at: usize| (line[at][1] - line[3][1]) / (line[7][1] - line[3][1]);
    assert!((part(0) - 200.0 / 270.0).abs() < 1e-3, "{line:?}");
    let table = String::from_utf8(figure.csv().unwrap()).unwrap();
    assert_eq!(table.lines().count(), 1 + 16);
    assert!(table.contains("From mode 2,A,0.375,0,2.5,open\n"), "{table}");
    assert!(matches!(
        cycle_contacts_figure(&CycleContactsFigure::default()),
        Err(FigureError::Empty { what: "cycles" })
    ));
    // Of a name that is longer than its row the end stands there, and all of it in the key.
    let mut long = data.clone();
    long.contacts[1] = "the lining of the inner pad at its trailing end, point 12".into();
    let picture = check(&cycle_contacts_figure(&long).unwrap(), "cycle_contacts_long");
    assert!(
        picture.texts.iter().any(|text| text.starts_with("..") && text.ends_with("point 12")),
        "{:?}",
        picture.texts
    );
    assert!(says(&picture, "contact the lining of the inner pad at its trailing end, point 12"));
    let mut wrong = data;
    wrong.cycles[0].contacts[0][0].normal_force = f64::NAN;
    assert!(matches!(cycle_contacts_figure(&wrong), Err(FigureError::NotFinite { .. })));
}

#[test]
fn harmonics_stand_at_their_frequencies_and_levels() {
    let harmonics = vec![[100.0, 2.0], [200.0, 0.2], [300.0, 0.02], [400.0, 1e-9]];
    let cycle = SpectrumOfCycle { name: "From mode 7".into(), mode_hz: 120.0, harmonics };
    let data = CycleSpectrumFigure { cycles: vec![cycle], ..CycleSpectrumFigure::default() };
    let figure = cycle_spectrum_figure(&data).unwrap();
    let picture = check(&figure, "cycle_spectrum");
    assert_eq!((picture.count("harmonic"), picture.count("mode")), (3, 1));
    assert!(says(&picture, "From mode 7; 1 weaker harmonic is not drawn"), "{:?}", picture.texts);
    let svg = figure.svg();
    // Equal steps of frequency and of decades.
    let stem = |order: usize| points(&svg, "harmonic", &format!("harmonic {order}: "))[0].clone();
    let [a, b, c] = [1, 2, 3].map(|order| stem(order)[1]);
    for axis in [0, 1] {
        assert!((c[axis] - b[axis] - (b[axis] - a[axis])).abs() < 0.02, "{a:?} {b:?} {c:?}");
    }
    assert!(b[0] > a[0] && b[1] > a[1]);
    let mode = points(&svg, "mode", "mode at 120 Hz")[0][0][0];
    assert!(((mode - a[0]) / (b[0] - a[0]) - 0.2).abs() < 1e-3, "{mode}");
    assert_eq!(
        String::from_utf8(figure.csv().unwrap()).unwrap().lines().last().unwrap(),
        "From mode 7,4,400,0.000000001"
    );
    let silent = SpectrumOfCycle { harmonics: vec![[100.0, 0.0]], ..SpectrumOfCycle::default() };
    let silent = CycleSpectrumFigure { cycles: vec![silent], ..CycleSpectrumFigure::default() };
    assert!(matches!(cycle_spectrum_figure(&silent), Err(FigureError::Empty { .. })));
}

/// A branch that goes back unstable to a fold and comes up stable; its last cycle is known in balance alone.
fn folded() -> CycleBranchesFigure {
    let point = |at: f64, hz: f64, in_time, is_fold| CyclePoint { at, hz, in_time, is_fold };
    let points = vec![
        point(0.5, 990.0, Some((0.2, false)), false),
        point(0.4, 980.0, Some((0.4, false)), false),
        point(0.35, 975.0, Some((0.6, true)), true),
        point(0.5, 960.0, Some((0.9, true)), false),
        point(0.7, 950.0, Some((1.2, true)), false),
        point(0.8, 945.0, None, false),
    ];
    let mode = |name: &str, hz: f64, from: f64| LocusBranch {
        mode: name.into(),
        points: (0..=10)
            .map(|i| f64::from(i) / 10.0)
            .map(|part| [part, hz + 10.0 * part, from + 100.0 * part])
            .collect(),
    };
    CycleBranchesFigure {
        title: "A branch with a fold".into(),
        parameter: "mu".into(),
        range: [0.0, 1.0],
        branches: vec![CycleBranch { mode: "4".into(), onset: [0.6, 1006.0], points }],
        modes: vec![mode("4", 1000.0, -60.0), mode("9", 5000.0, -500.0)],
        ..CycleBranchesFigure::default()
    }
}

#[test]
fn branches_of_cycles_are_solid_where_they_are_stable_and_dashed_where_not() {
    let data = folded();
    let figure = cycle_branches_figure(&data).unwrap();
    let picture = check(&figure, "cycle_branches");
    // In both panels the branch, its onset and its fold; no loudness of what is known in balance alone.
    assert_eq!((picture.count("branch"), picture.count("mark"), picture.count("fold")), (2, 2, 2));
    assert_eq!((picture.count("point"), picture.count("cea")), (4 + 5, 1));
    for text in
        ["unstable cycles", "in harmonic balance alone", "fold", "1 mode has other frequencies", "where it grows"]
    {
        assert!(says(&picture, text), "{text} is missing from {:?}", picture.texts);
    }
    let svg = figure.svg();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let mut branches = document.descendants().filter(|node| node.attribute("class") == Some("branch"));
    let (loudness, frequency) = (branches.next().unwrap(), branches.next().unwrap());
    let dashes = |node: roxmltree::Node| -> Vec<bool> {
        let paths = node.descendants().filter(|node| node.has_tag_name("path"));
        paths.map(|path| path.attribute("stroke-dasharray").is_some()).collect()
    };
    // From the onset to the fold, from the fold up, and in the balance.
    assert_eq!((dashes(loudness), dashes(frequency)), (vec![true, false], vec![true, false, true]));
    let lines = points(&svg, "branch", "cycles of mode 4");
    assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [4, 3]);
    // The onset has no loudness, and the parameter turns where the table says.
    let part = |at: usize| (lines[0][at][1] - lines[0][0][1]) / (lines[1][2][1] - lines[0][0][1]);
    assert!((part(1) - 0.2 / 1.2).abs() < 1e-3 && (part(2) - 0.4 / 1.2).abs() < 1e-3, "{lines:?}");
    assert!((lines[0][3][0] - lines[0][1][0]) / (lines[0][0][0] - lines[0][1][0]) < -1.49, "{lines:?}");
    // The mark is at the cycle farthest out, though the next one may be the first after the turn.
    assert!(svg.contains("<title>cycle of mode 4 at mu = 0.35: 975 Hz, stable, 0.6 m/s, fold</title>"), "{svg}");
    let mut later = data.clone();
    later.branches[0].points[2].is_fold = false;
    later.branches[0].points[3].is_fold = true;
    assert_eq!(cycle_branches_figure(&later).unwrap().svg(), svg);
    let table = String::from_utf8(figure.csv().unwrap()).unwrap();
    assert!(table.contains("\nonset,4,0.6,1006,\n") && table.contains("\nstable fold,4,0.35,975,0.6\n"), "{table}");
    assert_eq!(table.lines().count(), 1 + 1 + 6 + 2 * 11);
    let wrong = CycleBranchesFigure { range: [-1.0, 1.0], is_logarithmic: true, ..data };
    assert!(matches!(cycle_branches_figure(&wrong), Err(FigureError::OutOfRange { .. })));
}
