//! The eigenvalues in a rectangle, by sparse matrices.

use std::cell::Cell;

use formats::{Dof, Matrix};
use montecarlo::Progress;
use nalgebra_sparse::CscMatrix;
use output::{bytes_in_words, in_words};
use sparse::{Circle, Count, Eigenpair, Found, Options, Reach, Rectangle, SparseSecondOrder, eigenpairs_in};

use super::EigArgs;
use super::matrices::{Matrices, Sizes};
use super::text::{finite_json, heading, list, number, row, rows_json, taken, taken_json, vector_rows, vectors_json};
use crate::Error;
use crate::bar::Bar;
use crate::terminal::note;

/// Most degrees of freedom of a problem whose whole spectrum is certified, instead of a search; chosen: it takes some two seconds.
const MOST_DOFS_CERTIFIED: usize = 300;
/// Most degrees of freedom of a problem whose list is counted again without `--count`; chosen, so that the count takes about as long as the search.
const MOST_DOFS_COUNTED: usize = 10_000;
/// Largest border of a rectangle, rad/s; chosen: far above any vibration, and its powers are finite.
const LARGEST_BORDER: f64 = 1e12;
/// Memory of the matrices and a Krylov basis, bytes per degree of freedom. Memory is estimated as `BASIS_BYTES n + FACTOR_BYTES n^(4/3)`. Measured (GNU
/// time) with a disc and pad of linear solids of n = 14,985, 47,376, 108,459 and 205,227: 0.37, 1.38, 3.67 and 8.04 GB; the estimate is 0.36, 1.37, 3.68
/// and 7.99 GB.
const BASIS_BYTES: f64 = 13_000.0;
/// Memory of sparse factors, bytes per n^(4/3) of n degrees of freedom; the power 4/3 is the one of meshes of solids. Measured with [`BASIS_BYTES`].
const FACTOR_BYTES: f64 = 440.0;
/// Largest fraction of the allowed memory that the vectors of the eigenvalues take; chosen.
const PART_OF_VECTORS: f64 = 0.25;
/// Processor time at one shift, s per n^1.5 of n degrees of freedom, roughly. Some twenty eigenvalues are found there. Measured with [`BASIS_BYTES`], beside
/// other work: 2.1, 8.1, 30 and 78 s.
const SECONDS_AT_A_SHIFT: f64 = 8e-7;
/// Most degrees of freedom of a problem whose memory and time are not said beforehand; chosen: it takes a second or so in all.
const MOST_DOFS_UNANNOUNCED: usize = 3000;
/// Steps of the bar of progress.
const PERCENT: f64 = 100.0;
/// Largest distance of copies of one eigenvalue, as a fraction of the largest eigenvalue listed; chosen: rounding moves copies apart by less.
const COPIES: f64 = 1e-6;
/// Most copies of one eigenvalue without a warning; chosen: the eigenvalue zero of a free body has so many, two for each of six rigid body modes.
const MOST_COPIES: usize = 12;

/// The rectangle that the value of `--box` says.
///
/// # Errors
/// A text that is refused, with what is allowed.
pub(super) fn parse(text: &str) -> Result<Rectangle, String> {
    let allowed = format!(
        "allowed: RE0:RE1,IM0:IM1 in rad/s, as -50:1000,0:42000, each first below its second, none above {LARGEST_BORDER:e}"
    );
    let side = |text: &str| -> Option<[f64; 2]> {
        let (from, to) = text.split_once(':')?;
        Some([from.trim().parse().ok()?, to.trim().parse().ok()?])
    };
    let sides = text.split_once(',').and_then(|(re, im)| Some(Rectangle { re: side(re)?, im: side(im)? }));
    let rectangle = sides.ok_or_else(|| allowed.clone())?;
    rectangle.check().map_err(|error| format!("{error}; {allowed}"))?;
    if rectangle.re.iter().chain(&rectangle.im).any(|border| border.abs() > LARGEST_BORDER) {
        return Err(allowed);
    }
    Ok(rectangle)
}

