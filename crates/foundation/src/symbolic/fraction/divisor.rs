//! Greatest common divisors of polynomials by Brown's modular algorithm (J. ACM 18, 1971).
//!
//! The polynomials are reduced modulo primes and evaluated at random values of all variables but one; the divisors of
//! these images follow from Euclid's algorithm. Interpolation and the Chinese remainder theorem recover the divisor. A
//! result is accepted once it divides both polynomials and their quotients have no common divisor.

use super::Polynomial;
use super::field::Field;
use super::lattice::Lattice;
use super::packed::{Layout, Packed, make_primitive, product};
use super::polynomial::difference;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Zero};
use std::collections::BTreeMap;

impl Polynomial {
    /// The common divisor of largest degree. Its integer coefficients have no common divisor, and the first one in the
    /// order of [`Polynomial::sorted`] is positive. It is zero if both polynomials are zero.
    pub fn greatest_common_divisor(&self, other: &Polynomial) -> Polynomial {
        let [divisor, _, _] = self.with_cofactors(other);
        divisor
    }

    /// The greatest common divisor, `self` divided by it, and `other` divided by it.
    pub fn with_cofactors(&self, other: &Polynomial) -> [Polynomial; 3] {
        let (a, b) = (self, other);
        if a.is_zero() || b.is_zero() {
            let divisor = (a + b).primitive();
            let content = |p: &Polynomial| Polynomial::constant(p.content(), divisor.variables());
            return [divisor.clone(), content(a), content(b)];
        }
        let (least_a, least_b) = (a.monomial_content(), b.monomial_content());
        let least: Vec<u32> = least_a.iter().zip(&least_b).map(|(a, b)| *a.min(b)).collect();
        let divisor = Polynomial::monomial(least.clone(), BigRational::one());
        // A single term has no divisors but powers of the variables, which `least` has.
        if a.terms.len() == 1 || b.terms.len() == 1 {
            return [divisor, a.lowered(&least), b.lowered(&least)];
        }
        let (c, d, lattice) = (a.content(), b.content(), Lattice::of_differences(a, b));
        let (layout, [packed_a, packed_b]) = lattice.packed([(a, &c), (b, &d)]);
        let [divisor, left_a, left_b] = divisor_and_cofactors(&packed_a, &packed_b, &layout);
        let divisor = lattice.polynomial(&divisor, &layout, &least, &BigRational::one());
        let sign = divisor.content();
        [
            divisor.scaled(&sign),
            lattice.polynomial(&left_a, &layout, &difference(&least_a, &least), &(c * &sign)),
            lattice.polynomial(&left_b, &layout, &difference(&least_b, &least), &(d * &sign)),
        ]
    }
}

/// The greatest common divisor of two primitive polynomials, and the quotient of each by it.
fn divisor_and_cofactors(a: &Packed, b: &Packed, layout: &Layout) -> [Packed; 3] {
    let one = || vec![(0, BigInt::one())];
    // Where one divides the other, which sums of fractions often bring about, no prime is needed.
    if let Some(quotient) = layout.quotient(a, b) {
        return [b.clone(), quotient, one()];
    }
    if let Some(quotient) = layout.quotient(b, a) {
        return [a.clone(), one(), quotient];
    }
    let leading = |p: &Packed| p[p.len() - 1].1.clone();
    // The leading coefficient of the divisor is not known before, but divides this
    // number: images are scaled to it, and what it has too much is taken out at the end.
    let lead = leading(a).gcd(&leading(b));
    let mut modulus = BigInt::one();
    let mut lifted = BTreeMap::<u128, BigInt>::new();
    for mut field in Field::all() {
        // A prime that divides a leading coefficient lowers the degree of an image.
        if [a, b].iter().any(|p| field.residue(&leading(p)) == 0) {
            continue;
        }
        let image = |p: &Packed| -> Vec<(u128, u64)> {
            p.iter().map(|(key, c)| (*key, field.residue(c))).filter(|(_, c)| *c != 0).collect()
        };
        let (image_a, image_b) = (image(a), image(b));
        let image = image_divisor(&image_a, &image_b, layout.widths(), &mut field);
        let last = image[image.len() - 1].0;
        // Images have divisors at least as large: where theirs is a number, the polynomials have no common divisor.
        if last == 0 {
            return [one(), a.clone(), b.clone()];
        }
        // Of two primes with divisors of unequal degrees one was unlucky. It shows with more primes which.
        if lifted.last_key_value().is_none_or(|(key, _)| *key != last) {
            (modulus, lifted) = (BigInt::one(), BTreeMap::new());
        }
        lift(&mut lifted, &modulus, &image, field.residue(&lead), &field);
        modulus *= field.prime();
        let mut divisor: Packed = lifted.iter().filter(|(_, c)| !c.is_zero()).map(|(k, c)| (*k, c.clone())).collect();
        make_primitive(&mut divisor);
        // A division that fails says that more primes are needed, or that this one was unlucky.
        let Some(left_a) = layout.quotient(a, &divisor) else { continue };
        let Some(left_b) = layout.quotient(b, &divisor) else { continue };
        // Unlucky values may have given a divisor that is too small, so that the quotients are asked again.
        let [more, left_a, left_b] = divisor_and_cofactors(&left_a, &left_b, layout);
        return [product(&divisor, &more), left_a, left_b];
    }
    unreachable!("there is always another prime")
}

