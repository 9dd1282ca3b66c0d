//! Polynomials with rational coefficients. An identity between expressions that are polynomials is decided exactly
//! instead of being tested at sample points.

use super::packed::{self, Layout, Packed};
use super::small::{common_divisor, common_multiple, multiple, product, sum};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Pow, Signed, Zero};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::{Add, Mul, Neg, Sub};

/// `Σ c · x₀^e₀ x₁^e₁ …`, with the exponents as keys and without zero coefficients.
///
/// All polynomials of one operation must have the same number of variables.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Polynomial {
    pub(super) terms: BTreeMap<Vec<u32>, BigRational>,
}

impl Polynomial {
    /// `c · x₀^e₀ x₁^e₁ …`.
    pub fn monomial(exponents: Vec<u32>, coefficient: BigRational) -> Polynomial {
        let mut p = Polynomial::default();
        p.add_term(exponents, coefficient);
        p
    }

    /// `c`, as a polynomial in `variables` variables.
    pub fn constant(c: BigRational, variables: usize) -> Polynomial {
        Polynomial::monomial(vec![0; variables], c)
    }

    /// The variable with this index, of `variables` variables.
    pub fn variable(index: usize, variables: usize) -> Polynomial {
        let mut exponents = vec![0; variables];
        exponents[index] = 1;
        Polynomial::monomial(exponents, BigRational::one())
    }

    pub(super) fn add_term(&mut self, exponents: Vec<u32>, coefficient: BigRational) {
        match self.terms.entry(exponents) {
            Entry::Vacant(place) if !coefficient.is_zero() => {
                place.insert(coefficient);
            }
            Entry::Vacant(_) => {}
            Entry::Occupied(mut place) => {
                *place.get_mut() = sum(place.get(), &coefficient);
                if place.get().is_zero() {
                    place.remove();
                }
            }
        }
    }

    /// Whether it is the zero polynomial.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// Whether no variable occurs.
    pub fn is_constant(&self) -> bool {
        self.terms.keys().flatten().all(|e| *e == 0)
    }

    /// Whether it is the number one.
    pub fn is_one(&self) -> bool {
        self.is_constant() && self.terms.values().any(BigRational::is_one)
    }

    /// The number of variables. For the zero polynomial it is not known and returned as 0.
    pub fn variables(&self) -> usize {
        self.terms.keys().next().map_or(0, Vec::len)
    }

    /// The number of terms.
    pub fn term_count(&self) -> usize {
        self.terms.len()
    }

    /// The number of binary digits of the largest numerator or denominator of a coefficient.
    pub fn largest_bits(&self) -> u64 {
        self.terms.values().map(|c| c.numer().bits().max(c.denom().bits())).max().unwrap_or(0)
    }

    /// The total degree: the largest sum of the exponents of a term.
    pub fn degree(&self) -> u32 {
        self.terms.keys().map(|e| e.iter().sum()).max().unwrap_or(0)
    }

    /// The largest exponent of one variable.
    pub fn degree_in(&self, variable: usize) -> u32 {
        self.terms.keys().map(|e| e[variable]).max().unwrap_or(0)
    }

    /// The terms from the highest total degree to the lowest; within a degree, larger powers of earlier variables come
    /// first.
    pub fn sorted(&self) -> Vec<(&[u32], &BigRational)> {
        let mut terms: Vec<(&[u32], &BigRational)> = self.terms.iter().map(|(e, c)| (&e[..], c)).collect();
        terms.sort_by_key(|(e, _)| std::cmp::Reverse((e.iter().sum::<u32>(), *e)));
        terms
    }

    /// The value at the point `at`.
    pub fn evaluate(&self, at: &[BigRational]) -> BigRational {
        let power = |value: BigRational, (x, e): (&BigRational, &u32)| match e {
            _ if x.is_one() => value,
            0 => value,
            _ => value * Pow::pow(x, *e),
        };
        let value = |(e, c): (&Vec<u32>, &BigRational)| at.iter().zip(e).fold(c.clone(), power);
        self.terms.iter().map(value).fold(BigRational::zero(), |a, b| sum(&a, &b))
    }

