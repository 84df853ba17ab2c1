//! Contradictions of a brake of a user's own type: what it forgets, or says twice and differently.

use montecarlo::DistributionFault;

/// A fault of a plan or a brake that would make a wrong number, found when a study is made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Contradiction {
    /// A list of a plan that has nothing.
    #[error("the plan has no {what}; allowed: at least one")]
    Empty {
        /// "scenes" or "configurations".
        what: &'static str,
    },
    /// An index of a plan that is out of range.
    #[error("{of} has {what} {index}; there are {count}, numbered from 0, in {list}")]
    Index {
        /// Owner of the index: a scene or configuration by its index in the plan.
        of: String,
        /// Kind of thing that is indexed.
        what: &'static str,
        /// The index.
        index: usize,
        /// Length of the list.
        count: usize,
        /// Name of the list.
        list: &'static str,
    },
    /// A scene that stands for no arrangement.
    #[error("scene {scene} has no members; allowed: places in the list of arrangements of its panel, at least one")]
    NoMembers {
        /// Index of the scene in the plan.
        scene: usize,
    },
    /// An arrangement that two scenes, or one twice, stand for.
    #[error(
        "scenes {first} and {second} both stand for arrangement {member} of one set of constraints, law, speed range and panel"
    )]
    SceneTwice {
        /// Index of one scene in the plan.
        first: usize,
        /// Index of the other scene; the same where one scene has a member twice.
        second: usize,
        /// Index of the arrangement in the list of the panel.
        member: usize,
    },
    /// A body with a degree of freedom that does not exist.
    #[error("the body {body:?} of {of} owns degree of freedom {dof}; there are {order}, numbered from 0")]
    BodyDof {
        /// Configuration or origin.
        of: String,
        /// Name of the body.
        body: String,
        /// Index of the degree of freedom, from 0.
        dof: usize,
        /// Number of degrees of freedom.
        order: usize,
    },
    /// A body that has a degree of freedom twice.
    #[error("the body {body:?} of {of} owns degree of freedom {dof} twice")]
    BodyDofTwice {
        /// Configuration or origin.
        of: String,
        /// Name of the body.
        body: String,
        /// Index of the degree of freedom, from 0.
        dof: usize,
    },
    /// A brake with degrees of freedom or sectors of another system.
    #[error("{of} has {found} {what}; its equations have {order} degrees of freedom")]
    Order {
        /// Configuration or origin.
        of: String,
        /// Kind of count: free degrees of freedom, or degrees of freedom in its sectors.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number of degrees of freedom of its equations.
        order: usize,
    },
    /// A band that is no range of finite numbers, none of them negative.
    #[error("the band of the plan is {from} to {to} rad/s; allowed: 0 <= from < to, both finite")]
    Band {
        /// Lower end of the band, rad/s.
        from: f64,
        /// Upper end of the band, rad/s.
        to: f64,
    },
    /// A parameter of a distribution that is not allowed.
    #[error("the distribution of {parameter}: {fault}")]
    Distribution {
        /// Name of the parameter that is drawn.
        parameter: String,
        /// Number of the distribution that is not allowed, and the allowed values.
        fault: DistributionFault,
    },
    /// Two things of one name.
    #[error("the {what} {name:?} is there twice; allowed: names that differ")]
    NameTwice {
        /// Kind of the two.
        what: &'static str,
        /// Name of both.
        name: String,
    },
    /// A naming point that is no operating point of the medians.
    #[error(
        "configuration {configuration} is named at another point than its medians: {what} is {named} there, and {median} of the sample \
         of median() in {scene}"
    )]
    Medians {
        /// Index of the configuration in the plan.
        configuration: usize,
        /// The number that differs.
        what: String,
        /// Value at the naming point.
        named: f64,
        /// Value at the medians.
        median: f64,
        /// The scene in words.
        scene: String,
    },
    /// Two ways to one sample, or to the system of one, that lead to different numbers.
    #[error("{scene}: {one} and {other} differ: {what} is {found} by the first and {expected} by the second")]
    Differ {
        /// The scene in words.
        scene: String,
        /// First way.
        one: String,
        /// Second way.
        other: String,
        /// The number that differs.
        what: String,
        /// Value by the first way.
        found: f64,
        /// Value by the second way.
        expected: f64,
    },
    /// Numbers of inputs and of their values that differ.
    #[error(
        "{scene}: inputs() lists {inputs}, input_values() has {values} of a sample; allowed: one value for each input"
    )]
    InputValues {
        /// The scene in words.
        scene: String,
        /// Number of inputs.
        inputs: usize,
        /// Number of values of a sample.
        values: usize,
    },
    /// An input that is no function of its coordinate.
    #[error(
        "{scene}: the input {input:?} keeps its value when its coordinate {coordinate} of quantile_sample() changes"
    )]
    IdleCoordinate {
        /// The scene in words.
        scene: String,
        /// Name of the input.
        input: String,
        /// Coordinate of the input in [`DrawnInputs::quantile_sample`](crate::DrawnInputs::quantile_sample).
        coordinate: u32,
    },
    /// An input that changes with the coordinate of another, although it is said to depend on none.
    #[error(
        "{scene}: the input {input:?} changes with coordinate {coordinate} of quantile_sample(), which is that of {other:?}; allowed: \
         is_correlated, for inputs that depend on others"
    )]
    SharedCoordinate {
        /// The scene in words.
        scene: String,
        /// Name of the input.
        input: String,
        /// Coordinate that both change with.
        coordinate: u32,
        /// Name of the input that the coordinate belongs to.
        other: String,
    },
    /// A scene that is said to depend on one parameter, and does not.
    #[error("{scene}: single_parameter() has a distribution, but {found}")]
    NotSingle {
        /// The scene in words.
        scene: String,
        /// Finding that contradicts it.
        found: String,
    },
    /// A parameter by which nothing changes.
    #[error(
        "{scene}: system_with() has the same system whatever the value of {parameter:?}, which parameters() lists; tried: {tried}"
    )]
    IdleParameter {
        /// The scene in words.
        scene: String,
        /// Name of the parameter.
        parameter: String,
        /// Values tried.
        tried: String,
    },
    /// A value that is lost where several parameters have one.
    #[error(
        "{scene}: system_with() with values of {parameter:?} and others is that with the value of {parameter:?} alone"
    )]
    LostValues {
        /// The scene in words.
        scene: String,
        /// Name of the parameter whose value alone counts.
        parameter: String,
    },
}
