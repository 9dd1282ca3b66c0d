//! The elasticity tensor of a lattice as formulas of its constants.

use super::definition::{NamedLattice, Root, UNIT};
use crate::error::{Error, ErrorKind, Result};
use crate::symbolic::Fraction;
use num_rational::BigRational;
use num_traits::ToPrimitive;

/// The entries of an elasticity tensor with the symmetry of a cube or a square, or of an isotropic one, as formulas.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ClosedTensor {
    /// The names of the variables: k1, k2, …
    pub variables: Vec<String>,
    /// `C_11`, `C_12`, `C_44` (in the plane `C_66`), without the root and the spacing.
    pub entries: [Fraction; 3],
    /// Entries and Young's modulus are times the root of this number, and in space over the spacing.
    pub root: Root,
    /// Young's modulus along the axes, without the root and the spacing; `None` where a strain meets no resistance.
    pub young: Option<Fraction>,
    /// Poisson's ratio between the axes.
    pub poisson: Option<Fraction>,
    /// Zener's ratio.
    pub zener: Option<Fraction>,
}

impl ClosedTensor {
    /// A modulus as a number in Pa, in the plane N/m: `formula √r`, in space over the spacing in m; with the constants in N/m.
    pub fn value(&self, formula: &Fraction, constants: &[f64], spacing: f64, dimension: usize) -> Option<f64> {
        let root = (self.root.square() as f64).sqrt();
        let value = self.ratio(formula, constants)? * root;
        Some(if dimension == 3 { value / spacing } else { value })
    }

    /// A ratio as a number, for these constants.
    pub fn ratio(&self, formula: &Fraction, constants: &[f64]) -> Option<f64> {
        let at: Vec<BigRational> = constants.iter().map(|k| BigRational::from_float(*k)).collect::<Option<_>>()?;
        formula.evaluate(&at)?.to_f64()
    }
}

impl NamedLattice {
    /// The tensor as formulas of the constants `k1, k2, …` of the first `shells` shells.
    ///
    /// ```text
    /// V C_pqrs = Σ_bonds k x_p x_q x_r x_s/ℓ² − F_pqᵀ K⁻¹ F_rs,    F_pq = Σ k x x_p x_q/ℓ²,    K = Σ k x xᵀ/ℓ²
    /// ```
    ///
    /// The second term is that of the points of the cell, which give way to each other. Along y all coordinates have the factor √r: the
    /// unknowns along y are divided by it, and shears with y are counted without it, so that every number is rational.
    ///
    /// # Errors
    /// There are no such shells, or a strain drives a motion inside the cell that meets no resistance; kind `Unsupported`.
    pub fn closed(&self, shells: usize) -> Result<ClosedTensor> {
        if !(1..=self.shells.len()).contains(&shells) {
            let expected = format!("a number of shells from 1 to {}", self.shells.len());
            return Err(Error::expected("constants", expected, shells));
        }
        Sums::of(self, shells).tensor(self)
    }
}

/// The sums over the bonds, without odd roots.
struct Sums {
    shells: usize,
    /// `[strains][strains]`, in units of a².
    affine: Vec<Vec<Fraction>>,
    /// `[unknowns][strains]`, in units of a.
    force: Vec<Vec<Fraction>>,
    /// `[unknowns][unknowns]`.
    inner: Vec<Vec<Fraction>>,
}

/// The strains kk, then kl.
fn strains(d: usize) -> Vec<[usize; 2]> {
    let shears = (0..d).flat_map(|k| (k + 1..d).map(move |l| [k, l]));
    (0..d).map(|k| [k, k]).chain(shears).collect()
}

fn number(numerator: i64, denominator: i64, shells: usize) -> Fraction {
    Fraction::number(BigRational::new(numerator.into(), denominator.into()), shells)
}

impl Sums {
    fn of(lattice: &NamedLattice, shells: usize) -> Sums {
        let (d, n) = (lattice.dimension(), lattice.points());
        let (strains, root) = (strains(d), lattice.root.square());
        let zero = number(0, 1, shells);
        let table = |rows: usize, columns: usize| vec![vec![zero.clone(); columns]; rows];
        let mut sums = Sums {
            shells,
            affine: table(strains.len(), strains.len()),
            force: table(n * d, strains.len()),
            inner: table(n * d, n * d),
        };
        let add = |entry: &mut Fraction, shell: usize, above: i64, below: i64| {
            let term = Fraction::variable(shell, shells) * &number(above, below, shells);
            *entry = entry.clone() + &term;
        };
        for bond in lattice.bonds().iter().filter(|bond| bond.shell < shells) {
            let (x, square) = (lattice.along(bond), lattice.squares[bond.shell]);
            // x_p x_q, with the root of two factors along y.
            let strained = |[p, q]: [usize; 2]| x[p] * x[q] * if p == 1 && q == 1 { root } else { 1 };
            for (i, &a) in strains.iter().enumerate() {
                for (j, &b) in strains.iter().enumerate() {
                    add(&mut sums.affine[i][j], bond.shell, strained(a) * strained(b), square * UNIT * UNIT);
                }
            }
            // A bond pulls its ends apart: their unknowns enter its elongation with opposite signs.
            let ends = [(bond.from, -1), (bond.to, 1)];
            for (a, sign) in ends {
                for row in 0..d {
                    for (j, &b) in strains.iter().enumerate() {
                        add(&mut sums.force[a * d + row][j], bond.shell, sign * x[row] * strained(b), square * UNIT);
                    }
                    for (b, other) in ends {
                        for column in 0..d {
                            let entry = &mut sums.inner[a * d + row][b * d + column];
                            add(entry, bond.shell, sign * other * x[row] * x[column], square);
                        }
                    }
                }
            }
        }
        sums
    }

