//! Names of inputs, constants and helpers.

use super::error::ExpressionError;
use super::excerpt::excerpt;
use super::operation::function;

/// The constant π.
pub(super) const PI: &str = "pi";

/// Refused, because it means ln to some and log10 to others.
pub(super) const LOG: &str = "log";

/// Names that a message about an unknown one lists at most.
const MOST_LISTED: usize = 20;

/// Typing errors, insertions, deletions, replacements and swaps, up to which a name is taken for another one.
const MOST_TYPING_ERRORS: usize = 2;

/// Longer names are not compared, because the comparison takes the product of the lengths.
const LONGEST_COMPARED: usize = 100;

/// Whether a name may begin with the character.
pub(super) fn begins_name(character: char) -> bool {
    // The Greek alphabet with its accented letters and variants such as ϕ and ϵ.
    let is_greek = ('\u{370}'..='\u{3ff}').contains(&character) && character.is_alphabetic();
    character.is_ascii_alphabetic() || character == '_' || is_greek
}

/// Whether a name may go on with the character.
pub(super) fn continues_name(character: char) -> bool {
    begins_name(character) || character.is_ascii_digit()
}

/// Whether `name` can be given to an input, a constant or a helper.
pub(super) fn check(name: &str) -> Result<(), ExpressionError> {
    if !name.starts_with(begins_name) || !name.chars().all(continues_name) {
        return Err(ExpressionError::InvalidName { name: excerpt(name, 1) });
    }
    if name == PI || name == LOG || function(name).is_some() {
        return Err(ExpressionError::ReservedName { name: name.to_owned() });
    }
    Ok(())
}

/// The first of `names`, separated by commas.
pub(super) fn list(names: &[String]) -> String {
    let mut listed: Vec<String> = names.iter().take(MOST_LISTED).map(|name| excerpt(name, 1)).collect();
    if names.len() > MOST_LISTED {
        listed.push(format!("{} more", names.len() - MOST_LISTED));
    }
    listed.push(PI.to_owned());
    listed.join(", ")
}

/// The one of `names` that `name` looks like most, if any.
pub(super) fn closest<'n>(name: &str, names: &'n [String]) -> Option<&'n str> {
    if name == "π" {
        return Some(PI);
    }
    let length = name.chars().count();
    let is_comparable = |other: &str| other.len() <= LONGEST_COMPARED && length <= LONGEST_COMPARED;
    let candidates = names.iter().filter(|other| is_comparable(other)).map(|other| {
        let errors = strsim::damerau_levenshtein(&name.to_lowercase(), &other.to_lowercase());
        (errors, other.as_str())
    });
    // At least half of the name must be right: x does not look like y.
    let allowed = MOST_TYPING_ERRORS.min(length / 2);
    candidates.filter(|&(errors, _)| errors <= allowed).min_by_key(|&(errors, _)| errors).map(|(_, other)| other)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    #[test]
    fn names_have_letters_digits_and_underscores() {
        for name in ["k_A", "e", "E", "sin_beta", "pi_2", "max_k", "exp1", "_", "_1", "γ_1", "Ω", "ϕ", "μ", "Sin"] {
            assert_eq!(check(name), Ok(()), "{name}");
        }
        for name in ["", "1k", "k A", "k-A", "é", "µ", "k\n", "k.a", "٣", "a²"] {
            assert!(matches!(check(name), Err(ExpressionError::InvalidName { .. })), "{name}");
        }
        for name in ["sin", "pi", "log", "max", "atan2"] {
            assert!(matches!(check(name), Err(ExpressionError::ReservedName { .. })), "{name}");
        }
    }

    #[test]
    fn a_similar_name_is_found() {
        let known = names(&["mu", "k_p", "k_f", "gamma_1", "gamma_2"]);
        assert_eq!(closest("gama_2", &known), Some("gamma_2"));
        assert_eq!(closest("K_P", &known), Some("k_p"));
        assert_eq!(closest("x", &known), None);
        assert_eq!(closest("plate_mass", &known), None);
    }

    #[test]
    fn long_lists_are_shortened() {
        let many: Vec<String> = (0..23).map(|j| format!("x{j}")).collect();
        assert!(list(&many).ends_with("x18, x19, 3 more, pi"));
        assert_eq!(list(&names(&["mu"])), "mu, pi");
    }
}
