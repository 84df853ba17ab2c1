//! The arrangements of contacts that the first stage looks at.

use brakes::case::LatticeCase;
use squeal::osc_model::LatticeModel;

use crate::Error;

/// Number of symmetry classes, of the arrangements with one number in contact, of which one is kept; chosen.
const ONE_OF: usize = 6;
/// Most classes of one number in contact that are all kept: those with eight and nine in contact.
const KEPT_ALWAYS: usize = 4;

/// Leaves of the arrangements of a case a part that represents them: every sixth symmetry class.
///
/// # Errors
/// Those of the model.
pub fn thin(case: &mut LatticeCase) -> Result<(), Error> {
    let model = LatticeModel::new(case.lattice.clone(), case.readings.lateral, &[])?;
    for (_, arrangements) in &mut case.panels {
        let classes = model.symmetry_classes(&model.symmetries(), arrangements)?;
        let step = if classes.len() <= KEPT_ALWAYS { 1 } else { ONE_OF };
        let kept = classes.iter().step_by(step).flat_map(|class| &class.members);
        let mut places: Vec<usize> = kept.map(|member| member.arrangement).collect();
        places.sort_unstable();
        *arrangements = places.into_iter().map(|place| arrangements[place].clone()).collect();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sixth_class_is_left() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml");
        let mut case = LatticeCase::read(&path).unwrap();
        let whole = case.panels.clone();
        thin(&mut case).unwrap();
        let model = LatticeModel::new(case.lattice.clone(), case.readings.lateral, &[]).unwrap();
        let classes = |panels: &[(usize, Vec<_>)]| -> Vec<usize> {
            panels.iter().map(|(_, list)| model.symmetry_classes(&model.symmetries(), list).unwrap().len()).collect()
        };
        assert_eq!(classes(&whole), [1, 4, 13, 27]);
        assert_eq!(classes(&case.panels), [1, 4, 3, 5]);
        for ((number, list), (of_whole, all)) in case.panels.iter().zip(&whole) {
            assert_eq!(number, of_whole);
            assert!(list.iter().all(|arrangement| all.contains(arrangement)));
            // Classes are kept whole: no kept arrangement has a mirror image among those left out.
            let left_out: Vec<_> = all.iter().filter(|a| !list.contains(a)).cloned().collect();
            let both: Vec<_> = list.iter().chain(&left_out).cloned().collect();
            let together = model.symmetry_classes(&model.symmetries(), &both).unwrap().len();
            assert_eq!(together, classes(&[(0, list.clone()), (0, left_out)]).iter().sum::<usize>());
        }
    }
}
