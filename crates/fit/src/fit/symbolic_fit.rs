//! Least-squares fits as formulas to be read: the kernels of `least_squares.rs`, which fits numbers, run on exact rational functions of the
//! side lengths.
//!
//! Theory: page *Least squares* of the book.

use super::normal::Normal;
use super::rows::Rows;
use super::symbolic_modulus::{Modulus, sum};
use super::weight::{ClosedWeight, Weight};
use crate::element::{Element, SpringKind, Symmetry, permutations};
use crate::error::{Error, ErrorKind, Result};
use crate::material::Moduli;
use crate::scalar::Scalar;
use crate::springs::Springs;
use crate::stiffness::Geometry;
use crate::symbolic::Fraction;
use num_rational::BigRational;

/// The name of the last variable of all formulas, Poisson's ratio. The side lengths come before it.
pub const RATIO: &str = "nu";
/// The names of the side lengths.
const SIDES: [&str; 3] = ["a", "b", "c"];

/// An element whose matrices are formulas. A quantity that is linear in the moduli has a coefficient for each of them, one that is
/// quadratic has a coefficient for each product, in the order `c₁c₁, c₁c₂, …, c₂c₂, …`.
#[derive(Debug)]
pub struct ClosedForm {
    /// The moduli of the material: λ and μ, or those of an orthotropic one.
    pub moduli: Vec<Modulus>,
    /// The names of the variables: of the sides, if they are variable, and of ν.
    pub variables: Vec<String>,
    /// The positions of the nodes, `[nodes × dimension]`, m.
    pub positions: Vec<Fraction>,
    /// The stiffness for each modulus of one and the others zero, `[size × size]`, size = nodes·dimension.
    pub stiffness: Vec<Vec<Fraction>>,
    /// The classes of springs that a symmetry of the shape and of the material maps onto each other.
    pub classes: Vec<SymmetryClass>,
    /// `‖R‖²`, quadratic in the moduli.
    pub norm: Vec<Fraction>,
    /// The springs between all pairs of nodes of the exact network, for [`ClosedForm::exact`].
    exact: Vec<SymmetryClass>,
    springs: Springs,
    rows: Rows<Fraction>,
    /// The equations of all entries; their right-hand side is unused.
    plain: Normal<Fraction>,
    geometry: Geometry<Fraction>,
}

/// Springs that have the same constant because shape and material are symmetric.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SymmetryClass {
    /// The group of the springs.
    pub group: String,
    /// The nodes of each spring; all nodes for the spring on the content.
    pub springs: Vec<Vec<usize>>,
    /// The place of each among all springs.
    pub places: Vec<usize>,
}

/// The exact network: springs of rest length zero, and springs on the content.
#[derive(Debug)]
#[non_exhaustive]
pub struct ExactForm {
    /// The classes of pairs of nodes that a symmetry of the shape maps onto each other, and the constant of each spring
    /// for μ = 1, in N/m.
    pub pairs: Vec<(SymmetryClass, Fraction)>,
    /// Length, area or volume V of the cell, the sum over all quadrature points.
    pub content: Fraction,
}

/// The constants under one weight.
#[derive(Debug)]
#[non_exhaustive]
pub struct ClosedFit {
    /// The weight.
    pub weight: Weight,
    /// For each class the constants, in N/m, linear in the moduli.
    pub constants: Vec<Vec<Fraction>>,
    /// `‖R − K‖²` with all entries, quadratic in the moduli.
    pub residual: Vec<Fraction>,
}

impl ClosedForm {
    /// The element of an isotropic material at its reference positions or, with `sides`, stretched along its axes to the lengths a, b, c.
    ///
    /// # Errors
    /// The springs belong to another element; a node or shape function is not rational; the element's own quadrature is
    /// not exact on such a shape; or `∇c ∇cᵀ` of the measure of a spring requires roots.
    pub fn new(element: &Element, springs: &Springs, sides: bool) -> Result<ClosedForm> {
        Self::of(element, springs, sides, Modulus::isotropic(element.dimension()))
    }

    /// The element of an orthotropic material whose axes are those of the coordinates, as [`ClosedForm::new`].
    ///
    /// # Errors
    /// Those of [`ClosedForm::new`].
    pub fn orthotropic(element: &Element, springs: &Springs, sides: bool) -> Result<ClosedForm> {
        Self::of(element, springs, sides, Modulus::orthotropic(element.dimension()))
    }

