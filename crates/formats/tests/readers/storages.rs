//! Random matrices in every text format and storage: read back as they are, or refused with the word that helps.

use formats::nalgebra::DMatrix;
use formats::{FormatsError, Options, Symmetry, Wanted, read_bytes};

/// A generator of reproducible numbers: xorshift64 (Marsaglia, J. Stat. Softw. 8(14), 2003).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, most: usize) -> usize {
        (self.next() % most as u64) as usize
    }

    /// A number with few digits, so that every format holds it exactly; never 0.
    fn number(&mut self) -> f64 {
        (self.below(2000) as f64 - 999.5) / 8.0
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Diagonal,
    Symmetric,
    /// Entries on both sides that differ.
    Unsymmetric,
    /// Entries on both sides, none with a mirror image.
    Friction,
    Upper,
    Lower,
}

const SHAPES: [Shape; 6] =
    [Shape::Diagonal, Shape::Symmetric, Shape::Unsymmetric, Shape::Friction, Shape::Upper, Shape::Lower];

/// A matrix with a whole diagonal, and with entries beside it on the sides that its shape has.
fn matrix(random: &mut Random, order: usize, shape: Shape) -> DMatrix<f64> {
    let mut all = DMatrix::from_diagonal_element(order, order, 1.0).map(|one| one * (5.0 + random.below(9) as f64));
    for i in 0..order {
        for j in 0..i {
            // The first two pairs are always there, so that every shape is what it is called.
            let is_first = (i, j) == (1, 0);
            if !is_first && (i, j) != (2, 0) && random.below(3) > 0 {
                continue;
            }
            let (a, b) = (random.number(), random.number() + 0.0625);
            let (below, above) = match shape {
                Shape::Diagonal => (0.0, 0.0),
                Shape::Symmetric => (a, a),
                Shape::Unsymmetric => (a, b),
                Shape::Friction => {
                    if is_first || ((i, j) != (2, 0) && random.below(2) == 0) {
                        (a, 0.0)
                    } else {
                        (0.0, a)
                    }
                }
                Shape::Upper => (0.0, a),
                Shape::Lower => (a, 0.0),
            };
            (all[(i, j)], all[(j, i)]) = (below, above);
        }
    }
    all
}

/// What a file lists of a matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Listed {
    Whole,
    Upper,
    Lower,
}

fn entries(matrix: &DMatrix<f64>, listed: Listed, random: &mut Random) -> Vec<(usize, usize, f64)> {
    let order = matrix.nrows();
    let mut all = Vec::new();
    for i in 0..order {
        for j in 0..order {
            let is_listed = i == j || listed == Listed::Whole || (listed == Listed::Upper) == (i < j);
            if is_listed && matrix[(i, j)] != 0.0 {
                all.push((i, j, matrix[(i, j)]));
            }
        }
    }
    // Lists come in any order.
    for at in (1..all.len()).rev() {
        all.swap(at, random.below(at + 1));
    }
    all
}

fn market(matrix: &DMatrix<f64>, listed: &[(usize, usize, f64)], field: &str, symmetry: &str) -> String {
    let order = matrix.nrows();
    let mut text = format!("%%MatrixMarket matrix coordinate {field} {symmetry}\n{order} {order} {}\n", listed.len());
    for (i, j, value) in listed {
        let zero = if field == "complex" { " 0.0" } else { "" };
        text += &format!("{} {} {value:e}{zero}\n", i + 1, j + 1);
    }
    text
}

fn coordinates(listed: &[(usize, usize, f64)]) -> String {
    listed.iter().map(|(i, j, value)| format!("{} {} {value:e}\n", i + 1, j + 1)).collect()
}

/// Three directions a node, in order, so that places are those of the matrix.
fn abaqus(listed: &[(usize, usize, f64)], keyword: &str) -> String {
    let dof = |at: usize| format!("{},{}", 10 + at / 3, at % 3 + 1);
    let lines = listed.iter().map(|(i, j, value)| format!("{}, {}, {value:e}\n", dof(*i), dof(*j)));
    format!("{keyword}{}", lines.collect::<String>())
}

