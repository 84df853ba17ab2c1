//! The contact arrangements of a case, from numbers in contact or from lists.

use osc_model::ContactArrangement;

use super::CaseError;
use super::check::Check;
use super::schema::ContactTable;

/// Most arrangements of a case; chosen: each has a scene in memory.
const MOST_ARRANGEMENTS: usize = 100_000;

/// The arrangements of a case by number in contact, in the order of the file.
pub(super) fn arrangements_by_number(
    check: &Check<'_>,
    contact: &ContactTable,
    oscillators: usize,
) -> Result<Vec<(usize, Vec<ContactArrangement>)>, CaseError> {
    let mut panels: Vec<(usize, Vec<ContactArrangement>)> = Vec::new();
    match (contact.in_contact.as_slice(), contact.arrangements.as_slice()) {
        ([], []) => {
            return Err(check.value(
                "contact",
                "empty",
                "in_contact = [numbers] or arrangements = [[oscillators], ..]",
            ));
        }
        (numbers, []) => {
            check.no_repeats("contact.in_contact", numbers.iter().map(usize::to_string))?;
            for &number in numbers {
                if !(1..=oscillators).contains(&number) {
                    return Err(check.value("contact.in_contact", number, &format!("1 to {oscillators}")));
                }
                let so_far: usize = panels.iter().map(|(_, list)| list.len()).sum();
                if so_far.saturating_add(choices(oscillators, number)) > MOST_ARRANGEMENTS {
                    let allowed = format!("numbers with at most {MOST_ARRANGEMENTS} arrangements in all");
                    return Err(check.value("contact.in_contact", number, &allowed));
                }
                let all = ContactArrangement::all(oscillators, number).map_err(check.lattice("contact.in_contact"))?;
                panels.push((number, all));
            }
        }
        ([], arrangements) => {
            for numbers in arrangements {
                let arrangement = ContactArrangement::from_numbers(oscillators, numbers)
                    .map_err(check.lattice("contact.arrangements"))?;
                if numbers.is_empty() {
                    return Err(check.value("contact.arrangements", "[]", "one oscillator or more"));
                }
                match panels.iter_mut().find(|(number, _)| *number == numbers.len()) {
                    Some((_, list)) if list.contains(&arrangement) => {
                        return Err(check.value("contact.arrangements", format!("[{arrangement}]"), "each once"));
                    }
                    Some((_, list)) => list.push(arrangement),
                    None => panels.push((numbers.len(), vec![arrangement])),
                }
            }
        }
        (_, _) => return Err(check.value("contact", "both", "in_contact or arrangements, not both")),
    }
    Ok(panels)
}

/// The binomial coefficient of `all` over `chosen`, at most `usize::MAX`.
fn choices(all: usize, chosen: usize) -> usize {
    (0..chosen.min(all.saturating_sub(chosen)))
        .try_fold(1_usize, |count, i| Some(count.checked_mul(all - i)? / (i + 1)))
        .unwrap_or(usize::MAX)
}
