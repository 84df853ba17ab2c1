//! A brake of Python: a case, and where Python gives them, coefficients by a callable and samples of the user's own.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use brakes::case::{CaseFile, ChosenSpeed, MatricesCase, SceneChoice};
use brakes::{AnyBrake, CaseBrake, MatricesBrake, Purpose};
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::{MonteCarloError, StreamRng, index_of, stream};
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use squeal::identity::Identity;
use squeal::memory;
use squeal::study::{Cost, DrawnInputs, Erased, Input, NamedParameter, Parametrised, Plan, Scene, UncertainBrake};
use squeal_cli::bar::Stages;
use squeal_cli::{Error, override_run};

use crate::away::Watch;
use crate::errors;

/// Draws at which a study asks for single operating points before it samples: as many as it looks for anchors among, the most. A callable
/// computes them at once.
const FIRST_DRAWS: u64 = 64;

/// A brake as Python holds it.
#[pyclass(frozen, module = "squeal._squeal")]
pub(crate) struct Brake {
    pub(crate) source: Source,
}

/// Parts of which a brake is made.
#[derive(Clone)]
pub(crate) struct Source {
    case: CaseFile,
    computed: Option<Arc<Computed>>,
    /// Rows of values of the parameters, in their order.
    design: Option<Arc<Vec<Vec<f64>>>>,
}

/// Coefficients by a callable.
struct Computed {
    callable: Py<PyAny>,
    /// Targets of the callable, by the names that it uses.
    targets: Vec<(String, Target)>,
}

/// A number of an operating point.
#[derive(Clone, Copy)]
enum Target {
    /// The coefficient of a term.
    Coefficient(usize),
    /// The coefficient of friction of a contact.
    Mu(usize),
    /// The slope of a contact.
    Slope(usize),
}

/// Law, contacts and set of constraints of a scene that is chosen.
type Scenes = (Option<String>, Option<Vec<usize>>, Option<String>);

#[pymethods]
impl Brake {
    /// The brake of a case file with fields set, or of its text; `is_open` where a callable computes coefficients.
    #[new]
    fn new(py: Python<'_>, path: PathBuf, set: Vec<String>, text: Option<String>, is_open: bool) -> PyResult<Self> {
        let read = || match text {
            None => CaseFile::read_with(&path, &set),
            Some(text) if is_open => {
                MatricesCase::parse_open(&path, text).map(|(case, _)| CaseFile::Matrices(Box::new(case)))
            }
            Some(text) => CaseFile::parse(&path, text),
        };
        let mut case = py.detach(read).map_err(|error| errors::raised(py, &error.into()))?;
        case.header_mut().commit = squeal_cli::commit();
        Ok(Self { source: Source { case, computed: None, design: None } })
    }

    /// The brake with other samples and another seed.
    fn with_run(&self, py: Python<'_>, samples: Option<u64>, seed: Option<u64>) -> PyResult<Self> {
        let source = self.source.clone().with_run(samples, seed).map_err(|error| errors::raised(py, &error))?;
        Ok(Self { source })
    }

    /// The brake with one scene: at a speed, with speeds drawn from a range, or at the median.
    fn only(
        &self,
        py: Python<'_>,
        scene: Scenes,
        speed: Option<f64>,
        range: Option<String>,
        is_drawn: bool,
    ) -> PyResult<Self> {
        let speed = match speed {
            Some(speed) => ChosenSpeed::Fixed(speed),
            None if is_drawn => ChosenSpeed::Range(range),
            None => ChosenSpeed::Median,
        };
        let (law, contact, constraints) = scene;
        let choice = SceneChoice { law, contact, constraints, speed };
        let case = self.source.case.clone().only(&choice).map_err(|error| errors::raised(py, &error.into()))?;
        Ok(Self { source: Source { case, ..self.source.clone() } })
    }

