//! A brake given by its matrices in a case file.

use cycle::{ContactSystem, Part};
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::{Distribution, StreamRng};
use serde_json::{Map, Value, json};
use study::{
    DrawnContacts, DrawnInputs, Input, NamedParameter, Parametrised, Plan, Scene, SingleParameter, SlidingContacts,
    UncertainBrake,
};

use crate::any::{listed, with_family, with_unit};
use crate::case::{MatricesCase, Parameter, TableFunction, TakenMatrix};
use crate::{CaseBrake, Error};

/// The brake of a case with each of its sets of constraints. A sample is one value of each parameter.
#[derive(Debug)]
pub struct MatricesBrake {
    /// The case.
    pub case: MatricesCase,
    /// The scenes of the case, one for each set of constraints.
    pub plan: Plan,
}

impl MatricesBrake {
    /// Lays out the scenes of a case.
    ///
    /// # Errors
    /// [`study::Error::Median`] where the medians of the parameters have no operating point.
    pub fn new(case: MatricesCase) -> Result<Self, Error> {
        let failed = |source| study::Error::Median {
            study: case.header.path.display().to_string(),
            source: Box::new(Error::Case(source).into()),
        };
        let median = case.operating_point(&case.medians()).map_err(failed)?;
        let mut plan = case.header.plan(case.identity());
        for set in &case.constraints {
            plan.add_constraint_set(&set.name, case.brake(set)?, median.clone());
        }
        let has_losses = case.constraints.iter().any(|set| !set.dashpots.is_empty());
        plan.doubt_of_holds = has_losses.then(|| {
            "loss factors are dashpots of the brake without what a change holds, which are not those of the brake with it: \
             hold it by a set of [[constraints]], which has its own"
                .to_owned()
        });
        plan.labels.dofs.clone_from(&case.dofs);
        plan.labels.moves.clone_from(&case.moves);
        Ok(Self { case, plan })
    }

    /// The index of the only parameter that is not constant; `None` where no parameter varies, or several do.
    fn only_parameter(&self) -> Option<usize> {
        let mut varying = self.varying().map(|(at, _)| at);
        varying.next().filter(|_| varying.next().is_none())
    }

    /// The parameters of a case: `values`, by their indices, and all others at their medians.
    fn with_values(&self, values: &[(usize, f64)]) -> Vec<f64> {
        let mut sample = self.case.medians();
        values.iter().for_each(|&(place, value)| sample[place] = value);
        sample
    }

    /// Parameters that are not constant, with their indices.
    fn varying(&self) -> impl Iterator<Item = (usize, &Parameter)> {
        let varies =
            |(_, parameter): &(usize, &Parameter)| !matches!(parameter.distribution, Distribution::Constant { .. });
        self.case.parameters.iter().enumerate().filter(varies)
    }
}

impl UncertainBrake for MatricesBrake {
    type Sample = Vec<f64>;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Vec<f64>, study::Error> {
        Ok(self.case.draw(rng)?)
    }

    fn median(&self) -> Vec<f64> {
        self.case.medians()
    }

    fn operating_point(&self, _: &Scene, sample: &Vec<f64>) -> Result<OperatingPoint, study::Error> {
        Ok(self.case.operating_point(sample)?)
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<Vec<f64>>> {
        Some(self)
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        Some(self)
    }

    fn sliding_contacts(&self) -> Option<&dyn SlidingContacts> {
        Some(self)
    }

    fn drawn_contacts(&self) -> Option<&dyn DrawnContacts<Vec<f64>>> {
        Some(self)
    }
}

impl SlidingContacts for MatricesBrake {
    fn contact_system(
        &self,
        scene: &Scene,
        values: &[(usize, f64)],
        stick: f64,
    ) -> Result<ContactSystem, study::Error> {
        self.contact_system_of(scene, &self.with_values(values), stick)
    }
}

impl DrawnContacts<Vec<f64>> for MatricesBrake {
    fn contact_system_of(&self, scene: &Scene, sample: &Vec<f64>, stick: f64) -> Result<ContactSystem, study::Error> {
        let system = &self.plan.brake(scene).system;
        let at = self.case.operating_point(sample)?;
        let contacts = self.case.sliding_contacts(system.channels(), &at.channels, sample, stick)?;
        Ok(ContactSystem::new(Part::of_terms(system, &at.coefficients), contacts).map_err(Error::from)?)
    }
}

impl DrawnInputs<Vec<f64>> for MatricesBrake {
    fn inputs(&self, _: &Scene) -> Vec<Input> {
        let input = |(at, parameter): (usize, &Parameter)| Input {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            coordinate: at as u32,
            is_correlated: self.case.correlation.as_ref().is_some_and(|correlation| correlation.holds(at)),
            has_atoms: parameter.distribution.has_atoms(),
            jumps: parameter.distribution.jumps(),
        };
        self.varying().map(input).collect()
    }

