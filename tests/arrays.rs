//! Meshes from arrays are those that they were taken from, and wrong arrays are errors.

use crate::kit::{files, place};
use crate::shapes::{Random, elements};
use springfit_element::element::Element;
use springfit_mesh::mesh::{BoxMesh, Gate, Group, Mesh, MeshArrays, MeshSource};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

fn arrays_of(mesh: &Mesh) -> MeshArrays {
    MeshArrays {
        dimension: mesh.dimension,
        points: mesh.points.clone(),
        blocks: mesh.blocks.iter().map(|block| (block.element.clone(), block.connectivity.clone())).collect(),
        groups: mesh.groups.iter().map(|(name, group)| (name.clone(), group.points.clone())).collect(),
        cell_groups: BTreeMap::new(),
    }
}

fn boxes() -> Vec<Mesh> {
    let all = elements().into_iter().map(Arc::new);
    let boxed = |element: Arc<Element>| {
        let d = element.dimension();
        let (size, cells, origin) = (vec![1.0, 1.2, 0.9], vec![3, 2, 2], vec![0.3, 0.0, -0.1]);
        let [size, origin] = [size, origin].map(|list| list[..d].to_vec());
        BoxMesh { element, size, cells: cells[..d].to_vec(), origin }.build().ok()
    };
    all.filter_map(boxed).collect()
}

fn sorted(group: &Group) -> Group {
    let mut group = group.clone();
    group.sides.sort();
    group.lists_points = false;
    group
}

#[test]
fn arrays_give_the_mesh_again() {
    let generated = boxes();
    assert!(generated.len() > 10, "{}", generated.len());
    for mesh in generated {
        let again = arrays_of(&mesh).build(Gate::default()).unwrap();
        let name = &mesh.blocks[0].element.name;
        assert_eq!((again.dimension, &again.points), (mesh.dimension, &mesh.points), "{name}");
        assert_eq!(again.blocks[0].connectivity, mesh.blocks[0].connectivity, "{name}");
        assert_eq!((again.reversed, again.quality.pieces, again.quality.hanging), (0, Some(1), Some(0)), "{name}");
        // The faces of a box, and its cells: a group of points has the sides that a file would list.
        for (group, known) in &mesh.groups {
            let known =
                Group { sides: if group == "body" { Vec::new() } else { known.sides.clone() }, ..known.clone() };
            let mut found = sorted(&again.groups[group]);
            if group == "body" {
                found.sides.clear();
            } else {
                found.cells.clear();
            }
            assert_eq!(found, sorted(&known), "{name} {group}");
        }
    }
    let folder = place("scenes/meshes");
    for path in files(&folder) {
        let mesh = Mesh::resolve(&MeshSource::read(&path).unwrap(), &[], 1.0).unwrap();
        let again = arrays_of(&mesh).build(Gate::default()).unwrap();
        assert_eq!((&again.points, &again.quality), (&mesh.points, &mesh.quality), "{}", path.display());
        assert!(again.blocks.iter().zip(&mesh.blocks).all(|(a, b)| a.connectivity == b.connectivity));
    }
}

/// Unused points are left out, and the numbers say where the others were.
#[test]
fn unused_points_are_left_out_with_numbers() {
    for mesh in boxes() {
        let (d, count) = (mesh.dimension, mesh.point_count());
        let mut arrays = arrays_of(&mesh);
        // One before each point.
        arrays.points = mesh.points.chunks_exact(d).flat_map(|x| [x, x].concat()).collect();
        arrays.blocks.iter_mut().flat_map(|(_, nodes)| nodes).for_each(|p| *p = 2 * *p + 1);
        arrays.groups = BTreeMap::from([("all".into(), (0..2 * count).collect())]);
        let again = arrays.build(Gate::default()).unwrap();
        assert_eq!((again.points.len(), again.unused_points), (mesh.points.len(), count));
        assert!((0..count).all(|p| again.point_number(p) % 2 == 1));
        assert_eq!(again.groups["all"].points, (0..count).collect::<Vec<_>>());
        assert_eq!(again.numbering.unwrap().title(), "places in the array of points, from 0");
    }
}

/// A length, an index or a coordinate that is wrong is an error that names it; none panics.
#[test]
fn wrong_arrays_are_refused() {
    let meshes = boxes();
    let mut random = Random(7);
    let mut below = |count: usize| (((random.next() + 1.0) / 2.0) * count as f64) as usize % count;
    for round in 0..400 {
        let mesh = &meshes[below(meshes.len())];
        let mut arrays = arrays_of(mesh);
        let (count, nodes) = (mesh.point_count(), arrays.blocks[0].1.len());
        let key = match round % 8 {
            0 => {
                arrays.points.pop();
                "points"
            }
            1 => {
                let place = below(arrays.points.len());
                arrays.points[place] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][below(3)];
                "points["
            }
            2 => {
                arrays.blocks[0].1[below(nodes)] = [count, usize::MAX][below(2)];
                "cells of "
            }
            3 => {
                arrays.blocks[0].1.pop();
                if mesh.blocks[0].element.nodes() == 1 { "" } else { "cells of " }
            }
            4 => {
                arrays.groups.insert("far".into(), vec![count]);
                "groups.far"
            }
            5 => {
                arrays.dimension = [0, 4, usize::MAX][below(3)];
                "dimension"
            }
            6 => {
                arrays.blocks.clear();
                "cells"
            }
            _ => {
                arrays.points.iter_mut().for_each(|x| *x *= 1e200);
                "points"
            }
        };
        let outcome = catch_unwind(AssertUnwindSafe(|| arrays.build(Gate::default()))).expect("it does not panic");
        let error = outcome.expect_err(key);
        assert!(error.key().unwrap().starts_with(key), "round {round}: {error}");
    }
}
