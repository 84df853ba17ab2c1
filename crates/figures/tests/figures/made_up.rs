//! Made-up data with the shapes that real studies have, and with harder ones.

use figures::{
    BodyInMode, LawMode, LogLogFigure, LogLogPanel, LogLogSeries, ModeWorkFigure, NetWork, Occurrence,
    OccurrenceArrangement, OccurrenceBox, OccurrenceFigure, OccurrenceLaw, OccurrenceMark, OccurrenceMode,
    OccurrencePanel, OccurrenceSeries,
};
use num_complex::Complex64;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

/// Title, number in contact, arrangements, different systems.
const CONTACTS: [(&str, usize, usize, usize); 4] = [
    ("(a) nine in contact", 9, 1, 1),
    ("(b) eight in contact", 8, 9, 6),
    ("(c) seven in contact", 7, 36, 15),
    ("(d) six in contact", 6, 84, 27),
];

pub fn modes(labels: &[&str]) -> Vec<OccurrenceMode> {
    let mode = |(i, label): (usize, &&str)| OccurrenceMode {
        label: (*label).to_owned(),
        frequency_hz: 871.5 * (i as f64 + 1.0),
    };
    labels.iter().enumerate().map(mode).collect()
}

fn series(list: &[&str]) -> Vec<OccurrenceSeries> {
    list.iter().map(|s| OccurrenceSeries { name: (*s).to_owned(), description: format!("at {s}") }).collect()
}

pub fn arrangements(count: usize, systems: usize) -> Vec<OccurrenceArrangement> {
    (0..count).map(|i| OccurrenceArrangement { name: format!("arrangement {i}"), system: 1 + i % systems }).collect()
}

/// A percentage of 1,000 samples with limits around it.
pub fn value(percent: f64) -> Occurrence {
    Occurrence {
        samples: 1000,
        percent,
        open: 0.0,
        lower: (percent - 3.0).max(0.0),
        upper: (percent + 3.0).clamp(0.38, 100.0),
    }
}

/// Percentages around `center`, with a far value now and then.
fn percentages(rng: &mut Xoshiro256PlusPlus, center: f64, spread: f64, count: usize, far: f64) -> Vec<Occurrence> {
    let draw = |rng: &mut Xoshiro256PlusPlus| {
        let wide = if rng.random::<f64>() < far { 5.0 } else { 1.0 };
        let sum: f64 = (0..4).map(|_| rng.random::<f64>() - 0.5).sum();
        (center + wide * spread * sum).clamp(0.0, 100.0)
    };
    (0..count).map(|_| value((draw(rng) * 10.0).round() / 10.0)).collect()
}

/// `centers[mode][series]`, falling with the number in contact.
fn row(rng: &mut Xoshiro256PlusPlus, law: &str, centers: &[(usize, &[(usize, f64)])], far: f64) -> OccurrenceLaw {
    let panels = CONTACTS.iter().enumerate().map(|(p, &(title, in_contact, n, systems))| {
        let mut boxes = Vec::new();
        for &(mode, series) in centers {
            for &(series, center) in series {
                let center = center - 9.0 * p as f64;
                boxes.push(OccurrenceBox { mode, series, values: percentages(rng, center, 14.0, n, far) });
            }
        }
        OccurrencePanel { title: title.into(), in_contact, arrangements: arrangements(n, systems), boxes }
    });
    OccurrenceLaw { name: law.to_lowercase(), title: law.into(), panels: panels.collect() }
}

/// As Figure 5: one law, two speed ranges, a few modes.
pub fn one_law() -> OccurrenceFigure {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    let centers: [(usize, &[(usize, f64)]); 6] = [
        (0, &[(0, 35.0), (1, 12.0)]),
        (1, &[(0, 93.0), (1, 86.0)]),
        (2, &[(0, 22.0), (1, 18.0)]),
        (3, &[(0, 55.0), (1, 41.0)]),
        (4, &[(0, 12.0), (1, 0.0)]),
        (5, &[(0, -90.0), (1, -90.0)]),
    ];
    OccurrenceFigure {
        title: "Occurrence of instability per mode, velocity-dependent friction".into(),
        constraints: "none".into(),
        mode_note: "Names: A is the set of constraints \"none\".".into(),
        modes: modes(&["A12", "A15", "A16", "A17", "A22", "never"]),
        series: series(&["0.1–1 m/s", "1–10 m/s"]),
        marks: Vec::new(),
        laws: vec![row(&mut rng, "", &centers, 0.05)],
    }
}

