//! Samples of a finite element brake, and what its case says of the contact in one.

use montecarlo::StreamRng;

use super::FiniteElementSample;
use crate::Error;
use crate::LatticeSample;
use crate::case::{
    CaseError, Draws, Expression, ExpressionError, FiniteElementCase, LOAD_FACTOR, Law, OWN_SPEED, PatchContact,
};

/// Speed at which a law that does not depend on speed is evaluated, m/s; any value gives the same result.
const ANY_SPEED: f64 = 1.0;

/// A law with the index of its range of speed, where it has one; `None` without a contact.
pub(super) type State = Option<(Law, Option<usize>)>;

/// The law of a state, with the sliding speed of a sample, m/s.
pub(super) fn law_and_speed(
    case: &FiniteElementCase,
    state: State,
    sample: &FiniteElementSample,
) -> Option<(Law, f64)> {
    let (contact, (law, range)) = case.contact.as_ref().zip(state)?;
    Some((law, speed(contact, range, sample)))
}

/// Draws a sample: the parameters, then friction and speed.
pub(super) fn draw(case: &FiniteElementCase, rng: &mut StreamRng) -> Result<FiniteElementSample, Error> {
    let values = case.parameters.iter().map(|parameter| parameter.distribution.draw(rng)).collect::<Result<_, _>>()?;
    let of_contact = |contact: &PatchContact| {
        let count = if contact.draws == Draws::Shared { 1 } else { contact.patches.len() };
        LatticeSample::draw_for(&contact.friction, None, count, rng)
    };
    Ok(correlated(case, FiniteElementSample { values, contacts: case.contact.as_ref().map(of_contact).transpose()? }))
}

/// A sample from independent draws: of the contacts, and of the parameters of coefficients.
pub(super) fn correlated(case: &FiniteElementCase, sample: FiniteElementSample) -> FiniteElementSample {
    let Some(correlation) = &case.correlation else { return sample };
    let FiniteElementSample { mut values, contacts } = sample;
    let own: Vec<_> = case.parameters.iter().map(|own| &own.distribution).collect();
    match case.contact.as_ref().zip(contacts) {
        Some((contact, contacts)) => {
            let (contacts, values) = contacts.correlated_with(&contact.friction, (&own, values), correlation);
            FiniteElementSample { values, contacts: Some(contacts) }
        }
        None => {
            correlation.apply(&own, &mut values);
            FiniteElementSample { values, contacts: None }
        }
    }
}

/// The sample with the medians of all distributions.
pub(super) fn median(case: &FiniteElementCase) -> FiniteElementSample {
    FiniteElementSample {
        values: case.parameters.iter().map(|parameter| parameter.distribution.median()).collect(),
        contacts: case.contact.as_ref().map(|contact| LatticeSample::median_of(&contact.friction)),
    }
}

/// The sliding speed of a sample in a range of speeds, m/s.
fn speed(contact: &PatchContact, range: Option<usize>, sample: &FiniteElementSample) -> f64 {
    let quantile = sample.contacts.as_ref().map_or(0.5, |contacts| contacts.speed_quantile);
    range.map_or(ANY_SPEED, |range| contact.speeds[range].quantile(quantile))
}

/// Factor of the load of all pairs in a sample.
pub(super) fn load_factor(
    case: &FiniteElementCase,
    contact: &PatchContact,
    sample: &FiniteElementSample,
) -> Result<f64, CaseError> {
    Ok(positive(case, contact.load_factor.as_ref(), LOAD_FACTOR, sample)?.unwrap_or(1.0))
}

/// The sliding speed as the parameters of a sample say it, m/s; `None` where a range does.
pub(super) fn own_speed(case: &FiniteElementCase, sample: &FiniteElementSample) -> Result<Option<f64>, CaseError> {
    let contact = case.contact.as_ref().filter(|contact| contact.speeds.is_empty());
    let Some(own) = contact.and_then(|contact| contact.own_speed.as_ref()) else { return Ok(None) };
    Ok(positive(case, Some(&own.speed), OWN_SPEED, sample)?.map(|speed| speed * own.factor))
}

