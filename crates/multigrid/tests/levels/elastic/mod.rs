//! Elastic bodies whose matrices the tests and the measurement solve with: jittered boxes of cubes or simplices.
#![allow(dead_code)]

use springfit_multigrid::{BlockMatrix, Groups, Multigrid, Pattern, Settings, plane_motions, space_motions, unwatched};
use std::convert::Infallible;
use std::ops::Range;
use std::sync::Arc;

/// A box of cells, each with its own modulus.
pub struct Body<const D: usize> {
    pub points: Vec<f64>,
    pub nodes: Vec<u32>,
    pub starts: Vec<usize>,
    /// Young's modulus of each cell.
    pub young: Vec<f64>,
    pub poisson: f64,
    /// What x = 0 holds.
    pub is_held: Vec<bool>,
}

/// Numbers between −½ and ½.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}

#[derive(Clone, Copy, PartialEq)]
pub enum Shape {
    /// Squares, cubes.
    Cube,
    /// Two triangles, six tetrahedra in each of them.
    Simplex,
}

impl<const D: usize> Body<D> {
    /// `cells[k]` cells along axis k, of unit size times `stretch[k]`; inner points are moved by up to `jitter / 2` of a cell.
    pub fn new(cells: [usize; D], stretch: [f64; D], shape: Shape, jitter: f64, poisson: f64) -> Body<D> {
        let counts = cells.map(|c| c + 1);
        let total: usize = counts.iter().product();
        let place = |index: usize| {
            let mut rest = index;
            let mut at = [0; D];
            for k in 0..D {
                at[k] = rest % counts[k];
                rest /= counts[k];
            }
            at
        };
        let index = |at: [usize; D]| (0..D).rev().fold(0, |sum, k| sum * counts[k] + at[k]);
        let mut random = random(7);
        let mut points = Vec::with_capacity(total * D);
        for i in 0..total {
            let at = place(i);
            for k in 0..D {
                let is_inner = at[k] > 0 && at[k] < cells[k];
                let moved = if is_inner { jitter * random() } else { 0.0 };
                points.push((at[k] as f64 + moved) * stretch[k]);
            }
        }
        let (mut nodes, mut starts) = (Vec::new(), vec![0]);
        for i in 0..total {
            let at = place(i);
            if (0..D).any(|k| at[k] == cells[k]) {
                continue;
            }
            let corner = |bits: usize| index(std::array::from_fn(|k| at[k] + (bits >> k & 1))) as u32;
            match shape {
                Shape::Cube => {
                    nodes.extend((0..1 << D).map(corner));
                    starts.push(nodes.len());
                }
                // Kuhn's simplices: from one corner to the opposite one along the edges in every order.
                Shape::Simplex => {
                    let orders: &[&[usize]] = match D {
                        2 => &[&[0, 1], &[1, 0]],
                        _ => &[&[0, 1, 2], &[0, 2, 1], &[1, 0, 2], &[1, 2, 0], &[2, 0, 1], &[2, 1, 0]],
                    };
                    for order in orders {
                        let mut bits = 0;
                        nodes.push(corner(0));
                        for k in *order {
                            bits |= 1 << k;
                            nodes.push(corner(bits));
                        }
                        starts.push(nodes.len());
                    }
                }
            }
        }
        let is_held = (0..total).flat_map(|i| [place(i)[0] == 0; D]).collect();
        let young = vec![1.0; starts.len() - 1];
        Body { points, nodes, starts, young, poisson, is_held }
    }

