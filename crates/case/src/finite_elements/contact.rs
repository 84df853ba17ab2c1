//! The contact of a finite element case: pairs of nodes at the same places, in patches.

use linsys::Channel;
use nalgebra::Vector3;
use nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{SparseSecondOrder, SparseTerm};

use super::entries::{AxisTable, LateralEntry, SlidingEntry};
use super::missing::MissingRows;
use super::nodes::Model;
use super::schema::ContactTable;
use super::side::{Side, sides};
use super::{PairPlace, Patch};
use crate::CaseError;

/// The directions x, y and z.
const TRANSLATIONS: [u32; 3] = [1, 2, 3];
/// Least speed of a pair as a part of the mean; chosen: nearer to the axis rounding would say where the disc slides.
const LEAST_SPEED: f64 = 1e-6;
/// Difference of two distances, as a fraction of the tolerance, up to which two nodes are as near; chosen: of decks, whose coordinates have seven digits, nodes
/// at one place are there exactly.
const AS_NEAR: f64 = 1e-6;
/// Least part of the sliding that lies in the plane of the contact; chosen: below it rounding would say where to.
const IN_PLANE: f64 = 1e-9;

/// The patches with their terms (one spring normal to the contact in each pair) and channels (friction in each pair).
pub(super) struct Patches {
    pub patches: Vec<Patch>,
    pub terms: Vec<SparseTerm>,
    pub channels: Vec<Channel>,
    /// Evidence in the mesh that the pad and the disc are on their sides of the contact.
    pub sides: [Side; 2],
    /// Nodes of the contact that the matrices have no rows of.
    pub missing: Vec<MissingRows>,
}

/// A pair of nodes, the normal from the disc into the pad, the direction in which the disc slides under the pad, and how fast it does as a
/// multiple of the speed of a scene.
struct Pair {
    nodes: [i64; 2],
    position: Vector3<f64>,
    gap: f64,
    normal: Vector3<f64>,
    sliding: Vector3<f64>,
    speed: f64,
}

impl Patches {
    /// The patches of a contact between nodes, with a channel for the spring of each pair where `has_springs` says that these differ.
    pub fn new(model: &Model<'_>, contact: &ContactTable, has_springs: bool) -> Result<Self, CaseError> {
        let check = model.check;
        let positive = |field: &str, value: f64, what: &str| match value.is_finite() && value > 0.0 {
            true => Ok(value),
            false => Err(check.value(field, value, what)),
        };
        let stiffness = {
            let allowed = format!("a stiffness in {}, > 0, of all pairs together", check.units.of("N/m"));
            positive("contact.stiffness", contact.stiffness, &allowed)?
        };
        let load = positive("contact.load", contact.load, "a force in N, > 0, on each closed patch")?;
        positive("contact.tolerance", contact.tolerance, "a distance, > 0")?;
        if contact.patches.is_empty() {
            return Err(check.value("contact.patches", "[]", "one node set or more"));
        }
        check.no_repeats("contact.patches", contact.patches.iter().map(|name| name.to_ascii_uppercase()))?;
        let pairs = matched(model, contact)?;
        let nodes_of =
            |pairs: &[&Pair]| [0, 1].map(|side| pairs.iter().map(|pair| pair.nodes[side]).collect::<Vec<i64>>());
        let [pad, disc] = nodes_of(&pairs.iter().collect::<Vec<_>>());
        let missing = [("contact.pad", &pad), ("contact.disc", &disc)]
            .map(|(field, nodes)| model.missing_rows(field, nodes, &TRANSLATIONS).transpose());
        let missing = missing.into_iter().flatten().collect::<Result<_, _>>()?;
        let normal = pairs.first().map_or_else(Vector3::zeros, |pair| pair.normal);
        let sides = sides(model, [&pad, &disc], &normal)?;
        let mut owners: Vec<Option<&str>> = vec![None; pairs.len()];
        let mut out = Self { patches: Vec::new(), terms: Vec::new(), channels: Vec::new(), sides, missing };
        let of_pair = stiffness / pairs.len() as f64;
        for name in &contact.patches {
            check.plain_name("contact.patches", name)?;
            let nodes = model.nodes("contact.patches", std::slice::from_ref(name))?;
            let own: Vec<usize> = (0..pairs.len()).filter(|&at| nodes.contains(&pairs[at].nodes[0])).collect();
            if own.is_empty() {
                return Err(check.value("contact.patches", format!("{name:?}"), "a set with nodes of contact.pad"));
            }
            for &at in &own {
                if let Some(other) = owners[at].replace(name) {
                    let found = format!("node {} in {other:?} and {name:?}", pairs[at].nodes[0]);
                    return Err(check.value("contact.patches", found, "each node of contact.pad in one patch"));
                }
            }
            let own: Vec<&Pair> = own.iter().map(|&at| &pairs[at]).collect();
            for nodes in nodes_of(&own) {
                // Of a patch some nodes may be held, which was counted above.
                model.missing_rows(&format!("contact.patches {name:?}"), &nodes, &TRANSLATIONS)?;
            }
            let is_lateral = contact.lateral != Some(LateralEntry::None);
            out.add(model, name, own, (of_pair, load), [is_lateral, has_springs])?;
        }
        match owners.iter().position(Option::is_none) {
            None => Ok(out),
            Some(at) => {
                let found = format!("node {} of contact.pad in none", pairs[at].nodes[0]);
                let allowed = "each node of contact.pad in one patch; what does not touch belongs out of contact.pad";
                Err(check.value("contact.patches", found, allowed))
            }
        }
    }

