//! The numbers in which the state of a branch is kept, and the energy that they give.

use crate::model::{MaterialPoint, MaterialPoints};
use nalgebra::{Matrix3, Vector3};

/// Where the state of a branch is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchForm {
    /// One constant for each pair of points, as in networks.
    Edges,
    /// One tensor for each material point, as in finite elements.
    Tensors,
}

/// `E = Σ_points μ V₀ (½ tr(F G Fᵀ) − (3/2) c J^(2/3))` with G as tensors, or as the constants of springs
/// `½ Σ_edges k_ab |x_a − x_b|²`, `k_ab = −Σ_points μ V₀ ∇N_a·G ∇N_b`.
#[derive(Debug, Clone)]
pub(super) struct Form {
    points: MaterialPoints,
    /// The pairs of points, the lower first; none with tensors.
    edges: Vec<[usize; 2]>,
    /// The edge of each pair of nodes of each material point, one point after the other.
    slots: Vec<usize>,
    kind: BranchForm,
}

/// The numbers of a symmetric tensor.
pub(super) const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

pub(super) fn tensor(numbers: &[f64]) -> Matrix3<f64> {
    let mut g = Matrix3::zeros();
    for ((k, l), number) in SYMMETRIC.into_iter().zip(numbers) {
        (g[(k, l)], g[(l, k)]) = (*number, *number);
    }
    g
}

/// A shape of the whole body.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    /// The numbers of G = H.
    pub target: Vec<f64>,
    /// What the numbers are multiplied with in the energy: squares of lengths of constants, `μ V₀ C` of tensors.
    measures: Vec<f64>,
    /// `Σ_points μ V₀ J^(2/3)`, J.
    content: f64,
}

impl Shape {
    /// The energy of a branch with the state `numbers`, J.
    pub fn energy(&self, numbers: &[f64]) -> f64 {
        let straight: f64 = numbers.iter().zip(&self.measures).map(|(g, m)| g * m).sum();
        straight / 2.0 - 1.5 * self.content
    }
}

/// What a material point knows of the present shape.
pub(super) struct Present {
    pub f: Matrix3<f64>,
    /// `F⁻ᵀ`.
    pub inverse: Matrix3<f64>,
    /// `J^(2/3)`.
    pub size: f64,
}

impl Present {
    pub fn of(point: &MaterialPoint, x: &[f64], d: usize) -> Option<Present> {
        let f = point.deformation(x, d);
        let [a, b, c] = [0, 1, 2].map(|k| f.column(k).into_owned());
        // The columns of J F⁻ᵀ are products of those of F.
        let across = [b.cross(&c), c.cross(&a), a.cross(&b)];
        let j = a.dot(&across[0]);
        let edge = j.cbrt();
        // A point that is inverted or flat has no state; NaN has none either.
        (j > 0.0).then(|| Present { f, inverse: Matrix3::from_columns(&across) / j, size: edge * edge })
    }
}

impl Form {
    pub fn points(&self) -> &MaterialPoints {
        &self.points
    }

    pub fn new(points: MaterialPoints, kind: BranchForm) -> Form {
        let mut edges: Vec<[usize; 2]> = Vec::new();
        let mut slots = Vec::new();
        if kind == BranchForm::Edges {
            for point in points.each() {
                edges.extend(pairs(point.nodes.len()).map(|(a, b)| sorted(point.nodes[a], point.nodes[b])));
            }
            // Sorted and without repetitions, so that each edge is found by halving and has one spring for all points
            // around it.
            edges.sort_unstable();
            edges.dedup();
            for point in points.each() {
                let slot = |(a, b): (usize, usize)| {
                    edges.binary_search(&sorted(point.nodes[a], point.nodes[b])).expect("the edge is in the list")
                };
                slots.extend(pairs(point.nodes.len()).map(slot));
            }
        }
        Form { points, edges, slots, kind }
    }

    /// What the numbers are compared with at the positions x; in the plane those across follow the constants. `None` where a point is inverted.
    pub fn shape(&self, x: &[f64]) -> Option<Shape> {
        let d = self.points.dimension;
        let mut target = vec![0.0; self.edges.len()];
        let apart = |&[a, b]: &[usize; 2]| (0..d).map(|k| (x[a * d + k] - x[b * d + k]).powi(2)).sum();
        let mut measures: Vec<f64> = self.edges.iter().map(apart).collect();
        let (mut slots, mut content) = (&self.slots[..], 0.0);
        let mut spatial: Vec<Vector3<f64>> = Vec::new();
        for point in self.points.each() {
            let Present { f, inverse, size } = Present::of(&point, x, d)?;
            content += point.weight * size;
            match self.kind {
                BranchForm::Tensors => {
                    let (h, c) = (size * inverse.transpose() * inverse, point.weight * f.transpose() * f);
                    target.extend(SYMMETRIC.map(|at| h[at]));
                    // Six numbers stand for nine: those outside the diagonal count twice in a product of tensors.
                    measures.extend(SYMMETRIC.map(|at| if at.0 == at.1 { c[at] } else { 2.0 * c[at] }));
                }
                BranchForm::Edges => {
                    spatial.clear();
                    spatial.extend(point.gradients.iter().map(|g| inverse * g));
                    let scale = point.weight * size;
                    for (a, first) in spatial.iter().enumerate() {
                        let (own, others) = slots.split_at(spatial.len() - 1 - a);
                        own.iter().zip(&spatial[a + 1..]).for_each(|(slot, b)| target[*slot] -= scale * first.dot(b));
                        slots = others;
                    }
                    // In the plane F₃₃ is one, and no edge measures across: its part of the energy is a number of the
                    // point.
                    if d < 3 {
                        target.push(size);
                        measures.push(point.weight);
                    }
                }
            }
        }
        Some(Shape { target, measures, content })
    }

