//! Fractions keep the rules of a field, agree with numbers, and solve a system of equations exactly.

use num_rational::BigRational;
use num_traits::{One, Zero};
use springfit_foundation::scalar::Scalar;
use springfit_foundation::symbolic::{Fraction, Polynomial};

/// Numbers of a linear congruence, the same each time.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }

    fn rational(&mut self) -> BigRational {
        BigRational::new((self.below(41) as i64 - 20).into(), (1 + self.below(6) as i64).into())
    }

    fn point(&mut self, variables: usize) -> Vec<BigRational> {
        (0..variables).map(|_| self.rational() + BigRational::new(1.into(), 97.into())).collect()
    }

    /// Up to `terms` terms with exponents up to `degree` each; never zero.
    fn polynomial(&mut self, variables: usize, terms: usize, degree: u64) -> Polynomial {
        let mut sum = Polynomial::default();
        while sum.is_zero() {
            for _ in 0..terms {
                let exponents = (0..variables).map(|_| self.below(degree + 1) as u32).collect();
                sum = &sum + &Polynomial::monomial(exponents, self.rational());
            }
        }
        sum
    }

    /// Up to `terms` terms that all have the sum of exponents `degree`.
    fn homogeneous(&mut self, variables: usize, terms: usize, degree: u32, step: u32) -> Polynomial {
        let mut sum = Polynomial::default();
        while sum.is_zero() {
            for _ in 0..terms {
                let mut exponents = vec![0; variables];
                (0..degree).for_each(|_| exponents[self.below(variables as u64) as usize] += step);
                sum = &sum + &Polynomial::monomial(exponents, self.rational());
            }
        }
        sum
    }

    fn fraction(&mut self, variables: usize) -> Fraction {
        Fraction::new(self.polynomial(variables, 3, 2), self.polynomial(variables, 2, 2))
    }
}

fn integer(c: i64) -> BigRational {
    BigRational::from_integer(c.into())
}

fn polynomial(terms: &[(i64, &[u32])]) -> Polynomial {
    let terms = terms.iter().map(|(c, e)| Polynomial::monomial(e.to_vec(), integer(*c)));
    terms.fold(Polynomial::default(), |sum, term| &sum + &term)
}

fn product(factors: &[&Polynomial]) -> Polynomial {
    factors[1..].iter().fold(factors[0].clone(), |product, factor| &product * factor)
}

/// Checks `gcd(p g, q g)` against its definition, and that what it leaves has no divisor.
fn check_divisor(p: &Polynomial, q: &Polynomial, g: &Polynomial) {
    let (a, b) = (p * g, q * g);
    let [divisor, left_a, left_b] = a.with_cofactors(&b);
    assert!(divisor.divided_by(g).is_some(), "{divisor:?} is not divisible by {g:?}");
    assert_eq!(divisor.content(), BigRational::from_integer(1.into()));
    assert_eq!(&divisor * &left_a, a);
    assert_eq!(&divisor * &left_b, b);
    assert_eq!(a.divided_by(&divisor), Some(left_a.clone()));
    assert!(left_a.greatest_common_divisor(&left_b).is_one());
    assert_eq!(b.greatest_common_divisor(&a), divisor);
}

#[test]
fn divisors_divide_and_are_the_greatest() {
    let mut random = Random(1);
    for round in 0..400 {
        let variables = 1 + round % 5;
        let mut next = || random.polynomial(variables, 1 + round % 7, 3);
        check_divisor(&next(), &next(), &next());
    }
}

/// By Euclid's algorithm, in one variable; coefficients from the constant on.
fn euclid(mut a: Vec<BigRational>, mut b: Vec<BigRational>) -> Vec<BigRational> {
    let trim = |p: &mut Vec<BigRational>| p.truncate(p.iter().rposition(|c| !c.is_zero()).map_or(0, |last| last + 1));
    trim(&mut b);
    while !b.is_empty() {
        while a.len() >= b.len() {
            let (factor, shift) = (&a[a.len() - 1] / &b[b.len() - 1], a.len() - b.len());
            for (i, c) in b.iter().enumerate() {
                a[shift + i] -= &factor * c;
            }
            trim(&mut a);
        }
        std::mem::swap(&mut a, &mut b);
    }
    a
}

