//! Inputs: their laws, and how they are shown.

use super::error::StudyError;
use super::model::Kind;
use super::raw;
use super::validate::Lines;
use crate::mechanics::model::Parameter;
use pcc_evaluate::components::is_result_column;
use pcc_evaluate::probability::inputs::{
    Description, DescriptionError, Input, InputSpace, Marginal, MarginalError, Parameters, Polynomials,
};
use std::path::Path;
use toml::Spanned;

/// Orders of magnitude of an input that an expansion follows: as many as doubles have digits. Over twelve of them
/// estimated errors are too small by a factor of a few, over seventeen and more by ten, and builds take minutes.
const MOST_ORDERS: f64 = 16.0;

impl Lines<'_> {
    /// The inputs in their order.
    pub(super) fn inputs(
        &self,
        table: Spanned<raw::Ordered<raw::Input>>,
        kind: Kind,
        folder: &Path,
    ) -> Result<InputSpace, StudyError> {
        let place = self.place("inputs", &table);
        let mut inputs = Vec::new();
        for (name, raw) in table.into_inner().0 {
            let parameter = self.parameter_of_kind(kind, "inputs", &name, &raw)?;
            if is_result_column(&name) {
                return Err(StudyError::ResultColumn { place: self.place(format!("inputs.{name}"), &raw), name });
            }
            let marginal = self.marginal(&name, parameter, &raw, folder)?;
            inputs.push(Input { description: self.unit_and_label(&name, raw.get_ref())?, marginal, name });
        }
        InputSpace::new(inputs).map_err(|cause| StudyError::Inputs { place, cause })
    }

    fn marginal(
        &self,
        name: &str,
        parameter: Option<&Parameter>,
        raw: &Spanned<raw::Input>,
        folder: &Path,
    ) -> Result<Marginal, StudyError> {
        let key = format!("inputs.{name}");
        let input = raw.get_ref();
        let laws: Vec<(&str, ())> = Marginal::names().map(|name| (name, ())).collect();
        self.word(&format!("{key}.distribution"), &input.distribution, &laws)?;
        let place = self.place(&key, raw);
        let spread = input.spread.as_ref().map(|spread| self.spread(&key, spread)).transpose()?;
        let cv = input.cv.as_ref().map(|cv| self.variation(&key, cv)).transpose()?;
        let given = [
            ("lower", input.lower),
            ("upper", input.upper),
            ("nominal", input.nominal),
            ("spread", spread),
            ("mean", input.mean),
            ("std", input.std),
            ("cv", cv),
            ("median", input.median),
            ("shape", input.shape),
            ("scale", input.scale),
            ("location", input.location),
            ("alpha", input.alpha),
            ("beta", input.beta),
            ("mode", input.mode),
        ];
        let polynomials = input.polynomials.as_ref();
        let polynomials =
            polynomials.map(|word| self.word(&format!("{key}.polynomials"), word, &Polynomials::ALL)).transpose()?;
        let mut given: Vec<(&str, f64)> = given.into_iter().filter_map(|(name, value)| Some((name, value?))).collect();
        let law = match input.distribution.get_ref().as_str() {
            "data" => self.measured(&key, input, &given, folder)?,
            law => levels(input).and_then(|levels| {
                // Equal weights are nobody's key.
                let is_key = |name: &str| law == "discrete" || name == "value" || input.weights.is_some();
                given.extend(levels.into_iter().filter(|(name, _)| is_key(name)));
                given.extend(of_data(input).map(|name| (name, 0.0)));
                Marginal::named(law, &Parameters::of(given).with_polynomials(polynomials))
            }),
        };
        let marginal = law.map_err(|cause| match cause {
            MarginalError::Form { law: "uniform", .. } => StudyError::DistributionForm { place: place.clone() },
            cause => StudyError::Distribution { place: place.clone(), cause },
        })?;
        if let Some(found) = marginal.orders_of_magnitude().filter(|found| found.is_nan() || *found > MOST_ORDERS) {
            return Err(StudyError::TooWide { place, law: marginal.name(), found, most: MOST_ORDERS });
        }
        let [lower, upper] = marginal.support();
        if let Some(parameter) = parameter.filter(|p| !p.range.holds_nearly_all_of(&marginal)) {
            let expected = match lower.is_finite() && upper.is_finite() {
                true => format!("{} over the whole interval", parameter.range.describe()),
                false => {
                    let is_cut = ["normal", "data"].contains(&marginal.name());
                    let remedy =
                        if is_cut { "cut the law off with lower, or choose another" } else { "choose another law" };
                    format!("{} but for a billionth of all values; {remedy}", parameter.range.describe())
                }
            };
            return Err(StudyError::OutOfRange { place, found: format!("from {lower:?} to {upper:?}"), expected });
        }
        Ok(marginal)
    }

    fn unit_and_label(&self, name: &str, input: &raw::Input) -> Result<Description, StudyError> {
        type Add = fn(Description, &str) -> Result<Description, DescriptionError>;
        let mut description = Description::default();
        let keys: [(_, _, Add); 2] = [
            ("unit", &input.unit, |to, text| to.with_unit(text)),
            ("label", &input.label, |to, text| to.with_label(text)),
        ];
        for (key, text, add) in keys {
            if let Some(text) = text {
                description = add(description, text.get_ref()).map_err(|cause| StudyError::Description {
                    place: self.place(format!("inputs.{name}.{key}"), text),
                    cause,
                })?;
            }
        }
        Ok(description)
    }
}