    /// The brake whose callable computes the coefficients with these names.
    fn with_callable(&self, py: Python<'_>, callable: Py<PyAny>, names: Vec<String>) -> PyResult<Self> {
        let CaseFile::Matrices(case) = &self.source.case else { return Err(not_matrices(py, "coefficients")) };
        let terms =
            case.system.terms().iter().enumerate().map(|(at, term)| (term.name.clone(), Target::Coefficient(at)));
        let channels = case.system.channels().iter().enumerate().flat_map(|(at, channel)| {
            [(format!("{}.mu", channel.name), Target::Mu(at)), (format!("{}.slope", channel.name), Target::Slope(at))]
        });
        let known: Vec<(String, Target)> = terms.chain(channels).collect();
        let target = |name: &String| known.iter().find(|(of, _)| of == name).cloned();
        let found = names.iter().map(|name| target(name).ok_or(name)).collect::<Result<Vec<_>, _>>();
        let targets = found.map_err(|name| {
            let allowed = known.iter().map(|(name, _)| format!("{name:?}")).collect::<Vec<_>>().join(", ");
            errors::argument(py, "coefficients", &format!("{name:?}"), &allowed)
        })?;
        let computed = Some(Arc::new(Computed { callable, targets }));
        Ok(Self { source: Source { computed, ..self.source.clone() } })
    }

    /// The brake whose samples are the rows of a table of its parameters.
    fn with_design(&self, py: Python<'_>, values: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        if !matches!(self.source.case, CaseFile::Matrices(_)) {
            return Err(not_matrices(py, "design"));
        }
        let rows = values.as_array().rows().into_iter().map(|row| row.to_vec()).collect();
        Ok(Self { source: Source { design: Some(Arc::new(rows)), ..self.source.clone() } })
    }

    /// Name, unit and median of each parameter of a brake given by its matrices.
    fn parameters(&self, py: Python<'_>) -> PyResult<Vec<(String, String, f64)>> {
        let CaseFile::Matrices(case) = &self.source.case else { return Err(not_matrices(py, "brake")) };
        Ok(case.parameters.iter().map(|p| (p.name.clone(), p.unit.clone(), p.distribution.median())).collect())
    }

    /// Sentences that the user of the case should know.
    fn notes(&self) -> Vec<String> {
        self.source.case.header().notes.clone()
    }

    /// Name of the study, samples, seed, names of the sets of constraints.
    fn header(&self) -> (String, u64, u64, Vec<String>) {
        let (header, sets) = (self.source.case.header(), self.source.case.constraint_sets());
        (header.name.clone(), header.samples, header.seed, sets.into_iter().map(str::to_owned).collect())
    }
}

fn not_matrices(py: Python<'_>, argument: &str) -> PyErr {
    errors::argument(py, argument, "given for a lattice or finite elements", "a brake given by its matrices")
}

impl Source {
    /// The half width that the case asks for.
    pub(crate) fn half_width(&self) -> Option<f64> {
        self.case.header().half_width
    }

    /// The same with other samples and another seed.
    pub(crate) fn with_run(mut self, samples: Option<u64>, seed: Option<u64>) -> Result<Self, Error> {
        override_run(self.case.header_mut(), samples, seed, None)?;
        Ok(self)
    }

    /// Refuses a brake that does not give its contacts, before its reduction, which would take long.
    pub(crate) fn has_motion(&self) -> Result<(), Error> {
        squeal_cli::has_motion(&self.case, "brake", &self.case.header().name)
    }

    /// The brake, for a purpose, if the machine has the memory for it; it is made on this many threads.
    pub(crate) fn brake(
        self,
        purpose: Purpose<'_>,
        threads: Option<usize>,
        watch: &Arc<Watch>,
    ) -> Result<AnyBrake, Error> {
        let budget = memory::of_machine();
        if let Some(cost) = brakes::cost_of_making(&self.case, purpose, budget) {
            cost.check(&self.case.header().source(), budget)?;
        }
        let Self { case, computed, design } = self;
        let brake: AnyBrake = match case {
            CaseFile::Matrices(case) if computed.is_some() || design.is_some() => {
                Box::new(Erased(PythonBrake::new(*case, computed, design, Arc::clone(watch))?))
            }
            case => {
                let pool = squeal::workers(threads)?;
                watch.preparing(|| pool.install(|| brakes::make(case, purpose, &*watch.stage("reductions"))))?
            }
        };
        if brake.mode_source().is_none() {
            Cost::of(brake.plan()).check(&brake.plan().source(), budget)?;
        }
        Ok(brake)
    }
}

/// A brake given by its matrices, with what Python computes.
struct PythonBrake {
    inner: MatricesBrake,
    computed: Option<Arc<Computed>>,
    design: Option<Arc<Vec<Vec<f64>>>>,
    watch: Arc<Watch>,
    /// The operating point at the medians, of a brake with a callable.
    median: Option<OperatingPoint>,
    /// Operating points at the first draws, by the bits of these, of a brake with a callable.
    first: OnceLock<HashMap<Vec<u64>, OperatingPoint>>,
    /// Held while the callable is asked.
    asked: Mutex<()>,
}

