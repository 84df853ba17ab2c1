//! Kind of a matrix, by its name.

use crate::Kind;

/// Nastran's sets of degrees of freedom that a square matrix may be of.
const SETS: &str = "ABDEFGHJKLNOPQRSTUVXYZ";
/// Endings that may follow a set.
const AFTER_SET: [&str; 7] = ["", "X", "Z", "T", "P", "EXT", "EXTX"];
/// Endings that may follow a letter.
const AFTER_LETTER: [&str; 4] = ["", "MAT", "MATRIX", "RED"];

/// The kind by a usual name, in any case: `K`, `M`, `C`, `D` (damping), `B` (Nastran's damping), alone or with what programs add (`KGG`,
/// `MAAX`, `BHH`, `K2PP`, `KJJZ`, `Kmat`, `K_red`, `K1`, `matK`), or a name with `stif`, `mass` or `damp` in it. Of a member of a structure, `s.K`, the last
/// part counts. Names of structural damping (`K4GG`, `structural damping`) are of no kind.
pub(crate) fn kind_of(name: &str) -> Option<Kind> {
    if is_structural(name) {
        return None;
    }
    let plain = plain(name);
    let words = [("STIF", Kind::Stiffness), ("MASS", Kind::Mass), ("DAMP", Kind::Damping), ("DMPV", Kind::Damping)];
    let mut said = words.into_iter().filter(|(word, _)| plain.contains(word)).map(|(_, kind)| kind);
    match (said.next(), said.next()) {
        (Some(kind), None) => return Some(kind),
        (Some(_), Some(_)) => return None,
        _ => {}
    }
    let short = plain.strip_prefix("MAT").filter(|rest| rest.len() == 1).unwrap_or(plain.as_str());
    let (letter, rest) = short.split_at_checked(1)?;
    let kind = match letter {
        "K" => Kind::Stiffness,
        "M" => Kind::Mass,
        "B" | "C" | "D" => Kind::Damping,
        _ => return None,
    };
    let numbered = rest.len() <= 2 && rest.bytes().all(|b| b.is_ascii_digit());
    let after = rest.strip_prefix('2').unwrap_or(rest);
    let of_set = after.split_at_checked(2).is_some_and(|(set, end)| is_set(set) && AFTER_SET.contains(&end));
    (numbered || of_set || AFTER_LETTER.contains(&rest)).then_some(kind)
}

/// True for a name of structural damping, which is neither a viscous damping nor a stiffness.
pub(crate) fn is_structural(name: &str) -> bool {
    let plain = plain(name);
    // Words that begin so; the words of viscous damping do not.
    let mut words = name.split(|letter: char| !letter.is_ascii_alphanumeric()).map(str::to_uppercase);
    ["STRUCT", "HYST"].iter().any(|part| plain.contains(part))
        || words.any(|word| word.starts_with("SDAMP") || word.starts_with("DMPS"))
        || plain.starts_with("K4")
}

/// The letters and digits of the last part of a name, as capitals.
fn plain(name: &str) -> String {
    let last = name.rsplit('.').next().unwrap_or(name);
    last.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_uppercase()
}

fn is_set(letters: &str) -> bool {
    let mut each = letters.chars();
    matches!((each.next(), each.next()), (Some(a), Some(b)) if a == b && SETS.contains(a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_names_say_what_a_matrix_is() {
        let of = |names: &str, kind| {
            for name in names.split(' ') {
                assert_eq!(kind_of(name), kind, "{name}");
            }
        };
        of(
            "K k KGG KAA KAAX KLL KHH KXX KJJZ KFF K2GG K2PP KGGX Kmat K_mat K_red K1 K01 s.K a.b.k matK stiffness STIFF Stif1 global_stiffness",
            Some(Kind::Stiffness),
        );
        of("M m MGG MAAX MLL MHH MXX MJJX M2PP mass MASS_MATRIX M1 s.M MatM", Some(Kind::Mass));
        of(
            "C c D d B b BGG BAAX BLL BHH BXX B2GG CAA DHH damping DAMP viscous_damping C1 s.C matC",
            Some(Kind::Damping),
        );
        of(
            "K4 K4GG K4HH k4xx structural_damping hysteretic SDAMP matrix arr_0 A x KF MUG1T VAX EYE10 MATLAB Mode kappa mu dt DX kp S s.note 1K MEFT stiff_mass",
            None,
        );
        of("", None);
    }
}
