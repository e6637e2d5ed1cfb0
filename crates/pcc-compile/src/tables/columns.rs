//! The columns of a table of runs: what each of them means, by its name in the first line.
//!
//! | name | means |
//! |---|---|
//! | that of an input | its value, in the study's unit |
//! | `re_k`, `im_k` | an eigenvalue, k any whole number; of a conjugate pair one will do |
//! | `re_k_b` | the second of two real eigenvalues where `im_k` is 0, as result tables of pcc have it |
//! | `real_k` | an eigenvalue that is real in every row |
//! | `d_re_k_d_x`, `d_im_k_d_x`, `d_real_k_d_x` | the derivatives of eigenvalue k by input x |
//! | `error` | why the run failed; empty if it did not |
//!
//! Others are ignored, and named unless they are those of pcc's own tables.

use super::error::DataError;
use super::runs::cut;
use std::collections::HashMap;

/// Columns of pcc's own tables that say nothing new.
const OF_OUR_TABLES: [&str; 4] = ["run", "max_re", "stable", "verdict"];

/// The reason why a run failed.
const ERROR: &str = "error";

/// Where the parts of an eigenvalue stand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Slot {
    pub re: usize,
    /// None of an eigenvalue that is real in every row.
    pub im: Option<usize>,
    /// The second of two real eigenvalues.
    pub second: Option<usize>,
    /// The derivatives of its parts by each input, if there are any.
    pub slopes: Option<Vec<[Option<usize>; 2]>>,
}

/// Where everything stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Columns {
    /// The names in the first line.
    pub names: Vec<String>,
    pub inputs: Vec<usize>,
    pub slots: Vec<Slot>,
    pub error: Option<usize>,
    /// Names of columns that mean nothing.
    pub ignored: Vec<String>,
}

/// Names of an eigenvalue's columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Label {
    Mode(u64),
    Real(u64),
}

impl Label {
    fn of(name: &str) -> Option<Self> {
        let number = |digits: &str| {
            let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
            // As it is written in other columns: re_01 is none.
            let number = is_number.then(|| digits.parse::<u64>().ok()).flatten();
            number.filter(|number| number.to_string() == digits)
        };
        let mode = name.strip_prefix("re_").and_then(number).map(Self::Mode);
        mode.or_else(|| name.strip_prefix("real_").and_then(number).map(Self::Real))
    }

    fn re(self) -> String {
        match self {
            Self::Mode(k) => format!("re_{k}"),
            Self::Real(k) => format!("real_{k}"),
        }
    }

    fn im(self) -> Option<String> {
        match self {
            Self::Mode(k) => Some(format!("im_{k}")),
            Self::Real(_) => None,
        }
    }
}

/// Takes columns by their names, and knows which were taken.
struct Header<'h> {
    file: &'h str,
    names: &'h [String],
    by_name: HashMap<&'h str, Vec<usize>>,
    taken: Vec<bool>,
}

impl<'h> Header<'h> {
    fn new(file: &'h str, names: &'h [String]) -> Self {
        let mut by_name: HashMap<&str, Vec<usize>> = HashMap::new();
        names.iter().enumerate().for_each(|(at, name)| by_name.entry(name.as_str()).or_default().push(at));
        Self { file, names, by_name, taken: vec![false; names.len()] }
    }

    fn take(&mut self, name: &str) -> Result<Option<usize>, DataError> {
        match self.by_name.get(name).map(Vec::as_slice) {
            None => Ok(None),
            Some(&[at]) => {
                self.taken[at] = true;
                Ok(Some(at))
            }
            Some(_) => Err(DataError::SeveralTimes { file: self.file.to_owned(), column: name.to_owned() }),
        }
    }

    /// The column that belongs to one that is there.
    fn partner(&mut self, has: &str, name: String, remedy: &'static str) -> Result<usize, DataError> {
        let missing = |misses| DataError::NoPartner { file: self.file.to_owned(), has: has.to_owned(), misses, remedy };
        if !self.by_name.contains_key(name.as_str()) {
            return Err(missing(name));
        }
        Ok(self.take(&name)?.unwrap_or_default())
    }