impl PythonBrake {
    fn new(
        case: MatricesCase,
        computed: Option<Arc<Computed>>,
        design: Option<Arc<Vec<Vec<f64>>>>,
        watch: Arc<Watch>,
    ) -> Result<Self, Error> {
        let mut inner = MatricesBrake::new(case)?;
        if let Some(rows) = &design {
            let plan = &mut inner.plan;
            let identity = Identity::read(&plan.name, &plan.identity);
            let written = |to: &mut squeal::identity::Written| {
                to.list(&**rows, |to, row| to.list(row, |to, &value| to.number(value)))
            };
            plan.identity = identity.part("design", written).into_line();
        }
        let (first, asked) = (OnceLock::new(), Mutex::new(()));
        let mut brake = Self { inner, computed, design, watch, median: None, first, asked };
        if brake.computed.is_some() {
            let median = brake.point(&brake.inner.case.medians())?;
            let plan = &mut brake.inner.plan;
            plan.origins.iter_mut().for_each(|origin| origin.naming_point = median.clone());
            plan.configurations.iter_mut().for_each(|of| of.naming_point = median.clone());
            brake.median = Some(median);
        }
        Ok(brake)
    }

    /// The sample with `values`, by the indices of their parameters, and else the medians.
    fn with_values(&self, values: &[(usize, f64)]) -> Vec<f64> {
        let mut sample = self.inner.case.medians();
        for &(place, value) in values {
            sample[place] = value;
        }
        sample
    }

    /// The operating point at a sample; the operating point of the medians is not asked for again.
    fn point(&self, sample: &Vec<f64>) -> Result<OperatingPoint, squeal::study::Error> {
        match &self.median {
            Some(median) if *sample == self.inner.case.medians() => Ok(median.clone()),
            _ => self.points(&[sample]).pop().unwrap_or_else(|| Err(MonteCarloError::Cancelled.into())),
        }
    }

    /// The operating points at the first draws; draws without an operating point are left out.
    fn first(&self) -> HashMap<Vec<u64>, OperatingPoint> {
        let seed = self.inner.plan.seed;
        let draws: Vec<_> = (0..FIRST_DRAWS).filter_map(|index| self.draw(&mut stream(seed, index)).ok()).collect();
        let points = self.points(&draws.iter().collect::<Vec<_>>());
        draws.iter().zip(points).filter_map(|(draw, point)| Some((bits(draw), point.ok()?))).collect()
    }

    fn points(&self, samples: &[&Vec<f64>]) -> Vec<Result<OperatingPoint, squeal::study::Error>> {
        let own = samples.iter().map(|sample| Ok(self.inner.case.operating_point(sample)?));
        let Some(computed) = &self.computed else { return own.collect() };
        let cancelled = || samples.iter().map(|_| Err(MonteCarloError::Cancelled.into())).collect();
        let asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        // Looked at where nothing waits any more: the callable may take long.
        let values = Python::attach(|py| match self.watch.is_cancelled() {
            true => Ok(None),
            false => computed.values(py, &self.inner.case, samples).map(Some),
        });
        drop(asked);
        match values {
            Ok(None) => cancelled(),
            Ok(Some(columns)) => {
                let with = |(at, point): (usize, Result<OperatingPoint, squeal::study::Error>)| {
                    let mut point = point?;
                    for ((name, target), column) in computed.targets.iter().zip(&columns) {
                        if !column[at].is_finite() {
                            let found = format!("coefficients: {name:?} = {}; allowed: a finite number", column[at]);
                            return Err(squeal::study::Error::Brake(found.into()));
                        }
                        match *target {
                            Target::Coefficient(term) => point.coefficients[term] = column[at],
                            Target::Mu(channel) => point.channels[channel].mu = column[at],
                            Target::Slope(channel) => point.channels[channel].slope = column[at],
                        }
                    }
                    Ok(point)
                };
                own.enumerate().map(with).collect()
            }
            Err(error) => {
                self.watch.raise(error);
                cancelled()
            }
        }
    }
}

/// The bits of a sample.
fn bits(sample: &[f64]) -> Vec<u64> {
    sample.iter().map(|value| value.to_bits()).collect()
}

