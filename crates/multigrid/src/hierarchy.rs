//! The levels, and the preconditioner that they are.

use crate::block::Block;
use crate::bottom::{Bottom, is_diagonal};
use crate::entry::Entry;
use crate::fault::{Fault, Motion};
use crate::level::{Level, Next, size};
use crate::matrix::BlockMatrix;
use crate::parallel::dot;
use crate::settings::{Event, LevelSize, Settings, Watch};
use crate::smoother::Room;
use std::sync::Arc;

/// The last level has at most so many unknowns where its nodes do not group any more. Their dense matrix has 288 MB.
const LARGEST: usize = 6000;

/// A hierarchy for a symmetric, positive definite matrix of D × D blocks, with M motions that are carried to all levels.
#[derive(Debug)]
pub struct Multigrid<const D: usize, const M: usize> {
    pub(crate) first: Level<D, M>,
    pub(crate) others: Vec<Level<M, M>>,
    pub(crate) bottom: Bottom<M>,
    pub(crate) is_held: Vec<[bool; D]>,
    levels: Vec<LevelSize>,
}

/// The vectors that a V-cycle needs.
#[derive(Debug, Clone)]
pub struct Workspace<const D: usize, const M: usize, T = f64> {
    first: Room<D, T>,
    others: Vec<Stage<M, T>>,
}

#[derive(Debug, Clone)]
struct Stage<const M: usize, T> {
    force: Vec<[T; M]>,
    motion: Vec<[T; M]>,
    room: Room<M, T>,
}

impl<const D: usize, const M: usize> Multigrid<D, M> {
    /// Levels for the matrix on the unknowns that are not held. `motions` are, for each node, its displacements in the motions that the
    /// next levels shall represent: [`crate::plane_motions`] or [`crate::space_motions`] for elastic bodies.
    ///
    /// # Errors
    /// The matrix is shown not to be positive definite, its nodes do not group, the sizes do not agree, or the watch broke off.
    pub fn new(
        matrix: Arc<BlockMatrix<D, D>>,
        motions: &[Block<D, M>],
        is_held: &[bool],
        settings: &Settings,
        watch: &mut Watch,
    ) -> Result<Multigrid<D, M>, Fault> {
        let rows = matrix.rows();
        let agree = |what, expected, found| {
            if expected == found { Ok(()) } else { Err(Fault::Size { what, expected, found }) }
        };
        agree("the motions", rows, motions.len())?;
        agree("the supports", rows * D, is_held.len())?;
        agree("the columns", rows, matrix.pattern().width())?;
        // A number that is not finite would fail the first pivot below, and be told as a motion without resistance.
        if matrix.values().iter().flatten().flatten().any(|x| !x.is_finite()) {
            return Err(Fault::NotFinite);
        }
        let is_held: Vec<[bool; D]> = is_held.as_chunks::<D>().0.to_vec();
        let mut motions = motions.to_vec();
        let held = |(motion, held): (&mut Block<D, M>, &[bool; D])| {
            // The prolongator is built of these motions: what is zero here is never moved by a correction.
            (0..D).filter(|k| held[*k]).for_each(|k| motion[k] = [0.0; M]);
        };
        motions.iter_mut().zip(&is_held).for_each(held);
        let mut levels = vec![size(&*matrix)];
        tell(watch, levels[0])?;
        let built = Level::new(matrix.clone(), &motions, &is_held, settings, 0);
        let built = built.map_err(|motion| Fault::NotPositive(shown(&matrix, motion)))?;
        // As much memory as six vectors; the next levels have motions of their own.
        drop(motions);
        let Some((first, mut next)) = built else { return Err(Fault::Stagnant { levels }) };
        let mut others: Vec<Level<M, M>> = Vec::new();
        loop {
            let unknowns = next.matrix.rows() * M;
            levels.push(size(&*next.matrix));
            tell(watch, levels[levels.len() - 1])?;
            let fine = |motion: Vec<[f64; M]>, others: &[Level<M, M>]| {
                Fault::NotPositive(shown(&first.matrix, to_first(&first, others, motion)))
            };
            let Next { matrix, motions, is_held: coarse } = next;
            let bottom = if unknowns <= settings.dense {
                Bottom::dense(&matrix, &coarse).map(Some)
            } else if is_diagonal(&matrix) {
                Bottom::diagonal(&matrix, &coarse).map(Some)
            } else {
                match Level::new(matrix.clone(), &motions, &coarse, settings, others.len() as i32 + 1) {
                    Ok(Some((level, after))) => {
                        // The first level is always followed by another, even where its own unknowns are few enough for a factor.
                        others.push(level);
                        next = after;
                        continue;
                    }
                    Ok(None) if unknowns <= LARGEST => Bottom::dense(&matrix, &coarse).map(Some),
                    Ok(None) => Ok(None),
                    Err(motion) => Err(motion),
                }
            };
            return match bottom {
                Ok(Some(bottom)) => Ok(Multigrid { first, others, bottom, is_held, levels }),
                Ok(None) => Err(Fault::Stagnant { levels }),
                Err(motion) => Err(fine(motion, &others)),
            };
        }
    }

    /// The sizes of all levels, the finest first.
    pub fn levels(&self) -> &[LevelSize] {
        &self.levels
    }

