//! Motions of a network: rigid ones, those without resistance, the lowest vibrations.

use super::outcome::NetworkStability;
use crate::analysis::homogenise::folded_entries;
use crate::dynamics::largest_square;
use crate::error::Result;
use crate::mesh::pieces_of;
use crate::model::{Entries, Specimen, Support};
use crate::solve::{eigenvalues, is_definite, lowest_modes};
use nalgebra::DMatrix;
use springfit_scenes::{RELEASE, Raised};
use std::f64::consts::TAU;

/// Degrees of freedom up to which all motions are counted, by the eigenvalues of the stiffness. A dense decomposition
/// of that many takes about a second.
const FEW: usize = 900;
/// Motions without resistance that are looked for in larger networks.
// Each costs solutions in every round. Where all of them are without resistance the report says that there may be more.
const SOUGHT: usize = 12;
/// A stiffness below this share of the largest is rounding.
// Eigenvalues of a dense matrix of 900 rows are known to some 1e-13 of the largest, and those of a shifted sparse one to 1e-11
// (`modes.rs`).
const NOTHING: f64 = 1e-9;
/// The share of the largest ω² by which all are shifted, because some motions have no stiffness. It is far beyond
/// rounding, and still far below stiff motions, so that soft ones converge fast.
const SHIFT: f64 = 1e-4;
/// Rigid motions are independent if the share of one beside the others is larger than this.
const INDEPENDENT: f64 = 1e-12;

/// The equations of the own points of a network.
pub struct Motions<'a> {
    specimen: &'a Specimen,
    entries: Entries,
    support: Support,
    rigid: usize,
}

