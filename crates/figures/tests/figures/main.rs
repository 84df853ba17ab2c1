//! The figures, drawn from made-up data; the pictures stay in the target folder to be looked at.

#![allow(clippy::unwrap_used)] // also in the helpers

mod cycles;
mod made_up;

use std::fs;
use std::path::{Path, PathBuf};

use figures::{
    Figure, FigureError, LocusBranch, LocusEvent, LocusMark, LogLogFigure, ModeWorkFigure, ModelDiagram, Occurrence,
    OccurrenceBox, OccurrenceFigure, OccurrenceLaw, OccurrencePanel, OccurrenceSeries, RootLocusFigure, loglog,
    mode_and_work, model_diagram, occurrence_boxes, root_locus_figure,
};
use made_up::{arrangements, convergence, countermeasure, hard_occurrence, modes, one_law, shapes, value};
use proptest::prelude::*;

fn pictures() -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("figures");
    fs::create_dir_all(&dir).unwrap();
    dir
}

/// What a document shows.
struct Picture {
    classes: Vec<String>,
    texts: Vec<String>,
}

impl Picture {
    /// Number of objects of a class.
    fn count(&self, class: &str) -> usize {
        self.classes.iter().filter(|c| *c == class).count()
    }

    fn says(&self, text: &str) -> bool {
        self.texts.iter().any(|t| t == text)
    }
}

fn read(svg: &str) -> Picture {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document.descendants().filter(|n| n.has_tag_name("text"));
    Picture {
        classes: document.descendants().filter_map(|n| n.attribute("class").map(str::to_owned)).collect(),
        texts: texts.filter_map(|n| n.text().map(str::to_owned)).collect(),
    }
}

/// Writes the picture and checks what holds for every figure.
fn check(figure: &Figure, stem: &str) -> Picture {
    let dir = pictures();
    figure.save(&dir, stem).unwrap();
    let svg = fs::read_to_string(dir.join(format!("{stem}.svg"))).unwrap();
    assert_eq!(svg, figure.svg());
    let png = fs::read(dir.join(format!("{stem}.png"))).unwrap();
    assert_eq!(png, figure.png().unwrap());
    let header = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
    assert_eq!(header.info().width, 2126, "180 mm at 300 dots per inch");
    texts_stay_on_the_page(&svg);
    read(&svg)
}

/// No text leaves the page and none covers another, by the lengths that the document itself states.
fn texts_stay_on_the_page(svg: &str) {
    let document = roxmltree::Document::parse(svg).unwrap();
    let view: Vec<f64> =
        document.root_element().attribute("viewBox").unwrap().split(' ').map(|v| v.parse().unwrap()).collect();
    let boxes: Vec<(String, [f64; 4])> =
        document.descendants().filter(|n| n.has_tag_name("text")).map(extent).collect();
    for (text, [left, top, right, bottom]) in &boxes {
        assert!(*left >= 0.0 && *top >= 0.0 && *right <= view[2] && *bottom <= view[3], "{text} is cut");
    }
    for (i, (a, ea)) in boxes.iter().enumerate() {
        for (b, eb) in &boxes[i + 1..] {
            let apart = ea[2] <= eb[0] || eb[2] <= ea[0] || ea[3] <= eb[1] || eb[3] <= ea[1];
            assert!(apart, "{a} covers {b}");
        }
    }
}

/// Left, top, right, bottom of a text: capitals reach 0.72 of the size above the baseline, few letters 0.2 below.
fn extent(node: roxmltree::Node) -> (String, [f64; 4]) {
    let number = |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
    let (x, y, size, length) = (number("x"), number("y"), number("font-size"), number("textLength"));
    assert!(size >= 8.0, "text of {size} pt is too small for print");
    let before = match node.attribute("text-anchor").unwrap() {
        "start" => 0.0,
        "middle" => length / 2.0,
        _ => length,
    };
    let (from, to, above, below) = (-before, length - before, 0.72 * size, 0.2 * size);
    let extent = if node.attribute("transform").is_some() {
        [x - above, y - to, x + below, y - from]
    } else {
        [x + from, y - above, x + to, y + below]
    };
    (node.text().unwrap().to_owned(), extent)
}

/// Boxes of the modes that have a row.
fn shown(data: &OccurrenceFigure) -> usize {
    let all = || data.laws.iter().flat_map(|law| &law.panels).flat_map(|panel| &panel.boxes);
    let is_unstable = |v: &Occurrence| v.samples > 0 && (v.percent > 0.0 || v.open > 0.0);
    let unstable = |mode: usize| all().any(|b| b.mode == mode && b.values.iter().any(is_unstable));
    all().filter(|b| unstable(b.mode) && b.values.iter().any(|v| v.samples > 0)).count()
}