/// As Figure 9: three laws, one of them without a speed; quiet at six in contact.
pub fn countermeasure() -> OccurrenceFigure {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(9);
    let mut rows = vec![
        row(&mut rng, "Amontons–Coulomb", &[(0, &[(2, 14.0)]), (1, &[(2, 8.0)])], 0.02),
        row(&mut rng, "velocity-dependent", &[(0, &[(0, 20.0), (1, 9.0)]), (1, &[(0, 12.0), (1, 7.0)])], 0.02),
        row(&mut rng, "LuGre", &[(0, &[(0, 34.8), (1, 11.0)]), (1, &[(0, 30.0), (1, 4.0)])], 0.02),
    ];
    for row in &mut rows {
        for b in &mut row.panels[3].boxes {
            b.values.fill(value(0.0));
        }
    }
    OccurrenceFigure {
        title: "Corners, 4 and 6 constrained in x".into(),
        constraints: "corners-4-6".into(),
        mode_note: String::new(),
        modes: modes(&["9", "11"]),
        series: series(&["0.1–1 m/s", "1–10 m/s", "any speed"]),
        marks: vec![OccurrenceMark { percent: 34.8, text: "paper: 34.8 %".into(), panels: vec![[2, 0], [2, 1]] }],
        laws: rows,
    }
}

/// One mode; twelve modes with double labels under three laws; very long titles; many outliers; thirty modes.
pub fn hard_occurrence() -> Vec<(&'static str, OccurrenceFigure)> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(12);
    let series = series(&["0.1–1 m/s", "1–10 m/s", "any speed"]);
    let many = |rng: &mut Xoshiro256PlusPlus, modes: usize, far: f64, label: &dyn Fn(usize) -> String| {
        let low_high: Vec<[(usize, f64); 2]> =
            (0..modes).map(|m| [(0, 96.0 - 83.0 * m as f64 / modes as f64), (1, 60.0 * rng.random::<f64>())]).collect();
        let all: Vec<[(usize, f64); 1]> = low_high.iter().map(|lh| [(2, 0.8 * lh[0].1)]).collect();
        let coulomb: Vec<(usize, &[(usize, f64)])> = all.iter().enumerate().map(|(m, s)| (m, &s[..])).collect();
        let others: Vec<(usize, &[(usize, f64)])> = low_high.iter().enumerate().map(|(m, s)| (m, &s[..])).collect();
        OccurrenceFigure {
            title: "Corners constrained in x".into(),
            modes: (0..modes)
                .map(|m| OccurrenceMode { label: label(m), frequency_hz: 17.3 * (m * m + 9) as f64 })
                .collect(),
            series: series.clone(),
            laws: vec![
                row(rng, "Amontons–Coulomb", &coulomb, far),
                row(rng, "velocity-dependent", &others, far),
                row(rng, "LuGre", &others, far),
            ],
            ..OccurrenceFigure::default()
        }
    };
    let mut one = one_law();
    one.modes.truncate(1);
    for panel in &mut one.laws[0].panels {
        panel.boxes.retain(|b| b.mode == 0);
    }
    let mut long = one_law();
    long.title =
        "A title that goes on and on, over the whole width of the page and then some more, because somebody put \
                  the name of the study, its date and all its readings into it, and <angle> & ampersand too"
            .into();
    for panel in &mut long.laws[0].panels {
        panel.title = format!("{} with all other parameters at their medians and the plate clamped", panel.title);
    }
    let mut single = one_law();
    single.laws[0].panels.truncate(1);
    let mut three = one_law();
    three.laws[0].panels.truncate(3);
    let mut odd = one_law();
    for panel in &mut odd.laws[0].panels {
        panel.boxes[1].values[0].open = 19.3_f64.min(100.0 - panel.boxes[1].values[0].percent);
        panel.boxes[4].values.fill(Occurrence { upper: 100.0, ..Occurrence::default() });
    }
    vec![
        ("one_mode", one),
        ("open_names_and_no_data", odd),
        ("three_panels", three),
        ("twelve_modes", many(&mut rng, 12, 0.05, &|m| (m + 8).to_string())),
        ("twelve_double_labels", many(&mut rng, 12, 0.4, &|m| format!("{}/{}", m + 8, 2 * m + 15))),
        ("thirty_modes", many(&mut rng, 30, 0.2, &|m| (m + 1).to_string())),
        ("forty_modes_of_a_law", one_of(many(&mut rng, 40, 0.2, &|m| format!("A{}", m + 1)))),
        ("long_titles", long),
        ("one_panel", single),
    ]
}