/// Runs `squeal eig` with `--box`: the matrices that `args` names are read, a note says what the search costs, and the eigenvalues of the rectangle are
/// found. The answer, as text or as JSON.
///
/// # Errors
/// A file that is no matrix, shapes that differ, a singular pencil, no convergence, a rectangle with too much in it.
pub(super) fn spectrum(args: &EigArgs, rectangle: &Rectangle) -> Result<String, Error> {
    let budget = args.memory.budget();
    let sizes = Sizes {
        bytes: budget,
        order: largest_order(budget),
        beyond: ", by the memory there is; --memory says another",
    };
    let matrices = Matrices::read(args, sizes)?;
    let order = matrices.order();
    let labels = matrices.labels().map(<[Dof]>::to_vec);
    let Matrices { mass, damping, stiffness, files, held } = matrices;
    // Each is given back before the next one is copied.
    let sparse = |matrix: Matrix| matrix.to_csc();
    let c = damping.map_or_else(|| CscMatrix::zeros(order, order), sparse);
    let system = SparseSecondOrder::new(sparse(mass), c, sparse(stiffness))?;
    announce(order);
    let mut found = search(&system, rectangle, args.count, budget)?;
    let copies = if found.is_certified { 0 } else { most_copies(&found) };
    if copies > MOST_COPIES {
        note(&format!(
            "an eigenvalue occurs some {copies} times: of so many copies a search may list one in the place of another eigenvalue next to them, \
             which no count sees (docs/large-problems.md)"
        ));
    }
    if args.rightmost.is_some() {
        found.pairs.sort_by(|a, b| b.lambda.re.total_cmp(&a.lambda.re).then(b.lambda.im.total_cmp(&a.lambda.im)));
    }
    let listed = args.rightmost.map_or(found.pairs.len(), |most| found.pairs.len().min(most as usize));
    Ok(if args.json {
        let rows = if args.vectors { rows_json(labels.as_deref()) } else { String::new() };
        json((&found, listed), rectangle, args.vectors, &(taken_json(&files, &held) + &rows))
    } else {
        table((&found, listed), args.vectors) + &taken(&files, &held)
    })
}

/// Options of a search in a rectangle. If `is_counted`, its list is counted again however long that takes, otherwise only if it takes about as long as the
/// search. `budget` is the memory that may be taken, bytes.
#[must_use]
pub fn search_options(is_counted: bool, budget: u64) -> Options {
    let counted = if is_counted { usize::MAX } else { MOST_DOFS_COUNTED };
    let bytes = (PART_OF_VECTORS * budget as f64) as usize;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    Options { certified: MOST_DOFS_CERTIFIED, counted, bytes, threads, ..Options::default() }
}

/// The eigenpairs that a search of the rectangle finds, with a bar of its progress in percent of the area.
fn search(system: &SparseSecondOrder, rectangle: &Rectangle, is_counted: bool, budget: u64) -> Result<Found, Error> {
    let bar = Bar::of("% of the rectangle");
    let told = Cell::new(0_u64);
    bar.begin(PERCENT as u64, 0);
    let options = search_options(is_counted, budget);
    let found = eigenpairs_in(system, rectangle, &options, &mut |progress| {
        let covered = (progress.covered * PERCENT) as u64;
        bar.advance(covered.saturating_sub(told.replace(covered)));
    });
    bar.end();
    Ok(found?)
}

/// Largest number of copies of an eigenvalue in the list.
fn most_copies(found: &Found) -> usize {
    let reach = COPIES * found.pairs.iter().map(|pair| pair.lambda.norm()).fold(0.0, f64::max);
    let next_to =
        |one: &Eigenpair| found.pairs.iter().filter(|other| (other.lambda - one.lambda).norm() <= reach).count();
    found.pairs.iter().map(next_to).max().unwrap_or(0)
}

/// Memory, bytes, that a search of a system of `order` degrees of freedom takes, roughly.
fn bytes_of(order: usize) -> f64 {
    let n = order as f64;
    BASIS_BYTES * n + FACTOR_BYTES * n.powf(4.0 / 3.0)
}

/// The most degrees of freedom whose search fits into `budget` bytes.
#[must_use]
pub fn largest_order(budget: u64) -> usize {
    let (mut fits, mut above) = (0, 1_usize << 31);
    while above - fits > 1 {
        let middle = fits + (above - fits) / 2;
        if bytes_of(middle) <= budget as f64 { fits = middle } else { above = middle }
    }
    fits
}

/// Says beforehand how much memory and time a search of a system of `order` degrees of freedom takes, if it has many.
fn announce(order: usize) {
    if order > MOST_DOFS_UNANNOUNCED {
        let n = order as f64;
        let (memory, time) = (bytes_in_words(bytes_of(order)), in_words(SECONDS_AT_A_SHIFT * n.powf(1.5)));
        note(&format!("{order} degrees of freedom: roughly {memory}; {time} for every twenty eigenvalues or so"));
    }
}

