//! Parameters that have a value of their own in each patch of a contact, or in each point of it as a random field over its faces.

use std::ops::Range;

use montecarlo::Distribution;
use nalgebra::DMatrix;

use super::{Patch, PatchContact};
use crate::check::Check;
use crate::parameter::{OverEntry, OverField};
use crate::random_field::{FieldModes, Kernel};
use crate::{CaseError, Expression, ExpressionError, Parameter};

/// Most points of a face with a field; chosen: the time of the eigenvectors of their correlation grows with the third power, and each command takes it.
const MOST_POINTS: usize = 2000;
/// Most modes of a field over a face; chosen: each is a parameter that is drawn.
const MOST_MODES: usize = 200;

/// Parameters of a contact that have a value for each patch or pair.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SpreadParameters {
    /// Number of the parameters of the case of which the whole brake has one value; they are before all others.
    of_whole: usize,
    all: Vec<SpreadParameter>,
}

/// Parameter that has a value for each patch or pair.
#[derive(Debug, Clone, PartialEq)]
pub struct SpreadParameter {
    /// Name in expressions.
    pub name: String,
    /// Distribution of each of its values.
    pub distribution: Distribution,
    /// Places of its values, and the parameters of the case that they follow from.
    pub spread: Spread,
}

/// Places of the values of a parameter: patches of a contact, or its pairs.
#[derive(Debug, Clone, PartialEq)]
pub enum Spread {
    /// Patches, each with a parameter of the case of its own: this parameter, and the parameters that follow.
    Patches {
        /// Index of the parameter of the first patch.
        first: usize,
    },
    /// Pairs, by a random field over the face of each contact.
    Field {
        /// The field at the pairs of each patch.
        of_patches: Vec<PatchField>,
        /// Kernel, length and share in words.
        identity: String,
    },
}

/// A random field at the pairs of a patch.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchField {
    /// Indices of its coefficients, standard normal parameters of the case, which all patches of a face share.
    pub coefficients: Range<usize>,
    /// Shapes of its modes, a row of length 1 for each pair: their sum by the coefficients is its normal score.
    pub(crate) shapes: DMatrix<f64>,
}

/// A parameter as the case gives it, with the places of its values.
pub(super) struct SpreadOver {
    pub parameter: Parameter,
    over: OverEntry,
}

impl SpreadOver {
    /// A parameter that has a value for each patch or pair.
    ///
    /// # Errors
    /// Numbers that make no field, a parameter that is not drawn.
    pub fn new(check: &Check<'_>, parameter: Parameter, over: OverEntry) -> Result<Self, CaseError> {
        let key = |key: &str| format!("parameters.{}.over{key}", parameter.name);
        if let Distribution::Constant { .. } = parameter.distribution {
            return Err(check.value(&key(""), "given", "parameters that are drawn; a constant is the same everywhere"));
        }
        if let OverEntry::Field(OverField { length, share, .. }) = over {
            if length.is_nan() || length <= 0.0 {
                return Err(check.value(&key(".length"), length, "a distance, > 0; inf is one value for each face"));
            }
            if !(share > 0.0 && share <= 1.0) {
                return Err(check.value(&key(".share"), share, "a share of the variance, > 0 and <= 1"));
            }
        }
        Ok(Self { parameter, over })
    }
}

impl SpreadParameters {
    /// The parameters over patches or pairs; what is drawn for them is added to the parameters of the case.
    ///
    /// # Errors
    /// A field over pairs of nodes, which have no area, and one over too many points or of too many modes.
    pub(super) fn new(
        check: &Check<'_>,
        given: Vec<SpreadOver>,
        patches: &[Patch],
        parameters: &mut Vec<Parameter>,
    ) -> Result<Self, CaseError> {
        let of_whole = parameters.len();
        let mut all = Vec::with_capacity(given.len());
        for SpreadOver { parameter: Parameter { name, unit, distribution }, over } in given {
            let spread = match over {
                OverEntry::Word(_) => {
                    let first = parameters.len();
                    let of_patch = |number: usize| Parameter {
                        name: format!("{name}@{number}"),
                        unit: unit.clone(),
                        distribution: distribution.clone(),
                    };
                    parameters.extend((1..=patches.len()).map(of_patch));
                    Spread::Patches { first }
                }
                OverEntry::Field(field) => over_faces(check, &name, field, patches, parameters)?,
            };
            all.push(SpreadParameter { name, distribution, spread });
        }
        Ok(Self { of_whole, all })
    }

    /// The parameters, in the order of their names.
    pub fn all(&self) -> &[SpreadParameter] {
        &self.all
    }

    /// True if a parameter of the case, by its index, acts in one of the patches `closed`.
    pub fn acts_in(&self, parameter: usize, closed: &[usize]) -> bool {
        let is_part = |local: &SpreadParameter| match &local.spread {
            Spread::Patches { first } => closed.iter().any(|patch| first + patch == parameter),
            Spread::Field { of_patches, .. } => {
                closed.iter().any(|&patch| of_patches[patch].coefficients.contains(&parameter))
            }
        };
        parameter < self.of_whole || self.all.iter().any(is_part)
    }