fn dmig(listed: &[(usize, usize, f64)], form: usize) -> String {
    let mut text = format!("DMIG,K,0,{form},2,0\n");
    for (i, j, value) in listed {
        let dof = |at: usize| format!("{},{}", 10 + at / 3, at % 3 + 1);
        text += &format!("DMIG,K,{},,{},{value:?}\n", dof(*j), dof(*i));
    }
    text
}

fn harwell_boeing(matrix: &DMatrix<f64>, listed: &[(usize, usize, f64)], kind: &str) -> String {
    let order = matrix.nrows();
    let mut sorted = listed.to_vec();
    sorted.sort_by_key(|(i, j, _)| (*j, *i));
    let mut offsets = vec![1];
    offsets.extend((0..order).map(|column| 1 + sorted.iter().filter(|(_, j, _)| *j <= column).count()));
    let lines = |numbers: Vec<String>, per_line: usize| {
        numbers.chunks(per_line).map(|line| line.concat() + "\n").collect::<String>()
    };
    let whole = |all: Vec<usize>| lines(all.iter().map(|n| format!("{n:8}")).collect(), 10);
    let (first, second) = (whole(offsets), whole(sorted.iter().map(|(i, _, _)| i + 1).collect()));
    let third = lines(sorted.iter().map(|(_, _, value)| format!("{:>20}", format!("{value:.10E}"))).collect(), 4);
    let count = |part: &str| part.lines().count();
    let all = count(&first) + count(&second) + count(&third);
    format!(
        "{:<72}KEY\n{all:14}{:14}{:14}{:14}{:14}\n{kind:<14}{order:14}{order:14}{:14}{:14}\n{:<16}{:<16}{:<20}\n{first}{second}{third}",
        "A title (1 2 3)",
        count(&first),
        count(&second),
        count(&third),
        0,
        listed.len(),
        0,
        "(10I8)",
        "(10I8)",
        "(1P,4E20.10)"
    )
}

/// One array of NumPy, as `np.save` writes it.
fn npy(matrix: &DMatrix<f64>, is_complex: bool) -> Vec<u8> {
    let order = matrix.nrows();
    let kind = if is_complex { "<c16" } else { "<f8" };
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({order}, {order}), }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for i in 0..order {
        for j in 0..order {
            bytes.extend(matrix[(i, j)].to_le_bytes());
            if is_complex {
                bytes.extend(0.0_f64.to_le_bytes());
            }
        }
    }
    bytes
}

/// Reads the file as a user does who first says nothing, and then what the refusal asks for.
fn check(bytes: &[u8], expected: &DMatrix<f64>, must_ask: Option<Symmetry>, what: &str) {
    let file = || read_bytes(bytes, None, Options::default()).unwrap_or_else(|e| panic!("{what}: {e}"));
    match (file().only(), must_ask) {
        (Ok(matrix), None) => {
            assert_eq!(&matrix.to_dense(), expected, "{what}: {}", matrix.taken());
            // A word for all files does not change what a file says, or what cannot be otherwise.
            let whole = Wanted { otherwise: Some(Symmetry::Whole), ..Wanted::default() };
            assert_eq!(&file().take(&whole).unwrap().to_dense(), expected, "{what}");
        }
        (Err(FormatsError::OneSided { .. }), Some(answer)) => {
            let said = Wanted { symmetry: Some(answer), ..Wanted::default() };
            assert_eq!(&file().take(&said).unwrap().to_dense(), expected, "{what}");
        }
        (read, _) => panic!("{what}: {read:?}, asked: {must_ask:?}"),
    }
}