/// A figure of one panel.
fn one_panel(values: Vec<Vec<Occurrence>>) -> OccurrenceFigure {
    let (count, labels) = (values[0].len(), ["1", "2", "3"]);
    let boxes =
        values.into_iter().enumerate().map(|(mode, values)| OccurrenceBox { mode, series: 0, values }).collect();
    let panel =
        OccurrencePanel { title: "eight".into(), in_contact: 8, arrangements: arrangements(count, count), boxes };
    OccurrenceFigure {
        title: "One panel".into(),
        modes: modes(&labels),
        series: vec![OccurrenceSeries { name: "low".into(), description: "low speed".into() }],
        laws: vec![OccurrenceLaw { panels: vec![panel], ..OccurrenceLaw::default() }],
        ..OccurrenceFigure::default()
    }
}

#[test]
fn a_law_has_its_four_panels_and_every_mode_its_name_and_frequency() {
    let data = one_law();
    let picture = check(&occurrence_boxes(&data).unwrap(), "fig05");
    assert_eq!(picture.count("box"), 4 * 5 * 2, "panels, modes that are ever unstable, speed ranges");
    assert!(!picture.says("never"));
    for text in [
        "(a) nine in contact: n\u{a0}=\u{a0}1",
        "(d) six in contact:",
        "27\u{a0}different",
        "A15",
        "1743",
        "at 0.1–1 m/s",
        "100",
        "Modes without a row: 1, stable in every sample (95 %: unstable in at most 3.0 %).",
    ] {
        assert!(picture.texts.iter().any(|t| t.contains(text)), "{text} is missing from {:?}", picture.texts);
    }
}

#[test]
fn quartiles_are_those_of_r_and_numpy() {
    let data = one_panel(vec![[7.0, 1.0, 3.0, 2.0, 5.0, 4.0, 6.0, 100.0].map(value).to_vec()]);
    // numpy.quantile([1, 2, 3, 4, 5, 6, 7, 100], [0.25, 0.5, 0.75]) = [2.75, 4.5, 6.25]; 2.416 and 6.583 are type 8.
    let svg = occurrence_boxes(&data).unwrap().svg();
    assert!(svg.contains("median 4.5 %, quartiles 2.8 % and 6.2 %, n = 8"));
}

#[test]
fn an_open_name_is_drawn_and_a_zero_is_no_gap() {
    // Mode 1 is open in 193 of 1,000 samples, mode 2 never unstable there, mode 3 not solved at all.
    let open = Occurrence { open: 19.3, upper: 21.9, ..value(0.0) };
    let unsolved = Occurrence { upper: 100.0, ..Occurrence::default() };
    let mut data = one_panel(vec![vec![open], vec![value(0.0)], vec![unsolved]]);
    let mut second = data.laws[0].panels[0].clone();
    second.boxes.remove(2);
    second.boxes[1].values = vec![value(40.0)];
    second.boxes[0].values = vec![value(0.0)];
    second.boxes.push(OccurrenceBox { mode: 2, series: 0, values: vec![value(7.0)] });
    data.laws[0].panels.push(second);
    let figure = occurrence_boxes(&data).unwrap();
    let picture = check(&figure, "open_name");
    assert_eq!((picture.count("box"), picture.count("no-data")), (5, 1));
    assert!(picture.texts.iter().any(|t| t.contains("may be another one")));
    assert!(figure.svg().contains("0.0 %; 95 % limits 0.0 % to 21.9 %; name open in up to 19.3 %"));
}

#[test]
fn three_laws_stand_in_rows_and_quiet_panels_say_how_sure_they_are() {
    let data = countermeasure();
    let figure = occurrence_boxes(&data).unwrap();
    let picture = check(&figure, "fig09");
    assert_eq!(picture.count("box"), shown(&data));
    assert_eq!(picture.texts.iter().filter(|t| *t == "0 of 1000: at most 3.0 %").count(), 3);
    for law in ["Amontons–Coulomb", "velocity-dependent", "LuGre"] {
        assert!(picture.says(law));
    }
    assert_eq!(picture.count("mark"), 2);
    assert!(picture.says("paper: 34.8 %"));
    for series in &data.series {
        assert!(picture.says(&series.description));
    }
}

#[test]
fn small_values_have_a_scale_of_their_own() {
    let ends = |most: f64| {
        let picture = read(&occurrence_boxes(&one_panel(vec![vec![value(most); 3]])).unwrap().svg());
        (picture.says("100"), picture.says("15"))
    };
    assert_eq!((ends(12.0), ends(60.0)), ((false, true), (true, false)));
}