    /// The value of an expression, given the values of the parameters of the case, with all parameters over patches or pairs at their medians.
    ///
    /// # Errors
    /// Those of [`Expression::value`].
    pub fn value_at_medians(&self, expression: &Expression, values: &[f64]) -> Result<f64, ExpressionError> {
        let medians = self.all.iter().map(|local| local.distribution.median());
        expression.value(&values.iter().copied().take(self.of_whole).chain(medians).collect::<Vec<_>>())
    }

    /// The value of a parameter at a pair of a patch.
    fn local(&self, local: &SpreadParameter, values: &[f64], (patch, pair): (usize, usize)) -> f64 {
        let value = |at: usize| values.get(at).copied().unwrap_or(f64::NAN);
        match &local.spread {
            Spread::Patches { first } => value(first + patch),
            Spread::Field { of_patches, .. } => {
                let PatchField { coefficients, shapes } = &of_patches[patch];
                let modes = coefficients.clone().enumerate();
                local.distribution.of_score(modes.map(|(mode, at)| value(at) * shapes[(pair, mode)]).sum())
            }
        }
    }
}

impl PatchContact {
    /// The value of an expression at each pair of a patch, given the values of the parameters of the case.
    ///
    /// # Errors
    /// Those of [`Expression::value`].
    pub fn at_pairs(&self, expression: &Expression, values: &[f64], patch: usize) -> Result<Vec<f64>, ExpressionError> {
        let (spread, pairs) = (&self.spread, self.patches[patch].pairs.len());
        if expression.parameters().all(|parameter| parameter < spread.of_whole) {
            return Ok(vec![expression.value(values)?; pairs]);
        }
        let mut at: Vec<f64> = values.iter().copied().take(spread.of_whole).collect();
        let mut last: Option<(Vec<f64>, f64)> = None;
        let mut all = Vec::new();
        for pair in 0..pairs {
            at.truncate(spread.of_whole);
            at.extend(spread.all.iter().map(|local| spread.local(local, values, (patch, pair))));
            // Pairs of one patch may have the same values.
            let value = match last.take().filter(|(known, _)| *known == at) {
                Some((_, value)) => value,
                None => expression.value(&at)?,
            };
            last = Some((at.clone(), value));
            all.push(value);
        }
        Ok(all)
    }
}

/// A field over the face of each contact, with its coefficients among the parameters of the case.
fn over_faces(
    check: &Check<'_>,
    name: &str,
    OverField { kernel, length, share }: OverField,
    patches: &[Patch],
    parameters: &mut Vec<Parameter>,
) -> Result<Spread, CaseError> {
    let key = format!("parameters.{name}.over");
    let contacts = patches.last().map_or(0, |patch| patch.contact + 1);
    let mut of_patches = Vec::with_capacity(patches.len());
    for contact in 0..contacts {
        let own: Vec<&Patch> = patches.iter().filter(|patch| patch.contact == contact).collect();
        let areas: Vec<f64> = own.iter().flat_map(|patch| &patch.areas).copied().collect();
        let points: Vec<[f64; 3]> = own.iter().flat_map(|patch| &patch.places).map(|place| place.position).collect();
        if areas.len() != points.len() || areas.iter().sum::<f64>() <= 0.0 {
            let allowed =
                "\"patches\" of a contact between nodes, which have no area; fields are over faces, of [[contact]]";
            return Err(check.value(&key, "a field", allowed));
        }
        if points.len() > MOST_POINTS {
            let allowed = format!(
                "fields over at most {MOST_POINTS} points of a contact; Gauss points of larger faces, or \"patches\""
            );
            return Err(check.value(&key, format!("a field over {} points", points.len()), &allowed));
        }
        let Some(modes) = FieldModes::new(&points, &areas, (kernel, length), share) else {
            let allowed = "\"patches\" of a contact with points of negative area, or of none and far from all others";
            return Err(check.value(&key, "a field", allowed));
        };
        let (first, count) = (parameters.len(), modes.variances.len());
        let named = own.iter().map(|patch| patch.name.as_str()).collect::<Vec<_>>().join(", ");
        if count > MOST_MODES {
            let found = format!("a field of {count} modes over {named}");
            let allowed = format!("at most {MOST_MODES} modes: a longer length, or a smaller share");
            return Err(check.value(&key, found, &allowed));
        }
        check.note(format!(
            "parameters.{name}: a field over the face of {named}, of {count} modes, which have {:.4} of its variance at {} points; its mean over the face \
             varies with {:.3} times the variance that all modes would give it",
            modes.kept(),
            points.len(),
            modes.of_mean
        ));
        let of_mode = |number: usize| Parameter {
            name: format!("{name}.{}.mode{number}", contact + 1),
            unit: "deviations".into(),
            distribution: Distribution::Normal {
                mean: 0.0,
                deviation: 1.0,
                at_least: f64::NEG_INFINITY,
                at_most: None,
            },
        };
        parameters.extend((1..=count).map(of_mode));
        let mut row = 0;
        for patch in own {
            let shapes = modes.shapes.rows(row, patch.places.len()).into_owned();
            row += patch.places.len();
            of_patches.push(PatchField { coefficients: first..first + count, shapes });
        }
    }
    let identity = format!("{} {length} {share}", Kernel::name(kernel));
    Ok(Spread::Field { of_patches, identity })
}