impl<'a> Motions<'a> {
    /// # Errors
    /// The stiffness does not fit into memory.
    pub fn of(specimen: &'a Specimen) -> Result<Motions<'a>> {
        specimen.network.check_size()?;
        let d = specimen.network.dimension;
        let entries = specimen.network.stiffness(&specimen.points);
        let entries = match specimen.period {
            Some(_) => folded_entries(&entries, |dof| specimen.owner(dof / d) * d + dof % d),
            None => entries,
        };
        let free = || Support { prescribed: vec![None; specimen.count() * d] };
        let support = specimen.support.clone().unwrap_or_else(free);
        let rigid = rigid_motions(specimen, &support);
        Ok(Motions { specimen, entries, support, rigid })
    }

    fn at(&self) -> (&[f64], usize) {
        let d = self.specimen.network.dimension;
        (&self.specimen.points[..self.specimen.count() * d], d)
    }

    fn free(&self) -> usize {
        self.support.prescribed.iter().filter(|u| u.is_none()).count()
    }

    /// # Errors
    /// The equations do not fit into memory.
    pub fn stability(&self, masses: Option<&[f64]>) -> Result<NetworkStability> {
        let counted = |releasing: usize, zero: usize, is_complete| NetworkStability {
            releasing,
            mechanisms: zero.saturating_sub(self.rigid),
            rigid: self.rigid,
            is_complete,
        };
        if self.free() <= FEW {
            let all = eigenvalues(self.dense());
            let floor = NOTHING * all.amax();
            let releasing = all.iter().filter(|value| **value < -floor).count();
            let zero = all.iter().filter(|value| value.abs() <= floor).count();
            return Ok(counted(releasing, zero, true));
        }
        // A factor that is not there shows that some motion releases energy, and not how many do.
        if !is_definite(&self.entries, &self.support, NOTHING)? {
            return Ok(counted(1, self.rigid, false));
        }
        // Any masses show the motions without resistance.
        let ones = vec![1.0; self.at().0.len() / self.at().1];
        let masses = masses.filter(|masses| masses.iter().all(|m| *m > 0.0)).unwrap_or(&ones);
        // There are no more motions than degrees of freedom.
        let wanted = (self.rigid + SOUGHT).min(self.free());
        let (squares, largest) = self.squares(masses, wanted)?;
        let zero = squares.iter().filter(|square| **square <= NOTHING * largest).count();
        // If all that were looked for are without resistance, there may be more of them.
        Ok(counted(0, zero, zero < wanted))
    }

    /// The lowest frequencies beyond motions without resistance, Hz; `None` where some motion releases energy.
    ///
    /// # Errors
    /// The equations do not fit into memory, or the frequencies are not found.
    pub fn frequencies(&self, masses: &[f64], stability: &NetworkStability, count: usize) -> Result<Option<Vec<f64>>> {
        let d = self.at().1;
        let moves = |p: usize| (p * d..(p + 1) * d).any(|dof| !self.support.is_fixed(dof));
        let is_sound = masses.iter().enumerate().all(|(p, mass)| *mass > 0.0 || !moves(p));
        // ω² of K φ = ω² M φ needs a mass wherever something moves.
        if stability.releasing > 0 || !is_sound {
            return Ok(None);
        }
        let zero = stability.rigid + stability.mechanisms;
        let wanted = (zero + count).min(self.free());
        let (squares, _) = self.squares(masses, wanted)?;
        // The shift was taken off, and rounding may leave a square below zero.
        Ok(Some(squares.iter().skip(zero).map(|square| square.max(0.0).sqrt() / TAU).collect()))
    }

    /// The lowest ω², and an upper bound of the largest, rad²/s², from `(K + σ M) φ = (ω² + σ) M φ`.
    fn squares(&self, masses: &[f64], count: usize) -> Result<(Vec<f64>, f64)> {
        let mut raised = Raised::new(self.entries.clone(), masses, &self.support, self.at());
        let largest = raised.largest;
        let shift = SHIFT * largest;
        let system = raised.by(shift)?;
        let releases = || {
            let error = crate::error::Error::new("some motion releases energy: it does not vibrate");
            error.of_kind(crate::error::ErrorKind::Infeasible)
        };
        let factor = system.cholesky()?.ok_or_else(releases)?;
        let modes = lowest_modes(&system, &factor, masses, self.at().1, count)?;
        // The difference of two numbers of the size of the shift: what is left below this is their rounding.
        let square = |square: &f64| if (square - shift).abs() <= RELEASE * largest { 0.0 } else { square - shift };
        Ok((modes.squares.iter().map(square).collect(), largest))
    }

    /// `2/ω` of the fastest motion, s; `None` where a point that moves has no mass.
    pub fn longest_step(&self, masses: &[f64]) -> Option<f64> {
        let d = self.at().1;
        let held: Vec<bool> = self.support.prescribed.iter().map(Option::is_some).collect();
        let is_sound = held.iter().enumerate().all(|(dof, held)| *held || masses[dof / d] > 0.0);
        if !is_sound {
            return None;
        }
        let masses: Vec<f64> = masses.iter().flat_map(|m| std::iter::repeat_n(*m, d)).collect();
        let entries = self.entries.iter().map(|e| (e.row, e.col, e.val));
        let largest = largest_square(entries, &masses, &held);
        // Where images of one point are all there is, what is left of the stiffness of the springs is rounding.
        let springs = self.specimen.network.lengths.iter().map(|spring| spring.constant.abs()).fold(0.0, f64::max);
        let heaviest = masses.iter().copied().fold(0.0, f64::max);
        if largest <= NOTHING * springs / heaviest {
            return None;
        }
        // Central differences are stable up to `2/ω`. Without any stiffness there is no limit, and infinity is left
        // out.
        Some(2.0 / largest.sqrt()).filter(|step| step.is_finite())
    }

    fn dense(&self) -> DMatrix<f64> {
        let mut place = vec![usize::MAX; self.support.prescribed.len()];
        let free = (0..place.len()).filter(|dof| !self.support.is_fixed(*dof));
        free.enumerate().for_each(|(i, dof)| place[dof] = i);
        let mut k = DMatrix::zeros(self.free(), self.free());
        for e in &self.entries {
            let (i, j) = (place[e.row], place[e.col]);
            if i != usize::MAX && j != usize::MAX {
                k[(i, j)] += e.val;
                // Entries are those of the lower triangle.
                if e.row != e.col {
                    k[(j, i)] += e.val;
                }
            }
        }
        k
    }
}

/// The number of motions of the connected parts of a network that change no distance. A network that repeats itself has translations.
fn rigid_motions(specimen: &Specimen, support: &Support) -> usize {
    let d = specimen.network.dimension;
    let parts = parts(specimen);
    let is_periodic = specimen.period.is_some();
    // A network that repeats itself does not turn as a whole, because its images would leave their places.
    let motions = if is_periodic { d } else { d * (d + 1) / 2 };
    let count_of = |points: &[usize]| {
        let count = points.len() as f64;
        let centre: Vec<f64> =
            (0..d).map(|k| points.iter().map(|&p| specimen.points[p * d + k]).sum::<f64>() / count).collect();
        let from = |p: usize, k: usize| specimen.points[p * d + k] - centre[k];
        let extent = points.iter().flat_map(|&p| (0..d).map(move |k| (p, k))).map(|(p, k)| from(p, k).abs());
        // A part of one point has no extent, by which rotations are divided.
        let extent = extent.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let row = |dof: usize| -> Vec<f64> {
            let (p, axis) = (dof / d, dof % d);
            let mut row: Vec<f64> = (0..d).map(|k| f64::from(u8::from(k == axis))).collect();
            for (k, l) in (0..d).flat_map(|k| (0..k).map(move |l| (k, l))) {
                row.push(match axis {
                    axis if axis == k => from(p, l) / extent,
                    axis if axis == l => -from(p, k) / extent,
                    _ => 0.0,
                });
            }
            row.truncate(motions);
            row
        };
        let rank = |dofs: &mut dyn Iterator<Item = usize>| {
            let mut gram = DMatrix::<f64>::zeros(motions, motions);
            for dof in dofs {
                let row = row(dof);
                for (a, b) in (0..motions).flat_map(|a| (0..motions).map(move |b| (a, b))) {
                    gram[(a, b)] += row[a] * row[b];
                }
            }
            // The Gram matrix grows with the number of points, and so does its rounding.
            eigenvalues(gram).iter().filter(|value| **value > INDEPENDENT * count).count()
        };
        let all = || points.iter().flat_map(|p| p * d..(p + 1) * d);
        // Rigid motions that the held directions see are held. Those that are left move the part freely.
        rank(&mut all()) - rank(&mut all().filter(|dof| support.is_fixed(*dof)))
    };
    parts.iter().map(|points| count_of(points)).sum()
}

/// The own points of each part that springs join.
pub fn parts(specimen: &Specimen) -> Vec<Vec<usize>> {
    let springs = specimen.network.springs();
    pieces_of(specimen.count(), springs.map(|(points, _)| points.iter().map(|&p| specimen.owner(p))))
}