    pub fn groups(&self) -> Groups<'_> {
        Groups { nodes: &self.nodes, starts: &self.starts }
    }

    pub fn matrix(&self) -> Arc<BlockMatrix<D, D>> {
        let pattern = Arc::new(Pattern::of_groups(self.points.len() / D, &[self.groups()]));
        let add = |cells: Range<usize>, mut entries: &mut [f64]| {
            for cell in cells {
                let (own, rest) = entries.split_at_mut((self.groups().of(cell).len() * D).pow(2));
                self.stiffness(cell, own);
                entries = rest;
            }
            Ok::<(), Infallible>(())
        };
        Arc::new(BlockMatrix::assemble(pattern, &self.groups(), add).unwrap())
    }

    /// `∫ λ div u div v + 2 μ ε(u):ε(v)` of one cell, by Gauss's rule of two points per axis, or the midpoint of a simplex.
    fn stiffness(&self, cell: usize, entries: &mut [f64]) {
        let nodes = &self.nodes[self.starts[cell]..self.starts[cell + 1]];
        let n = nodes.len();
        let (e, nu) = (self.young[cell], self.poisson);
        let (lambda, mu) = (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)));
        let x = |a: usize, k: usize| self.points[nodes[a] as usize * D + k];
        let is_simplex = n == D + 1;
        let gauss = 0.5 - 0.5 / 3.0_f64.sqrt();
        for q in 0..if is_simplex { 1 } else { 1 << D } {
            // Gradients in the reference cell [0, 1]^D.
            let at: [f64; D] = std::array::from_fn(|k| if q >> k & 1 == 0 { gauss } else { 1.0 - gauss });
            let local = |a: usize, k: usize| match is_simplex {
                true if a == 0 => -1.0,
                true => f64::from(u8::from(a == k + 1)),
                false => (0..D)
                    .map(|l| match (a >> l & 1, l == k) {
                        (0, true) => -1.0,
                        (_, true) => 1.0,
                        (0, false) => 1.0 - at[l],
                        (_, false) => at[l],
                    })
                    .product(),
            };
            let j: [[f64; D]; D] =
                std::array::from_fn(|i| std::array::from_fn(|k| (0..n).map(|a| x(a, i) * local(a, k)).sum()));
            let (inverse, determinant) = inverted(&j);
            let factorial = if is_simplex { (1..=D).product::<usize>() as f64 } else { (1 << D) as f64 };
            let weight = determinant.abs() / factorial;
            let g: Vec<[f64; D]> =
                (0..n).map(|a| std::array::from_fn(|i| (0..D).map(|k| local(a, k) * inverse[k][i]).sum())).collect();
            for a in 0..n {
                for b in 0..n {
                    let along: f64 = (0..D).map(|k| g[a][k] * g[b][k]).sum();
                    for i in 0..D {
                        for k in 0..D {
                            let own = if i == k { mu * along } else { 0.0 };
                            let entry = lambda * g[a][i] * g[b][k] + mu * g[a][k] * g[b][i] + own;
                            entries[(a * D + i) * n * D + b * D + k] += weight * entry;
                        }
                    }
                }
            }
        }
    }
}

fn inverted<const D: usize>(j: &[[f64; D]; D]) -> ([[f64; D]; D], f64) {
    let (mut a, mut inverse, mut determinant) = (*j, [[0.0; D]; D], 1.0);
    (0..D).for_each(|i| inverse[i][i] = 1.0);
    for c in 0..D {
        let pivot = (c..D).max_by(|x, y| a[*x][c].abs().total_cmp(&a[*y][c].abs())).unwrap();
        if pivot != c {
            a.swap(pivot, c);
            inverse.swap(pivot, c);
            determinant = -determinant;
        }
        determinant *= a[c][c];
        let p = a[c][c];
        (0..D).for_each(|k| (a[c][k], inverse[c][k]) = (a[c][k] / p, inverse[c][k] / p));
        for r in (0..D).filter(|r| *r != c) {
            let f = a[r][c];
            (0..D).for_each(|k| (a[r][k], inverse[r][k]) = (a[r][k] - f * a[c][k], inverse[r][k] - f * inverse[c][k]));
        }
    }
    (inverse, determinant)
}

impl Body<2> {
    pub fn multigrid(&self, settings: &Settings) -> Multigrid<2, 3> {
        let motions = plane_motions(&self.points, &self.is_held);
        Multigrid::new(self.matrix(), &motions, &self.is_held, settings, &mut unwatched).unwrap()
    }
}

impl Body<3> {
    pub fn multigrid(&self, settings: &Settings) -> Multigrid<3, 6> {
        let motions = space_motions(&self.points, &self.is_held);
        Multigrid::new(self.matrix(), &motions, &self.is_held, settings, &mut unwatched).unwrap()
    }
}
