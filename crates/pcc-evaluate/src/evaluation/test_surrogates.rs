//! Surrogates written by hand, whose answers are known: for tests.

use crate::components::{Component, Output, OutputKind};
use crate::polynomials::{IndexSet, Mesh, MultiIndex};
use crate::probability::inputs::{Input, InputSpace, Marginal, Uniform};
use crate::surrogate::{
    Counts, Decision, Expansion, LeaveOut, Provenance, SelfTest, StopReason, Surrogate, Training, VerdictBasis,
};

/// The standardized variable ξ in terms of φ_1 = √3 ξ: the coefficient of φ_1.
pub const XI: f64 = 0.577_350_269_189_625_8;

/// The inputs x1, x2, … uniform between these bounds.
pub fn inputs(bounds: &[(f64, f64)]) -> InputSpace {
    let input = |(j, &(lower, upper)): (usize, &(f64, f64))| {
        Input::new(format!("x{}", j + 1), Marginal::Uniform(Uniform::new(lower, upper).unwrap()))
    };
    InputSpace::new(bounds.iter().enumerate().map(input).collect()).unwrap()
}

/// The expansion Σ c_α ψ_α of `terms`, given as (α, c_α).
pub fn expansion(terms: &[(&[u16], f64)]) -> Expansion {
    let mut terms: Vec<_> = terms.iter().map(|&(alpha, c)| (MultiIndex::new(alpha.to_vec()), c)).collect();
    terms.sort_by(|a, b| a.0.cmp(&b.0));
    let (indices, coefficients) = terms.into_iter().unzip();
    Expansion {
        indices: IndexSet::from_sorted(indices).unwrap(),
        coefficients,
        r2: None,
        s2: None,
        corrected_s2: None,
        leave_out: LeaveOut::Row,
        degree: 0,
        stop: StopReason::Accurate,
    }
}

/// A surrogate whose modes have these expansions for Re λ, and Im λ = 10, 11, …: max Re λ is the largest expansion.
pub fn surrogate(inputs: InputSpace, growth_rates: Vec<Expansion>) -> Surrogate {
    let (mut outputs, mut expansions) = (Vec::new(), Vec::new());
    for (mode, growth_rate) in growth_rates.into_iter().enumerate() {
        let component = |id: usize, center| Component { id, name: format!("component {id}"), center, scale: 1.0 };
        outputs.push(Output {
            kind: OutputKind::Eigenvalue,
            modes: vec![mode + 1],
            reals: Vec::new(),
            name: format!("mode {}", mode + 1),
            unit: "1/s".to_owned(),
            components: vec![component(2 * mode, 0.0), component(2 * mode + 1, 10.0 + mode as f64)],
        });
        expansions.extend([growth_rate, expansion(&[])]);
    }
    Surrogate {
        provenance: Provenance {
            tool_version: String::new(),
            study_name: "by hand".to_owned(),
            problem_hash: String::new(),
            study_hash: String::new(),
        },
        mesh: Mesh::whole(inputs.dimension()),
        inputs,
        outputs,
        expansions,
        training: Training {
            method: String::new(),
            settings: Vec::new(),
            design: String::new(),
            seed: 0,
            levels: Vec::new(),
            counts: Counts::default(),
        },
        decision: Decision::default(),
        self_test: SelfTest { points: Vec::new(), components: Vec::new(), max_re: Vec::new(), tolerance: 1e-9 },
        coverage: None,
        left_out: None,
        trained_domain: None,
        certificates: Vec::new(),
        verdict: VerdictBasis::default(),
    }
}

/// A surrogate with inputs on \[−1, 1\] and one mode, max Re λ = Σ c_α ψ_α.
pub fn polynomial(dimension: usize, terms: &[(&[u16], f64)]) -> Surrogate {
    surrogate(inputs(&vec![(-1.0, 1.0); dimension]), vec![expansion(terms)])
}

/// `work` on a pool of so many threads.
pub fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}