/// Changes `lifted`, which holds residues of least magnitude modulo `modulus`, so that it also agrees with
/// `scale · image`.
fn lift(lifted: &mut BTreeMap<u128, BigInt>, modulus: &BigInt, image: &[(u128, u64)], scale: u64, field: &Field) {
    let inverse = field.inverse(field.residue(modulus));
    let mut image: BTreeMap<u128, u64> = image.iter().map(|(key, c)| (*key, field.product(*c, scale))).collect();
    image.keys().for_each(|key| _ = lifted.entry(*key).or_default());
    for (key, c) in lifted {
        let wanted = image.remove(key).unwrap_or(0);
        let step = field.product(field.difference(wanted, field.residue(c)), inverse);
        *c += modulus * field.least(step);
    }
}

/// A polynomial as powers of all variables but the last, with polynomials in the last variable as coefficients.
type Grouped = Vec<(u128, Vec<u64>)>;

/// The greatest common divisor of polynomials over a field; its last coefficient is one. Unlucky random values can give
/// a wrong divisor, but a result of one is always right.
fn image_divisor(a: &[(u128, u64)], b: &[(u128, u64)], widths: &[u32], field: &mut Field) -> Vec<(u128, u64)> {
    let (&width, others) = widths.split_last().expect("there are variables");
    let (mut a, mut b) = (grouped(a, width), grouped(b, width));
    let content = field.divisor(take_content(&mut a, field), take_content(&mut b, field));
    if others.is_empty() {
        return flat([(0, content)], width);
    }
    let leading = |p: &Grouped| p[p.len() - 1].1.clone();
    let (lead_a, lead_b) = (leading(&a), leading(&b));
    let lead = field.divisor(lead_a.clone(), lead_b.clone());
    let degree = |p: &Grouped| p.iter().map(|(_, c)| c.len()).max().unwrap_or(0);
    // The scaled divisor has at most this degree in the last variable, for which so many points and one more suffice.
    let enough = degree(&a).min(degree(&b)) + lead.len();
    let mut modulus = vec![1];
    let mut found = BTreeMap::<u128, Vec<u64>>::new();
    loop {
        let at = field.random();
        // Such a value lowers the degree of an image.
        if field.value(&lead_a, at) == 0 || field.value(&lead_b, at) == 0 {
            continue;
        }
        let image = image_divisor(&image(&a, at, field), &image(&b, at, field), others, field);
        let last = image[image.len() - 1].0;
        if last == 0 {
            return flat([(0, content)], width);
        }
        if found.last_key_value().is_none_or(|(key, _)| *key != last) {
            (modulus, found) = (vec![1], BTreeMap::new());
        }
        let changed = interpolate(&mut found, &modulus, &image, at, field.value(&lead, at), field);
        modulus = field.times_root(&modulus, at);
        // A further value that changes nothing says that all is found; the division of the polynomials proves it.
        if !changed || modulus.len() > enough {
            let mut divisor: Grouped = found.into_iter().filter(|(_, c)| !c.is_empty()).collect();
            take_content(&mut divisor, field);
            return flat(divisor.into_iter().map(|(key, c)| (key, field.polynomial_product(&c, &content))), width);
        }
    }
}

/// Changes `found`, which is known modulo `modulus`, so that it takes the values `scale · image` at one more point.
fn interpolate(
    found: &mut BTreeMap<u128, Vec<u64>>,
    modulus: &[u64],
    image: &[(u128, u64)],
    at: u64,
    scale: u64,
    field: &Field,
) -> bool {
    let inverse = field.inverse(field.value(modulus, at));
    let mut image: BTreeMap<u128, u64> = image.iter().map(|(key, c)| (*key, field.product(*c, scale))).collect();
    image.keys().for_each(|key| _ = found.entry(*key).or_default());
    let mut changed = false;
    for (key, c) in found {
        let wanted = image.remove(key).unwrap_or(0);
        let step = field.product(field.difference(wanted, field.value(c, at)), inverse);
        if step != 0 {
            field.add_multiple(c, step, modulus);
            changed = true;
        }
    }
    changed
}

fn grouped(terms: &[(u128, u64)], width: u32) -> Grouped {
    let exponent = |key: u128| (key & ((1 << width) - 1)) as usize;
    let group = |terms: &[(u128, u64)]| {
        let mut coefficients = vec![0; exponent(terms[terms.len() - 1].0) + 1];
        terms.iter().for_each(|(key, c)| coefficients[exponent(*key)] = *c);
        (terms[0].0 >> width, coefficients)
    };
    terms.chunk_by(|a, b| a.0 >> width == b.0 >> width).map(group).collect()
}

fn flat(groups: impl IntoIterator<Item = (u128, Vec<u64>)>, width: u32) -> Vec<(u128, u64)> {
    let term = |key: u128| move |(e, c)| (key << width | e as u128, c);
    let terms = groups.into_iter().flat_map(|(key, p)| p.into_iter().enumerate().map(term(key)));
    terms.filter(|(_, c)| *c != 0).collect()
}

/// The polynomials evaluated at one value of the last variable.
fn image(p: &Grouped, at: u64, field: &Field) -> Vec<(u128, u64)> {
    p.iter().map(|(key, c)| (*key, field.value(c, at))).filter(|(_, c)| *c != 0).collect()
}

/// Divides the polynomial by the greatest common divisor of its coefficients and returns this divisor.
fn take_content(p: &mut Grouped, field: &Field) -> Vec<u64> {
    let mut content = Vec::new();
    for (_, c) in p.iter() {
        content = field.divisor(c.clone(), content);
        // A content of one cannot become smaller.
        if content.len() == 1 {
            return content;
        }
    }
    p.iter_mut().for_each(|(_, c)| *c = field.quotient(c, &content));
    content
}