#[test]
fn hard_cases_stay_readable() {
    for (stem, data) in hard_occurrence() {
        let picture = check(&occurrence_boxes(&data).unwrap(), stem);
        assert_eq!(picture.count("box"), shown(&data), "{stem}");
    }
}

#[test]
fn nothing_unstable_anywhere_is_still_a_figure() {
    let picture = check(&occurrence_boxes(&one_panel(vec![vec![value(0.0); 2]])).unwrap(), "quiet");
    assert_eq!(picture.count("box"), 0);
    assert!(picture.says("0 of 1000: at most 3.0 %"));
    let panel = OccurrencePanel { title: "(a) nine in contact".into(), ..OccurrencePanel::default() };
    let laws = vec![OccurrenceLaw { panels: vec![panel], ..OccurrenceLaw::default() }];
    let picture = check(&occurrence_boxes(&OccurrenceFigure { laws, ..Default::default() }).unwrap(), "no_data");
    assert!(picture.says("no data"));
}

#[test]
fn every_body_has_its_shape_and_its_bar() {
    for (stem, data) in shapes() {
        let picture = check(&mode_and_work(&data).unwrap(), stem);
        let bodies = data.laws.len() * (data.rows * data.columns + 1);
        assert_eq!((picture.count("body"), picture.count("bar")), (2 * bodies, bodies), "{stem}, at two instants");
        for law in &data.laws {
            assert!(picture.texts.iter().any(|t| t.contains(law.law.split(' ').next().unwrap())), "{}", law.law);
        }
    }
}

#[test]
fn every_series_has_a_name_and_a_zero_has_its_place() {
    for (stem, data) in convergence() {
        let picture = check(&loglog(&data).unwrap(), stem);
        assert_eq!(picture.count("series"), data.panels.iter().map(|p| p.series.len()).sum::<usize>());
        for series in data.panels.iter().flat_map(|p| &p.series) {
            assert!(picture.says(&series.name), "{} is not named", series.name);
        }
        let zero = data.panels.iter().flat_map(|p| &p.series).flat_map(|s| &s.points).any(|p| p[1] == 0.0);
        assert_eq!(picture.says("0"), zero);
    }
}

#[test]
fn the_model_diagram_numbers_every_spring() {
    let data = ModelDiagram {
        title: "The model".into(),
        rows: 3,
        columns: 3,
        in_contact: (0..9).map(|i| i != 1 && i != 5).collect(),
        theta_degrees: 60.0,
        phi_degrees: 60.0,
        leans_with_sliding: false,
    };
    let figure = model_diagram(&data).unwrap();
    let picture = check(&figure, "fig02");
    assert_eq!(picture.count("body"), 9);
    assert!(picture.says("12"));
    let csv = String::from_utf8(figure.csv().unwrap()).unwrap();
    // The wall springs of the paper's table: 1, 4, 5, 8, 9, 12 in both directions.
    for axis in ["x", "y"] {
        for number in 1..=12 {
            let line = csv.lines().find(|l| l.starts_with(&format!("{axis},{number},"))).unwrap();
            assert_eq!(line.contains("wall"), [1, 4, 5, 8, 9, 12].contains(&number), "{line}");
        }
    }
    assert_eq!(csv.lines().filter(|l| l.ends_with("plate")).count(), 7);
    let other = ModelDiagram { rows: 2, columns: 4, in_contact: vec![true; 8], leans_with_sliding: true, ..data };
    check(&model_diagram(&other).unwrap(), "model_diagram_2x4");
    let short = ModelDiagram { in_contact: vec![true; 3], ..other };
    assert!(matches!(model_diagram(&short), Err(FigureError::Length { found: 3, expected: 8, .. })));
}

