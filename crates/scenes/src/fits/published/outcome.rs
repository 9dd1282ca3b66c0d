//! The assumptions of a published formula that a body does not meet.

use crate::fit::published::{Method, Unmet};
use crate::material::MaterialMap;

/// The assumptions of the method that are not met.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PublishedOutcome {
    /// The method.
    pub method: Method,
    /// The assumptions that are not met.
    pub unmet: Unmet,
}

impl PublishedOutcome {
    /// Notes for the reader, one sentence each. The body has `cells` cells of `material`.
    pub fn notes(&self, cells: usize, material: &MaterialMap) -> Vec<String> {
        let unmet = &self.unmet;
        let name = self.method.name();
        let ratio = unmet.poisson.map(|assumed| match material.uniform() {
            Some(material) => {
                format!("{name} assumes Poisson's ratio {assumed:.4}, and the material has {}", material.poisson())
            }
            None => format!("{name} assumes Poisson's ratio {assumed:.4}, and that of some cells is another"),
        });
        let shape = (unmet.cells > 0).then(|| {
            let percent = 100.0 * unmet.deviation;
            format!(
                "{} of {cells} elements do not have the shape that {} assumes (lengths differ by up to {percent:.0} %)",
                unmet.cells,
                self.method.name()
            )
        });
        let lacking: Vec<String> = ratio.into_iter().chain(shape).collect();
        if lacking.is_empty() {
            return Vec::new();
        }
        vec![lacking.join("; ")]
    }
}