/// Where the other variables have random values, the divisor has the degree that Euclid's algorithm finds.
#[test]
fn divisors_have_the_degree_of_euclids() {
    let mut random = Random(11);
    let mut common = 0;
    for round in 0..150 {
        let variables = 1 + round % 4;
        let mut next = || random.polynomial(variables, 2 + round % 5, 2);
        let (p, q, g) = (next(), next(), next());
        let (a, b) = match round % 3 {
            0 => (p, q),
            1 => (product(&[&p, &g]), product(&[&q, &g])),
            _ => (product(&[&p, &p, &q]), product(&[&p, &q, &q, &g])),
        };
        let others: Vec<BigRational> = (1..variables).map(|_| integer(random.below(1 << 30) as i64)).collect();
        let coefficients = |p: &Polynomial| {
            let mut coefficients = vec![BigRational::from_integer(0.into()); p.degree_in(0) as usize + 1];
            for (e, c) in p.sorted() {
                coefficients[e[0] as usize] += Polynomial::monomial(e[1..].to_vec(), c.clone()).evaluate(&others);
            }
            coefficients
        };
        let degree = euclid(coefficients(&a), coefficients(&b)).len() - 1;
        assert_eq!(a.greatest_common_divisor(&b).degree_in(0) as usize, degree);
        common += usize::from(degree > 0);
    }
    assert!((50..150).contains(&common));
}

#[test]
fn divisors_of_five_variables_and_degree_forty() {
    let mut random = Random(12);
    for homogeneous in [false, true] {
        let mut next = || match homogeneous {
            true => random.homogeneous(5, 15, 20, 1),
            false => random.polynomial(5, 15, 8),
        };
        let (p, q, g) = (next(), next(), next());
        check_divisor(&p, &q, &g);
    }
}

#[test]
fn divisors_of_differences_of_powers() {
    let power = |n: u32| polynomial(&[(1, &[n, 0]), (-1, &[0, n])]);
    assert_eq!(power(12).greatest_common_divisor(&power(18)), power(6));
    assert_eq!(power(40).greatest_common_divisor(&power(27)), power(1));
    let (zero, six) = (Polynomial::default(), power(3).scaled(&integer(-6)));
    assert_eq!(zero.greatest_common_divisor(&six), power(3));
    assert_eq!(six.greatest_common_divisor(&zero), power(3));
    assert!(zero.greatest_common_divisor(&zero).is_zero());
    assert!(six.greatest_common_divisor(&Polynomial::constant(integer(4), 2)).is_one());
}

#[test]
fn divisors_of_homogeneous_and_even_polynomials() {
    let mut random = Random(2);
    for round in 0..200 {
        let (variables, step) = (2 + round % 4, 1 + (round % 2) as u32);
        let mut next = |degree| random.homogeneous(variables, 6, degree, step);
        check_divisor(&next(3), &next(4), &next(5));
    }
}

#[test]
fn divisors_of_polynomials_in_different_variables() {
    let mut random = Random(3);
    let moved = |p: &Polynomial, by: usize| {
        let place = |e: &[u32]| (0..5).map(|v| e.get((v + by) % 5).copied().unwrap_or(0)).collect::<Vec<u32>>();
        let terms = p.sorted().into_iter().map(|(e, c)| Polynomial::monomial(place(e), c.clone()));
        terms.fold(Polynomial::default(), |a, b| &a + &b)
    };
    for round in 0..200 {
        let mut next = |by| moved(&random.polynomial(1 + round % 3, 4, 3), by);
        check_divisor(&next(0), &next(1), &next(2));
        check_divisor(&next(0), &next(0), &next(3));
    }
}

#[test]
fn divisors_with_large_coefficients() {
    let mut random = Random(4);
    let large =
        |p: &Polynomial| p.scaled(&BigRational::new("1".repeat(50).parse().unwrap(), "7".repeat(41).parse().unwrap()));
    for _ in 0..30 {
        let mut next = || {
            let p = &large(&random.polynomial(3, 5, 3)) + &random.polynomial(3, 4, 3);
            if p.is_zero() { Polynomial::constant(integer(1), 3) } else { p }
        };
        check_divisor(&next(), &next(), &next());
    }
}

#[test]
fn what_does_not_divide_is_not_divided() {
    let mut random = Random(5);
    for _ in 0..200 {
        let (p, q) = (random.polynomial(3, 5, 3), random.polynomial(3, 4, 2));
        let product = &p * &q;
        assert_eq!(product.divided_by(&q), Some(p.clone()));
        if !q.is_constant() {
            assert_eq!((&product + &Polynomial::constant(integer(1), 3)).divided_by(&q), None);
        }
    }
}