    fn of(element: &Element, springs: &Springs, sides: bool, moduli: Vec<Modulus>) -> Result<ClosedForm> {
        springs.check(element)?;
        element.check_plain("closed forms, which are linear in the moduli")?;
        let refuse = |why: &str| {
            Error::new(format!("{} has no closed form: {why}", element.name)).of_kind(ErrorKind::Unsupported)
        };
        let positions =
            element.rational_positions.as_ref().ok_or_else(|| refuse("a node is not at a rational place"))?;
        let table = element
            .rational_tabulation()
            .ok_or_else(|| refuse("its shape functions are not rational, or no rule integrates them exactly"))?;
        let d = element.dimension();
        let lengths = if sides { &SIDES[..d] } else { &[] };
        let variables: Vec<String> = lengths.iter().map(|s| s.to_string()).chain([RATIO.to_string()]).collect();
        let count = variables.len();
        let x: Vec<Fraction> = positions
            .iter()
            .enumerate()
            .map(|(i, x)| {
                let number = Fraction::number(x.clone(), count);
                if !sides {
                    return number;
                }
                let along = element.cell.corners().iter().map(|c| c[i % d]);
                let extent = along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min);
                let side = Fraction::variable(i % d, count);
                number * side.scaled(&BigRational::from_float(1.0 / extent).expect("an extent is 1 or 2"))
            })
            .collect();
        if !is_exact(element, &table.map(to_f64)) {
            return Err(refuse(
                "closed forms are those of exact integration, and the quadrature of the file is another one; with more points it is exact",
            ));
        }
        let mut geometry = Geometry::like(&x[0], &table);
        if !geometry.update(&table, &x) {
            return Err(refuse("its reference cell is turned inside out"));
        }
        let by_axis = !is_isotropic(&moduli);
        let classes = classes(element, springs, &x, by_axis);
        let (mut functions, mut squares) = (Vec::new(), Vec::new());
        for (f, spring) in springs.functions().iter().enumerate() {
            let at: Vec<Fraction> = spring.nodes.iter().flat_map(|&a| &x[a * d..(a + 1) * d]).cloned().collect();
            let (row, square) = spring.rational_row(&at, d).ok_or_else(|| {
                let group = &springs.names()[springs.groups()[springs.pairs().len() + f]];
                refuse(&format!("what its springs \"{group}\" measure needs roots, or has no gradient on this shape"))
            })?;
            let mut whole = vec![x[0].zero(); x.len()];
            for (&a, row) in spring.nodes.iter().zip(row.chunks_exact(d)) {
                (0..d).for_each(|k| whole[a * d + k] = whole[a * d + k].clone() + &row[k]);
            }
            functions.extend(whole);
            squares.push(square);
        }
        let rows = Rows::new(springs, &x, &geometry, (functions, squares));
        let stiffness: Vec<_> = moduli.iter().map(|modulus| modulus.stiffness(&geometry)).collect();
        let plain = rows.normal(ClosedWeight::None, &x, &stiffness[0]);
        let norm = quadratic(moduli.len(), |i, j| inner(&stiffness[i], &stiffness[j]));
        let mut exact = self::classes(element, &Springs::exact(element, false, false), &x, by_axis);
        exact.retain(|class| class.springs[0].len() == 2);
        let springs = springs.clone();
        Ok(ClosedForm {
            moduli,
            variables,
            positions: x,
            stiffness,
            classes,
            norm,
            exact,
            springs,
            rows,
            plain,
            geometry,
        })
    }

    /// The exact network: `k_ab = −μ ∫ ∇N_a·∇N_b dV` of every pair of nodes, and the content.
    pub fn exact(&self) -> ExactForm {
        let (n, d) = (self.geometry.nodes, self.geometry.dimension);
        let constant = |class: &SymmetryClass| {
            let (a, b) = (class.springs[0][0], class.springs[0][1]);
            let points = self.geometry.gradients.chunks_exact(n * d).zip(&self.geometry.volumes);
            let product = points.map(|(grad, volume)| {
                let dot = (0..d).map(|k| grad[a * d + k].clone() * &grad[b * d + k]);
                sum(dot, volume) * volume
            });
            let zero = self.positions[0].zero();
            zero.clone() - &sum(product, &zero)
        };
        let pairs = self.exact.iter().map(|class| (class.clone(), constant(class))).collect();
        ExactForm { pairs, content: self.geometry.content() }
    }

    /// The constants under this weight.
    ///
    /// # Errors
    /// The weight has no closed form, such as `relative`; or the weight does not determine the springs.
    pub fn fit(&self, weight: Weight) -> Result<ClosedFit> {
        let closed = weight.closed(false)?;
        let zero = self.positions[0].zero();
        let mut group = vec![0; self.springs.len()];
        for (i, class) in self.classes.iter().enumerate() {
            class.places.iter().for_each(|&spring| group[spring] = i);
        }
        let solve = |normal: &Normal<Fraction>| {
            let mut tied = Normal::default();
            // The mean of an optimum over all symmetries is an optimum too, as the norm is convex and none of them
            // changes it: equal constants in a class lose nothing.
            normal.tied(&group, self.classes.len(), &mut tied);
            let none = || Error::new("this weight does not determine the springs").of_kind(ErrorKind::Infeasible);
            tied.solve_regular().then_some(tied.rhs).ok_or_else(none)
        };
        let solved = match closed {
            ClosedWeight::Modal(_) => {
                let of_stiffness = |r: &Vec<Fraction>| solve(&self.rows.normal(closed, &self.positions, r));
                self.stiffness.iter().map(of_stiffness).collect::<Result<Vec<_>>>()?
            }
            // M is that of the springs alone: it is worked out once, whatever modulus it is asked for, and only b changes.
            ClosedWeight::None | ClosedWeight::OffDiagonal => {
                let normal = self.rows.normal(closed, &self.positions, &self.stiffness[0]);
                let of_stiffness = |r: &Vec<Fraction>| {
                    let mut normal = normal.clone();
                    normal.rhs = self.rows.works(r, closed == ClosedWeight::OffDiagonal);
                    solve(&normal)
                };
                self.stiffness.iter().map(of_stiffness).collect::<Result<Vec<_>>>()?
            }
        };
        // ‖R − K‖² = ‖R‖² − 2 bᵀk + kᵀ M k
        let spread = |k: &Vec<Fraction>| group.iter().map(|i| k[*i].clone()).collect::<Vec<_>>();
        let k: Vec<Vec<Fraction>> = solved.iter().map(spread).collect();
        let m = self.springs.len();
        let image = |k: &Vec<Fraction>| -> Vec<Fraction> {
            let entry = |s: usize, t: usize| &self.plain.gram[s.max(t) * m + s.min(t)];
            let row = |s: usize| sum((0..m).map(|t| entry(s, t).clone() * &k[t]), &zero);
            (0..m).map(row).collect()
        };
        let images: Vec<_> = k.iter().map(image).collect();
        let works: Vec<_> = self.stiffness.iter().map(|r| self.rows.works(r, false)).collect();
        let less = |i: usize, j: usize| inner(&works[i], &k[j]) + &inner(&works[j], &k[i]);
        let more = |i: usize, j: usize| inner(&k[i], &images[j]);
        let change = quadratic(self.moduli.len(), |i, j| more(i, j) - &less(i, j));
        let residual = self.norm.iter().zip(&change).map(|(norm, change)| norm.clone() + change).collect();
        let class = |i: usize| solved.iter().map(|k| k[i].clone()).collect();
        Ok(ClosedFit { weight, constants: (0..self.classes.len()).map(class).collect(), residual })
    }
}