    fn tensor(mut self, lattice: &NamedLattice) -> Result<ClosedTensor> {
        let d = lattice.dimension();
        self.relax(lattice)?;
        // A shear xy has lost the root, and so has each of the two that make an entry.
        let root = number(lattice.root.square(), 1, self.shells);
        for (i, [p, q]) in strains(d).into_iter().enumerate() {
            if (p == 1) != (q == 1) {
                self.affine[i][i] = self.affine[i][i].clone() * &root;
            }
        }
        self.check_symmetry(lattice)?;
        let volume = self.volume(lattice);
        let entry = |i: usize, j: usize| self.affine[i][j].clone() / &volume;
        let entries = [entry(0, 0), entry(0, 1), entry(d, d)];
        let [c11, c12, c44] = &entries;
        let times = |c: &Fraction, n: usize| c.clone() * &number(n as i64, 1, self.shells);
        let (difference, sum, mixed) =
            (c11.clone() - c12, c11.clone() + &times(c12, d - 1), c11.clone() + &times(c12, d - 2));
        let resists = [&difference, &sum, &mixed, c44].iter().all(|c| !c.is_zero());
        Ok(ClosedTensor {
            variables: (1..=self.shells).map(|shell| format!("k{shell}")).collect(),
            young: resists.then(|| difference.clone() * &sum / &mixed),
            poisson: resists.then(|| c12.clone() / &mixed),
            zener: (!difference.is_zero()).then(|| times(c44, 2) / &difference),
            root: lattice.root,
            entries,
        })
    }

    /// The volume of the cell over a^d, `v √r`, as what C is divided by: `v r`, where C is times √r.
    fn volume(&self, lattice: &NamedLattice) -> Fraction {
        let c = |row: usize, k: usize| lattice.cell[row][k];
        let determinant: i64 = match lattice.dimension() {
            2 => c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0),
            _ => (0..3)
                .map(|k| c(0, k) * (c(1, (k + 1) % 3) * c(2, (k + 2) % 3) - c(1, (k + 2) % 3) * c(2, (k + 1) % 3)))
                .sum(),
        };
        let unit = UNIT.pow(lattice.dimension() as u32);
        number(determinant.abs() * lattice.root.square(), unit, self.shells)
    }

    /// `A − Fᵀ K⁻¹ F`, by elimination of the unknowns of all points but the first, which is where it is.
    fn relax(&mut self, lattice: &NamedLattice) -> Result<()> {
        let Sums { affine, force, inner, .. } = self;
        // The first point is held: a translation of all points has no energy, and would leave a pivot of zero.
        let mut left: Vec<usize> = (lattice.dimension()..inner.len()).collect();
        // Pivots are taken where they are not zero: the matrix is that of energies, where a zero on the diagonal is a row of zeros.
        while let Some(at) = left.iter().position(|&row| !inner[row][row].is_zero()) {
            let pivot = left.remove(at);
            for i in 0..affine.len() {
                for j in 0..affine.len() {
                    let given = force[pivot][i].clone() * &force[pivot][j] / &inner[pivot][pivot];
                    affine[i][j] = affine[i][j].clone() - &given;
                }
            }
            for &row in &left {
                let factor = inner[row][pivot].clone() / &inner[pivot][pivot];
                for column in 0..inner.len() {
                    inner[row][column] = inner[row][column].clone() - &(factor.clone() * &inner[pivot][column]);
                }
                for case in 0..affine.len() {
                    force[row][case] = force[row][case].clone() - &(factor.clone() * &force[pivot][case]);
                }
            }
        }
        // What is left has no resistance; the strains must not drive it.
        match left.iter().any(|&row| force[row].iter().any(|f| !f.is_zero())) {
            true => Err(Error::new(format!("{} has a motion inside its cell without resistance", lattice.name))
                .of_kind(ErrorKind::Unsupported)),
            false => Ok(()),
        }
    }

    /// That the tensor is that of a cube or a square.
    fn check_symmetry(&self, lattice: &NamedLattice) -> Result<()> {
        let (d, affine) = (lattice.dimension(), &self.affine);
        let is = |i: usize, j: usize, (k, l): (usize, usize)| (affine[i][j].clone() - &affine[k][l]).is_zero();
        let normal = (0..d).all(|k| is(k, k, (0, 0))) && (0..d).all(|k| (0..k).all(|l| is(k, l, (0, 1))));
        let shear = (d..affine.len()).all(|k| is(k, k, (d, d)));
        let mixed = (d..affine.len()).all(|k| (0..affine.len()).all(|l| k == l || affine[k][l].is_zero()));
        match normal && shear && mixed {
            true => Ok(()),
            false => {
                let problem = format!("{} has not the symmetry of a cube or a square", lattice.name);
                Err(Error::new(problem).of_kind(ErrorKind::Unsupported))
            }
        }
    }
}