/// The value of an expression of the contact, which must be > 0, with what has a value for each patch or pair at its median.
pub(super) fn positive(
    case: &FiniteElementCase,
    expression: Option<&Expression>,
    field: &str,
    sample: &FiniteElementSample,
) -> Result<Option<f64>, CaseError> {
    let Some((expression, contact)) = expression.zip(case.contact.as_ref()) else { return Ok(None) };
    let value = contact.spread.value_at_medians(expression, &sample.values).map_err(without_value(case, field))?;
    above_zero(case, field, value).map(Some)
}

/// The values of an expression of the contact at each pair of a patch, which must be > 0; 1 without an expression.
pub(super) fn positive_at_pairs(
    case: &FiniteElementCase,
    (contact, patch): (&PatchContact, usize),
    expression: Option<&Expression>,
    field: &str,
    sample: &FiniteElementSample,
) -> Result<Vec<f64>, CaseError> {
    let Some(expression) = expression else { return Ok(vec![1.0; contact.patches[patch].pairs.len()]) };
    let values = contact.at_pairs(expression, &sample.values, patch).map_err(without_value(case, field))?;
    values.into_iter().map(|value| above_zero(case, field, value)).collect()
}

/// The error of a field whose expression has no value.
fn without_value<'a>(
    case: &'a FiniteElementCase,
    field: &'a str,
) -> impl FnOnce(ExpressionError) -> CaseError + use<'a> {
    move |source| {
        let (path, field) = (case.header.path.clone(), field.to_owned());
        CaseError::Expression { path, field, source: Box::new(source) }
    }
}

