//! Double-double numbers in groups of a register, beside the same numbers one by one.

use crate::shapes::{Random, distorted, materials, with_angles};
use springfit_element::springs::Springs;
use springfit_fit::fit::solvers::{add_outers, factorize, row_products};
use springfit_fit::fit::{
    Balance, Fit, Higher, MotionWeight, Objective, Weight, constants_of_kind, double_double_constants,
};
use springfit_foundation::scalar::{DoubleDouble, Real, Scalar};
use std::ops::{Add, Div, Mul, Sub};

/// A double-double number that has no groups: loops over it are those over single numbers.
#[derive(Debug, Clone, Copy)]
struct Single(DoubleDouble);

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait<&Single> for Single {
            type Output = Single;

            fn $method(self, other: &Single) -> Single {
                Single(self.0.$method(&other.0))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Scalar for Single {
    type Constant = f64;

    fn exact(value: f64) -> f64 {
        value
    }

    fn epsilon() -> f64 {
        DoubleDouble::epsilon()
    }

    fn given() -> f64 {
        DoubleDouble::given()
    }

    fn constant(&self, c: &f64) -> Single {
        Single(self.0.constant(c))
    }

    fn scaled(self, c: &f64) -> Single {
        Single(self.0.scaled(c))
    }

    fn plus_product(self, a: &Single, b: &Single) -> Single {
        Single(self.0.plus_product(&a.0, &b.0))
    }

    fn minus_product(self, a: &Single, b: &Single) -> Single {
        Single(self.0.minus_product(&a.0, &b.0))
    }

    fn exceeds(&self, other: &Single) -> bool {
        self.0.exceeds(&other.0)
    }
}

impl Real for Single {
    fn sqrt(self) -> Single {
        Single(self.0.sqrt())
    }

    fn rounded(&self) -> f64 {
        self.0.rounded()
    }

    fn choose(&self, yes: &Single, no: &Single) -> Single {
        Single(self.0.choose(&yes.0, &no.0))
    }
}

fn bits(numbers: &[DoubleDouble]) -> Vec<[u64; 2]> {
    numbers.iter().map(|number| [number.hi.to_bits(), number.lo.to_bits()]).collect()
}

fn bare(numbers: &[Single]) -> Vec<DoubleDouble> {
    numbers.iter().map(|number| number.0).collect()
}

fn single(numbers: &[DoubleDouble]) -> Vec<Single> {
    numbers.iter().copied().map(Single).collect()
}

/// Numbers with all digits, of both signs, some zero, over six decades.
fn numbers(count: usize, random: &mut Random) -> Vec<DoubleDouble> {
    let number = |random: &mut Random| {
        let high = DoubleDouble::from(random.next() * 10f64.powf(3.0 * random.next()));
        if random.next() > 0.8 { DoubleDouble::from(0.0) } else { high / &DoubleDouble::from(3.0) }
    };
    (0..count).map(|_| number(random)).collect()
}

/// The lower triangle without what is above it, which no one reads.
fn lower(of: &[DoubleDouble], n: usize) -> Vec<[u64; 2]> {
    bits(&(0..n).flat_map(|i| of[i * n..=i * n + i].to_vec()).collect::<Vec<_>>())
}

/// Sizes below a group, of whole groups, and with a rest of any length.
#[test]
fn sums_of_groups_are_those_of_single_numbers_to_the_last_bit() {
    let mut random = Random(4);
    let none = DoubleDouble::from(0.0);
    for (rows, columns, n) in [(1, 8, 3), (4, 9, 1), (5, 15, 8), (13, 16, 17), (30, 27, 6), (3, 3, 5)] {
        let (a, b) = (numbers(rows * n, &mut random), numbers(columns * n, &mut random));
        let mut out = vec![none; rows * columns];
        let mut one_by_one = single(&out);
        row_products(&a, &b, n, false, &mut out);
        row_products(&single(&a), &single(&b), n, false, &mut one_by_one);
        assert_eq!(bits(&out), bits(&bare(&one_by_one)), "{rows} × {columns} of {n}");
    }
    for n in 1..40 {
        let m = 1 + (7 * n) % 23;
        let g = numbers(m * n, &mut random);
        let (mut out, mut sum) = (vec![none; m * m], numbers(n * n, &mut random));
        let (mut one_by_one, mut sum_by_one) = (single(&out), single(&sum));
        row_products(&g, &g, n, true, &mut out);
        row_products(&single(&g), &single(&g), n, true, &mut one_by_one);
        assert_eq!(lower(&out, m), lower(&bare(&one_by_one), m), "{m} rows of {n}");
        // Several rows share a factor.
        let unknowns: Vec<usize> = (0..m).map(|s| s / 2).collect();
        let c = numbers(m, &mut random);
        add_outers(&mut sum, &g, n, &c, &unknowns, -1.0);
        add_outers(&mut sum_by_one, &single(&g), n, &single(&c), &unknowns, -1.0);
        assert_eq!(lower(&sum, n), lower(&bare(&sum_by_one), n), "{m} rows of {n}");
    }
}

/// Positive matrices, singular ones whose last pivots are below the floor, and ones that have pivots below zero.
#[test]
fn factors_of_groups_are_those_of_single_numbers_to_the_last_bit() {
    let mut random = Random(9);
    for n in 1..45usize {
        for (rank, floor) in [(n + 3, 0.0), (n.div_ceil(2), 1e-28), (n, 1e-28)] {
            let g = numbers(rank * n, &mut random);
            let signs: Vec<DoubleDouble> =
                (0..rank).map(|i| DoubleDouble::from(if rank == n && i % 3 == 1 { -1.0 } else { 1.0 })).collect();
            let mut a = vec![DoubleDouble::from(0.0); n * n];
            add_outers(&mut a, &g, n, &signs, &(0..rank).collect::<Vec<_>>(), 1.0);
            let mut inverse = vec![DoubleDouble::from(0.0); n];
            let (mut a_by_one, mut inverse_by_one) = (single(&a), single(&inverse));
            let least = factorize(&mut a, n, floor, &mut inverse);
            let least_by_one = factorize(&mut a_by_one, n, floor, &mut inverse_by_one);
            let told = format!("order {n}, rank {rank}");
            assert_eq!(bits(&[least]), bits(&[least_by_one.0]), "{told}");
            assert_eq!(bits(&inverse), bits(&bare(&inverse_by_one)), "{told}");
            assert_eq!(lower(&a, n), lower(&bare(&a_by_one), n), "{told}");
        }
    }
}

/// Whole fits: every objective that has no closed form, of elements with springs on lengths, contents and angles, for which twice the digits
/// have both ways.
#[test]
fn fits_in_groups_are_those_in_single_numbers_to_the_last_bit() {
    let mut random = Random(12);
    let objectives = [
        Objective::Frobenius(Weight::Relative),
        Objective::Spectral(MotionWeight::None),
        Objective::Spectral(MotionWeight::Modal(Higher::DEFAULT)),
        Objective::Divergence(Balance::DEFAULT),
    ];
    let mut fitted = 0;
    for name in ["quad4", "tet4", "pyramid5", "tri6", "wedge6", "tet10"] {
        let element = with_angles(name);
        let springs = Springs::select(&element, None).unwrap();
        let x = distorted(&element, &mut random);
        let material = &materials(element.dimension())[2];
        for objective in objectives {
            for tied in [false, true] {
                let fit = Fit { tied, ..Fit::new(objective) };
                let groups = double_double_constants(&element, &springs, &x, &material.moduli(), &fit);
                let none = Single(DoubleDouble::from(0.0));
                let one_by_one = constants_of_kind(&none, &element, &springs, &x, &material.moduli(), &fit);
                let told = format!("{name}, {}, tied: {tied}", objective.title());
                match (groups, one_by_one) {
                    (Ok(groups), Ok(one_by_one)) => {
                        assert_eq!(bits(&groups), bits(&bare(&one_by_one)), "{told}");
                        fitted += 1;
                    }
                    (Err(groups), Err(one_by_one)) => assert_eq!(groups.problem(), one_by_one.problem(), "{told}"),
                    (groups, one_by_one) => panic!("{told}: {groups:?}, {one_by_one:?}"),
                }
            }
        }
    }
    // Springs of some shapes depend on each other, which both ways say.
    assert!(fitted >= 40, "{fitted}");
}
