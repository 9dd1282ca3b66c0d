//! The springs of a network that belong to a sample of its cells.

use super::sample::{Sample, Stars};
use crate::fit::CellFits;
use crate::mesh::Mesh;
use crate::model::{LengthSpring, MeasureSpring, Network, PatchSpring};
use crate::springs::{Measure, Patch};
use std::collections::HashSet;
use std::sync::Arc;

/// The springs that belong to a sample, and the springs of its interior points that extend beyond it.
pub(super) struct Piece {
    /// Its points are those of the sample, then the outer ends of springs.
    pub(super) network: Network,
    /// The positions of the points, `[points × dimension]`, m.
    pub(super) points: Vec<f64>,
    /// The share of each spring that belongs to the sample, length springs first.
    pub(super) shares: Vec<f64>,
    pub(super) patches: Vec<PatchSpring>,
}

impl Piece {
    /// The springs of the cells of the sample. A spring on the content of a patch belongs to the sample by the share of
    /// that content that is in the sample.
    pub(super) fn of_cells(mesh: &Mesh, sample: &Sample, cells: &[CellFits], patches: &[&MeasureSpring]) -> Piece {
        let fits: Vec<CellFits> = cells.iter().zip(&sample.cells).map(|(fits, cells)| fits.of_cells(cells)).collect();
        Piece::of_sample(mesh, sample, Network::assemble(&sample.mesh, &fits), patches)
    }

    /// The springs `network` of the sample alone, and its share of the patches.
    pub(super) fn of_sample(mesh: &Mesh, sample: &Sample, network: Network, patches: &[&MeasureSpring]) -> Piece {
        let shares = vec![1.0; network.len()];
        let mut piece = Piece { network, points: sample.mesh.points.clone(), shares, patches: Vec::new() };
        piece.add_patches(mesh, sample, patches);
        piece
    }

    /// The springs on the contents of patches, which all samples ask for: a network has millions of other springs.
    pub(super) fn patches_of(network: &Network) -> Vec<&MeasureSpring> {
        network.others.iter().filter(|spring| matches!(spring.measure, Measure::Patch(_))).collect()
    }

    fn add_patches(&mut self, mesh: &Mesh, sample: &Sample, patches: &[&MeasureSpring]) {
        let d = mesh.dimension;
        let near = |spring: &&&MeasureSpring| spring.points.iter().any(|p| sample.places.contains_key(p));
        let springs: Vec<&MeasureSpring> = patches.iter().filter(near).copied().collect();
        if springs.is_empty() {
            return;
        }
        let own: HashSet<Vec<usize>> = sample
            .mesh
            .blocks
            .iter()
            .flat_map(|block| block.cells())
            .map(|nodes| nodes.iter().map(|&place| sample.points[place]).collect())
            .collect();
        let mut places = sample.places.clone();
        for spring in springs {
            let Measure::Patch(patch) = &spring.measure else { continue };
            let is_own =
                |nodes: &[usize]| own.contains(&nodes.iter().map(|&a| spring.points[a]).collect::<Vec<usize>>());
            let cells = patch.cells.iter().filter(|(nodes, _)| is_own(nodes)).cloned().collect();
            let x: Vec<f64> = spring.points.iter().flat_map(|&point| mesh.point(point)).copied().collect();
            let part = Measure::Patch(Arc::new(Patch { element: patch.element.clone(), cells }));
            let content = spring.measure.value(&x, d);
            let [_, _, slope] = spring.pull(content);
            let share = part.value(&x, d) / content;
            let place = |point: &usize| {
                *places.entry(*point).or_insert_with(|| {
                    self.points.extend(mesh.point(*point));
                    self.points.len() / d - 1
                })
            };
            let points = spring.points.iter().map(place).collect();
            let gradient = spring.measure.gradient(&x, d);
            self.patches.push(PatchSpring { points, gradient, slope, share });
        }
    }

    /// The springs of a network that belong to no cell: each is shared equally among the cells that have all of its
    /// points or, if there is none, among those that have any. Patches are as in [`Piece::of_cells`].
    pub(super) fn of_network(
        mesh: &Mesh,
        stars: &Stars,
        sample: &Sample,
        whole: &Network,
        patches: &[&MeasureSpring],
    ) -> Piece {
        let has = |cell: usize, point: usize| stars.points(cell).contains(&point);
        let share_of = |cells: &mut dyn Iterator<Item = usize>| {
            let (own, count) =
                cells.fold((0, 0), |(own, count), cell| (own + u32::from(stars.is_in(cell, sample)), count + 1_u32));
            (count > 0).then(|| f64::from(own) / f64::from(count))
        };
        let share = |points: &[usize]| {
            let around = || stars.around(points[0]);
            let any = || points.iter().flat_map(|&point| stars.around(point));
            let all = share_of(&mut around().filter(|&cell| points.iter().all(|&point| has(cell, point))));
            all.or_else(|| share_of(&mut any())).unwrap_or(0.0)
        };
        let place = |point: &usize| sample.places.get(point).copied();
        let mut network = Network { dimension: whole.dimension, ..Network::default() };
        let mut shares = Vec::new();
        for &point in &sample.points {
            // Springs on lengths are sorted by their points, so that those of a point follow each other.
            let first = whole.lengths.partition_point(|spring| spring.points[0] < point);
            for spring in whole.lengths[first..].iter().take_while(|spring| spring.points[0] == point) {
                if let (Some(a), Some(b)) = (place(&spring.points[0]), place(&spring.points[1])) {
                    shares.push(share(&spring.points));
                    network.lengths.push(LengthSpring { points: [a, b], ..*spring });
                }
            }
        }
        for spring in whole.others.iter().filter(|spring| !matches!(spring.measure, Measure::Patch(_))) {
            if let Some(points) = spring.points.iter().map(place).collect() {
                shares.push(share(&spring.points));
                network.others.push(MeasureSpring { points, ..spring.clone() });
            }
        }
        let mut piece = Piece { network, points: sample.mesh.points.clone(), shares, patches: Vec::new() };
        piece.add_patches(mesh, sample, patches);
        piece
    }
}