/// The value of a field of the contact, refused where it is not > 0.
fn above_zero(case: &FiniteElementCase, field: &str, value: f64) -> Result<f64, CaseError> {
    if value <= 0.0 {
        let (path, field) = (case.header.path.clone(), field.to_owned());
        return Err(CaseError::Value { path, field, value: value.to_string(), allowed: "> 0".into() });
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]

    use std::path::Path;

    use montecarlo::{Distribution, stream};

    use super::draw;
    use crate::case::{CaseFile, FiniteElementCase};

    /// The disc and pad with a factor of the stiffness of its contact, which has further fields, and with further tables; `draws` of friction.
    fn case_with(draws: &str, of_kc: &str, given: &str) -> Result<FiniteElementCase, String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
        let text = std::fs::read_to_string(folder.join("disc-pad.toml")).unwrap();
        let text = text.replace("load = 468.0", "stiffness_factor = \"kc\"\nload = 468.0");
        let text = text.replace("patches = [", &format!("draws = \"{draws}\"\npatches = ["));
        let kc = format!("[parameters.kc]\ndistribution = \"log-normal\"\nmedian = 1.0\nsigma = 0.2\n{of_kc}\n");
        match CaseFile::parse(&folder.join("changed.toml"), format!("{text}\n{kc}{given}"))
            .map_err(|e| e.to_string())?
        {
            CaseFile::FiniteElements(case) => Ok(*case),
            other => panic!("{other:?}"),
        }
    }

    fn case(given: &str) -> Result<FiniteElementCase, String> {
        case_with("shared", "", given)
    }

    /// Friction and stiffness of the contact: their normal scores have the correlation that is asked for, each the distribution that it has alone,
    /// and what is not correlated keeps its draws.
    #[test]
    fn parameters_of_coefficients_are_correlated_with_friction() {
        let table = "[correlation]\nparameters = [\"mu\", \"kc\"]\nmatrix = [[1.0, -0.7], [-0.7, 1.0]]\n";
        let (alone, together) = (case("").unwrap(), case(table).unwrap());
        let (mut products, mut squares, count) = (0.0, 0.0, 4000);
        for at in 0..count {
            let [free, tied] = [&alone, &together].map(|case| draw(case, &mut stream(3, at)).unwrap());
            let friction = |sample: &crate::FiniteElementSample| *sample.contacts.as_ref().unwrap().contact(0);
            // mu is normal with 0.5 and 0.1, ln kc with 0 and 0.2.
            let score = (friction(&tied).mu - 0.5) / 0.1;
            products += score * tied.values[0].ln() / 0.2;
            squares += (tied.values[0].ln() / 0.2).powi(2);
            assert_eq!(friction(&free).mu, friction(&tied).mu);
            assert_eq!(friction(&free).alpha, friction(&tied).alpha);
        }
        let [correlation, variance] = [products, squares].map(|sum| sum / count as f64);
        println!("{correlation} {variance}");
        assert!((correlation + 0.7).abs() < 0.05 && (variance - 1.0).abs() < 0.08);
    }

    /// Largest distance between the distribution function and the empirical one of the draws.
    fn kolmogorov_smirnov(distribution: &Distribution, mut draws: Vec<f64>) -> f64 {
        draws.sort_by(f64::total_cmp);
        let n = draws.len() as f64;
        let distance = |(rank, &value): (usize, &f64)| {
            let probability = distribution.cumulative(value);
            (probability - rank as f64 / n).abs().max((probability - (rank + 1) as f64 / n).abs())
        };
        draws.iter().enumerate().map(distance).fold(0.0, f64::max)
    }

    /// The stiffness of a patch is correlated with the friction of this patch and of no other. Each value has the distribution that it has alone, and a
    /// value that the correlation does not name has its draws.
    #[test]
    fn a_patch_has_a_stiffness_that_goes_with_its_own_friction() {
        let over = "over = \"patches\"";
        let table = "[correlation]\nparameters = [\"kc@1\", \"mu@1\", \"kc@2\", \"mu@2\"]\n\
                     matrix = [[1.0, -0.7, 0.0, 0.0], [-0.7, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.5], [0.0, 0.0, 0.5, 1.0]]\n";
        let (alone, together) = (case_with("each", over, "").unwrap(), case_with("each", over, table).unwrap());
        let [kc, mu] = [&alone.parameters[0].distribution, &alone.contact.as_ref().unwrap().friction.mu];
        let friction =
            |sample: &crate::FiniteElementSample, patch: usize| *sample.contacts.as_ref().unwrap().contact(patch);
        let (count, mut columns) = (4000, vec![Vec::new(); 4]);
        for at in 0..count {
            let [free, tied] = [&alone, &together].map(|case| draw(case, &mut stream(3, at)).unwrap());
            let of = |sample: &crate::FiniteElementSample| {
                [sample.values[0], friction(sample, 0).mu, sample.values[1], friction(sample, 1).mu]
            };
            columns.iter_mut().zip(of(&tied)).for_each(|(column, value)| column.push(value));
            // kc@1 and kc@2 are correlated with nothing before them.
            assert_eq!((tied.values[0], tied.values[1]), (free.values[0], free.values[1]));
            assert_eq!(tied.values[2..], free.values[2..]);
            assert_eq!(friction(&tied, 2), friction(&free, 2));
            assert_eq!(friction(&tied, 0).mu_k, friction(&free, 0).mu_k);
        }
        let normal = Distribution::Normal { mean: 0.0, deviation: 1.0, at_least: f64::NEG_INFINITY, at_most: None };
        let mut scores = Vec::new();
        for (column, distribution) in columns.into_iter().zip([kc, mu, kc, mu]) {
            scores.push(
                column.iter().map(|value| normal.quantile(distribution.cumulative(*value))).collect::<Vec<f64>>(),
            );
            // sqrt(n) D is above 1.95 with a probability of 0.1 % (Kolmogorov's distribution).
            assert!(kolmogorov_smirnov(distribution, column) < 1.95 / (count as f64).sqrt());
        }
        for (i, j, expected) in [(0, 1, -0.7), (2, 3, 0.5), (0, 3, 0.0), (1, 2, 0.0), (0, 2, 0.0), (1, 3, 0.0)] {
            let found = scores[i].iter().zip(&scores[j]).map(|(a, b)| a * b).sum::<f64>() / count as f64;
            println!("{i} {j}: {found}");
            assert!((found - expected).abs() < 0.06, "{i} {j}: {found}");
        }
    }

    #[test]
    fn values_by_their_own_names_are_refused_in_one_line_where_they_make_no_sense() {
        let of = |parameters: &str, matrix: &str| format!("[correlation]\nparameters = [{parameters}]\n{matrix}\n");
        let two = "matrix = [[1.0, -0.7], [-0.7, 1.0]]";
        let field = "field = { kernel = \"exponential\", length = 50.0 }";
        for (draws, given, words) in [
            (
                "each",
                of("\"mu\", \"kc@1\"", two),
                ["correlation.parameters = \"mu\"", "mu@N, lateral_mu@N, mu_s@N", "; kc@1, kc@2, "],
            ),
            (
                "each",
                of("\"mu@1\", \"kc@10\"", two),
                ["\"kc@10\"", "N of the contact, 1 to 9; kc@1", "each contact alone: mu, lateral_mu"],
            ),
            ("each", of("\"mu@0\", \"kc@1\"", two), ["\"mu@0\"", "1 to 9", "kc@9"]),
            ("shared", of("\"mu@1\", \"kc@1\"", two), ["\"mu@1\"", "what is drawn: mu, ", "kc@9"]),
            (
                "each",
                of("\"kc@1\", \"kc@2\"", &format!("{two}\n{field}")),
                ["correlation.field = given", "as mu@1", "all contacts"],
            ),
            (
                "each",
                of("\"mu@1\", \"mu@2\"", &format!("{two}\n{field}")),
                ["correlation.matrix = -0.7 in row 1, column 2", "0 for mu@1 and mu@2", "the field"],
            ),
            (
                "each",
                of("\"mu@1\", \"kc@1\"", "matrix = [[1.0, 1.0], [1.0, 1.0]]"),
                ["correlation.matrix", "eigenvalue", "> 0"],
            ),
            (
                "each",
                of(
                    "\"mu@1\", \"kc@1\"",
                    "matrix = [[1.0, 0.9], [0.9, 1.0]]\nfield = { kernel = \"exponential\", length = 1e3 }",
                ),
                ["correlation = a matrix and a field with the eigenvalue -", "together", "shorter length"],
            ),
        ] {
            let error = case_with(draws, "over = \"patches\"", &given).unwrap_err();
            assert!(!error.contains('\n') && words.iter().all(|word| error.contains(word)), "{error}");
        }
        let both =
            of("\"mu@1\", \"kc@1\"", &format!("matrix = [[1.0, 0.4], [0.4, 1.0]]\n{}", field.replace("50.0", "1e-3")));
        assert!(case_with("each", "over = \"patches\"", &both).unwrap().correlation.is_some());
    }

    /// A factor that follows a table over what each patch draws: at the pairs of each, and in all that tells the brake from others.
    #[test]
    fn a_factor_of_patches_follows_a_table() {
        let with = |table: &str, factor: &str| {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
            let text = std::fs::read_to_string(folder.join("disc-pad.toml")).unwrap();
            let text = text.replace("load = 468.0", &format!("stiffness_factor = \"{factor}\"\nload = 468.0"));
            let text = format!(
                "{text}\n[parameters.T]\ndistribution = \"uniform\"\nfrom = 20.0\nto = 400.0\nover = \"patches\"\n{table}"
            );
            match CaseFile::parse(&folder.join("changed.toml"), text).map_err(|e| e.to_string())? {
                CaseFile::FiniteElements(case) => Ok::<_, String>(*case),
                other => panic!("{other:?}"),
            }
        };
        let table = |last: f64| format!("[tables.soft]\nat = [20.0, 100.0, 300.0]\nvalue = [1.0, 0.9, {last}]\n");
        let [case, other] = [0.5, 0.4].map(|last| with(&table(last), "2*soft(T)").unwrap());
        let contact = case.contact.as_ref().unwrap();
        let mut values: Vec<f64> = case.parameters.iter().map(|_| 60.0).collect();
        values[1] = 200.0;
        values[2] = 301.0;
        let at = |patch: usize| contact.at_pairs(contact.stiffness_factor.as_ref().unwrap(), &values, patch);
        assert!(at(0).unwrap().iter().all(|factor| (factor - 1.9).abs() < 1e-15));
        assert!(at(1).unwrap().iter().all(|factor| (factor - 1.4).abs() < 1e-15));
        assert!(at(2).unwrap_err().to_string().contains("soft(301) at T = 301"));
        let identities = |case: &FiniteElementCase| [case.identity(), case.prepared_identity(), case.brake_identity()];
        assert!(identities(&case).iter().zip(identities(&other)).all(|(one, other)| *one != other));
        let error = with("[tables.T]\nat = [0.0, 1.0]\nvalue = [1.0, 2.0]\n", "T(T)").unwrap_err();
        assert!(error.ends_with("tables = \"T\"; allowed: a name that no parameter has"), "{error}");
    }
}
