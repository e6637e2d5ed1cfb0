//! Groups of labels: what the components of a surrogate are made of.
//!
//! A label that oscillates at every point, always the same half of the same pair, can be a group by itself, *complex*:
//! its conjugate follows. A label that is real at one point and complex at another belongs to its partner there, and
//! the group is *closed under conjugation*; so is a label that is real everywhere, a group by itself. Every other group
//! is a union of these.

use super::labels::Labels;
use super::modes::Spectrum;
use crate::numerics::accuracy::Accuracy;
use nalgebra::Complex;
use pcc_evaluate::components::{MOST_IN_CLOSED_GROUP, MOST_MODES, OutputKind};

/// Labels that form one output.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Group {
    /// Ascending; of complex groups those with Im λ > 0 alone.
    labels: Vec<usize>,
    is_closed: bool,
}

impl Group {
    /// Its labels, ascending; of complex groups those with Im λ > 0 alone.
    pub fn labels(&self) -> &[usize] {
        &self.labels
    }

    /// Whether it is closed under conjugation.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Number of eigenvalues that its polynomial has.
    pub fn size(&self) -> usize {
        self.labels.len()
    }

    /// How its components form eigenvalues.
    pub fn kind(&self) -> OutputKind {
        match (self.is_closed, self.labels.len()) {
            (true, _) => OutputKind::Closed,
            (false, 1) => OutputKind::Eigenvalue,
            (false, _) => OutputKind::Cluster,
        }
    }

    /// Whether an output can hold it.
    pub fn is_possible(&self) -> bool {
        self.size() <= if self.is_closed { MOST_IN_CLOSED_GROUP } else { MOST_MODES }
    }
}

/// How the labels of a design can be grouped.
#[derive(Debug, Clone, PartialEq)]
pub struct Groups {
    /// The finest groups.
    finest: Vec<Group>,
    /// For each label its group among the finest, or the group of its conjugate.
    group_of: Vec<usize>,
    /// For each label of a complex group, either half, its conjugate; itself for the others.
    conjugate: Vec<usize>,
    /// For each label, whether it oscillates at some point.
    oscillates: Vec<bool>,
}

impl Groups {
    /// The finest groups of labels with these spectra, one per run.
    pub fn new(labels: &Labels, spectra: &[&Spectrum]) -> Self {
        let count = labels.count();
        // For each run, the partner of every label: itself where it is real.
        let partners: Vec<Vec<usize>> = spectra
            .iter()
            .enumerate()
            .map(|(run, spectrum)| {
                let mut label_at = vec![0; count];
                (0..count).for_each(|label| label_at[labels.position(run, label)] = label);
                (0..count).map(|label| label_at[spectrum.conjugate(labels.position(run, label))]).collect()
            })
            .collect();
        let im = |run: usize, label: usize| spectra[run].eigenvalues()[labels.position(run, label)].im;
        let runs = 0..spectra.len();
        let same_half = |label: usize| {
            let (first, partner) = (im(0, label), partners[0][label]);
            partner != label
                && runs.clone().all(|run| partners[run][label] == partner && (im(run, label) > 0.0) == (first > 0.0))
        };
        let is_complex: Vec<bool> = (0..count).map(|label| !spectra.is_empty() && same_half(label)).collect();
        let mut joined = Joined::new(count);
        for label in (0..count).filter(|&label| !is_complex[label]) {
            partners.iter().for_each(|at_run| joined.join(label, at_run[label]));
        }
        let (mut finest, mut group_of) = (Vec::new(), vec![0; count]);
        for label in 0..count {
            let is_lower_half = is_complex[label] && im(0, label) < 0.0;
            let is_first = is_complex[label] || joined.root(label) == label;
            if is_lower_half || !is_first {
                continue;
            }
            let members: Vec<usize> = match is_complex[label] {
                true => vec![label],
                false => (0..count).filter(|&other| joined.root(other) == label).collect(),
            };
            members.iter().for_each(|&member| group_of[member] = finest.len());
            if is_complex[label] {
                group_of[partners[0][label]] = finest.len();
            }
            finest.push(Group { labels: members, is_closed: !is_complex[label] });
        }
        let conjugate = (0..count).map(|label| if is_complex[label] { partners[0][label] } else { label }).collect();
        let oscillates = (0..count).map(|label| partners.iter().any(|at_run| at_run[label] != label)).collect();
        Self { finest, group_of, conjugate, oscillates }
    }

    /// The finest groups.
    pub fn finest(&self) -> &[Group] {
        &self.finest
    }

    /// The position of a label's group among the finest.
    pub fn of_label(&self, label: usize) -> usize {
        self.group_of[label]
    }

    /// Whether a label is the half of a pair with Im λ > 0 everywhere.
    pub fn is_upper_half(&self, label: usize) -> bool {
        let group = &self.finest[self.group_of[label]];
        !group.is_closed && group.labels[0] == label
    }

    /// The group with its conjugates.
    pub fn closed(&self, group: &Group) -> Group {
        if group.is_closed {
            return group.clone();
        }
        let mut labels: Vec<usize> = group.labels.iter().flat_map(|&label| [label, self.conjugate[label]]).collect();
        labels.sort_unstable();
        Group { labels, is_closed: true }
    }

    /// Two groups in one: closed if either is.
    pub fn union(&self, one: &Group, other: &Group) -> Group {
        if one.is_closed != other.is_closed {
            return self.union(&self.closed(one), &self.closed(other));
        }
        let mut labels = [&one.labels[..], &other.labels].concat();
        labels.sort_unstable();
        labels.dedup();
        Group { labels, is_closed: one.is_closed }
    }

