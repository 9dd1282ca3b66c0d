//! The springs of an element: each measures one number c(x), and pulls with k (c − c₀) along its gradient g = ∇c.
//!
//! At rest the tangent stiffness is `K(k) = Σ_s k_s g_s g_sᵀ`, so a fit needs nothing of a spring but g.

use crate::element::{Element, SpringKind};
use crate::error::Result;
use crate::stiffness::Geometry;

/// The springs of one element type that a fit uses: length springs first, then at most one on the cell's content.
#[derive(Debug, Clone, PartialEq)]
pub struct Springs {
    pub dimension: usize,
    pub nodes: usize,
    /// Node pairs of the length springs.
    pub pairs: Vec<[usize; 2]>,
    /// Whether the last spring measures the cell's area or volume.
    pub content: Option<SpringKind>,
    /// The group of each spring, as an index into `names`.
    pub groups: Vec<usize>,
    pub names: Vec<String>,
    /// Length springs that share a node: `(s, t)`, s < t, `(g_s · g_t)² = (n_s · n_t)²`; all others are orthogonal.
    pub(crate) touching: Vec<(usize, usize)>,
    /// Those of them that join the same two nodes.
    pub(crate) parallel: Vec<(usize, usize)>,
}

impl Springs {
    /// The named groups of the element, or all that are not optional.
    ///
    /// # Errors
    /// A name is no group of this element.
    pub fn select(element: &Element, names: Option<&[String]>) -> Result<Springs> {
        let mut chosen = element.select_groups(names)?;
        chosen.sort_by_key(|g| g.kind != SpringKind::Length);
        let mut springs = Springs {
            dimension: element.dimension(),
            nodes: element.nodes(),
            pairs: Vec::new(),
            content: None,
            groups: Vec::new(),
            names: chosen.iter().map(|g| g.name.clone()).collect(),
            touching: Vec::new(),
            parallel: Vec::new(),
        };
        for (index, group) in chosen.iter().enumerate() {
            match group.kind {
                SpringKind::Length => {
                    springs.pairs.extend(&group.pairs);
                    springs.groups.extend(group.pairs.iter().map(|_| index));
                }
                kind => {
                    springs.content = Some(kind);
                    springs.groups.push(index);
                }
            }
        }
        springs.touching = sharing(&springs.pairs, 1);
        springs.parallel = sharing(&springs.pairs, 2);
        Ok(springs)
    }

    pub fn len(&self) -> usize {
        self.groups.len()
    }

    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Writes the rows g_s, `[springs × nodes·dimension]`, of the element with nodes at `x`, `[nodes × dimension]`.
    ///
    /// A length spring's g is dimensionless: −n at its first node and n at its second. That of the content is
    /// `∫ ∇N dV`, in m² (m in two dimensions), so its constant is in N/m⁵ (N/m³).
    pub fn gradients(&self, x: &[f64], geometry: &Geometry, g: &mut Vec<f64>) {
        let d = self.dimension;
        let size = self.nodes * d;
        g.clear();
        g.resize(self.len() * size, 0.0);
        for (row, &[i, j]) in g.chunks_exact_mut(size).zip(&self.pairs) {
            let (xi, xj) = (&x[i * d..(i + 1) * d], &x[j * d..(j + 1) * d]);
            let length = distance(xi, xj);
            for k in 0..d {
                let n = (xj[k] - xi[k]) / length;
                row[i * d + k] = -n;
                row[j * d + k] = n;
            }
        }
        if self.content.is_some() {
            g[self.pairs.len() * size..].copy_from_slice(&geometry.content_gradient());
        }
    }
}

/// `‖b − a‖`.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt()
}

/// The springs `(s, t)`, s < t, that have at least `nodes` nodes in common.
fn sharing(pairs: &[[usize; 2]], nodes: usize) -> Vec<(usize, usize)> {
    let common = |s: usize, t: usize| pairs[s].iter().filter(|node| pairs[t].contains(node)).count();
    (0..pairs.len()).flat_map(|t| (0..t).filter(move |&s| common(s, t) >= nodes).map(move |s| (s, t))).collect()
}