/// Onsets of many modes within a small part of the range, some of which lose their frequency while they grow: names do not cover each other or leave
/// their panel, and how many have no room is said.
#[test]
fn names_of_crowded_onsets_do_not_cover_each_other() {
    let mut not_named = 0;
    for (at, (count, part)) in
        [(3, 1.0), (12, 0.3), (25, 0.1), (60, 0.05), (60, 0.001), (200, 0.02)].into_iter().enumerate()
    {
        let place = |i: usize| 0.4 + part * ((i * 37 + at) % count) as f64 / count as f64 * 0.5;
        let mark = |i: usize| {
            let event = [LocusEvent::Starts, LocusEvent::Stops, LocusEvent::ToDivergence][i % 3];
            let growth = if i % 3 == 2 { 40.0 * (i % 7) as f64 } else { 0.0 };
            LocusMark { event, mode: format!("A{}", 100 + i), at: [place(i), 1000.0 + 500.0 * place(i), growth] }
        };
        let points = (0..20).map(|i| [i as f64 / 19.0, 900.0 + 40.0 * i as f64, -100.0 + 20.0 * i as f64]).collect();
        let data = RootLocusFigure {
            parameter: "mu".into(),
            range: [0.0, 1.0],
            branches: vec![LocusBranch { mode: "1".into(), points }],
            marks: (0..count).map(mark).collect(),
            onsets: ["starts to grow", "stops growing"],
            ..RootLocusFigure::default()
        };
        let picture = check(&root_locus_figure(&data).unwrap(), &format!("crowded-locus-{at}"));
        // Each name is in two panels, or counted as left out.
        let named = picture.texts.iter().filter(|text| text.starts_with("A1") || text.starts_with("A2")).count();
        let left_out =
            |text: &String| text.strip_suffix(" more in the table").map(|count| count.parse::<usize>().unwrap());
        let left_out: usize = picture.texts.iter().filter_map(left_out).sum();
        assert_eq!(named + left_out, 2 * count, "{at}");
        not_named += left_out;
    }
    assert!(not_named > 0);
}

/// A branch far below zero does not squeeze what happens about zero, and is said to go on; a range that is given is shown.
#[test]
fn a_root_locus_shows_what_is_about_zero() {
    let branch = |(at, [from, to]): (usize, [f64; 2])| LocusBranch {
        mode: at.to_string(),
        points: (0..=20)
            .map(|i| f64::from(i) / 20.0)
            .map(|part| [part, 1000.0 + 50.0 * at as f64, from + part * (to - from)])
            .collect(),
    };
    let all = [[-50.0, 120.0], [-60.0, -80.0], [-40.0, -30_000.0], [-25_000.0, -30_000.0]];
    let mut data = RootLocusFigure {
        parameter: "mu".into(),
        range: [0.0, 1.0],
        branches: all.into_iter().enumerate().map(branch).collect(),
        marks: vec![LocusMark { event: LocusEvent::Coalescence, mode: "2 and 3".into(), at: [0.9, 1120.0, -26_000.0] }],
        onsets: ["starts to grow", "stops growing"],
        ..RootLocusFigure::default()
    };
    let says = |picture: &Picture, text: &str| picture.texts.iter().any(|other| other == text);
    for (growth, below, low, high) in [
        (None, "2 branches go on below the picture", "\u{2212}300", "200"),
        (Some([-100.0, 200.0]), "2 branches go on below the picture", "\u{2212}100", "200"),
        (Some([-30_000.0, 200.0]), "", "\u{2212}30000", "10000"),
    ] {
        data.growth = growth;
        let picture = check(&root_locus_figure(&data).unwrap(), "about-zero");
        assert_eq!(says(&picture, below), !below.is_empty(), "{growth:?}: {:?}", picture.texts);
        assert!(says(&picture, low) && says(&picture, high), "{growth:?}: {:?}", picture.texts);
    }
}

/// Letters that the font lacks are boxes in the picture, not nothing.
#[test]
fn letters_beyond_the_font_are_seen() {
    let dark = |title: &str| {
        let data = RootLocusFigure {
            title: title.into(),
            parameter: "mu".into(),
            range: [0.0, 1.0],
            branches: vec![LocusBranch { mode: "1".into(), points: vec![[0.0, 1.0, -1.0], [1.0, 2.0, 1.0]] }],
            onsets: ["starts", "stops"],
            ..RootLocusFigure::default()
        };
        let png = root_locus_figure(&data).unwrap().png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        // The title is above everything.
        pixels[..pixels.len() / 20].iter().filter(|value| **value < 128).count()
    };
    let nothing = dark(".");
    for title in ["\u{44b}\u{44b}\u{44b}", "\u{4e2d}\u{6587}\u{5236}\u{52a8}", "\u{5d0}\u{5d1}", "\u{1f527}"] {
        let found = dark(title);
        assert!(found > nothing + 30 * title.chars().count(), "{title}: {found} dark pixels, {nothing} without it");
    }
}

#[test]
fn the_same_data_give_the_same_bytes() {
    let (a, b) = (occurrence_boxes(&countermeasure()).unwrap(), occurrence_boxes(&countermeasure()).unwrap());
    assert_eq!(a.svg(), b.svg());
    assert_eq!(a.png().unwrap(), b.png().unwrap());
    assert_eq!(a.csv().unwrap(), b.csv().unwrap());
}

