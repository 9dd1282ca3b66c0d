//! Least-squares fits as formulas: the same kernels, run on exact rational functions of the side lengths.
//!
//! Theory: page *Least squares* of the book.

use super::least_squares::normal_equations;
use super::normal::Normal;
use super::weight::{ClosedWeight, Weight};
use crate::element::{Element, permutations};
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

/// An element whose matrices are formulas. Quantities that are linear in the moduli λ and μ are pairs of coefficients.
#[derive(Debug)]
pub struct ClosedForm {
    /// The names of the variables: of the sides, if they are variable, and of ν.
    pub variables: Vec<String>,
    /// The positions of the nodes, `[nodes × dimension]`, m.
    pub positions: Vec<Fraction>,
    /// The stiffness `R = λ R_λ + μ R_μ`, `[size × size]` each, size = nodes·dimension.
    pub stiffness: [Vec<Fraction>; 2],
    /// The classes of springs that a symmetry of the shape maps onto each other.
    pub classes: Vec<SymmetryClass>,
    /// `‖R‖²` as the coefficients of λ², λμ and μ².
    pub norm: [Fraction; 3],
    /// The springs between all pairs of nodes of the exact network, for [`ClosedForm::exact`].
    exact: Vec<SymmetryClass>,
    springs: Springs,
    plain: [Normal<Fraction>; 2],
    geometry: Geometry<Fraction>,
}

/// Springs that have the same constant because the shape is symmetric.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SymmetryClass {
    /// The group of the springs.
    pub group: String,
    /// The nodes of each spring; all nodes for the spring on the content.
    pub springs: Vec<Vec<usize>>,
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
    /// One pair per class, in N/m: the constants for λ = 1 and for μ = 1.
    pub constants: Vec<[Fraction; 2]>,
    /// `‖R − K‖²` with all entries, as the coefficients of λ², λμ and μ².
    pub residual: [Fraction; 3],
}