    fn input_values(&self, _: &Scene, sample: &Vec<f64>) -> Vec<f64> {
        self.varying().map(|(at, _)| sample[at]).collect()
    }

    fn quantile_sample(&self, _: &Scene, uniform: &dyn Fn(u32) -> f64) -> Vec<f64> {
        let parameters = self.case.parameters.iter().zip(0..);
        let independent = parameters.map(|(parameter, dimension)| parameter.distribution.quantile(uniform(dimension)));
        self.case.correlated(independent.collect())
    }

    /// The one parameter that varies; `None` also of a case with tables, which may bend within any interval at whose ends and some places between a straight line is found.
    fn single_parameter(&self, _: &Scene) -> Option<SingleParameter<'_, Vec<f64>>> {
        let only = self.only_parameter().filter(|_| self.case.tables.is_empty())?;
        let with = move |value: f64| {
            let mut sample = self.median();
            sample[only] = value;
            sample
        };
        Some(SingleParameter::new(&self.case.parameters[only].distribution, with))
    }
}

impl Parametrised for MatricesBrake {
    fn parameters(&self, _: &Scene) -> Vec<NamedParameter> {
        let named = |parameter: &Parameter| NamedParameter {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            median: parameter.distribution.median(),
        };
        self.case.parameters.iter().map(named).collect()
    }

    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, study::Error> {
        self.system(scene, &self.with_values(values))
    }

    fn contact_points(&self, _: &Scene) -> Vec<String> {
        Vec::new()
    }

    fn closed_points(&self, _: &Scene, _: &[(usize, f64)]) -> Result<Vec<bool>, study::Error> {
        Ok(Vec::new())
    }
}

impl CaseBrake for MatricesBrake {
    fn contents(&self) -> Vec<(&'static str, String)> {
        let case = &self.case;
        let terms = case.system.terms().iter().map(|term| with_family(&term.name, &term.family));
        let contacts = case.system.contacts().map(|channel| with_family(&channel.name, &channel.family));
        let parameters = case.parameters.iter().map(|parameter| format!("{} [{}]", parameter.name, parameter.unit));
        let mut lines = vec![("dofs", case.dofs.len().to_string()), ("terms", listed(terms.collect()))];
        for (at, taken) in TakenMatrix::in_words(&case.taken).into_iter().enumerate() {
            lines.push((if at == 0 { "matrices" } else { "" }, taken));
        }
        let relaxing = case.branches.iter().map(|branch| branch.in_words(&case.system.terms()[branch.term].name));
        if !case.branches.is_empty() {
            lines.push(("viscoelastic", listed(relaxing.collect())));
        }
        lines.extend([("contacts", listed(contacts.collect())), ("parameters", listed(parameters.collect()))]);
        lines.extend(TableFunction::in_words(&case.tables).map(|words| ("tables", words)));
        lines.extend([
            ("bodies", listed(case.bodies.iter().map(|body| body.name.clone()).collect())),
            ("constraints", listed(self.plan.labels.constraints.clone())),
        ]);
        lines
    }

    fn medians_in_words(&self) -> String {
        let values = self.case.parameters.iter().zip(self.median());
        let values: Vec<String> = values.map(|(p, value)| with_unit(&p.name, value, &p.unit)).collect();
        match values.is_empty() {
            true => "no parameters".into(),
            false => format!("median parameters: {}", values.join(", ")),
        }
    }

    fn scene_json(&self) -> Value {
        let named = self.case.parameters.iter().zip(self.median()).map(|(p, value)| (p.name.clone(), json!(value)));
        json!({ "constraints": self.plan.labels.constraints[0], "parameters": named.collect::<Map<_, _>>() })
    }
}