#[test]
fn every_storage_of_every_shape_is_read_back_or_asked_about() {
    let mut random = Random(0x5eed_0fd1_5c5e_ed01);
    for round in 0..60 {
        for shape in SHAPES {
            let order = 3 + random.below(8);
            let matrix = matrix(&mut random, order, shape);
            let what = |format: &str| format!("round {round}, {shape:?}, {format}");
            let whole = entries(&matrix, Listed::Whole, &mut random);
            // Whole in a file that does not say so: one side is asked about, and of a list entries without any mirror image.
            let one_side = matches!(shape, Shape::Upper | Shape::Lower).then_some(Symmetry::Whole);
            let all = &matrix;
            let mut beside = whole.iter().filter(|(i, j, value)| i != j && *value != 0.0).peekable();
            let has_none = beside.peek().is_some() && beside.all(|&(i, j, _)| all[(j, i)] == 0.0);
            let unpaired = has_none.then_some(Symmetry::Whole);
            check(coordinates(&whole).as_bytes(), all, unpaired, &what("a list"));
            check(abaqus(&whole, "").as_bytes(), all, unpaired, &what("MATRIX INPUT"));
            check(&npy(all, false), all, one_side, &what("npy"));
            check(&npy(all, true), all, one_side, &what("complex npy"));
            // In one that does, not.
            check(market(all, &whole, "real", "general").as_bytes(), all, None, &what("Matrix Market"));
            check(market(all, &whole, "complex", "general").as_bytes(), all, None, &what("complex Matrix Market"));
            check(
                abaqus(&whole, "*MATRIX INPUT, NAME=K, TYPE=UNSYMMETRIC\n").as_bytes(),
                all,
                None,
                &what("UNSYMMETRIC"),
            );
            check(dmig(&whole, 1).as_bytes(), all, None, &what("DMIG 1"));
            check(harwell_boeing(all, &whole, "RUA").as_bytes(), all, None, &what("RUA"));
            if !matches!(shape, Shape::Diagonal | Shape::Symmetric) {
                continue;
            }
            for (listed, side) in [(Listed::Upper, Symmetry::Upper), (Listed::Lower, Symmetry::Lower)] {
                let part = entries(all, listed, &mut random);
                let one_side = (shape == Shape::Symmetric).then_some(side);
                check(coordinates(&part).as_bytes(), all, one_side, &what("a list of a triangle"));
                check(abaqus(&part, "").as_bytes(), all, one_side, &what("MATRIX INPUT of a triangle"));
                let untyped = abaqus(&part, "*MATRIX INPUT, NAME=K\n");
                check(untyped.as_bytes(), all, one_side, &what("MATRIX INPUT without TYPE"));
                let typed = abaqus(&part, "*MATRIX INPUT, NAME=K, TYPE=SYMMETRIC\n");
                check(typed.as_bytes(), all, None, &what("SYMMETRIC"));
                check(dmig(&part, 6).as_bytes(), all, None, &what("DMIG 6"));
                check(harwell_boeing(all, &part, "RSA").as_bytes(), all, None, &what("RSA"));
                let triangle = DMatrix::from_fn(order, order, |i, j| {
                    if (i < j) == (side == Symmetry::Upper) || i == j { all[(i, j)] } else { 0.0 }
                });
                check(&npy(&triangle, false), all, one_side, &what("npy of a triangle"));
                // A triangle under a word that says whole is read as it says, and there is a line about it.
                let general = market(all, &part, "real", "general");
                let read = || read_bytes(general.as_bytes(), None, Options::default()).unwrap();
                assert_eq!(
                    !read().only().unwrap().doubts().is_empty(),
                    shape == Shape::Symmetric,
                    "{}",
                    what("general")
                );
                let said = Wanted { symmetry: Some(side), ..Wanted::default() };
                let otherwise = Wanted { otherwise: Some(side), ..Wanted::default() };
                for wanted in [said, otherwise] {
                    let mirrored = read().take(&wanted).unwrap();
                    assert_eq!((&mirrored.to_dense(), mirrored.doubts()), (all, Vec::new()), "{}", what("general"));
                }
            }
            // A triangle with its rows in another order.
            let mut part = entries(all, Listed::Lower, &mut random);
            for (at, (i, j, _)) in part.iter_mut().enumerate().filter(|(at, _)| at % 2 == 0) {
                (*i, *j) = if at % 4 == 0 { (*j, *i) } else { (*i, *j) };
            }
            let beside: Vec<_> = part.iter().filter(|(i, j, value)| i != j && *value != 0.0).collect();
            if beside.iter().any(|(i, j, _)| i < j) && beside.iter().any(|(i, j, _)| i > j) {
                check(coordinates(&part).as_bytes(), all, Some(Symmetry::Triangle), &what("a triangle in any order"));
            }
            let lower = entries(all, Listed::Lower, &mut random);
            for [field, symmetry] in [["real", "symmetric"], ["complex", "symmetric"], ["complex", "hermitian"]] {
                check(market(all, &lower, field, symmetry).as_bytes(), all, None, &what(symmetry));
            }
        }
    }
}