#[test]
fn polynomials_agree_with_their_values() {
    let mut random = Random(6);
    for _ in 0..100 {
        let (p, q, at) = (random.polynomial(4, 6, 3), random.polynomial(4, 6, 3), random.point(4));
        assert_eq!((&p + &q).evaluate(&at), p.evaluate(&at) + q.evaluate(&at));
        assert_eq!((&p - &q).evaluate(&at), p.evaluate(&at) - q.evaluate(&at));
        assert_eq!((&p * &q).evaluate(&at), p.evaluate(&at) * q.evaluate(&at));
        assert_eq!((-&p).evaluate(&at), -p.evaluate(&at));
        assert_eq!(p.primitive().scaled(&p.content()), p);
    }
}

#[test]
fn factors_multiply_to_the_polynomial() {
    let mut random = Random(7);
    for _ in 0..60 {
        let [p, q, r] = std::array::from_fn(|_| random.polynomial(3, 3, 2));
        let whole = product(&[&p, &q, &q, &r, &r, &r]);
        let mut again = Polynomial::constant(whole.content(), 3);
        for (factor, power) in whole.factors() {
            assert!(!factor.is_constant() && factor.content().is_one());
            (0..power).for_each(|_| again = &again * &factor);
        }
        assert_eq!(again, whole);
    }
    assert!(Polynomial::default().factors().is_empty());
    assert!(Polynomial::constant(integer(-3), 2).factors().is_empty());
}

#[test]
fn fractions_are_a_field() {
    let mut random = Random(8);
    for round in 0..60 {
        let variables = 1 + round % 4;
        let [x, y, z] = std::array::from_fn(|_| random.fraction(variables));
        assert_eq!(&(&x + &y) + &z, &x + &(&y + &z));
        assert_eq!(&(&x * &y) * &z, &x * &(&y * &z));
        assert_eq!(&x * &(&y + &z), &(&x * &y) + &(&x * &z));
        assert_eq!(&x + &y, &y + &x);
        assert_eq!(&x * &y, &y * &x);
        assert_eq!(&(&x - &y) + &y, x);
        assert_eq!(&(&x / &y) * &y, x);
        assert_eq!(&x / &x, x.one());
        assert_eq!(&x - &x, x.zero());
        assert_eq!(x.clone() + &x.zero(), x);
        assert_eq!(x.clone() * &x.one(), x);
        assert_eq!(-x.clone(), x.zero() - &x);
        assert_eq!(z.clone().plus_product(&x, &y), &z + &(&x * &y));
        assert_eq!(z.clone().minus_product(&x, &y), &z - &(&x * &y));
        assert_eq!(x.clone().scaled(&integer(3)), &(&x + &x) + &x);
        assert!(x.numerator().greatest_common_divisor(x.denominator()).is_one());
    }
}

#[test]
fn fractions_agree_with_their_values() {
    let mut random = Random(9);
    for _ in 0..100 {
        let (x, y, at) = (random.fraction(3), random.fraction(3), random.point(3));
        let (Some(a), Some(b)) = (x.evaluate(&at), y.evaluate(&at)) else { continue };
        assert_eq!((&x + &y).evaluate(&at), Some(&a + &b));
        assert_eq!((&x - &y).evaluate(&at), Some(&a - &b));
        assert_eq!((&x * &y).evaluate(&at), Some(&a * &b));
        if !b.is_zero() {
            assert_eq!((&x / &y).evaluate(&at), Some(a / b));
        }
    }
}

/// Lengths that differ a little, so that no pivot is zero because two of them are equal.
#[test]
fn signs_are_those_where_the_variables_are_nearly_one() {
    let [a, b] = [0, 1].map(|v| Fraction::variable(v, 2));
    let (sum, one) = (&a + &b, a.constant(&integer(1)));
    assert!(sum.exceeds(&a) && !a.exceeds(&sum));
    assert!(b.exceeds(&a) && !a.exceeds(&b) && !a.exceeds(&one) && !one.exceeds(&a));
    let pole = &a / &(&a - &one);
    assert!(!pole.exceeds(&a) && !a.exceeds(&pole));
    assert_eq!(pole.evaluate(&[integer(1), integer(1)]), None);
    assert_eq!(Fraction::exact(0.375), BigRational::new(3.into(), 8.into()));
}

