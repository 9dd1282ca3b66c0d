//! The springs of a method, chosen from those that an element has.

use super::corners::{Corners, Joint};
use super::delingette::couples;
use super::method::{Cover, Method};
use crate::element::{Element, SpringKind};
use crate::error::{Error, Result};
use crate::springs::{FunctionSpring, Measure, Springs};
use crate::symbolic::{Compiled, Expr};
use std::sync::Arc;

/// The springs of a method on an element, and the pairs of nodes in its formula.
#[derive(Debug)]
pub struct Pattern {
    pub pairs: Vec<[usize; 2]>,
    pub springs: Springs,
}

impl Pattern {
    /// Selects the springs that the method needs from the length springs `offered`, in their order, and adds springs on
    /// its other measures.
    ///
    /// # Errors
    /// A length spring is missing, or the springs are not those of this element.
    pub fn new(
        method: Method,
        cover: &Cover,
        corners: &Corners,
        element: &Element,
        offered: &Springs,
    ) -> Result<Pattern> {
        let shape = |s: &Springs| (s.nodes(), s.dimension(), s.space());
        if shape(offered) != (element.nodes(), element.dimension(), element.space()) {
            return Err(Error::expected("springs", format!("those of {}", element.name), "those of another element"));
        }
        for &joint in cover.joints {
            for [a, b] in corners.joined(joint) {
                if !offered.pairs().contains(&[a, b]) && !offered.pairs().contains(&[b, a]) {
                    let what = match joint {
                        Joint::Edge => "an edge",
                        Joint::FaceDiagonal => "the diagonal of a side",
                        Joint::Diagonal => "a diagonal",
                    };
                    let expected = format!("a spring between the nodes {a} and {b}, {what}, for {}", method.name());
                    return Err(Error::expected("springs", expected, "none"));
                }
            }
        }
        let needed = |&s: &usize| {
            let pair = offered.pairs()[s];
            let first = offered.pairs()[..s].iter().all(|p| *p != pair && *p != [pair[1], pair[0]]);
            method == Method::MacielUniform
                || first && corners.joint(pair).is_some_and(|joint| cover.joints.contains(&joint))
        };
        let kept: Vec<usize> = (0..offered.pairs().len()).filter(needed).collect();
        let pairs: Vec<[usize; 2]> = kept.iter().map(|&s| offered.pairs()[s]).collect();
        let own = element.springs.iter().find(|group| group.is_content()).map_or("content", |group| &group.name);
        let kind = if offered.dimension() == 2 { SpringKind::Area } else { SpringKind::Volume };
        let content = Some((own, kind));
        let edges = || pairs.iter().map(|pair| pair.to_vec());
        let two = || couples(pairs.len()).map(|[i, j]| [pairs[i], pairs[j]].concat());
        let springs = match method {
            Method::LloydPreserving => offered.with(&kept, Vec::new(), content),
            Method::BaudetCorrected => {
                let side = element.nodes() / 2;
                let extents = corners.facing.iter().cloned();
                let extents = measured(offered, "extent", SpringKind::Measure, extents, |d| Measure::extent(side, d))?;
                offered.with(&kept, extents, content)
            }
            Method::DelingetteQuadratic => {
                let sum = |d: usize| Measure::of_kind(SpringKind::Coupling, 4, d);
                offered.with(&kept, measured(offered, "coupling", SpringKind::Coupling, two(), sum)?, None)
            }
            Method::DelingetteBiquadratic => {
                let squares = |pairs: usize| move |d: usize| Measure::squared_lengths(pairs, d);
                let mut all = measured(offered, "squared edge", SpringKind::Measure, edges(), squares(1))?;
                all.extend(measured(offered, "squared coupling", SpringKind::Measure, two(), squares(2))?);
                offered.with(&[], all, None)
            }
            _ => offered.with(&kept, Vec::new(), None),
        };
        Ok(Pattern { pairs, springs })
    }
}

/// Springs on one function of several lists of nodes; `function` gives it for a number of dimensions.
fn measured<'a>(
    springs: &Springs,
    group: &'a str,
    kind: SpringKind,
    nodes: impl Iterator<Item = Vec<usize>>,
    function: impl Fn(usize) -> Result<Expr>,
) -> Result<Vec<(&'a str, FunctionSpring)>> {
    let own = Arc::new(Compiled::from(function(springs.dimension())?));
    let embedded = springs.space() > springs.dimension();
    let in_space = embedded.then(|| function(springs.space()).map(|own| Arc::new(Compiled::from(own)))).transpose()?;
    let spring = |nodes| FunctionSpring { kind, nodes, function: own.clone(), in_space: in_space.clone() };
    Ok(nodes.map(|nodes| (group, spring(nodes))).collect())
}
