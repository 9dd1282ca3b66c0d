//! Block matrices are the sums of what is added to them.

use super::elastic::{Body, Shape};
use proptest::prelude::*;
use springfit_multigrid::{BlockMatrix, Groups, Pattern};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::ops::Range;
use std::sync::Arc;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_matrix_is_the_sum_of_its_groups_whatever_they_are(
        groups in prop::collection::vec(prop::collection::btree_set(0u32..40, 1..6), 1..60), seed in 1u64..1000,
    ) {
        let mut starts = vec![0];
        let mut nodes = Vec::new();
        for group in &groups {
            nodes.extend(group.iter().copied());
            starts.push(nodes.len());
        }
        let all = Groups { nodes: &nodes, starts: &starts };
        let entry = |group: usize, i: usize, j: usize| ((group as u64 * 31 + (i * j + i + j) as u64 * 7 + seed) % 101) as f64 - 50.0;
        let fill = |some: Range<usize>, mut entries: &mut [f64]| {
            for group in some {
                let n = 2 * groups[group].len();
                let (own, rest) = entries.split_at_mut(n * n);
                for i in 0..n {
                    (0..n).for_each(|j| own[i * n + j] = entry(group, i, j));
                }
                entries = rest;
            }
            Ok::<(), Infallible>(())
        };
        let pattern = Arc::new(Pattern::of_groups(40, &[Groups { nodes: &nodes, starts: &starts }]));
        let matrix = BlockMatrix::<2, 2>::assemble(pattern.clone(), &all, fill).unwrap();
        let mut expected = BTreeMap::new();
        for (g, group) in groups.iter().enumerate() {
            let dofs: Vec<u32> = group.iter().flat_map(|n| [2 * n, 2 * n + 1]).collect();
            for (i, row) in dofs.iter().enumerate() {
                for (j, column) in dofs.iter().enumerate() {
                    *expected.entry((*row, *column)).or_insert(0.0) += entry(g, i, j);
                }
            }
        }
        let mut blocks = 0;
        for row in 0..40 {
            prop_assert!(pattern.row(row).is_sorted());
            for &column in pattern.row(row) {
                let block = matrix.values()[pattern.place(row, column as usize).unwrap()];
                for i in 0..2 {
                    for j in 0..2 {
                        let wanted = expected.get(&(2 * row as u32 + i as u32, 2 * column + j as u32)).copied().unwrap_or(0.0);
                        // Sums of whole numbers are exact.
                        prop_assert_eq!(block[i][j], wanted);
                    }
                }
                blocks += 1;
            }
        }
        prop_assert_eq!(blocks, pattern.len());
        prop_assert!(expected.keys().all(|(r, c)| pattern.place(*r as usize / 2, *c as usize / 2).is_some()));
    }
}

/// The derivative of a rigid motion's strain is zero: exact for cells of any shape but for rounding.
#[test]
fn rigid_motions_meet_no_force() {
    for shape in [Shape::Cube, Shape::Simplex] {
        let body = Body::<3>::new([4, 3, 5], [1.0, 2.0, 0.5], shape, 0.4, 0.3);
        let matrix = body.matrix();
        let motions = springfit_multigrid::space_motions(&body.points, &vec![false; body.points.len()]);
        for k in 0..6 {
            let x: Vec<[f64; 3]> = motions.iter().map(|block| std::array::from_fn(|i| block[i][k])).collect();
            let mut force = vec![[0.0; 3]; x.len()];
            matrix.apply(&x, &mut force);
            assert!(force.iter().flatten().all(|f| f.abs() < 1e-13), "motion {k}");
        }
    }
}

#[test]
fn a_matrix_has_the_same_bits_on_any_number_of_threads() {
    let body = Body::<3>::new([24, 20, 22], [1.0; 3], Shape::Simplex, 0.4, 0.3);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| body.matrix())
    };
    assert_eq!(on(1), on(3));
}