/// `a² + b²`, `a² + b² + c²` and the like, which the lengths of diagonals have in common.
fn diagonals() -> Vec<Polynomial> {
    let squares: [&[u32]; 3] = [&[2, 0, 0], &[0, 2, 0], &[0, 0, 2]];
    [&[0, 1][..], &[0, 2], &[1, 2], &[0, 1, 2]]
        .iter()
        .map(|set| polynomial(&set.iter().map(|v| (1, squares[*v])).collect::<Vec<_>>()))
        .collect()
}

/// Solves `A x = b` for symmetric `A` by `L D Lᵀ`, in exact arithmetic.
fn solve(a: &[Vec<Fraction>], b: &[Fraction]) -> Vec<Fraction> {
    let n = b.len();
    let (mut l, mut x) = (a.to_vec(), b.to_vec());
    for s in 0..n {
        for t in 0..s {
            for r in 0..t {
                let (done, other) = (l[s][r].clone(), l[t][r].clone());
                l[s][t] = l[s][t].clone().minus_product(&done, &other);
            }
        }
        for t in 0..s {
            let scaled = l[s][t].clone() / &l[t][t];
            l[s][s] = l[s][s].clone().minus_product(&l[s][t].clone(), &scaled);
            l[s][t] = scaled;
        }
        assert!(!l[s][s].is_zero());
        for t in 0..s {
            x[s] = x[s].clone().minus_product(&l[s][t], &x[t].clone());
        }
    }
    for s in (0..n).rev() {
        x[s] = x[s].clone() / &l[s][s];
        for t in s + 1..n {
            x[s] = x[s].clone().minus_product(&l[t][s], &x[t].clone());
        }
    }
    x
}

fn check_solution(a: &[Vec<Fraction>], b: &[Fraction]) {
    let x = solve(a, b);
    for (row, b) in a.iter().zip(b) {
        let residual = row.iter().zip(&x).fold(b.clone(), |sum, (a, x)| sum.minus_product(a, x));
        assert!(residual.is_zero());
    }
}

fn symmetric(n: usize, mut entry: impl FnMut(usize, usize) -> Fraction) -> Vec<Vec<Fraction>> {
    let mut a: Vec<Vec<Fraction>> = Vec::new();
    for s in 0..n {
        let row = (0..n).map(|t| if t < s { a[t][s].clone() } else { entry(s, t) }).collect();
        a.push(row);
    }
    a
}

/// Squares of lengths over squares of diagonals, as in the equations of seven springs.
#[test]
fn a_system_of_seven_equations_is_solved_exactly() {
    let (mut random, diagonals) = (Random(10), diagonals());
    let mut entry = |_, _| {
        let denominator = diagonals[random.below(4) as usize].clone();
        Fraction::new(random.homogeneous(3, 2, 1, 2), denominator)
    };
    let a = symmetric(7, &mut entry);
    let b: Vec<Fraction> = (0..7).map(|_| entry(0, 0)).collect();
    check_solution(&a, &b);
}

/// The same with terms of another degree, so that no variable can be saved.
#[test]
fn a_system_without_homogeneity_is_solved_exactly() {
    let (mut random, diagonals) = (Random(13), diagonals());
    let mut entry = |_, _| {
        let above = &random.homogeneous(3, 2, 1, 2) + &random.homogeneous(3, 1, 1, 1);
        Fraction::new(above, diagonals[random.below(4) as usize].clone())
    };
    let a = symmetric(4, &mut entry);
    let b: Vec<Fraction> = (0..4).map(|_| entry(0, 0)).collect();
    check_solution(&a, &b);
}

