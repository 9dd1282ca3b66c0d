//! Least squares in closed form: the constants of one element, or of one per lane, from the node positions alone.

use super::least_squares::{equations, normal_equations};
use super::nodal::{Nodal, is_shorter};
use super::normal::Normal;
use super::{Fit, Objective, Weight};
use crate::element::Tabulation;
use crate::material::Moduli;
use crate::scalar::Real;
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// How a fit solves its equations, and the memory that it does so in.
#[derive(Debug, Clone)]
pub struct Closed<T> {
    pub weight: Weight,
    route: Route,
    nonnegative: bool,
    nodal: Nodal<T>,
    normal: Normal<T>,
    tied: Normal<T>,
    /// The equations before their elimination, where constants are bounded.
    kept: Normal<T>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Route {
    /// `M = 2I`: each constant is half of its right-hand side.
    Decoupled,
    /// By the equations of the nodes, which are fewer than those of the springs.
    Nodes,
    Springs,
    /// One equation per group.
    Groups,
}

impl<T: Real> Closed<T> {
    pub fn of(springs: &Springs, fit: &Fit) -> Closed<T> {
        let lengths_alone = springs.content.is_none() && springs.functions.is_empty() && springs.parallel.is_empty();
        let route = match fit.objective {
            _ if fit.tied => Route::Groups,
            Objective::Frobenius(Weight::OffDiagonal) if lengths_alone => Route::Decoupled,
            Objective::Frobenius(Weight::None) if is_shorter(springs) => Route::Nodes,
            _ => Route::Springs,
        };
        Closed {
            weight: fit.objective.weight().unwrap_or(Weight::None),
            route,
            nonnegative: fit.nonnegative,
            nodal: Nodal::default(),
            normal: Normal::default(),
            tied: Normal::default(),
            kept: Normal::default(),
        }
    }

    /// Whether the blocks of different nodes are asked of springs that measure functions, of which only the gradient is known.
    pub fn is_foreign_to(&self, springs: &Springs) -> bool {
        self.weight == Weight::OffDiagonal && !springs.functions.is_empty()
    }

    /// Solves for the element with nodes at `x`, `[nodes × dimension]`, and fills in its geometry. Returns false if the Jacobian is
    /// not safely positive or the equations are not regular.
    pub fn solve(
        &mut self,
        table: &Tabulation,
        springs: &Springs,
        x: &[T],
        geometry: &mut Geometry<T>,
        moduli: &Moduli,
    ) -> bool
    where
        T: Real,
    {
        if self.route == Route::Nodes {
            return geometry.update(table, x) && self.nodal.solve(springs, x, geometry, moduli, &mut self.normal);
        }
        // A copy for each of the common sizes, in which the loops unroll: for few nodes they are all overhead.
        macro_rules! of_size {
            ($d:literal, $n:expr) => {
                x[0].vectorize(
                    #[inline(always)]
                    || self.solve_in::<$d>($n, table, springs, x, geometry, moduli),
                )
            };
        }
        let regular = match (springs.dimension, springs.nodes) {
            (2, 3) if T::UNROLLED => of_size!(2, 3),
            (2, 4) if T::UNROLLED => of_size!(2, 4),
            (3, 4) if T::UNROLLED => of_size!(3, 4),
            (3, 8) if T::UNROLLED => of_size!(3, 8),
            (1, n) => of_size!(1, n),
            (2, n) => of_size!(2, n),
            (_, n) => of_size!(3, n),
        };
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
        moduli: &Moduli,
    ) -> bool {
        if !geometry.update_in::<D>(n, table, x) {
            return false;
        }
        equations::<T, D>(n, self.weight, springs, x, geometry, moduli, &mut self.normal);
        if self.route == Route::Decoupled {
            for b in &mut self.normal.rhs {
                *b = b.clone().scaled(&0.5);
            }
        }
        true
    }

    /// Solves the equations.
    fn finish(&mut self, springs: &Springs) -> bool {
        let equations = match self.route {
            Route::Decoupled | Route::Nodes => return true,
            Route::Springs => &mut self.normal,
            Route::Groups => {
                self.normal.tied(&springs.groups, springs.names.len(), &mut self.tied);
                &mut self.tied
            }
        };
        if self.nonnegative {
            self.kept.gram.clone_from(&equations.gram);
            self.kept.rhs.clone_from(&equations.rhs);
        }
        equations.solve_regular()
    }

    /// The constant of spring `s` after [`Closed::solve`], N/m, without regard to a bound.
    pub fn constant(&self, springs: &Springs, s: usize) -> &T {
        match self.route {
            Route::Groups => &self.tied.rhs[springs.groups[s]],
            Route::Decoupled | Route::Nodes | Route::Springs => &self.normal.rhs[s],
        }
    }

    /// The equations that [`Closed::solve`] solved, for bounded constants; none where each constant has one of its own.
    pub fn equations(
        &mut self,
        springs: &Springs,
        x: &[T],
        geometry: &Geometry<T>,
        moduli: &Moduli,
    ) -> Option<&Normal<T>> {
        match self.route {
            Route::Decoupled => None,
            Route::Nodes => {
                normal_equations(self.weight, springs, x, geometry, moduli, &mut self.normal);
                Some(&self.normal)
            }
            Route::Springs | Route::Groups => Some(&self.kept),
        }
    }
}
