//! Samples of a finite element brake, and what its case says of the contact in one.

use montecarlo::StreamRng;

use super::FiniteElementSample;
use crate::Error;
use crate::LatticeSample;
use crate::case::{
    CaseError, Draws, Expression, ExpressionError, FiniteElementCase, LOAD_FACTOR, Law, OWN_SPEED, PatchContact,
};
use crate::lattice::FrictionDraw;

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

/// A sample from independent draws: of the contacts, and of the parameters of coefficients with those that all patches share.
pub(super) fn correlated(case: &FiniteElementCase, sample: FiniteElementSample) -> FiniteElementSample {
    let Some(correlation) = &case.correlation else { return sample };
    let FiniteElementSample { values, contacts } = sample;
    match (&case.contact, contacts) {
        (Some(contact), Some(contacts)) if contact.draws == Draws::Each => {
            let contacts = Some(contacts.correlated(&contact.friction, Some(correlation)));
            FiniteElementSample { values, contacts }
        }
        (contact, contacts) => {
            let of_friction = contact.iter().flat_map(|contact| contact.friction.of_draw());
            let distributions: Vec<_> =
                of_friction.chain(case.parameters.iter().map(|own| &own.distribution)).collect();
            let mut all: Vec<f64> = contacts.iter().flat_map(|contacts| contacts.contact(0).values()).collect();
            let friction = all.len();
            all.extend(values);
            correlation.apply(&distributions, &mut [&mut all]);
            let contacts = contacts.map(|contacts| match all.first_chunk() {
                Some(draw) => LatticeSample::shared(FrictionDraw::from_values(*draw), contacts.speed_quantile),
                None => contacts,
            });
            FiniteElementSample { values: all.split_off(friction), contacts }
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

    use montecarlo::stream;

    use super::draw;
    use crate::case::{CaseFile, FiniteElementCase};

    fn case(given: &str) -> Result<FiniteElementCase, String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
        let text = std::fs::read_to_string(folder.join("disc-pad.toml")).unwrap();
        let text = text.replace("load = 468.0", "stiffness_factor = \"kc\"\nload = 468.0");
        let kc = "[parameters.kc]\ndistribution = \"log-normal\"\nmedian = 1.0\nsigma = 0.2\n";
        match CaseFile::parse(&folder.join("changed.toml"), format!("{text}\n{kc}{given}"))
            .map_err(|e| e.to_string())?
        {
            CaseFile::FiniteElements(case) => Ok(*case),
            other => panic!("{other:?}"),
        }
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
        // With a draw of friction for each patch there is no one mu on which kc could depend.
        let each = "draws = \"each\"\npatches = [";
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
        let text = std::fs::read_to_string(folder.join("disc-pad.toml")).unwrap().replace("patches = [", each);
        let error = CaseFile::parse(&folder.join("changed.toml"), format!("{text}\n{table}")).unwrap_err().to_string();
        assert!(error.contains("correlation.parameters = \"kc\"; allowed: what is drawn: mu, "), "{error}");
    }
}