#[test]
fn text_and_latex() {
    let names = ["a", "b"];
    let written = |above: &Polynomial, below: &Polynomial| {
        let fraction = Fraction::new(above.clone(), below.clone());
        (fraction.text(&names), fraction.latex(&names))
    };
    let check = |above: &Polynomial, below: &Polynomial, text: &str, latex: &str| {
        assert_eq!(written(above, below), (text.to_string(), latex.to_string()));
    };
    let one = polynomial(&[(1, &[0, 0])]);
    let (a, b) = (polynomial(&[(1, &[1, 0])]), polynomial(&[(1, &[0, 1])]));
    let squares = polynomial(&[(1, &[2, 0]), (1, &[0, 2])]);
    let difference = polynomial(&[(1, &[2, 0]), (-1, &[0, 2])]);
    let third = BigRational::new((-3).into(), 8.into());
    check(
        &polynomial(&[(3, &[0, 2]), (5, &[2, 0])]),
        &polynomial(&[(8, &[1, 1])]),
        "(5*a^2 + 3*b^2)/(8*a*b)",
        r"\frac{5 a^{2} + 3 b^{2}}{8 a b}",
    );
    check(&Polynomial::default(), &one, "0", "0");
    check(&one, &one, "1", "1");
    check(&one.scaled(&third), &one, "-3/8", r"-\frac{3}{8}");
    check(&a.scaled(&third), &one, "-3/8*a", r"-\frac{3}{8} a");
    check(&a, &b, "a/b", r"\frac{a}{b}");
    check(&one, &product(&[&b, &b]), "1/b^2", r"\frac{1}{b^{2}}");
    check(&(-&a), &b, "-a/b", r"-\frac{a}{b}");
    check(&squares, &one, "a^2 + b^2", "a^{2} + b^{2}");
    check(&(-&difference), &one, "-(a^2 - b^2)", "-(a^{2} - b^{2})");
    check(&product(&[&a, &squares]), &one, "a*(a^2 + b^2)", "a (a^{2} + b^{2})");
    check(
        &product(&[&a, &squares]).scaled(&third),
        &product(&[&difference, &difference]),
        "-3*a*(a^2 + b^2)/(8*(a^2 - b^2)^2)",
        r"-\frac{3 a (a^{2} + b^{2})}{8 (a^{2} - b^{2})^{2}}",
    );
    check(
        &product(&[&squares, &squares]),
        &difference,
        "(a^2 + b^2)^2/(a^2 - b^2)",
        r"\frac{(a^{2} + b^{2})^{2}}{a^{2} - b^{2}}",
    );
    check(
        &polynomial(&[(1, &[1, 0]), (-1, &[0, 0])]).scaled(&BigRational::new(1.into(), 6.into())),
        &one,
        "1/6*(a - 1)",
        r"\frac{1}{6} (a - 1)",
    );
}

#[test]
fn factors_of_fewer_variables_are_told_apart() {
    let names = ["a", "b", "c"];
    let all = diagonals();
    let factors: Vec<&Polynomial> = all.iter().chain([&all[0], &all[3]]).collect();
    let fraction = Fraction::new(polynomial(&[(1, &[0, 0, 0])]), product(&factors));
    assert_eq!(fraction.text(&names), "1/((a^2 + c^2)*(b^2 + c^2)*(a^2 + b^2)^2*(a^2 + b^2 + c^2)^2)");
}

#[test]
fn polynomials_are_written_from_high_to_low_degree() {
    let p = polynomial(&[(-1, &[0, 0]), (2, &[1, 1]), (-3, &[0, 3]), (1, &[1, 2]), (1, &[0, 1])]);
    assert_eq!(p.text(&["a", "b"]), "a*b^2 - 3*b^3 + 2*a*b + b - 1");
    assert_eq!(p.latex(&["x", r"\lambda"]), r"x \lambda^{2} - 3 \lambda^{3} + 2 x \lambda + \lambda - 1");
}

/// Numbers of one word are worked with apart from those of more, with the same results in lowest terms.
#[test]
fn numbers_of_one_word_are_those_of_many() {
    let most = i128::from(i64::MAX);
    let above = [0, 1, -1, 6, -(1 << 32), 3 << 40, 1 << 62, most, -most, -most - 1, most + 1, 5 * most];
    let below = [1, 6, 15, 3 << 40, 1 << 62, most - 1, most, 7 * most];
    let numbers: Vec<BigRational> =
        above.iter().flat_map(|a| below.iter().map(|b| BigRational::new((*a).into(), (*b).into()))).collect();
    let same = |found: &BigRational, expected: &BigRational| {
        (found.numer(), found.denom()) == (expected.numer(), expected.denom())
    };
    for a in &numbers {
        for b in &numbers {
            let [p, q] = [a, b].map(|c| Fraction::number(c.clone(), 1));
            assert!(same((&p + &q).content(), &(a + b)), "{a} + {b}: {:?}", &p + &q);
            assert!(same((&p * &q).content(), &(a * b)), "{a} * {b}: {:?}", &p * &q);
            let terms = Polynomial::monomial(vec![1], a * integer(6)).scaled(b);
            assert_eq!(terms, Polynomial::monomial(vec![1], a * integer(6) * b), "{a} {b}");
            let sum = &Polynomial::monomial(vec![2], a.clone()) + &Polynomial::monomial(vec![0], b.clone());
            let content = sum.content();
            assert!(sum.is_zero() || sum.primitive().content().is_one(), "{a} x² + {b}: {content}");
            assert_eq!(sum.primitive().scaled(&content), sum, "{a} x² + {b}: {content}");
        }
    }
}