impl Computed {
    /// Values of each target that the callable computes for samples.
    fn values(&self, py: Python<'_>, case: &MatricesCase, samples: &[&Vec<f64>]) -> PyResult<Vec<Vec<f64>>> {
        let given = PyDict::new(py);
        for (at, parameter) in case.parameters.iter().enumerate() {
            let values: Vec<f64> = samples.iter().map(|sample| sample[at]).collect();
            given.set_item(&parameter.name, values.into_pyarray(py))?;
        }
        let names: Vec<&str> = self.targets.iter().map(|(name, _)| name.as_str()).collect();
        let checked =
            py.import("squeal._brake")?.getattr("computed")?.call1((&self.callable, given, names, samples.len()))?;
        let columns: Vec<Bound<'_, numpy::PyArray1<f64>>> = checked.extract()?;
        columns.iter().map(|column| Ok(column.to_vec()?)).collect()
    }
}

impl UncertainBrake for PythonBrake {
    type Sample = Vec<f64>;

    fn plan(&self) -> &Plan {
        self.inner.plan()
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Vec<f64>, squeal::study::Error> {
        let Some(rows) = &self.design else { return self.inner.draw(rng) };
        let index = index_of(rng);
        let row = usize::try_from(index).ok().and_then(|at| rows.get(at));
        row.cloned().ok_or_else(|| {
            let allowed = format!("below {}, the rows of the design", rows.len());
            squeal::study::Error::Brake(
                squeal::Error::Argument { argument: "sample", value: index.to_string(), allowed }.into(),
            )
        })
    }

    fn median(&self) -> Vec<f64> {
        self.inner.median()
    }

    fn operating_point(&self, _: &Scene, sample: &Vec<f64>) -> Result<OperatingPoint, squeal::study::Error> {
        if self.computed.is_none() || *sample == self.inner.case.medians() {
            return self.point(sample);
        }
        let known = self.first.get_or_init(|| self.first()).get(&bits(sample));
        known.map_or_else(|| self.point(sample), |point| Ok(point.clone()))
    }

    fn operating_points(&self, _: &Scene, samples: &[&Vec<f64>]) -> Vec<Result<OperatingPoint, squeal::study::Error>> {
        self.points(samples)
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<Vec<f64>>> {
        // Samples of the user's own have no quantiles.
        if self.design.is_some() { None } else { Some(self) }
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        Some(self)
    }
}

impl DrawnInputs<Vec<f64>> for PythonBrake {
    fn inputs(&self, scene: &Scene) -> Vec<Input> {
        self.inner.inputs(scene)
    }

    fn input_values(&self, scene: &Scene, sample: &Vec<f64>) -> Vec<f64> {
        self.inner.input_values(scene, sample)
    }

    fn quantile_sample(&self, scene: &Scene, uniform: &dyn Fn(u32) -> f64) -> Vec<f64> {
        self.inner.quantile_sample(scene, uniform)
    }

    fn single_parameter(&self, scene: &Scene) -> Option<squeal::study::SingleParameter<'_, Vec<f64>>> {
        self.inner.single_parameter(scene)
    }
}

impl Parametrised for PythonBrake {
    fn parameters(&self, scene: &Scene) -> Vec<NamedParameter> {
        self.inner.parameters(scene)
    }

    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, squeal::study::Error> {
        Ok(self.plan().brake(scene).system.assemble(&self.point(&self.with_values(values))?)?)
    }

    fn systems_with(
        &self,
        scene: &Scene,
        values: &[Vec<(usize, f64)>],
    ) -> Vec<Result<SecondOrder, squeal::study::Error>> {
        let samples: Vec<_> = values.iter().map(|values| self.with_values(values)).collect();
        let points = self.points(&samples.iter().collect::<Vec<_>>());
        let system = &self.plan().brake(scene).system;
        points.into_iter().map(|point| Ok(system.assemble(&point?)?)).collect()
    }

    fn contact_points(&self, _: &Scene) -> Vec<String> {
        Vec::new()
    }

    fn closed_points(&self, _: &Scene, _: &[(usize, f64)]) -> Result<Vec<bool>, squeal::study::Error> {
        Ok(Vec::new())
    }
}

impl CaseBrake for PythonBrake {
    fn contents(&self) -> Vec<(&'static str, String)> {
        self.inner.contents()
    }

    fn medians_in_words(&self) -> String {
        self.inner.medians_in_words()
    }

    fn scene_json(&self) -> serde_json::Value {
        self.inner.scene_json()
    }
}
