//! Least squares in closed form: the constants of one element, or of one per lane, from the node positions alone.
//!
//! Theory: page *Least squares* of the book.

use super::bounded::{Factors, bound};
use super::least_squares::{equations, normal_equations};
use super::nodal::{Nodal, is_shorter};
use super::normal::Normal;
use super::settings::Fit;
use super::sizes::of_size;
use super::weight::{ClosedWeight, Route};
use crate::element::Tabulation;
use crate::material::Hooke;
use crate::scalar::{Packed, Real};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// The most bounded constants whose equations are solved by factors in all lanes at once. Beyond it one lane after the
/// other is faster.
// With 67 and 106 constants of `quad12` and `wedge15` both ways take the same time; with 191 of `hex20` and `tet20`
// factors in all lanes take 1.4 to 1.7 times as long.
const MOST_FACTORED: usize = 120;
/// The most bounded constants that are solved by factors where the equations of the nodes are solved. Beyond it
/// conjugate gradients are faster, whose products with M are cheap there.
// With 45 constants of `tet10` both ways take the same time; with 66 of `quad12` factors take twice as long, and with
// 190 of `hex20` five times.
const MOST_FACTORED_WITH_NODES: usize = 60;

/// How the equations of a fit are solved, with the working memory.
#[derive(Debug, Clone)]
pub struct Closed<T> {
    weight: ClosedWeight,
    equations: Equations,
    nonnegative: bool,
    nodal: Nodal<T>,
    normal: Normal<T>,
    tied: Normal<T>,
    /// The equations before elimination, if constants are bounded.
    kept: Normal<T>,
    factors: Factors<T>,
}

/// The linear equations by which constants are found.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Equations {
    /// `M = 2I`: each constant is half of its right-hand side.
    Decoupled,
    /// The equations of the nodes are fewer than those of the springs.
    PerNode,
    /// One for each spring.
    PerSpring,
    /// One for each group of springs.
    PerGroup,
}

impl<T: Real> Closed<T> {
    /// None for objectives without a closed form.
    pub fn of(springs: &Springs, fit: &Fit) -> Option<Closed<T>> {
        let Route::Closed(weight) = fit.objective.route(springs.need_matrix()) else { return None };
        let lengths_alone = springs.content().is_none() && springs.parallel().is_empty();
        let equations = match weight {
            _ if fit.tied => Equations::PerGroup,
            // Two length springs share a block of different nodes only if they join
            // the same nodes: M is diagonal. A spring on the content is in all blocks.
            ClosedWeight::OffDiagonal if lengths_alone => Equations::Decoupled,
            ClosedWeight::None if is_shorter(springs) => Equations::PerNode,
            ClosedWeight::None | ClosedWeight::OffDiagonal | ClosedWeight::Modal(_) => Equations::PerSpring,
        };
        Some(Closed {
            weight,
            equations,
            nonnegative: fit.nonnegative,
            nodal: Nodal::default(),
            normal: Normal::default(),
            tied: Normal::default(),
            kept: Normal::default(),
            factors: Factors::default(),
        })
    }

    /// Solves for the element with nodes at `x`, `[nodes × dimension]`, and fills in its geometry. Returns false if the
    /// Jacobian is not safely positive or the equations are not regular.
    pub fn solve(
        &mut self,
        table: &Tabulation,
        springs: &Springs,
        x: &[T],
        geometry: &mut Geometry<T>,
        hooke: &Hooke<T>,
    ) -> bool
    where
        T: Real,
    {
        if self.equations == Equations::PerNode {
            return geometry.update(table, x) && self.nodal.solve(springs, x, geometry, hooke, &mut self.normal);
        }
        let regular = of_size!(T, x[0], (springs.dimension(), springs.nodes()), |D, n| {
            self.solve_in::<D>(n, table, springs, x, geometry, hooke)
        });
        regular && self.finish(springs)
    }

    #[inline(always)]
    fn solve_in<const D: usize>(
        &mut self,
        n: usize,
        table: &Tabulation,
        springs: &Springs,
        x: &[T],
        geometry: &mut Geometry<T>,
        hooke: &Hooke<T>,
    ) -> bool {
        if !geometry.update_in::<D>(n, table, x) {
            return false;
        }
        equations::<T, D>(n, self.weight, springs, x, geometry, hooke, &mut self.normal);
        if self.equations == Equations::Decoupled {
            for b in &mut self.normal.rhs {
                *b = b.clone().scaled(&0.5);
            }
        }
        true
    }