/// The last law alone.
fn one_of(mut data: OccurrenceFigure) -> OccurrenceFigure {
    data.laws.drain(..2);
    data
}

fn body(u: [f64; 3], out_of_phase: f64, work: f64, quartiles: Option<[f64; 2]>) -> BodyInMode {
    // Any phase and scale: the figure turns it back.
    let turned = Complex64::from_polar(0.037, 1.1);
    BodyInMode {
        displacement: u.map(|c| turned * Complex64::new(c, out_of_phase * c)),
        constrained: [false; 3],
        work: NetWork { median: work, quartiles },
    }
}

/// As Figure 7; the same with constraints, negative work and one law; a lattice that is not square.
pub fn shapes() -> Vec<(&'static str, ModeWorkFigure)> {
    let corners = |k: f64| -> Vec<BodyInMode> {
        let corner = [1.0, -1.0, 1.0, -1.0];
        let mut bodies: Vec<BodyInMode> = (0..9)
            .map(|i| match [0, 2, 6, 8].iter().position(|&c| c == i) {
                Some(c) => {
                    body([corner[c], 0.12 * k, -0.45 * corner[c]], 0.1 * k, 1.0 - 0.03 * c as f64, Some([0.8, 1.1]))
                }
                None => {
                    body([0.05 * k, 0.2, if i == 4 { 0.3 } else { -0.02 }], 0.05, 0.1 * k - 0.15, Some([-0.1, 0.15]))
                }
            })
            .collect();
        bodies.push(body([-0.03, 0.0, 0.06], 0.0, -0.2 * k, Some([-0.3 * k, -0.1])));
        bodies
    };
    let law = |law: &str, caption: &str, k| LawMode { law: law.into(), caption: caption.into(), bodies: corners(k) };
    let three = ModeWorkFigure {
        title: "The most robustly unstable mode, nine in contact, median parameters".into(),
        note: "The oscillators 1, 3, 7 and 9 have most net work under every law.".into(),
        rows: 3,
        columns: 3,
        laws: vec![
            law("Amontons–Coulomb", "1507.2 Hz, growth rate 46.2 1/s", 1.0),
            law("velocity-dependent", "1507.3 Hz, growth rate 81.0 1/s", 1.4),
            law("LuGre", "1508.9 Hz, growth rate 112.7 1/s", 1.8),
        ],
    };
    let mut held = ModeWorkFigure { laws: vec![law("LuGre", "", -2.0)], ..three.clone() };
    held.title = "After constraining the corners, oscillators 4 and 6, and more".into();
    for (i, body) in held.laws[0].bodies.iter_mut().enumerate() {
        body.constrained = [[0, 2, 6, 8, 3, 5].contains(&i), i == 1, i == 7];
        for (u, held) in body.displacement.iter_mut().zip(body.constrained) {
            if held {
                *u = Complex64::ZERO;
            }
        }
        body.work = NetWork { median: if i == 9 { -7.4 } else { 0.3 * i as f64 - 1.0 }, quartiles: None };
    }
    let wide = ModeWorkFigure {
        title: String::new(),
        note: String::new(),
        rows: 2,
        columns: 5,
        laws: ["Amontons–Coulomb", "velocity-dependent", "LuGre", "Stribeck, a control with a long name"]
            .iter()
            .map(|name| LawMode {
                law: (*name).into(),
                caption: "1.21 kHz".into(),
                bodies: (0..11)
                    .map(|i| body([0.1 * f64::from(i), 0.3, -0.4], 0.6, 1e-3 * f64::from(i), None))
                    .collect(),
            })
            .collect(),
    };
    let large = ModeWorkFigure {
        title: "5 x 4".into(),
        rows: 5,
        columns: 4,
        laws: ["Amontons–Coulomb", "velocity-dependent", "LuGre"]
            .iter()
            .map(|name| LawMode {
                law: (*name).into(),
                caption: "at 0.632 m/s, median of the low range; 1721.4 Hz, growth +85 1/s".into(),
                bodies: (0..21)
                    .map(|i| {
                        let side = if i % 3 == 0 { 1.0 } else { -0.6 };
                        body(
                            [side, 0.3, -0.4 * side],
                            0.4,
                            0.05 * f64::from(i) - 0.2,
                            Some([-0.3, 0.05 * f64::from(i)]),
                        )
                    })
                    .collect(),
            })
            .collect(),
        ..ModeWorkFigure::default()
    };
    let mut zero = three.clone();
    zero.title = "All zero".into();
    for body in zero.laws.iter_mut().flat_map(|law| &mut law.bodies) {
        *body = BodyInMode::default();
    }
    vec![("fig07", three), ("held", held), ("wide_lattice", wide), ("large_lattice", large), ("all_zero", zero)]
}