fn to_f64(value: &BigRational) -> f64 {
    num_traits::ToPrimitive::to_f64(value).unwrap_or(f64::NAN)
}

/// Orthotropic materials have one, four or nine moduli.
fn is_isotropic(moduli: &[Modulus]) -> bool {
    moduli.len() == 2
}

fn inner(a: &[Fraction], b: &[Fraction]) -> Fraction {
    sum(a.iter().zip(b).map(|(a, b)| a.clone() * b), &a[0])
}

/// The coefficients of a symmetric quadratic form with these entries.
fn quadratic(count: usize, entry: impl Fn(usize, usize) -> Fraction) -> Vec<Fraction> {
    let two = BigRational::from_integer(2.into());
    let pairs = (0..count).flat_map(|i| (i..count).map(move |j| (i, j)));
    pairs.map(|(i, j)| if i == j { entry(i, i) } else { entry(i, j).scaled(&two) }).collect()
}

/// Whether the rule of the file and the exact rule give the same stiffness of the reference cell.
fn is_exact(element: &Element, exact: &crate::element::Tabulation) -> bool {
    let with = |table: &crate::element::Tabulation| {
        let mut geometry = Geometry::new(table);
        geometry.set(table, &element.positions).ok()?;
        Some(geometry.stiffness(Moduli { lambda: 1.0, mu: 1.0 }))
    };
    match (with(&element.tabulation), with(exact)) {
        // Two exact rules differ by rounding, 1e-15, and a rule that is not exact differs in its first digits.
        (Some(own), Some(exact)) => (&own - &exact).norm() < 1e-10 * exact.norm(),
        _ => false,
    }
}