    /// Adds a patch, whose pairs share its load equally.
    ///
    /// The spring presses with `N = k n^T (u_disc - u_pad)`, so that a channel reads `r = k (n on the pad, -n on the disc)`, and
    /// friction mu N pulls the pad along the sliding and the disc against it: `b = (t on the pad, -t on the disc)`. Where friction has the
    /// direction of the sliding, a motion across that turns it: a channel across the sliding reads no normal force.
    fn add(
        &mut self,
        model: &Model<'_>,
        name: &str,
        pairs: Vec<&Pair>,
        (stiffness, load): (f64, f64),
        [is_lateral, has_springs]: [bool; 2],
    ) -> Result<(), CaseError> {
        let (order, first) = (model.dofs.len(), self.channels.len());
        let (mut across, mut springs) = (Vec::new(), Vec::new());
        let mut k = CooMatrix::new(order, order);
        for pair in &pairs {
            let relative = |v: &Vector3<f64>| {
                let sides = pair.nodes.into_iter().zip([1.0, -1.0]);
                let entries = sides.flat_map(|(node, sign)| (1..=3).map(move |d| (node, d, sign)));
                let entries =
                    entries.filter_map(|(node, d, sign)| Some((model.row(node, d)?, sign * v[d as usize - 1])));
                entries.filter(|&(_, value)| value != 0.0).collect::<Vec<(usize, f64)>>()
            };
            let (gap, force) = (relative(&pair.normal), relative(&pair.sliding));
            for &(i, a) in &gap {
                gap.iter().for_each(|&(j, b)| k.push(i, j, stiffness * a * b));
            }
            let reading: Vec<(usize, f64)> = gap.iter().map(|&(dof, value)| (dof, stiffness * value)).collect();
            let [pad, disc] = pair.nodes;
            if has_springs {
                springs.push(Channel::new(format!("{pad}/{disc} spring"), "contact", gap, reading.clone()));
            }
            self.channels.push(Channel::new(format!("{pad}/{disc}"), format!("friction {name}"), force, reading));
            if is_lateral {
                let force = relative(&pair.normal.cross(&pair.sliding));
                let [name, family] = [format!("{pad}/{disc} across"), format!("lateral friction {name}")];
                across.push(Channel::new(name, family, force, Vec::new()));
            }
        }
        self.channels.extend(across);
        self.channels.extend(springs);
        let zero = || CscMatrix::zeros(order, order);
        let matrices = SparseSecondOrder::new(zero(), zero(), (&k).into()).map_err(model.check.sparse("contact"))?;
        self.terms.push(SparseTerm { name: name.into(), family: "contact".into(), matrices, loss: 0.0 });
        let load = load / pairs.len() as f64;
        let speeds = pairs.iter().map(|pair| pair.speed).collect();
        let place = |pair: &&Pair| PairPlace {
            position: pair.position.into(),
            normal: pair.normal.into(),
            sliding: pair.sliding.into(),
            gap: pair.gap,
        };
        let places = pairs.iter().map(place).collect();
        let springs = vec![stiffness; pairs.len()];
        let pairs: Vec<[i64; 2]> = pairs.iter().map(|pair| pair.nodes).collect();
        let (channels, shares) = (first..self.channels.len(), vec![1.0; pairs.len()]);
        self.patches.push(Patch {
            name: name.into(),
            pairs,
            speeds,
            channels,
            springs,
            load,
            shares,
            places,
            points: Vec::new(),
            areas: Vec::new(),
            contact: 0,
        });
        Ok(())
    }
}

