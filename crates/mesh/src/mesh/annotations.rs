//! What a file says besides the points, cells and groups of a body.

use std::collections::BTreeMap;

/// What a file says besides the points, cells and groups of a body: what is left out of it, what it prescribes and is not taken, and the
/// material that it names.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Annotations {
    /// How many things of each kind are no part of the body, by their names in the singular.
    pub left_out: BTreeMap<String, usize>,
    /// How many lines of each keyword prescribe what is not taken from the file: supports, loads, ties and the like.
    pub prescribed: BTreeMap<String, usize>,
    /// What was read otherwise than a reader could think, one sentence each.
    pub remarks: Vec<String>,
    /// The materials of groups of cells, in the units of the file.
    pub sections: Vec<Section>,
}

/// The material of the cells of a group as a deck states it, in the units of the deck.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Section {
    /// The name of the group.
    pub group: String,
    /// Young's modulus.
    pub young: Option<f64>,
    /// Poisson's ratio.
    pub poisson: Option<f64>,
    /// The density.
    pub density: Option<f64>,
    /// The thickness of surfaces.
    pub thickness: Option<f64>,
    /// The area of rods.
    pub area: Option<f64>,
}

impl Annotations {
    /// Counts something that is no part of the body.
    pub fn leave_out(&mut self, kind: &str, count: usize) {
        if count > 0 {
            *self.left_out.entry(kind.into()).or_default() += count;
        }
    }

    /// Counts a line of a keyword that prescribes something.
    pub fn prescribe(&mut self, keyword: &str) {
        *self.prescribed.entry(keyword.into()).or_default() += 1;
    }

    /// Adds a sentence, once.
    pub fn remark(&mut self, sentence: impl Into<String>) {
        let sentence = sentence.into();
        if !self.remarks.contains(&sentence) {
            self.remarks.push(sentence);
        }
    }

    /// What is no part of the body, with the number of each: `2 lines of REBAR, MASS (1)`.
    pub fn left_out_words(&self) -> String {
        counts(&self.left_out)
    }

    /// What a reader must know, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let left_out = (!self.left_out.is_empty())
            .then(|| format!("no part of the body, but for the groups that they make: {}", counts(&self.left_out)));
        let prescribed = (!self.prescribed.is_empty()).then(|| {
            format!(
                "the file prescribes what is not taken from it: {}; supports and loads are those of the scene",
                counts(&self.prescribed)
            )
        });
        left_out.into_iter().chain(prescribed).chain(self.remarks.iter().cloned()).collect()
    }
}

/// The kinds with their numbers; names of keywords and types have no plural.
fn counts(of: &BTreeMap<String, usize>) -> String {
    let is_name = |kind: &str| kind.starts_with(|first: char| first.is_ascii_uppercase() || first == '*');
    let counted = |(kind, count): (&String, &usize)| match (is_name(kind), kind.split_once(" of ")) {
        (true, _) => format!("{kind} ({count})"),
        (false, _) if *count == 1 => format!("1 {kind}"),
        (false, Some((what, group))) => format!("{count} {what}s of {group}"),
        (false, None) => format!("{count} {kind}s"),
    };
    of.iter().map(counted).collect::<Vec<_>>().join(", ")
}