/// The orbits of the springs under the permutations of nodes that keep every distance or, `by_axis`, every distance along an axis, in
/// the order of their first springs.
fn classes(element: &Element, springs: &Springs, x: &[Fraction], by_axis: bool) -> Vec<SymmetryClass> {
    let (d, n) = (element.dimension(), element.nodes());
    let square = |a: usize, b: usize| {
        let along = (0..d).map(|k| (x[b * d + k].clone() - &x[a * d + k]).squared());
        if by_axis { along.collect() } else { vec![sum(along, &x[0])] }
    };
    let squares: Vec<Vec<Fraction>> = (0..n * n).map(|i| square(i / n, i % n)).collect();
    let pairs = springs.pairs().iter().map(|pair| (SpringKind::Length, pair.to_vec()));
    let functions = springs.functions().iter().map(|f| (f.kind, f.nodes.clone()));
    let all: Vec<(SpringKind, Vec<usize>)> = pairs.chain(functions).collect();
    let known = |kind: SpringKind, nodes: &[usize]| (kind, kind.properties().symmetry.representative(nodes));
    let own: Vec<(SpringKind, Vec<usize>)> = all.iter().map(|(kind, nodes)| known(*kind, nodes)).collect();
    // A symmetry takes every spring to a spring. What a user's own expression measures may change where the element is mirrored.
    let takes = |p: &[usize], kind: SpringKind, nodes: &[usize]| {
        let image: Vec<usize> = nodes.iter().map(|&a| p[a]).collect();
        image == *nodes || kind.properties().symmetry != Symmetry::Ordered && own.contains(&known(kind, &image))
    };
    let keeps = |p: &Vec<usize>| {
        // Squares of distances are rational where the nodes are, so that they are compared exactly.
        (0..n * n).all(|i| squares[i] == squares[p[i / n] * n + p[i % n]])
            && all.iter().all(|(kind, nodes)| takes(p, *kind, nodes))
    };
    let symmetries: Vec<Vec<usize>> =
        permutations(element.cell, &element.positions).into_iter().filter(keeps).collect();
    let mut classes: Vec<SymmetryClass> = Vec::new();
    for (s, (kind, nodes)) in all.iter().enumerate() {
        let symmetry = kind.properties().symmetry;
        let mut images =
            symmetries.iter().map(|p| symmetry.representative(&nodes.iter().map(|&a| p[a]).collect::<Vec<_>>()));
        let group = &springs.names()[springs.groups()[s]];
        let of = images.find_map(|image| {
            let is_like = |class: &SymmetryClass| {
                class.group == *group && class.springs.iter().any(|t| symmetry.representative(t) == image)
            };
            classes.iter().position(is_like)
        });
        match of {
            Some(i) => {
                classes[i].springs.push(nodes.clone());
                classes[i].places.push(s);
            }
            None => classes.push(SymmetryClass { group: group.clone(), springs: vec![nodes.clone()], places: vec![s] }),
        }
    }
    if springs.content().is_some() {
        let last = springs.len() - 1;
        let group = springs.names()[springs.groups()[last]].clone();
        classes.push(SymmetryClass { group, springs: vec![(0..n).collect()], places: vec![last] });
    }
    classes
}