/// The result as JSON, of its eigenvalues the first `listed`; `before` are further fields with a comma after each.
fn json((found, listed): (&Found, usize), rectangle: &Rectangle, vectors: bool, before: &str) -> String {
    let eigenvalue = |pair: &Eigenpair| {
        let shapes = if vectors { vectors_json(&pair.right, &pair.left) } else { String::new() };
        let errors = [pair.backward_error, pair.condition, pair.bound];
        let known = finite_json(pair.lambda, errors, pair.verdict);
        format!("\n    {{{known}, \"on_border\": {}{shapes}}}", pair.on_border)
    };
    let side = |[from, to]: [f64; 2]| format!("[{}, {}]", number(from), number(to));
    let discs = list(&found.discs, |disc| {
        format!(
            "\n      {{\"re\": {}, \"im\": {}, \"radius\": {}, \"eigenvalues\": {}, \"columns\": {}}}",
            number(disc.centre.re),
            number(disc.centre.im),
            number(disc.radius),
            disc.eigenvalues,
            disc.columns
        )
    });
    let circle = |circle: &Circle| {
        format!(
            "{{ \"re\": {}, \"im\": {}, \"radius\": {}, \"eigenvalues\": {} }}",
            number(circle.centre.re),
            number(circle.centre.im),
            number(circle.radius),
            circle.eigenvalues
        )
    };
    let count = match &found.count {
        Count::Argument { circles, points } => format!(
            "{{ \"by\": \"argument-principle\", \"points\": {points}, \"circles\": [{}] }}",
            list(circles, circle)
        ),
        Count::SecondBlock => "{ \"by\": \"second-block\" }".to_owned(),
        Count::Unclear => "null".to_owned(),
    };
    format!(
        "{{\n  \"route\": \"{}\",\n{before}  \"eigenvalues\": [{}],\n  \"coverage\": {{\n    \"re\": {}, \"im\": {},\n    \
         \"count\": {count},\n    \"discs\": [{discs}],\n    \"factorisations\": {}, \"solves\": {}\n  }}\n}}\n",
        if found.is_certified { "certified" } else { "sparse" },
        list(&found.pairs[..listed], eigenvalue),
        side(rectangle.re),
        side(rectangle.im),
        found.counters.factorisations,
        found.counters.solves
    )
}

/// The result as text, of its eigenvalues the first `listed`; counts are of all.
fn table((found, listed): (&Found, usize), vectors: bool) -> String {
    let mut text = heading();
    for (i, pair) in found.pairs[..listed].iter().enumerate() {
        let border = if pair.on_border { ", on the border" } else { "" };
        let said = format!("{}{border}", pair.verdict);
        text += &row(i + 1, pair.lambda, pair.backward_error, pair.condition, &said);
        if vectors {
            text += &vector_rows(&pair.right, &pair.left);
        }
    }
    let count = |wanted: &str| found.pairs.iter().filter(|pair| pair.verdict.to_string() == wanted).count();
    let again = match (&found.count, &found.reach) {
        (Count::Argument { circles, .. }, Some(Reach { modulus, real })) if circles.is_empty() => format!(
            "nothing is there to be searched: by the norms of the matrices |lambda| <= {modulus:.6e} and |Re lambda| <= {real:.6e} rad/s"
        ),
        (Count::Argument { circles, points }, _) => {
            let within = match &circles[..] {
                [Circle { centre, radius, eigenvalues }] => {
                    format!("within {radius:.6e} of {centre:.6e} rad/s: {eigenvalues}")
                }
                several => format!("within {} circles around it", several.len()),
            };
            format!("counted again by the argument principle, {within}, as many as were found, from {points} points")
        }
        (Count::SecondBlock, _) => format!(
            "not counted again, which above {MOST_DOFS_COUNTED} degrees of freedom takes longer than the search: --count does; a second block of \
             vectors at each disc found nothing new"
        ),
        (Count::Unclear, _) => {
            "not counted again: Q is singular to rounding next to each circle that was tried, or its pivots are too \
                           small"
                .to_owned()
        }
    };
    let how = if found.is_certified {
        "all eigenvalues of the matrices certified, docs/error-bounds.md".to_owned()
    } else {
        format!(
            "discs that cover it: {}, factorisations: {}, solutions: {}; verdicts by first-order bounds",
            found.discs.len(),
            found.counters.factorisations,
            found.counters.solves
        )
    };
    let of_all =
        if listed < found.pairs.len() { format!("; the {listed} rightmost are listed") } else { String::new() };
    text + &format!(
        "\n{} eigenvalues in the rectangle: {} unstable, {} stable, {} marginal, {} undecided{of_all}\n{again}\n{how}\ndamping = -Re lambda / \
         |lambda|; completeness: docs/large-problems.md\n",
        found.pairs.len(),
        count("unstable"),
        count("stable"),
        count("marginal"),
        count("undecided")
    )
}
