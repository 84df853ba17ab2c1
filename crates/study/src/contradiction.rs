//! What a brake of a user's own type forgets, or says twice and differently.

use montecarlo::DistributionFault;

/// A fault of a plan or a brake that would make a wrong number, found when a study is made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Contradiction {
    /// A list of a plan that has nothing.
    #[error("the plan has no {what}; allowed: at least one")]
    Empty {
        /// scenes, configurations.
        what: &'static str,
    },
    /// An index of a plan that is out of range.
    #[error("{of} has {what} {index}; there are {count}, numbered from 0, in {list}")]
    Index {
        /// What has the index: a scene or configuration by its place in the plan.
        of: String,
        /// What the index is of.
        what: &'static str,
        /// The index.
        index: usize,
        /// Length of the list.
        count: usize,
        /// The list.
        list: &'static str,
    },
    /// A scene that stands for no arrangement.
    #[error("scene {scene} has no members; allowed: places in the list of arrangements of its panel, at least one")]
    NoMembers {
        /// Its place in the plan.
        scene: usize,
    },
    /// An arrangement that two scenes, or one twice, stand for.
    #[error(
        "scenes {first} and {second} both stand for arrangement {member} of one set of constraints, law, speed range and panel"
    )]
    SceneTwice {
        /// The place of one in the plan.
        first: usize,
        /// The place of the other; the same where one scene has a member twice.
        second: usize,
        /// The arrangement, by its place in the list of the panel.
        member: usize,
    },
    /// A body with a degree of freedom that does not exist.
    #[error("the body {body:?} of {of} owns degree of freedom {dof}; there are {order}, numbered from 0")]
    BodyDof {
        /// Configuration or origin.
        of: String,
        /// The body.
        body: String,
        /// The degree of freedom.
        dof: usize,
        /// How many there are.
        order: usize,
    },
    /// A body that has a degree of freedom twice.
    #[error("the body {body:?} of {of} owns degree of freedom {dof} twice")]
    BodyDofTwice {
        /// Configuration or origin.
        of: String,
        /// The body.
        body: String,
        /// The degree of freedom.
        dof: usize,
    },
    /// Degrees of freedom or sectors of another system.
    #[error("{of} has {found} {what}; its equations have {order} degrees of freedom")]
    Order {
        /// Configuration or origin.
        of: String,
        /// Free degrees of freedom, or degrees of freedom in its sectors.
        what: &'static str,
        /// How many.
        found: usize,
        /// Those of its terms.
        order: usize,
    },
    /// A band that is no range of positive numbers.
    #[error("the band of the plan is {from} to {to} rad/s; allowed: 0 <= from < to, both finite")]
    Band {
        /// Its lower end.
        from: f64,
        /// Its upper end.
        to: f64,
    },
    /// A parameter of a distribution that is not allowed.
    #[error("the distribution of {parameter}: {fault}")]
    Distribution {
        /// Name of the parameter that is drawn.
        parameter: String,
        /// Which number of the distribution, and what is allowed.
        fault: DistributionFault,
    },
    /// Two of one name.
    #[error("the {what} {name:?} is there twice; allowed: names that differ")]
    NameTwice {
        /// Kind of what is named.
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
        /// Its place in the plan.
        configuration: usize,
        /// The number that differs.
        what: String,
        /// At the naming point.
        named: f64,
        /// At the medians.
        median: f64,
        /// The scene in words.
        scene: String,
    },
    /// Two ways to one sample, or to the system of one, that lead to different numbers.
    #[error("{scene}: {one} and {other} differ: {what} is {found} by the first and {expected} by the second")]
    Differ {
        /// The scene in words.
        scene: String,
        /// One way.
        one: String,
        /// The other.
        other: String,
        /// The number that differs.
        what: String,
        /// By the first way.
        found: f64,
        /// By the second.
        expected: f64,
    },
    /// Not one value for each input.
    #[error(
        "{scene}: inputs() lists {inputs}, input_values() has {values} of a sample; allowed: one value for each input"
    )]
    InputValues {
        /// The scene in words.
        scene: String,
        /// Inputs.
        inputs: usize,
        /// Values.
        values: usize,
    },
    /// An input that is no function of its coordinate.
    #[error(
        "{scene}: the input {input:?} keeps its value when its coordinate {coordinate} of quantile_sample() changes"
    )]
    IdleCoordinate {
        /// The scene in words.
        scene: String,
        /// The input.
        input: String,
        /// Its coordinate.
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
        /// The input.
        input: String,
        /// The coordinate.
        coordinate: u32,
        /// Whose coordinate it is.
        other: String,
    },
    /// A scene that is said to depend on one parameter, and does not.
    #[error("{scene}: single_parameter() has a distribution, but {found}")]
    NotSingle {
        /// The scene in words.
        scene: String,
        /// What is there instead.
        found: String,
    },
    /// A parameter by which nothing changes.
    #[error(
        "{scene}: system_with() has the same system whatever the value of {parameter:?}, which parameters() lists; tried: {tried}"
    )]
    IdleParameter {
        /// The scene in words.
        scene: String,
        /// The parameter.
        parameter: String,
        /// The values.
        tried: String,
    },
    /// A value that is lost where several parameters have one.
    #[error(
        "{scene}: system_with() with values of {parameter:?} and others is that with the value of {parameter:?} alone"
    )]
    LostValues {
        /// The scene in words.
        scene: String,
        /// The parameter whose value alone counts.
        parameter: String,
    },
}