    /// How many modes a group has, and real eigenvalues that belong to none.
    pub fn modes_and_reals(&self, group: &Group) -> (usize, usize) {
        if !group.is_closed {
            return (group.labels.len(), 0);
        }
        let oscillating = group.labels.iter().filter(|&&label| self.oscillates[label]).count();
        let modes = oscillating / 2;
        (modes, group.labels.len() - 2 * modes)
    }

    /// The eigenvalues of a group at a run, in the order in which components are made of them: those of complex groups
    /// by frequency, those of closed ones by |λ|.
    pub fn eigenvalues(&self, group: &Group, labels: &Labels, run: usize, spectrum: &Spectrum) -> Vec<Complex<f64>> {
        positions(group, labels, run, spectrum).into_iter().map(|position| spectrum.eigenvalues()[position]).collect()
    }

    /// The accuracy of each of these.
    pub fn accuracies(&self, group: &Group, labels: &Labels, run: usize, spectrum: &Spectrum) -> Vec<Accuracy> {
        positions(group, labels, run, spectrum).into_iter().map(|position| spectrum.accuracies()[position]).collect()
    }
}

fn positions(group: &Group, labels: &Labels, run: usize, spectrum: &Spectrum) -> Vec<usize> {
    let mut positions: Vec<usize> = group.labels.iter().map(|&label| labels.position(run, label)).collect();
    positions.sort_unstable();
    if !group.is_closed {
        let lambda = |position: usize| spectrum.eigenvalues()[position];
        positions.sort_by_key(|&position| spectrum.oscillating().iter().position(|other| *other == lambda(position)));
    }
    positions
}

/// Sets that can be joined: the smallest member stands for all.
struct Joined {
    parents: Vec<usize>,
}

impl Joined {
    fn new(count: usize) -> Self {
        Self { parents: (0..count).collect() }
    }

    fn root(&self, mut at: usize) -> usize {
        while self.parents[at] != at {
            at = self.parents[at];
        }
        at
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.root(one), self.root(other));
        self.parents[one.max(other)] = one.min(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spectrum(parts: &[(f64, f64)]) -> Spectrum {
        let both = |&(re, im): &(f64, f64)| match im == 0.0 {
            true => vec![Complex::new(re, 0.0)],
            false => vec![Complex::new(re, im), Complex::new(re, -im)],
        };
        Spectrum::new(&parts.iter().flat_map(both).collect::<Vec<_>>()).unwrap()
    }

    fn finest(runs: &[Spectrum]) -> (Groups, Vec<(Vec<usize>, bool)>) {
        let spectra: Vec<&Spectrum> = runs.iter().collect();
        let groups = Groups::new(&Labels::by_modulus(&spectra), &spectra);
        let listed = groups.finest().iter().map(|group| (group.labels().to_vec(), group.is_closed())).collect();
        (groups, listed)
    }

    #[test]
    fn modes_that_oscillate_everywhere_are_groups_by_themselves() {
        let (groups, listed) =
            finest(&[spectrum(&[(-1.0, 10.0), (-1.0, 20.0)]), spectrum(&[(-2.0, 11.0), (-1.0, 30.0)])]);
        assert_eq!(listed, [(vec![0], false), (vec![2], false)]);
        assert!(groups.is_upper_half(2) && !groups.is_upper_half(3) && groups.of_label(3) == 1);
        let both = groups.union(&groups.finest()[0], &groups.finest()[1]);
        assert_eq!((both.labels(), both.kind()), (&[0, 2][..], OutputKind::Cluster));
        assert_eq!(groups.closed(&both).labels(), [0, 1, 2, 3]);
        assert_eq!(groups.modes_and_reals(&groups.closed(&both)), (2, 0));
    }

    /// Cuts by modulus: −0.3, a pair, −14, and elsewhere four real ones, as of a bicycle from standstill.
    #[test]
    fn modes_that_become_real_are_closed_with_what_they_meet() {
        let apart = spectrum(&[(-0.3, 0.0), (-0.8, 4.0), (-14.0, 0.0)]);
        assert_eq!(finest(std::slice::from_ref(&apart)).1, [(vec![0], true), (vec![1], false), (vec![3], true)]);
        let real = spectrum(&[(3.2, 0.0), (-3.2, 0.0), (5.5, 0.0), (-5.8, 0.0)]);
        let (groups, listed) = finest(&[apart, real]);
        assert_eq!(listed, [(vec![0], true), (vec![1, 2], true), (vec![3], true)]);
        let counts: Vec<_> = groups.finest().iter().map(|group| groups.modes_and_reals(group)).collect();
        assert_eq!(counts, [(0, 1), (1, 0), (0, 1)]);
        let all = groups.union(&groups.finest()[0], &groups.finest()[1]);
        assert_eq!((all.labels(), groups.modes_and_reals(&all)), (&[0, 1, 2][..], (1, 1)));
    }

    #[test]
    fn labels_that_change_their_partner_are_closed_together() {
        // By modulus the pair is on ranks 0 and 1, then on 1 and 2.
        let runs = [spectrum(&[(-1.0, 2.0), (-5.0, 0.0)]), spectrum(&[(-1.0, 0.0), (-1.0, 2.0)])];
        assert_eq!(finest(&runs).1, [(vec![0, 1, 2], true)]);
    }
}
