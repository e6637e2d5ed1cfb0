//! Which parameters go together, law by law: what does not belong to one, or is missing.

use super::marginal_error::a_law;

/// A law, its forms, each with all of its keys, and keys that any of them can have besides.
type Forms = (&'static str, &'static [&'static [&'static str]], &'static [&'static str]);

const BOUNDS: &[&str] = &["lower", "upper"];

const FORMS: [Forms; 12] = [
    ("uniform", &[BOUNDS, &["nominal", "spread"]], &[]),
    ("normal", &[&["mean", "std"], &["mean", "cv"], &["nominal", "cv"]], BOUNDS),
    ("lognormal", &[&["mean", "std"], &["mean", "cv"], &["median", "cv"], &["nominal", "cv"]], &[]),
    ("gamma", &[&["mean", "std"], &["mean", "cv"], &["shape", "scale"], &["nominal", "cv"]], &[]),
    ("beta", &[&["alpha", "beta"], &["mean", "std"], &["mean", "cv"], &["nominal", "cv"]], BOUNDS),
    ("triangular", &[&["lower", "mode", "upper"]], &[]),
    ("log-uniform", &[BOUNDS], &[]),
    ("exponential", &[&["mean"]], &[]),
    ("weibull", &[&["shape", "scale"]], &[]),
    ("gumbel", &[&["location", "scale"], &["mean", "std"]], &[]),
    ("discrete", &[&["values"]], &["weights"]),
    ("data", &[&["file"]], &["column", "smoothing", "lower", "upper"]),
];

/// What is wrong with these keys, which are not those of the law.
pub(super) fn complaint<'a>(law: &str, given: impl Iterator<Item = &'a str>) -> String {
    let mut given: Vec<&str> = given.map(key).collect();
    given.sort_unstable();
    given.dedup();
    let Some(law) = FORMS.iter().find(|(known, ..)| *known == law) else { return String::new() };
    of_foreign(law, &given)
        .or_else(|| of_missing(law, &given))
        .unwrap_or_else(|| format!("{} are too many, remove some", given.join(", ")))
}

/// Keys that no form has.
fn of_foreign((law, forms, besides): &Forms, given: &[&str]) -> Option<String> {
    let belongs = |name: &&str| besides.contains(name) || forms.iter().any(|form| form.contains(name));
    let foreign: Vec<&str> = given.iter().copied().filter(|name| !belongs(name)).collect();
    let (verb, keys) = if foreign.len() == 1 { ("does", "that key") } else { ("do", "those keys") };
    let is_cut = foreign.iter().any(|name| BOUNDS.contains(name));
    let cut = if is_cut { format!(", and {} cannot be cut off", a_law(law)) } else { String::new() };
    (!foreign.is_empty()).then(|| format!("{} {verb} not belong to it{cut}; remove {keys}", foreign.join(" and ")))
}

/// Keys without which these are no form, in all forms that have these.
fn of_missing((law, forms, besides): &Forms, given: &[&str]) -> Option<String> {
    let missing = |form: &&[&'static str]| -> Option<Vec<&str>> {
        let is_of_it = given.iter().all(|name| form.contains(name) || besides.contains(name));
        is_of_it.then(|| form.iter().copied().filter(|name| !given.contains(name)).collect())
    };
    let mut missing: Vec<Vec<&str>> = forms.iter().filter_map(missing).collect();
    if *law == "beta" && missing.iter().any(Vec::is_empty) {
        // It has both bounds, or none.
        missing = BOUNDS.iter().filter(|name| !given.contains(name)).map(|name| vec![*name]).collect();
    }
    let verb = if missing.iter().all(|names| names.len() == 1) { "is" } else { "are" };
    let names: Vec<String> = missing.iter().map(|names| names.join(" and ")).collect();
    (!names.is_empty()).then(|| format!("{} {verb} missing", names.join(", or ")))
}

/// As study files call it, which have single values and their weights in lists.
fn key(name: &str) -> &str {
    match name {
        "value" => "values",
        "weight" => "weights",
        name => name,
    }
}

#[cfg(test)]
mod tests {
    use super::super::marginal::Marginal;
    use super::super::marginal_error::MarginalError;
    use super::super::parameters::Parameters;
    use super::*;

    #[test]
    fn every_form_is_one() {
        assert!(Marginal::names().eq(FORMS.iter().map(|(name, ..)| *name)));
        for (law, forms, besides) in FORMS.iter().filter(|(name, ..)| !["discrete", "data"].contains(name)) {
            for form in *forms {
                for besides in [&[][..], besides] {
                    let keys = form.iter().chain(besides.iter()).map(|name| (*name, 1.0));
                    let made = Marginal::named(law, &Parameters::of(keys));
                    assert!(!matches!(made, Err(MarginalError::Form { .. })), "{law}: {form:?}, {besides:?}");
                }
            }
        }
    }

    #[test]
    fn what_does_not_belong_or_is_missing_is_named() {
        for (law, given, expected) in [
            (
                "gamma",
                &["mean", "std", "lower"][..],
                "lower does not belong to it, and a gamma law cannot be cut off; remove that key",
            ),
            (
                "lognormal",
                &["lower", "mean", "cv", "upper"],
                "lower and upper do not belong to it, and a lognormal law cannot be cut off; remove those keys",
            ),
            ("normal", &["mean", "std", "mode"], "mode does not belong to it; remove that key"),
            ("weibull", &["value", "value"], "values does not belong to it; remove that key"),
            ("normal", &["mean"], "std, or cv is missing"),
            ("normal", &["mean", "lower"], "std, or cv is missing"),
            ("weibull", &[], "shape and scale are missing"),
            ("triangular", &["lower"], "mode and upper are missing"),
            ("beta", &["alpha", "beta", "lower"], "upper is missing"),
            ("gumbel", &["mean", "scale"], "mean, scale are too many, remove some"),
            ("normal", &["mean", "std", "cv"], "cv, mean, std are too many, remove some"),
            ("discrete", &[], "values is missing"),
            ("data", &["lower"], "file is missing"),
            ("data", &["file", "mean"], "mean does not belong to it; remove that key"),
        ] {
            assert_eq!(complaint(law, given.iter().copied()), expected, "{law} {given:?}");
        }
    }
}