    /// The matrix of the finest level.
    pub fn matrix(&self) -> &Arc<BlockMatrix<D, D>> {
        &self.first.matrix
    }

    /// The number of nodes of the finest level.
    pub fn rows(&self) -> usize {
        self.first.matrix.rows()
    }

    /// Bytes of all levels but the matrix itself.
    pub fn bytes(&self) -> usize {
        fn level<const R: usize, const C: usize>(level: &Level<R, C>) -> usize {
            let inverse = level.smoother.inverse.len() * size_of::<Block<R, R>>();
            level.prolongator.bytes() + inverse + 8 * level.prolongator.values.len()
        }
        level(&self.first) + self.others.iter().map(|other| level(other) + other.matrix.bytes()).sum::<usize>()
    }

    /// The vectors that [`Multigrid::apply`] needs.
    pub fn workspace(&self) -> Workspace<D, M> {
        self.rooms()
    }

    pub(crate) fn rooms<T: Entry>(&self) -> Workspace<D, M, T> {
        let zero = |rows: usize| vec![[T::ZERO; M]; rows];
        let stage = |rows: usize| Stage { force: zero(rows), motion: zero(rows), room: Room::new(rows) };
        let others = self.levels[1..].iter().map(|level| stage(level.nodes)).collect();
        Workspace { first: Room::new(self.rows()), others }
    }

    /// `z ← M⁻¹ r`, one V-cycle; what is held is zero in z, whatever it is in r.
    pub fn apply(&self, r: &[[f64; D]], z: &mut [[f64; D]], workspace: &mut Workspace<D, M>) {
        self.cycle(r, z, workspace);
    }

    /// Computes `z ← M⁻¹ r` by one V-cycle, for one vector or for several; what is held is zero in z, whatever it is in r.
    pub(crate) fn cycle<T: Entry>(&self, r: &[[T; D]], z: &mut [[T; D]], workspace: &mut Workspace<D, M, T>) {
        let Workspace { first, others } = workspace;
        first.residual.copy_from_slice(r);
        // `Multigrid::new` returns only with a level that has the bottom, so that there are at least two sizes.
        let (stage, rest) = others.split_first_mut().expect("there is a level after the first");
        let Stage { force, motion, room } = stage;
        self.first.cycle(z, first, force, motion, |force, motion| self.descend(0, force, motion, room, rest));
    }

    /// The V-cycle of a level after the first.
    fn descend<T: Entry>(
        &self,
        level: usize,
        force: &[[T; M]],
        motion: &mut [[T; M]],
        room: &mut Room<M, T>,
        rest: &mut [Stage<M, T>],
    ) {
        match (self.others.get(level), rest.split_first_mut()) {
            (Some(own), Some((stage, rest))) => {
                room.residual.copy_from_slice(force);
                let Stage { force, motion: coarse, room: next } = stage;
                own.cycle(motion, room, force, coarse, |force, coarse| {
                    self.descend(level + 1, force, coarse, next, rest);
                });
            }
            (_, _) => self.bottom.solve(force, motion),
        }
    }

    /// Zero in what is held.
    pub(crate) fn mask<T: Entry>(&self, x: &mut [[T; D]]) {
        for (x, held) in x.iter_mut().zip(&self.is_held) {
            (0..D).filter(|k| held[*k]).for_each(|k| x[k] = T::ZERO);
        }
    }
}

fn tell(watch: &mut Watch, level: LevelSize) -> Result<(), Fault> {
    if watch(Event::Level(level)).is_break() { Err(Fault::Interrupted) } else { Ok(()) }
}

/// A motion of a level on the first one.
fn to_first<const D: usize, const M: usize>(
    first: &Level<D, M>,
    others: &[Level<M, M>],
    mut motion: Vec<[f64; M]>,
) -> Vec<[f64; D]> {
    for level in others.iter().rev() {
        let mut finer = vec![[0.0; M]; level.matrix.rows()];
        level.prolong(&motion, &mut finer);
        motion = finer;
    }
    let mut finest = vec![[0.0; D]; first.matrix.rows()];
    first.prolong(&motion, &mut finest);
    finest
}

/// The motion with its energy.
pub(crate) fn shown<const D: usize>(a: &BlockMatrix<D, D>, mut motion: Vec<[f64; D]>) -> Motion {
    let largest = motion.iter().flatten().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest > 0.0 {
        motion.as_flattened_mut().iter_mut().for_each(|x| *x /= largest);
    }
    let mut image = motion.clone();
    a.apply(&motion, &mut image);
    // Sizes do not cancel where the energies of neighbours do, so that the quotient is near zero for a motion without resistance.
    let own = |(row, x): (usize, &[f64; D])| -> f64 {
        let block = a.diagonal(row);
        (0..D).flat_map(|i| (0..D).map(move |j| (i, j))).map(|(i, j)| (x[i] * block[i][j] * x[j]).abs()).sum()
    };
    let scale: f64 = motion.iter().enumerate().map(own).sum();
    // A motion of zeros has the energy zero, not 0/0.
    let energy = dot(&motion, &image) / scale.max(f64::MIN_POSITIVE);
    Motion { displacement: motion.as_flattened().to_vec(), energy }
}