    /// Solves the equations.
    fn finish(&mut self, springs: &Springs) -> bool {
        let equations = match self.equations {
            Equations::Decoupled | Equations::PerNode => return true,
            Equations::PerSpring => &mut self.normal,
            Equations::PerGroup => {
                self.normal.tied(springs.groups(), springs.names().len(), &mut self.tied);
                &mut self.tied
            }
        };
        // The elimination overwrites the equations, which the search under bounds needs.
        if self.nonnegative {
            self.kept.gram.clone_from(&equations.gram);
            self.kept.rhs.clone_from(&equations.rhs);
        }
        equations.solve_regular()
    }

    /// The constant of spring `s` after [`Closed::solve`], in N/m, without bounds.
    pub fn constant(&self, springs: &Springs, s: usize) -> &T {
        match self.equations {
            Equations::PerGroup => &self.tied.rhs[springs.groups()[s]],
            Equations::Decoupled | Equations::PerNode | Equations::PerSpring => &self.normal.rhs[s],
        }
    }

    /// Solves the equations of [`Closed::solve`] for another right-hand side, one number per spring: `w ← M⁻¹ w`. Of tied springs each receives
    /// that of its group.
    pub fn solve_again(&mut self, springs: &Springs, w: &mut [T]) {
        let Some(any) = w.first().cloned() else { return };
        any.vectorize(
            #[inline(always)]
            || match self.equations {
                Equations::Decoupled => {
                    for w in &mut *w {
                        *w = w.clone().scaled(&0.5);
                    }
                }
                Equations::PerNode => self.nodal.solve_again(springs, w),
                Equations::PerSpring => self.normal.substitute(w),
                Equations::PerGroup => {
                    let mut sums = vec![any.zero(); springs.names().len()];
                    // The equations of groups are sums over their springs, and so is their right-hand side.
                    for (w, &group) in w.iter().zip(springs.groups()) {
                        sums[group] = sums[group].clone() + w;
                    }
                    self.tied.substitute(&mut sums);
                    for (w, &group) in w.iter_mut().zip(springs.groups()) {
                        *w = sums[group].clone();
                    }
                }
            },
        );
    }

    /// The weight of the norm.
    pub fn weight(&self) -> ClosedWeight {
        self.weight
    }

    /// The equations of a single element, one per spring.
    pub fn equations_alone(&self, springs: &Springs, x: &[f64], geometry: &Geometry, hooke: &Hooke) -> Normal {
        let mut normal = Normal::default();
        normal_equations(self.weight, springs, x, geometry, hooke, &mut normal);
        normal
    }

    /// The equations that [`Closed::solve`] solved, for bounded constants; none if each constant has an equation of its
    /// own.
    pub fn equations(
        &mut self,
        springs: &Springs,
        x: &[T],
        geometry: &Geometry<T>,
        hooke: &Hooke<T>,
    ) -> Option<&Normal<T>> {
        match self.equations {
            Equations::Decoupled => None,
            // The nodes were solved without any equation of a spring, which is worked out only now, for the few cells with bounds.
            Equations::PerNode => {
                normal_equations(self.weight, springs, x, geometry, hooke, &mut self.normal);
                Some(&self.normal)
            }
            Equations::PerSpring | Equations::PerGroup => Some(&self.kept),
        }
    }
}

impl<T: Packed> Closed<T> {
    /// Replaces the constants of these lanes, after [`Closed::solve`], by the optimum under `k ≥ 0`. False, with nothing changed, where each
    /// constant has an equation of its own, there are too many of them, or the search does not end.
    pub fn bound(
        &mut self,
        springs: &Springs,
        x: &[T],
        geometry: &Geometry<T>,
        hooke: &Hooke<T>,
        lanes: &[usize],
    ) -> bool {
        match self.equations {
            Equations::Decoupled => return false,
            Equations::PerNode if springs.len() > MOST_FACTORED_WITH_NODES => {
                return self.nodal.bound(springs, &mut self.normal.rhs, lanes);
            }
            // The equations of the nodes have no rows of single springs, which bounds need.
            Equations::PerNode => normal_equations(self.weight, springs, x, geometry, hooke, &mut self.kept),
            Equations::PerSpring | Equations::PerGroup if self.kept.size() > MOST_FACTORED => return false,
            Equations::PerSpring | Equations::PerGroup => {}
        }
        let k = if self.equations == Equations::PerGroup { &mut self.tied.rhs } else { &mut self.normal.rhs };
        self.factors.set(&self.kept);
        bound(&mut self.factors, &self.kept.rhs, k, lanes)
    }
}