/// Two panels with the same routes; one panel with many series; exact zeros; a single point.
pub fn convergence() -> Vec<(&'static str, LogLogFigure)> {
    let routes = [
        "standard form, scaled",
        "standard form, unscaled",
        "QZ, scaled",
        "first-order perturbation",
        "second-order perturbation",
        "exact one-parameter integral",
        "LAPACK dgeev",
        "LAPACK dggev",
        "nalgebra Schur",
    ];
    let line = |i: usize, name: &str, floor: f64, joined: bool| LogLogSeries {
        name: name.to_owned(),
        points: (0..6)
            .map(|k| {
                let t = 1e-5 * 1.6f64.powi(i as i32) * 3f64.powi(k);
                [t, (10f64.powi(-(i as i32) - 3) / f64::from(k + 1).powi(3)).max(floor)]
            })
            .collect(),
        joined,
    };
    let panel = |title: &str, floor: f64, joined| LogLogPanel {
        title: title.to_owned(),
        series: routes.iter().enumerate().map(|(i, r)| line(i, r, floor, joined)).collect(),
    };
    let mut zeros = panel("(b) near coalescence", 1e-9, true);
    zeros.series[2].points[3][1] = 0.0;
    zeros.series[5].points[5][1] = 0.0;
    let two = LogLogFigure {
        title: "Time against error of each route".into(),
        x_label: "time per sample (s)".into(),
        y_label: "largest relative error of an eigenvalue".into(),
        panels: vec![panel("(a) away from coalescence", 1e-15, true), zeros],
    };
    let estimators = LogLogPanel {
        title: String::new(),
        series: (0..16).map(|i| line(i % 7, &format!("route {i}"), 1e-8, i % 2 == 0)).collect(),
    };
    let many = LogLogFigure {
        title: "Sixteen series".into(),
        x_label: "time (s)".into(),
        y_label: "error of the occurrence (percentage points) as measured against the exact integral over friction"
            .into(),
        panels: vec![estimators],
    };
    let point = LogLogSeries { name: "one".into(), points: vec![[1.0, 0.0]], joined: false };
    let lone = LogLogPanel { title: "one point at zero".into(), series: vec![point] };
    let lone = LogLogFigure {
        panels: vec![lone, LogLogPanel::default()],
        x_label: "x (1)".into(),
        y_label: "y (1)".into(),
        ..Default::default()
    };
    vec![("routes", two), ("sixteen_series", many), ("lone_point", lone)]
}
