//! Sides of cells: those on the boundary and those of groups, as a search through all sides finds them.

use crate::shapes::{Random, loaded};
use springfit_element::element::SHIPPED;
use springfit_mesh::mesh::{BoxMesh, CellIndex, Mesh, MeshSource, Selection, SideIndex};
use std::collections::BTreeMap;

/// The sides of each set of points, in the order of the cells.
fn sets(mesh: &Mesh) -> BTreeMap<Vec<usize>, Vec<SideIndex>> {
    let mut sets: BTreeMap<Vec<usize>, Vec<SideIndex>> = BTreeMap::new();
    for (block, cells) in mesh.blocks.iter().enumerate() {
        for (cell, nodes) in cells.cells().enumerate() {
            for (side, table) in cells.element.sides().iter().enumerate() {
                let mut points: Vec<usize> = table.nodes.iter().map(|&a| nodes[a]).collect();
                points.sort_unstable();
                sets.entry(points).or_default().push(SideIndex { cell: CellIndex { block, cell }, side });
            }
        }
    }
    sets
}

fn place(side: &SideIndex) -> (usize, usize, usize) {
    (side.cell.block, side.cell.cell, side.side)
}

#[test]
fn sides_of_one_cell_are_the_boundary() {
    let mut random = Random(31);
    for shipped in SHIPPED.iter() {
        let element = loaded(shipped.name);
        let d = element.dimension();
        let spec = BoxMesh { element, size: vec![1.0; d], cells: vec![3; d], origin: vec![0.0; d] };
        let Ok(mut mesh) = spec.build() else { continue };
        // Numbers of points without any order.
        let count = mesh.point_count();
        let mut numbers: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            numbers.swap(i, (0.5 * (random.next() + 1.0) * i as f64) as usize);
        }
        let old = mesh.points.clone();
        for (p, &number) in numbers.iter().enumerate() {
            mesh.points[number * d..(number + 1) * d].copy_from_slice(&old[p * d..(p + 1) * d]);
        }
        mesh.blocks.iter_mut().flat_map(|block| &mut block.connectivity).for_each(|p| *p = numbers[*p]);
        let mut expected: Vec<SideIndex> = sets(&mesh).into_values().filter(|s| s.len() == 1).flatten().collect();
        expected.sort_unstable_by_key(place);
        let found = Selection::Everything.sides(&mesh).unwrap();
        assert!(!found.is_empty(), "{}", shipped.name);
        assert_eq!(found, expected, "{}", shipped.name);
    }
}

#[test]
fn sides_of_groups_are_the_first_of_their_points() {
    let folder = crate::kit::place("scenes/meshes");
    let mut tested = 0;
    for path in crate::kit::files(&folder) {
        let mesh = Mesh::resolve(&MeshSource::read(&path).unwrap(), &[], 1.0).unwrap();
        let sets = sets(&mesh);
        // A group that lists no sides has the outer ones between its points.
        for (name, group) in mesh.groups.iter().filter(|(_, group)| !group.sides.is_empty()) {
            let mut listed = group.sides.clone();
            listed.sort_unstable();
            listed.dedup();
            let expected: Vec<SideIndex> = listed.iter().filter_map(|points| Some(sets.get(points)?[0])).collect();
            let found = Selection::Group(name.clone()).sides(&mesh).unwrap();
            assert_eq!(found, expected, "{}: {name}", path.display());
            tested += found.len();
        }
    }
    assert!(tested > 100, "{tested}");
}
