//! Which numbers belong together because rounding does not tell them apart.

use num_complex::Complex;

/// Positions of the members of each group: neighbours are nearer to each other than `reach` of one of them.
pub(super) fn groups(lambdas: &[Complex<f64>], reach: impl Fn(Complex<f64>) -> f64) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..lambdas.len()).collect();
    order.sort_by(|&a, &b| lambdas[a].im.total_cmp(&lambdas[b].im));
    // The group of each as the one before it in its group, itself for the first.
    let mut first: Vec<usize> = (0..lambdas.len()).collect();
    let root = |first: &[usize], mut i: usize| {
        while first[i] != i {
            i = first[i];
        }
        i
    };
    for (at, &i) in order.iter().enumerate() {
        let own = reach(lambdas[i]);
        for &j in &order[at + 1..] {
            if lambdas[j].im - lambdas[i].im > own {
                break;
            }
            if (lambdas[j] - lambdas[i]).norm() <= own {
                let (a, b) = (root(&first, i), root(&first, j));
                first[a.max(b)] = a.min(b);
            }
        }
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); lambdas.len()];
    (0..lambdas.len()).for_each(|i| members[root(&first, i)].push(i));
    members.retain(|group| !group.is_empty());
    members
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_of_neighbours_are_groups() {
        let lambdas = [(0.0, 1.0), (5.0, 1.0), (0.9, 1.0), (1.8, 1.1), (5.0, 3.0), (5.0, 1.9)];
        let found = groups(&lambdas.map(|(re, im)| Complex::new(re, im)), |_| 1.0);
        assert_eq!(found, [vec![0, 2, 3], vec![1, 5], vec![4]]);
    }
}