impl ClosedForm {
    /// The element at its reference positions or, with `sides`, stretched along its axes to the lengths a, b, c.
    ///
    /// # Errors
    /// The springs belong to another element; a node or shape function is not rational; the element's own quadrature is
    /// not exact on such a shape; or the measure of a spring requires roots.
    pub fn new(element: &Element, springs: &Springs, sides: bool) -> Result<ClosedForm> {
        springs.check(element)?;
        let refuse = |why: &str| {
            Error::new(format!("{} has no closed form: {why}", element.name)).of_kind(ErrorKind::Unsupported)
        };
        if !springs.functions.is_empty() {
            return Err(refuse("its angles, areas, couplings or measures need roots"));
        }
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
        let classes = classes(element, springs, &x);
        let equations = |moduli: Moduli<BigRational>| {
            let mut normal = Normal::default();
            normal_equations(ClosedWeight::None, springs, &x, &geometry, &moduli.of_kind(&x[0]), &mut normal);
            normal
        };
        let plain = units().map(equations);
        let stiffness = units().map(|moduli| stiffness(&geometry, &moduli));
        let norm = quadratic(&stiffness, |a, b| sum(a.iter().zip(b).map(|(a, b)| a.clone() * b), &x[0]));
        let mut exact = self::classes(element, &Springs::exact(element, false, false), &x);
        exact.retain(|class| class.springs[0].len() == 2);
        let springs = springs.clone();
        Ok(ClosedForm { variables, positions: x, stiffness, classes, norm, exact, springs, plain, geometry })
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
    /// The weight has no closed form, such as `relative`, or it does not determine the springs.
    pub fn fit(&self, weight: Weight) -> Result<ClosedFit> {
        let closed = weight.closed(false)?;
        let zero = self.positions[0].zero();
        let mut group = vec![0; self.springs.len()];
        for (i, class) in self.classes.iter().enumerate() {
            for nodes in &class.springs {
                let spring = self.springs.pairs.iter().position(|pair| pair[..] == nodes[..]);
                group[spring.unwrap_or(self.springs.len() - 1)] = i;
            }
        }
        let solve = |normal: &Normal<Fraction>| {
            let mut tied = Normal::default();
            normal.tied(&group, self.classes.len(), &mut tied);
            tied.solve_regular().then_some(tied.rhs)
        };
        let weighted = |moduli: Moduli<BigRational>| {
            let mut normal = Normal::default();
            let moduli = moduli.of_kind(&self.positions[0]);
            normal_equations(closed, &self.springs, &self.positions, &self.geometry, &moduli, &mut normal);
            solve(&normal)
        };
        let solved =
            if closed == ClosedWeight::None { self.plain.each_ref().map(solve) } else { units().map(weighted) };
        let [Some(lambda), Some(mu)] = solved else {
            return Err(Error::new("this weight does not determine the springs").of_kind(ErrorKind::Infeasible));
        };
        // ‖R − K‖² = ‖R‖² − 2 bᵀk + kᵀ M k
        let k = [&lambda, &mu].map(|k| group.iter().map(|i| k[*i].clone()).collect::<Vec<_>>());
        let m = self.springs.len();
        let image = |k: &[Fraction]| -> Vec<Fraction> {
            let entry = |s: usize, t: usize| &self.plain[0].gram[s.max(t) * m + s.min(t)];
            let row = |s: usize| sum((0..m).map(|t| entry(s, t).clone() * &k[t]), &zero);
            (0..m).map(row).collect()
        };
        let images = [image(&k[0]), image(&k[1])];
        let dot = |a: &[Fraction], b: &[Fraction]| sum(a.iter().zip(b).map(|(a, b)| a.clone() * b), &zero);
        let (b, two) = ([&self.plain[0].rhs, &self.plain[1].rhs], BigRational::from_integer(2.into()));
        let work = |i: usize, j: usize| dot(b[i], &k[j]);
        let bent = |i: usize, j: usize| dot(&k[i], &images[j]);
        let less = [work(0, 0).scaled(&two), (work(0, 1) + &work(1, 0)).scaled(&two), work(1, 1).scaled(&two)];
        let more = [bent(0, 0), bent(0, 1).scaled(&two), bent(1, 1)];
        let residual = std::array::from_fn(|i| self.norm[i].clone() - &less[i] + &more[i]);
        let constants = lambda.into_iter().zip(mu).map(|(l, m)| [l, m]).collect();
        Ok(ClosedFit { weight, constants, residual })
    }
}

fn to_f64(value: &BigRational) -> f64 {
    num_traits::ToPrimitive::to_f64(value).unwrap_or(f64::NAN)
}

/// The moduli λ = 1 and μ = 1.
fn units() -> [Moduli<BigRational>; 2] {
    let (one, zero) = (BigRational::from_integer(1.into()), BigRational::from_integer(0.into()));
    [Moduli { lambda: one.clone(), mu: zero.clone() }, Moduli { lambda: zero, mu: one }]
}

fn sum(terms: impl Iterator<Item = Fraction>, any: &Fraction) -> Fraction {
    terms.fold(any.zero(), |sum, term| sum + &term)
}

/// The coefficients of λ², λμ and μ² in a product of two quantities that are linear in both.
fn quadratic(parts: &[Vec<Fraction>; 2], product: impl Fn(&[Fraction], &[Fraction]) -> Fraction) -> [Fraction; 3] {
    let two = BigRational::from_integer(2.into());
    [product(&parts[0], &parts[0]), product(&parts[0], &parts[1]).scaled(&two), product(&parts[1], &parts[1])]
}

/// Whether the rule of the file and the exact rule give the same stiffness of the reference cell.
fn is_exact(element: &Element, exact: &crate::element::Tabulation) -> bool {
    let with = |table: &crate::element::Tabulation| {
        let mut geometry = Geometry::new(table);
        geometry.set(table, &element.positions).ok()?;
        Some(geometry.stiffness(Moduli { lambda: 1.0, mu: 1.0 }))
    };
    match (with(&element.tabulation), with(exact)) {
        (Some(own), Some(exact)) => (&own - &exact).norm() < 1e-10 * exact.norm(),
        _ => false,
    }
}

/// `Σ_q v (λ ∇_a ∇_bᵀ + μ (∇_b ∇_aᵀ + ∇_a·∇_b I))`, `[size × size]`.
fn stiffness(geometry: &Geometry<Fraction>, moduli: &Moduli<BigRational>) -> Vec<Fraction> {
    let (n, d) = (geometry.nodes, geometry.dimension);
    let size = n * d;
    let mut r = vec![geometry.volumes[0].zero(); size * size];
    for (grad, v, w) in geometry.each_point() {
        let (lambda, mu) = (w.clone().scaled(&moduli.lambda), v.clone().scaled(&moduli.mu));
        for a in 0..n {
            for b in 0..=a {
                let (ga, gb) = (&grad[a * d..(a + 1) * d], &grad[b * d..(b + 1) * d]);
                let dot = sum(ga.iter().zip(gb).map(|(x, y)| x.clone() * y), v);
                for k in 0..d {
                    for l in 0..d {
                        let mut entry = (ga[k].clone() * &gb[l]) * &lambda + &((gb[k].clone() * &ga[l]) * &mu);
                        if k == l {
                            entry = entry.plus_product(&mu, &dot);
                        }
                        let place = (a * d + k) * size + b * d + l;
                        r[place] = r[place].clone() + &entry;
                    }
                }
            }
        }
    }
    for i in 0..size {
        for j in i + 1..size {
            r[i * size + j] = r[j * size + i].clone();
        }
    }
    r
}

/// The orbits of the springs under the permutations of nodes that keep every distance, in the order of their first
/// springs.
fn classes(element: &Element, springs: &Springs, x: &[Fraction]) -> Vec<SymmetryClass> {
    let (d, n) = (element.dimension(), element.nodes());
    let square = |a: usize, b: usize| {
        let difference = |k: usize| x[b * d + k].clone() - &x[a * d + k];
        sum((0..d).map(|k| difference(k).squared()), &x[0])
    };
    let squares: Vec<Fraction> = (0..n * n).map(|i| square(i / n, i % n)).collect();
    let keeps = |p: &Vec<usize>| (0..n * n).all(|i| squares[i] == squares[p[i / n] * n + p[i % n]]);
    let symmetries: Vec<Vec<usize>> =
        permutations(element.cell, &element.positions).into_iter().filter(keeps).collect();
    let mut classes: Vec<SymmetryClass> = Vec::new();
    for (s, pair) in springs.pairs.iter().enumerate() {
        let images = symmetries.iter().map(|p| [p[pair[0]], p[pair[1]]]);
        let of = images.clone().find_map(|[a, b]| {
            classes.iter().position(|class| class.springs.iter().any(|t| t[..] == [a, b] || t[..] == [b, a]))
        });
        let group = &springs.names[springs.groups[s]];
        match of.filter(|&i| classes[i].group == *group) {
            Some(i) => classes[i].springs.push(pair.to_vec()),
            None => classes.push(SymmetryClass { group: group.clone(), springs: vec![pair.to_vec()] }),
        }
    }
    if springs.content.is_some() {
        let group = springs.names[springs.groups[springs.len() - 1]].clone();
        classes.push(SymmetryClass { group, springs: vec![(0..n).collect()] });
    }
    classes
}