#[test]
fn rows_without_a_mirror_image_are_never_mirrored_unasked() {
    let mut random = Random(77);
    for _ in 0..200 {
        let order = 3 + random.below(12);
        let matrix = matrix(&mut random, order, Shape::Friction);
        let listed = entries(&matrix, Listed::Whole, &mut random);
        for text in [coordinates(&listed), abaqus(&listed, "")] {
            let read = || read_bytes(text.as_bytes(), None, Options::default()).unwrap();
            let whole = Wanted { symmetry: Some(Symmetry::Whole), ..Wanted::default() };
            assert_eq!(read().take(&whole).unwrap().to_dense(), matrix);
            assert!(matches!(read().only(), Err(FormatsError::OneSided { .. })));
        }
        // Abaqus would take this as symmetric; whoever wrote friction did not mean it.
        let untyped = abaqus(&listed, "*MATRIX INPUT, NAME=KF\n");
        let read = read_bytes(untyped.as_bytes(), None, Options::default()).unwrap().only();
        assert!(matches!(read, Err(FormatsError::OneSided { .. })));
    }
}

/// A triangle that gives some entries twice is no whole matrix, and a whole matrix that lacks some is no triangle: both look alike, and nothing is guessed.
#[test]
fn a_triangle_with_some_entries_mirrored_is_asked_about_in_every_format() {
    let mut random = Random(0x007a_1f5e);
    let whole = Wanted { symmetry: Some(Symmetry::Whole), ..Wanted::default() };
    for round in 0..100 {
        let order = 3 + random.below(9);
        let all = matrix(&mut random, order, Shape::Symmetric);
        let side = if round % 2 == 0 { Listed::Upper } else { Listed::Lower };
        let mut listed = entries(&all, side, &mut random);
        // Some of the entries off the diagonal are mirrored, and some, always the last of them, are not.
        let beside: Vec<_> = listed.iter().copied().filter(|(i, j, _)| i != j).collect();
        let count = 1 + random.below(beside.len() - 1);
        let images = beside.iter().take(count).map(|&(i, j, value)| (j, i, value));
        listed.splice(0..0, images);
        let meant = DMatrix::from_fn(order, order, |i, j| {
            listed.iter().find(|entry| (entry.0, entry.1) == (i, j)).map_or(0.0, |entry| entry.2)
        });
        assert!(meant != all && meant.transpose() != meant);
        let mut cut = entries(&all, Listed::Whole, &mut random);
        let lost = cut.iter().position(|(i, j, _)| i != j).unwrap();
        let (row, column, _) = cut.remove(lost);
        for bytes in [
            coordinates(&listed).into_bytes(),
            coordinates(&cut).into_bytes(),
            abaqus(&listed, "").into_bytes(),
            npy(&meant, false),
        ] {
            let read = || read_bytes(&bytes, None, Options::default()).unwrap();
            let refused = read().only().unwrap_err();
            assert!(matches!(refused, FormatsError::PartlyMirrored { .. }), "round {round}: {refused}");
            assert!(!read().take(&whole).unwrap().to_dense().is_empty());
        }
        assert_eq!(
            read_bytes(&npy(&meant, false), None, Options::default()).unwrap().take(&whole).unwrap().to_dense(),
            meant
        );
        let named = read_bytes(coordinates(&cut).as_bytes(), None, Options::default()).unwrap().only().unwrap_err();
        assert!(named.to_string().contains(&format!("an entry at ({}, {}) without", column + 1, row + 1)), "{named}");
        // What a file calls symmetric has one triangle, and what it calls whole is so, with a line.
        for text in [abaqus(&listed, "*MATRIX INPUT, NAME=K\n"), dmig(&listed, 6)] {
            let refused = read_bytes(text.as_bytes(), None, Options::default()).unwrap_err().to_string();
            assert!(refused.contains("and its mirror image"), "{refused}");
        }
        for text in [market(&all, &listed, "real", "general"), dmig(&listed, 1)] {
            let read = read_bytes(text.as_bytes(), None, Options::default()).unwrap().only().unwrap();
            assert_eq!((read.to_dense(), read.doubts().len()), (meant.clone(), 1));
        }
    }
}

