//! Random problems with bounds, of kinds whose optima are unique or not.

use crate::shapes::Random;
use springfit_fit::fit::solvers::Normal;

/// How the columns of the least-squares problem `|A k − r|²` are drawn.
#[derive(Clone, Copy)]
pub enum Kind {
    /// More rows than unknowns.
    Regular,
    /// Fewer rows than unknowns.
    Flat,
    /// Each column twice.
    Repeated,
    /// Some columns are sums of two others.
    Sums,
}

impl Kind {
    pub fn of(number: usize) -> Kind {
        [Kind::Regular, Kind::Flat, Kind::Repeated, Kind::Sums][number % 4]
    }

    /// The normal equations. Every third problem has a right-hand side that positive constants reach, and the columns of
    /// half of them have sizes from 1e-6 to 1e6.
    pub fn problem(self, number: usize) -> Normal {
        let Columns { columns, sizes, target } = self.columns(number);
        let scaled = |(column, size): (&Vec<f64>, &f64)| column.iter().map(|a| a * size).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = columns.iter().zip(&sizes).map(scaled).collect();
        let (m, dot) = (columns.len(), |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>());
        let gram = (0..m * m).map(|st| dot(&columns[st / m], &columns[st % m])).collect();
        Normal::new(gram, columns.iter().map(|column| dot(column, &target)).collect())
    }

    /// The changes of the constants that change nothing, as far as they are known from how the columns are drawn.
    pub fn flat_motions(self, number: usize) -> Vec<Vec<f64>> {
        let Columns { columns, sizes, .. } = self.columns(number);
        let motion = |of: &[(usize, f64)]| {
            let mut motion = vec![0.0; columns.len()];
            of.iter().for_each(|&(s, factor)| motion[s] = factor / sizes[s]);
            motion
        };
        let every = |step: usize| (step - 1..columns.len()).step_by(step);
        match self {
            Kind::Regular | Kind::Flat => Vec::new(),
            Kind::Repeated => every(2).map(|s| motion(&[(s - 1, 1.0), (s, -1.0)])).collect(),
            Kind::Sums => every(3).map(|s| motion(&[(s - 2, 1.0), (s - 1, 1.0), (s, -1.0)])).collect(),
        }
    }

    fn columns(self, number: usize) -> Columns {
        let mut random = Random(2 * number as u64 + 1);
        let m = 1 + number / 4 % 40;
        let rows = match self {
            Kind::Flat => m.div_ceil(2),
            Kind::Regular | Kind::Repeated | Kind::Sums => m + 2,
        };
        let mut columns: Vec<Vec<f64>> = (0..m).map(|_| (0..rows).map(|_| random.next()).collect()).collect();
        for s in 0..m {
            match self {
                Kind::Repeated if s % 2 == 1 => columns[s] = columns[s - 1].clone(),
                Kind::Sums if s % 3 == 2 => {
                    columns[s] = columns[s - 1].iter().zip(&columns[s - 2]).map(|(a, b)| a + b).collect();
                }
                _ => {}
            }
        }
        let mut target: Vec<f64> = (0..rows).map(|_| random.next()).collect();
        if number.is_multiple_of(3) {
            let constants: Vec<f64> = (0..m).map(|_| random.next().max(0.0)).collect();
            (0..rows).for_each(|i| target[i] = columns.iter().zip(&constants).map(|(column, k)| column[i] * k).sum());
        }
        let size = |_| if (number / 160).is_multiple_of(2) { 1.0 } else { 10f64.powf(6.0 * random.next()) };
        let sizes = (0..m).map(size).collect();
        Columns { columns, sizes, target }
    }
}

/// A least-squares problem with the columns times their sizes.
struct Columns {
    columns: Vec<Vec<f64>>,
    sizes: Vec<f64>,
    target: Vec<f64>,
}