    /// The derivative `∂self/∂variable`.
    pub fn derivative(&self, variable: usize) -> Polynomial {
        let mut derivative = Polynomial::default();
        for (e, c) in self.terms.iter().filter(|(e, _)| e[variable] > 0) {
            let mut lower = e.clone();
            lower[variable] -= 1;
            derivative.add_term(lower, c * BigRational::from_integer(e[variable].into()));
        }
        derivative
    }

    /// `c · self`.
    pub fn scaled(&self, c: &BigRational) -> Polynomial {
        match c {
            _ if c.is_zero() => Polynomial::default(),
            _ if c.is_one() => self.clone(),
            _ => Polynomial { terms: self.terms.iter().map(|(e, d)| (e.clone(), product(d, c))).collect() },
        }
    }

    /// The number by which `self` has to be divided so that its coefficients are integers without a common divisor, the
    /// first one in the order of [`Self::sorted`] being positive.
    pub fn content(&self) -> BigRational {
        let (mut above, mut below) = (BigInt::zero(), BigInt::one());
        for c in self.terms.values() {
            if !above.is_one() {
                above = common_divisor(&above, c.numer());
            }
            if !c.denom().is_one() {
                below = common_multiple(&below, c.denom());
            }
        }
        let leading = self.terms.iter().max_by_key(|(e, _)| (e.iter().sum::<u32>(), *e));
        if leading.is_some_and(|(_, c)| c.is_negative()) {
            above = -above;
        }
        // A prime that divides all numerators divides no denominator, because each coefficient is in lowest terms.
        BigRational::new_raw(above, below)
    }

    /// `self` divided by its content.
    pub fn primitive(&self) -> Polynomial {
        let content = self.content();
        let integers = self.integers(&content).map(BigRational::from_integer);
        Polynomial { terms: self.terms.keys().cloned().zip(integers).collect() }
    }

    /// For each variable, the largest power that divides every term.
    pub fn monomial_content(&self) -> Vec<u32> {
        let least = |a: Vec<u32>, b: &Vec<u32>| a.iter().zip(b).map(|(a, b)| *a.min(b)).collect();
        let mut exponents = self.terms.keys();
        exponents.next().map_or(Vec::new(), |first| exponents.fold(first.clone(), least))
    }

    /// `self` divided by its monomial content.
    pub fn without_monomial(&self) -> Polynomial {
        self.lowered(&self.monomial_content())
    }

    /// `self` divided by a product of powers that divides every term.
    pub(super) fn lowered(&self, by: &[u32]) -> Polynomial {
        Polynomial { terms: self.terms.iter().map(|(e, c)| (difference(e, by), c.clone())).collect() }
    }

    /// The greatest common divisor of the coefficients, where `self` is read as a polynomial in one variable.
    pub fn content_in(&self, variable: usize) -> Polynomial {
        let mut coefficients = BTreeMap::<u32, Polynomial>::new();
        for (e, c) in &self.terms {
            let mut others = e.clone();
            let power = std::mem::take(&mut others[variable]);
            coefficients.entry(power).or_default().add_term(others, c.clone());
        }
        coefficients.values().fold(Polynomial::default(), |g, c| g.greatest_common_divisor(c))
    }

    /// The quotient `self/divisor`, or `None` if it is not a polynomial.
    ///
    /// # Panics
    /// If the divisor is zero.
    pub fn divided_by(&self, divisor: &Polynomial) -> Option<Polynomial> {
        assert!(!divisor.is_zero(), "a polynomial is divided by zero");
        if self.is_zero() {
            return Some(Polynomial::default());
        }
        // One layout for both, so that their keys can be compared and subtracted.
        let layout = Layout::new((0..self.variables()).map(|v| self.degree_in(v).max(divisor.degree_in(v))));
        let ((c, a), (d, b)) = (self.packed(&layout), divisor.packed(&layout));
        Some(Polynomial::unpacked(&layout.quotient(&a, &b)?, &(c / d), &layout))
    }