    /// The positions of the entries of the tangent.
    pub fn places(&self) -> Vec<(usize, usize)> {
        let d = self.points.dimension;
        let mut places = Vec::new();
        for &[a, b] in &self.edges {
            for k in 0..d {
                places.extend([(a * d + k, a * d + k), (b * d + k, b * d + k), (b * d + k, a * d + k)]);
            }
        }
        for point in self.points.each() {
            each_entry(point.nodes, d, |row, column, _, _| places.push((row, column)));
        }
        places
    }

    /// The energy with the state `numbers` and the factor c of the content of each point at the positions x, J. Adds the forces, N, unless the list is
    /// empty, and writes the entries of the tangent, N/m, unless that is. `None` where a point is inverted.
    pub fn evaluate(
        &self,
        numbers: &[f64],
        c: &dyn Fn(usize) -> f64,
        x: &[f64],
        force: &mut [f64],
        tangent: &mut [f64],
    ) -> Option<f64> {
        let d = self.points.dimension;
        let (constants, own) = numbers.split_at(self.edges.len());
        let mut energy = 0.0;
        for (&[a, b], k) in self.edges.iter().zip(constants) {
            let mut square = 0.0;
            for axis in 0..d {
                let apart = x[a * d + axis] - x[b * d + axis];
                square += apart * apart;
                if !force.is_empty() {
                    force[a * d + axis] += k * apart;
                    force[b * d + axis] -= k * apart;
                }
            }
            energy += k * square / 2.0;
        }
        let (mut entry, mut straight) = (0, Vec::new());
        if !tangent.is_empty() {
            for k in constants {
                for _ in 0..d {
                    tangent[entry..entry + 3].copy_from_slice(&[*k, *k, -k]);
                    entry += 3;
                }
            }
        }
        for (i, point) in self.points.each().enumerate() {
            let Present { f, inverse, size } = Present::of(&point, x, d)?;
            let (weight, c) = (point.weight, c(i));
            energy -= 1.5 * c * weight * size;
            let spatial = point.gradients.iter().map(|g| inverse * g);
            // F G of the tensor of the point.
            let pushed = match self.kind {
                BranchForm::Tensors => {
                    let g = tensor(&own[6 * i..6 * i + 6]);
                    energy += weight / 2.0 * (f * g * f.transpose()).trace();
                    Some((f * g, g))
                }
                BranchForm::Edges => {
                    energy += own.get(i).map_or(0.0, |across| weight / 2.0 * across);
                    None
                }
            };
            if !force.is_empty() {
                for ((node, gradient), b) in point.nodes.iter().zip(point.gradients).zip(spatial.clone()) {
                    let mut own = b * (-c * weight * size);
                    if let Some((pushed, _)) = &pushed {
                        own += pushed * gradient * weight;
                    }
                    (0..d).for_each(|k| force[node * d + k] += own[k]);
                }
            }
            if !tangent.is_empty() {
                let spatial: Vec<Vector3<f64>> = spatial.collect();
                let (n, scale) = (spatial.len(), c * weight * size);
                straight.clear();
                straight.resize(n * n, 0.0);
                if let Some((_, g)) = &pushed {
                    for (row, a) in straight.chunks_exact_mut(n).zip(point.gradients) {
                        row.iter_mut().zip(point.gradients).for_each(|(entry, b)| *entry = weight * a.dot(&(g * b)));
                    }
                }
                each_entry(point.nodes, d, |_, _, [a, b], [k, l]| {
                    let (p, q) = (&spatial[a], &spatial[b]);
                    let content = scale * (p[l] * q[k] - 2.0 / 3.0 * p[k] * q[l]);
                    tangent[entry] = content + if k == l { straight[a * n + b] } else { 0.0 };
                    entry += 1;
                });
            }
        }
        Some(energy)
    }
}

fn sorted(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// All pairs of this number of nodes.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |a| (a + 1..count).map(move |b| (a, b)))
}

/// Visits the entries of the lower triangle of the nodes of a point: row and column, the nodes and the directions.
fn each_entry(nodes: &[usize], d: usize, mut visit: impl FnMut(usize, usize, [usize; 2], [usize; 2])) {
    for (a, b) in (0..nodes.len()).flat_map(|a| (0..nodes.len()).map(move |b| (a, b))) {
        for (k, l) in (0..d).flat_map(|k| (0..d).map(move |l| (k, l))) {
            let (row, column) = (nodes[a] * d + k, nodes[b] * d + l);
            // The two parts of an entry with its mirror image are one: the lower triangle is enough.
            if row >= column {
                visit(row, column, [a, b], [k, l]);
            }
        }
    }
}