/// Levels with their weights.
fn levels(input: &raw::Input) -> Result<Vec<(&'static str, f64)>, MarginalError> {
    let values = input.values.as_deref().unwrap_or_default();
    let weights = input.weights.clone().unwrap_or_else(|| vec![1.0; values.len()]);
    if weights.len() != values.len() {
        return Err(MarginalError::Weights { values: values.len(), weights: weights.len() });
    }
    Ok(values.iter().zip(weights).flat_map(|(value, weight)| [("value", *value), ("weight", weight)]).collect())
}

/// Keys that measured values alone have, and that are given.
pub(super) fn of_data(input: &raw::Input) -> impl Iterator<Item = &'static str> {
    let keys =
        [("file", input.file.is_some()), ("column", input.column.is_some()), ("smoothing", input.smoothing.is_some())];
    keys.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use crate::study::{Study, StudyError};

    fn study(input: &str) -> Result<Study, StudyError> {
        Study::from_toml(&format!(
            "format = 1\nname = \"s\"\n[model]\nkind = \"matrices\"\nM = [[1]]\nK = [[\"k\"]]\n[inputs]\nk = {{ distribution = \
             \"uniform\", {input} }}\n"
        ))
    }

    fn refusal(input: &str) -> String {
        study(input).unwrap_err().to_string()
    }

    #[test]
    fn units_and_labels_are_kept_printed_and_change_no_hash() {
        let plain = study("lower = 1.0, upper = 2.0").unwrap();
        let texts = ["unit = \" N/m \"", "label = \"Steifigkeit \\\"k\\\", e\\u0301, 'µ' \\\\\""];
        for given in [texts[0].to_owned(), texts[1].to_owned(), texts.join(", ")] {
            let described = study(&format!("lower = 1.0, upper = 2.0, {given}")).unwrap();
            assert_ne!(described, plain);
            assert_eq!(Study::from_toml(&described.to_toml()).unwrap(), described, "{}", described.to_toml());
            assert_eq!(described.problem_hash(), plain.problem_hash());
            assert_eq!(described.study_hash(), plain.study_hash());
            assert_eq!(described.model_hash(), plain.model_hash());
            assert!(described.inputs.is_same_as(&plain.inputs));
        }
        let both = study(&format!("lower = 1.0, upper = 2.0, {}", texts.join(", "))).unwrap();
        assert_eq!(both.inputs.inputs()[0].description.unit(), Some("N/m"));
        assert_eq!(both.inputs.inputs()[0].description.label(), Some("Steifigkeit \"k\", e\u{301}, 'µ' \\"));
        assert!(both.to_toml().contains("upper = 2.0, unit = \"N/m\", label = "), "{}", both.to_toml());
    }

    #[test]
    fn units_and_labels_that_cannot_be_shown_are_refused_with_key_and_line() {
        let long = "m".repeat(81);
        let cases = [
            ("unit = \"\"", "unit: is empty"),
            ("unit = \"N\\n/m\"", "unit: has control characters"),
            (&format!("unit = \"{}\"", &long[..41]), "unit: has 41 characters; write at most 40"),
            ("label = \"  \"", "label: is empty"),
            ("label = \"\\u001b[31mred\"", "label: has control characters"),
            (&format!("label = \"{long}\""), "label: has 81 characters; write at most 80"),
        ];
        for (given, expected) in cases {
            let message = refusal(&format!("lower = 1.0, upper = 2.0, {given}"));
            assert!(message.starts_with(&format!("line 8: inputs.k.{expected}")), "{message}");
        }
        assert!(refusal("lower = 1.0, upper = 2.0, unit = 3").contains("expected a text in quotes"));
    }
}