/// Pairs of the contact: each node of the pad with the nearest one of the disc, which must lie within the tolerance.
fn matched(model: &Model<'_>, contact: &ContactTable) -> Result<Vec<Pair>, CaseError> {
    let check = model.check;
    let pad = model.nodes("contact.pad", contact.pad.items())?;
    let disc = model.nodes("contact.disc", contact.disc.items())?;
    let unit = |field: &str, v: [f64; 3]| {
        let v = Vector3::from(v);
        v.try_normalize(0.0).filter(|unit| unit.iter().all(|x| x.is_finite())).ok_or_else(|| {
            check.value(field, format!("{:?}", <[f64; 3]>::from(v)), "a direction of three finite numbers, not all 0")
        })
    };
    let normal = unit("contact.normal", contact.normal)?;
    let positions = disc
        .iter()
        .map(|&node| Ok(Vector3::from(model.position("contact.disc", node)?)))
        .collect::<Result<Vec<_>, CaseError>>()?;
    let mut pairs = Vec::with_capacity(pad.len());
    let mut taken = vec![None; disc.len()];
    for &node in &pad {
        let place = Vector3::from(model.position("contact.pad", node)?);
        let distance = |at: &usize| (positions[*at] - place).norm();
        let nearest = (0..disc.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(nearest) = nearest.filter(|at| distance(at) <= contact.tolerance) else {
            let away = nearest.map_or(f64::INFINITY, |at| distance(&at));
            let found = format!("node {node}, {away:.3e} from the nearest node of contact.disc");
            let allowed = format!("nodes within contact.tolerance = {} of one of the disc", contact.tolerance);
            return Err(check.value("contact.pad", found, &allowed));
        };
        // Which of several nodes is meant would follow from their numbers.
        let own = disc.contains(&node).then(|| "itself, in contact.disc too".to_owned());
        let as_near = (0..disc.len()).find(|at| {
            *at != nearest
                && disc[*at] != disc[nearest]
                && distance(at) <= distance(&nearest) + AS_NEAR * contact.tolerance
        });
        let both =
            as_near.map(|at| format!("nodes {} and {} of contact.disc, which are as near", disc[nearest], disc[at]));
        if let Some(others) = own.or(both) {
            let allowed = "one node of the disc next to each; [[contact]] is for faces whose nodes do not match";
            return Err(check.value("contact.pad", format!("node {node} at {others}"), allowed));
        }
        if let Some(other) = taken[nearest].replace(node) {
            let found = format!("nodes {other} and {node} at node {} of contact.disc", disc[nearest]);
            return Err(check.value("contact.pad", found, "a node of the disc for each"));
        }
        let velocity = match contact.sliding {
            SlidingEntry::Direction(direction) => unit("contact.sliding", direction)?,
            SlidingEntry::About(about) => {
                unit("contact.sliding.axis", about.axis)?.cross(&(place - Vector3::from(about.through)))
            }
        };
        // Friction acts in the plane of the contact.
        let (whole, velocity) = (velocity.norm(), velocity - normal * normal.dot(&velocity));
        let speed = velocity.norm();
        if !speed.is_finite() || speed <= IN_PLANE * whole {
            let (found, what) = match contact.sliding {
                SlidingEntry::Direction(direction) => (format!("{direction:?}"), "a direction"),
                SlidingEntry::About(AxisTable { axis, through }) => {
                    (format!("{{ axis = {axis:?}, through = {through:?} }}"), "an axis about which the disc moves")
                }
            };
            let allowed = format!("{what} across contact.normal = {:?} at node {node} of contact.pad", contact.normal);
            return Err(check.value("contact.sliding", found, &allowed));
        }
        let sliding = velocity / speed;
        let gap = normal.dot(&(place - positions[nearest]));
        pairs.push(Pair { nodes: [node, disc[nearest]], position: place, gap, normal, sliding, speed });
    }
    // A direction has one speed, up to rounding.
    let is_direction = matches!(contact.sliding, SlidingEntry::Direction(_));
    let mean = pairs.iter().map(|pair| pair.speed).sum::<f64>() / pairs.len() as f64;
    for pair in &mut pairs {
        pair.speed = if is_direction { 1.0 } else { pair.speed / mean };
        if !(pair.speed.is_finite() && pair.speed >= LEAST_SPEED) {
            let found = format!(
                "node {} of contact.pad, {:e} times as far from the axis as the mean",
                pair.nodes[0], pair.speed
            );
            return Err(check.value("contact.sliding", found, "an axis that goes through no pair of the contact"));
        }
    }
    Ok(pairs)
}