/// Numbers of the size of rounding, of which the other side is exactly zero, do not make a symmetric matrix doubtful.
#[test]
fn rounding_without_a_mirror_image_is_no_doubt() {
    let mut random = Random(0x00d1);
    for _ in 0..50 {
        let order = 3 + random.below(9);
        let mut all = matrix(&mut random, order, Shape::Symmetric);
        let (i, j) = (order - 1, order - 2);
        (all[(i, j)], all[(j, i)]) = (1e-15, 0.0);
        let listed = entries(&all, Listed::Whole, &mut random);
        for bytes in [coordinates(&listed).into_bytes(), npy(&all, false)] {
            assert_eq!(read_bytes(&bytes, None, Options::default()).unwrap().only().unwrap().to_dense(), all);
        }
    }
}

#[test]
fn imaginary_parts_and_patterns_are_refused_by_name() {
    let market = "%%MatrixMarket matrix coordinate complex symmetric\n2 2 2\n1 1 4.0 0.0\n2 2 5.0 0.25\n";
    let npy = {
        let mut bytes = npy(&DMatrix::from_element(2, 2, 3.0), true);
        let end = bytes.len();
        bytes[end - 8..].copy_from_slice(&0.25_f64.to_le_bytes());
        bytes
    };
    let dmig = b"DMIG,K,0,6,4,0\nDMIG,K,1,1,,1,1,4.0,0.25\n".to_vec();
    for bytes in [market.as_bytes().to_vec(), npy, dmig] {
        let message = read_bytes(&bytes, None, Options::default()).unwrap_err().to_string();
        assert!(
            message.contains("imaginary parts up to 2.5e-1") && message.contains("structural damping"),
            "{message}"
        );
    }
    let real = b"DMIG,K,0,6,4,0\nDMIG,K,1,1,,1,1,4.0,0.0\n";
    assert_eq!(read_bytes(real, None, Options::default()).unwrap().only().unwrap().to_dense()[(0, 0)], 4.0);
    let unsigned = b"%%MatrixMarket matrix coordinate unsigned-integer symmetric\n2 2 1\n1 1 18446744073709551615\n";
    assert_eq!(
        read_bytes(unsigned, None, Options::default()).unwrap().only().unwrap().to_dense()[(0, 0)],
        18446744073709551615.0
    );
    let negative = b"%%MatrixMarket matrix coordinate unsigned-integer symmetric\n2 2 1\n1 1 -1\n";
    assert!(read_bytes(negative, None, Options::default()).is_err());
    let header = |kind: &str, values: &str| {
        format!(
            "title\n 3 1 1 {}\n{kind} 2 2 2 0\n(10I8) (10I8) (4E20.12)\n       1       2       3\n       1       2\n{values}",
            values.lines().count()
        )
    };
    for (kind, part) in [
        ("PSA", "matrix type \"PSA\" is not supported; allowed: real values, as RSA or RUA; this is a pattern"),
        ("PUA", "pattern without values"),
        ("RSE", "this is one by elements"),
        ("RXA", "none of the formats"),
    ] {
        let message = read_bytes(header(kind, "").as_bytes(), None, Options::default()).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
    let complex =
        |imaginary: &str| header("CSA", &format!("{:>20}{:>20}{:>20}{:>20}\n", "1.0", "0.0", "2.0", imaginary));
    let read = |text: String| read_bytes(text.as_bytes(), None, Options::default());
    assert_eq!(read(complex("0.0")).unwrap().only().unwrap().to_dense().diagonal().sum(), 3.0);
    assert!(read(complex("0.5")).unwrap_err().to_string().contains("imaginary parts up to 5.0e-1"));
}
