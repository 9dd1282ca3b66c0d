//! Polynomials rewritten in fewer variables: in products of powers that generate all of their terms.

use super::Polynomial;
use super::packed::{Layout, Packed};
use super::small::multiple;
use num_rational::BigRational;

/// A basis, in echelon form, of the differences between the exponents of terms. The products of powers that it stands
/// for are variables that suffice for both polynomials, up to one power product each. A homogeneous polynomial needs
/// one variable less; an even polynomial has half the degree.
pub(super) struct Lattice {
    /// Each row with the variable that is zero in all later rows and positive in this one.
    rows: Vec<(usize, Vec<i64>)>,
}

impl Lattice {
    pub fn of_differences(a: &Polynomial, b: &Polynomial) -> Lattice {
        // Of several dependent variables, the one of largest degree is eliminated.
        let mut order: Vec<usize> = (0..a.variables()).collect();
        order.sort_by_key(|v| a.degree_in(*v).min(b.degree_in(*v)));
        let mut rows = vec![Vec::new(); order.len()];
        for p in [a, b] {
            let first = p.terms.keys().next().expect("the polynomial has terms");
            p.terms.keys().skip(1).for_each(|e| insert(change(e, first), &mut rows, &order));
        }
        let mut rows: Vec<(usize, Vec<i64>)> =
            order.into_iter().map(|v| (v, std::mem::take(&mut rows[v]))).filter(|(_, row)| !row.is_empty()).collect();
        for r in 0..rows.len() {
            let (done, later) = rows.split_at_mut(r);
            let (pivot, row) = &mut later[0];
            if row[*pivot] < 0 {
                row.iter_mut().for_each(|e| *e = -*e);
            }
            for (_, above) in done {
                // The entries above a pivot are made the least that are not negative, which keeps the exponents of the new variables small.
                let times = above[*pivot].div_euclid(row[*pivot]);
                subtract(above, times, row);
            }
        }
        Lattice { rows }
    }

    /// Both polynomials, divided by their contents and monomials, in the new variables.
    pub fn packed(&self, polynomials: [(&Polynomial, &BigRational); 2]) -> (Layout, [Packed; 2]) {
        let places = polynomials.map(|(p, _)| self.places(p));
        let largest = |v: usize| places.iter().map(|p| p.iter().map(|place| place[v]).max().unwrap_or(0)).sum();
        let layout = Layout::new((0..self.rows.len()).map(largest));
        let packed = [0, 1].map(|i| {
            let keys = places[i].iter().map(|place| layout.pack(place.iter().copied()));
            let (p, content) = polynomials[i];
            let mut packed: Packed = keys.zip(p.integers(content)).collect();
            packed.sort_unstable_by_key(|(key, _)| *key);
            packed
        });
        (layout, packed)
    }

    /// The exponents of the new variables for each term of `p`, moved so that the smallest exponent of each variable is
    /// zero.
    fn places(&self, p: &Polynomial) -> Vec<Vec<u32>> {
        let first = p.terms.keys().next().expect("the polynomial has terms");
        let place = |e: &Vec<u32>| {
            let mut rest = change(e, first);
            let coordinate = |(pivot, row): &(usize, Vec<i64>)| {
                let times = rest[*pivot] / row[*pivot];
                subtract(&mut rest, times, row);
                times
            };
            // The variables of large degree are last in the rows and first in the order of terms.
            let mut place: Vec<i64> = self.rows.iter().map(coordinate).collect();
            place.reverse();
            place
        };
        lifted(p.terms.keys().map(place).collect(), &vec![0; self.rows.len()])
    }

    /// The polynomial in the old variables, multiplied by `content`, with `least` as its monomial content.
    pub fn polynomial(&self, packed: &Packed, layout: &Layout, least: &[u32], content: &BigRational) -> Polynomial {
        let exponents = |key: u128| {
            let mut exponents = vec![0; least.len()];
            for (times, (_, row)) in layout.unpack(key).zip(&self.rows) {
                subtract(&mut exponents, -i64::from(times), row);
            }
            exponents
        };
        let exponents = lifted(packed.iter().map(|(key, _)| exponents(*key)).collect(), least);
        Polynomial { terms: exponents.into_iter().zip(packed).map(|(e, (_, c))| (e, multiple(c, content))).collect() }
    }
}

/// Adds a vector to a basis in echelon form, in which the row of a variable is empty or has this variable as the first
/// in `order`.
fn insert(mut vector: Vec<i64>, rows: &mut [Vec<i64>], order: &[usize]) {
    for &v in order {
        if vector[v] == 0 {
            continue;
        }
        if rows[v].is_empty() {
            rows[v] = vector;
            return;
        }
        // Euclid's algorithm on whole numbers: the row keeps the greatest common
        // divisor of both entries, and the vector goes on without this variable.
        while vector[v] != 0 {
            let times = rows[v][v] / vector[v];
            subtract(&mut rows[v], times, &vector);
            std::mem::swap(&mut rows[v], &mut vector);
        }
    }
}

fn change(a: &[u32], b: &[u32]) -> Vec<i64> {
    a.iter().zip(b).map(|(a, b)| i64::from(*a) - i64::from(*b)).collect()
}

fn subtract(vector: &mut [i64], times: i64, row: &[i64]) {
    vector.iter_mut().zip(row).for_each(|(v, r)| *v -= times * r);
}

/// The vectors, all moved by the same amount so that their smallest entries are `least`.
fn lifted(vectors: Vec<Vec<i64>>, least: &[u32]) -> Vec<Vec<u32>> {
    let smallest = |i: usize| vectors.iter().map(|v| v[i]).min().unwrap_or(0);
    let smallest: Vec<i64> = (0..least.len()).map(smallest).collect();
    let lift = |v: &Vec<i64>| (0..least.len()).map(|i| (v[i] - smallest[i]) as u32 + least[i]).collect();
    vectors.iter().map(lift).collect()
}