    /// Factors that are not constant, with their powers; their product is `self` divided by its content. They are the
    /// variables, and the factors that multiplicities and the sets of variables that occur can separate. A factor need
    /// not be irreducible.
    pub fn factors(&self) -> Vec<(Polynomial, u32)> {
        if self.is_zero() {
            return Vec::new();
        }
        let n = self.variables();
        let variables = self.monomial_content().into_iter().enumerate().filter(|(_, e)| *e > 0);
        let mut factors: Vec<_> = variables.map(|(v, e)| (Polynomial::variable(v, n), e)).collect();
        let rest = self.without_monomial().primitive();
        // A factor of multiplicity e divides every derivative e − 1 times.
        let mut repeated = (0..n).fold(rest.clone(), |g, v| g.greatest_common_divisor(&rest.derivative(v)));
        let mut left = rest.divided_by(&repeated).expect("a divisor divides");
        for power in 1.. {
            if left.is_constant() {
                break;
            }
            let [common, single, others] = left.with_cofactors(&repeated);
            factors.extend(single.split().into_iter().map(|factor| (factor, power)));
            (left, repeated) = (common, others);
        }
        factors
    }

    /// Splits off factors in which not all variables occur; ordered from few terms to many.
    fn split(self) -> Vec<Polynomial> {
        let contents = (0..self.variables()).filter(|v| self.degree_in(*v) > 0).map(|v| self.content_in(v));
        let Some(content) = { contents }.find(|c| !c.is_constant()) else {
            return if self.is_constant() { Vec::new() } else { vec![self] };
        };
        let rest = self.divided_by(&content).expect("a content divides");
        let mut factors = [content.split(), rest.split()].concat();
        // Factors are listed in an order that does not depend on how they were found, so that formulas are printed alike.
        let first = |f: &Polynomial| std::cmp::Reverse(f.terms.keys().rev().cloned().collect::<Vec<_>>());
        factors.sort_by_cached_key(|f| (f.terms.len(), f.degree(), first(f)));
        factors
    }

    /// The content, and the polynomial with integer coefficients that remains.
    fn packed(&self, layout: &Layout) -> (BigRational, Packed) {
        let content = self.content();
        let key = |e: &Vec<u32>| layout.pack(e.iter().copied());
        let terms = self.terms.iter().zip(self.integers(&content));
        let packed = terms.map(|((e, _), c)| (key(e), c)).collect();
        (content, packed)
    }

    /// The coefficients divided by the content.
    pub(super) fn integers<'a>(&'a self, content: &'a BigRational) -> impl Iterator<Item = BigInt> {
        self.terms.values().map(|c| match content.is_one() {
            true => c.numer().clone(),
            false => c.numer() / content.numer() * (content.denom() / c.denom()),
        })
    }

    fn unpacked(packed: &Packed, content: &BigRational, layout: &Layout) -> Polynomial {
        let exponents = |key: u128| {
            let mut exponents: Vec<u32> = layout.unpack(key).collect();
            exponents.reverse();
            exponents
        };
        Polynomial { terms: packed.iter().map(|(key, c)| (exponents(*key), multiple(c, content))).collect() }
    }
}

pub(super) fn difference(a: &[u32], b: &[u32]) -> Vec<u32> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

impl Add for &Polynomial {
    type Output = Polynomial;

    fn add(self, other: &Polynomial) -> Polynomial {
        let mut sum = self.clone();
        for (e, c) in &other.terms {
            sum.add_term(e.clone(), c.clone());
        }
        sum
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;

    fn sub(self, other: &Polynomial) -> Polynomial {
        self + &-other
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;

    fn neg(self) -> Polynomial {
        Polynomial { terms: self.terms.iter().map(|(e, c)| (e.clone(), -c)).collect() }
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;

    fn mul(self, other: &Polynomial) -> Polynomial {
        // Exponents add up in a product: with so many bits none carries into the next.
        let degrees = (0..self.variables()).map(|v| [self, other].map(|p| p.degree_in(v)).iter().sum());
        let layout = Layout::new(degrees);
        let ((c, a), (d, b)) = (self.packed(&layout), other.packed(&layout));
        Polynomial::unpacked(&packed::product(&a, &b), &product(&c, &d), &layout)
    }
}