#[test]
fn the_table_holds_every_value_exactly_and_no_cell_is_empty() {
    let data = one_law();
    let csv = occurrence_boxes(&data).unwrap().csv().unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_slice());
    let column = reader.headers().unwrap().iter().position(|name| name == "occurrence_percent").unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let boxes = data.laws.iter().flat_map(|r| &r.panels).flat_map(|p| &p.boxes);
    let values: Vec<f64> = boxes.flat_map(|b| &b.values).map(|value| value.percent).collect();
    assert_eq!(rows.iter().map(|r| r[column].parse::<f64>().unwrap()).collect::<Vec<_>>(), values);
    let (_, shape) = shapes().remove(0);
    let csv = String::from_utf8(mode_and_work(&shape).unwrap().csv().unwrap()).unwrap();
    assert!(!csv.contains(",,") && csv.lines().all(|line| !line.starts_with(',') && !line.ends_with(',')));
}

#[test]
fn a_bad_folder_is_an_error_that_names_the_file() {
    let dir = tempfile::tempdir().unwrap();
    let missing = dir.path().join("not there");
    let figure = occurrence_boxes(&one_law()).unwrap();
    let error = figure.save(&missing, "fig05").unwrap_err();
    assert!(matches!(&error, FigureError::Write { path, .. } if *path == missing.join("fig05.svg")), "{error:?}");
    assert!(error.to_string().contains("not there"), "{error}");
    // A folder in the way of the second file: the first stands, whole, and nothing half-written stays.
    fs::create_dir(dir.path().join("fig05.png")).unwrap();
    assert!(
        matches!(figure.save(dir.path(), "fig05"), Err(FigureError::Write { path, .. }) if path.ends_with("fig05.png"))
    );
    let names: Vec<_> = fs::read_dir(dir.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
}

#[test]
fn bad_numbers_are_errors_that_name_them() {
    let mut data = one_law();
    data.laws[0].panels[1].boxes[0].values[3].percent = f64::NAN;
    let error = occurrence_boxes(&data).err().unwrap();
    assert!(matches!(error, FigureError::NotFinite { .. }));
    assert!(error.to_string().contains("(b) eight in contact"), "{error}");

    let mut data = one_law();
    data.laws[0].panels[1].boxes[0].values[3].percent = 100.5;
    assert!(matches!(occurrence_boxes(&data), Err(FigureError::OutOfRange { value: 100.5, .. })));
    data.laws[0].panels[1].boxes[0].values.pop();
    assert!(matches!(occurrence_boxes(&data), Err(FigureError::Length { found: 8, expected: 9, .. })));
    data.laws[0].panels[0].boxes[0].mode = 99;
    assert!(matches!(occurrence_boxes(&data), Err(FigureError::Index { index: 99, .. })));
    assert!(matches!(occurrence_boxes(&OccurrenceFigure::default()), Err(FigureError::Empty { .. })));

    let (_, mut data) = shapes().remove(0);
    data.laws[1].bodies[4].displacement[2].im = f64::INFINITY;
    assert!(mode_and_work(&data).err().unwrap().to_string().contains("z_im of 5"));
    data.laws[1].bodies.pop();
    assert!(matches!(mode_and_work(&data), Err(FigureError::NotFinite { .. } | FigureError::Length { .. })));
    assert!(matches!(mode_and_work(&ModeWorkFigure::default()), Err(FigureError::Empty { .. })));

    let (_, mut data) = convergence().remove(0);
    data.panels[0].series[0].points[0] = [0.0, 1.0];
    assert!(matches!(loglog(&data), Err(FigureError::OutOfRange { allowed: "x > 0", .. })));
    data.panels[0].series[0].points[0] = [1.0, f64::NAN];
    assert!(matches!(loglog(&data), Err(FigureError::NotFinite { .. })));
    assert!(matches!(loglog(&LogLogFigure::default()), Err(FigureError::Empty { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever the percentages: a well-formed picture, one object per value set, no text cut or covered.
    #[test]
    fn any_percentages_can_be_drawn(values in prop::collection::vec(prop::collection::vec(0.0..=100.0f64, 4), 1..14)) {
        let labels: Vec<String> = (0..values.len()).map(|m| (m + 20).to_string()).collect();
        let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
        let values = values.iter().map(|values| values.iter().copied().map(value).collect()).collect();
        let data = OccurrenceFigure { modes: modes(&labels), ..one_panel(values) };
        let svg = occurrence_boxes(&data).unwrap().svg();
        texts_stay_on_the_page(&svg);
        prop_assert_eq!(read(&svg).count("box"), shown(&data));
    }
}