    fn shown(&self) -> String {
        /// Characters of the header in a message.
        const SHOWN: usize = 200;
        let whole = self.names.join(", ");
        if whole.chars().count() > SHOWN { whole.chars().take(SHOWN).chain(['…']).collect() } else { whole }
    }

    fn slot(&mut self, label: Label, inputs: &[String]) -> Result<Slot, DataError> {
        let (re_name, im_name) = (label.re(), label.im());
        let re = self.take(&re_name)?.unwrap_or_default();
        let im = match &im_name {
            Some(im) => {
                let remedy = "add it, with 0 where the eigenvalue is real; or call one that is real in every row real_1 and so on";
                Some(self.partner(&re_name, im.clone(), remedy)?)
            }
            None => None,
        };
        let second = self.take(&format!("{re_name}_b"))?;
        Ok(Slot { re, im, second, slopes: self.slopes(&re_name, im_name.as_deref(), inputs)? })
    }

    /// The derivatives of one eigenvalue: by all inputs, or none.
    fn slopes(
        &mut self,
        re: &str,
        im: Option<&str>,
        inputs: &[String],
    ) -> Result<Option<Vec<[Option<usize>; 2]>>, DataError> {
        let parts = [Some(re), im];
        let name = |part: &str, input: &String| format!("d_{part}_d_{input}");
        let all = inputs.iter().flat_map(|input| parts.into_iter().flatten().map(move |part| name(part, input)));
        let Some(first) = all.into_iter().find(|name| self.by_name.contains_key(name.as_str())) else {
            return Ok(None);
        };
        let remedy = "give the derivatives of an eigenvalue by all inputs, or none of them";
        let mut slopes = Vec::with_capacity(inputs.len());
        for input in inputs {
            let mut of_input = [None; 2];
            for (column, part) in of_input.iter_mut().zip(parts) {
                *column = part.map(|part| self.partner(&first, name(part, input), remedy)).transpose()?;
            }
            slopes.push(of_input);
        }
        Ok(Some(slopes))
    }
}

impl Columns {
    /// Finds the columns of these inputs and of all eigenvalues.
    pub fn find(file: &str, names: Vec<String>, inputs: &[String]) -> Result<Self, DataError> {
        let mut header = Header::new(file, &names);
        let missing: Vec<String> =
            inputs.iter().filter(|input| !header.by_name.contains_key(input.as_str())).cloned().collect();
        if !missing.is_empty() {
            return Err(DataError::NoInputs { file: file.to_owned(), names: missing, header: header.shown() });
        }
        let mut of_inputs = Vec::with_capacity(inputs.len());
        for input in inputs {
            of_inputs.extend(header.take(input)?);
        }
        let mut labels: Vec<Label> = names.iter().filter_map(|name| Label::of(name)).collect();
        labels.sort_unstable();
        labels.dedup();
        if labels.is_empty() {
            return Err(DataError::NoEigenvalues { file: file.to_owned(), header: header.shown() });
        }
        let slots = labels.into_iter().map(|label| header.slot(label, inputs)).collect::<Result<Vec<_>, _>>()?;
        let error = if inputs.iter().any(|input| input == ERROR) { None } else { header.take(ERROR)? };
        for (at, name) in names.iter().enumerate().filter(|(at, _)| !header.taken[*at]) {
            if let Some(number) = name.strip_prefix("im_").filter(|rest| Label::of(&format!("re_{rest}")).is_some()) {
                let remedy = "add it";
                let (has, misses) = (names[at].clone(), format!("re_{number}"));
                return Err(DataError::NoPartner { file: file.to_owned(), has, misses, remedy });
            }
        }
        let is_unknown = |(at, name): &(usize, &String)| {
            !header.taken[*at] && !name.is_empty() && !OF_OUR_TABLES.contains(&name.as_str())
        };
        let ignored = names.iter().enumerate().filter(is_unknown).map(|(_, name)| cut(name)).collect();
        Ok(Self { inputs: of_inputs, slots, error, ignored, names })
    }

    /// Number of eigenvalues that a row has cells for.
    pub fn eigenvalues(&self) -> usize {
        self.slots.iter().map(|slot| 1 + usize::from(slot.second.is_some())).sum()
    }
}
