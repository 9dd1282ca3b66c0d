//! Meshes that random changes have spoilt: each fault is an error, or is counted by its name. No sound mesh has one.

use crate::kit::{files, place};
use crate::shapes::statics::support_at;
use crate::shapes::{Random, elements, loaded};
use springfit_bodies::model::{LengthSpring, Network, Support, unheld_bodies, unheld_parts};
use springfit_element::element::{Cell, Side};
use springfit_foundation::error::Result;
use springfit_mesh::mesh::{
    Annotations, Below, BoxMesh, CellBlock, Format, Gate, Mesh, MeshSource, NumberOrigin, SourceBlock,
};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Of each kind.
const MUTATIONS: usize = 100;
/// Gmsh's numbers of the linear triangle, tetrahedron and pyramid.
const TRIANGLE: u32 = 2;
const TETRAHEDRON: u32 = 4;
const PYRAMID: u32 = 7;

fn resolve(source: &MeshSource, below: Below) -> Result<Mesh> {
    Mesh::resolve_within(source, &[], 1.0, Some(Gate { below, ..Gate::default() }))
}

/// What a Gmsh file of the mesh would say.
fn source_of(mesh: &Mesh) -> MeshSource {
    let d = mesh.dimension;
    let block = |block: &CellBlock| {
        let gmsh = block.element.formats.gmsh.clone().unwrap();
        let in_order = |nodes: &[usize]| {
            let mut placed = nodes.to_vec();
            for (a, &place) in gmsh.order.iter().flatten().enumerate() {
                placed[place] = nodes[a];
            }
            placed
        };
        SourceBlock {
            dimension: d,
            cell_type: gmsh.cell_type,
            nodes_per_cell: block.element.nodes(),
            connectivity: block.cells().flat_map(in_order).collect(),
            groups: Vec::new(),
            is_marker: true,
            runs: Vec::new(),
        }
    };
    let place = |x: &[f64]| std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0));
    MeshSource {
        format: Format::Gmsh,
        origin: NumberOrigin::GmshTag,
        points: mesh.points.chunks_exact(d).map(place).collect(),
        numbers: (1..=mesh.point_count() as u64).collect(),
        blocks: mesh.blocks.iter().map(block).collect(),
        space: None,
        annotations: Annotations::default(),
    }
}

/// The shipped meshes, and a box of every element that fills one and that Gmsh has.
fn sound() -> Vec<(String, MeshSource)> {
    let mut all = Vec::new();
    for element in elements().into_iter().map(Arc::new) {
        let d = element.dimension();
        let (size, cells, origin) = (vec![1.0, 1.2, 0.9], vec![3, 2, 2], vec![0.3, 0.0, -0.1]);
        let [size, origin] = [size, origin].map(|list| list[..d].to_vec());
        let spec = BoxMesh { element: element.clone(), size, cells: cells[..d].to_vec(), origin };
        if let (Ok(mesh), true) = (spec.build(), element.formats.gmsh.is_some()) {
            all.push((format!("box of {}", element.name), source_of(&mesh)));
        }
    }
    assert!(all.len() > 10, "{}", all.len());
    let folder = place("scenes/meshes");
    let mut files = files(&folder);
    // A sheet has no side that is outside.
    files.retain(|path| !path.ends_with("roof_tri.msh"));
    assert_eq!(files.len(), 12);
    all.extend(files.iter().map(|path| (path.display().to_string(), MeshSource::read(path).unwrap())));
    all
}

fn below(random: &mut Random, count: usize) -> usize {
    (((random.next() + 1.0) / 2.0) * count as f64) as usize % count
}

fn shuffle(random: &mut Random, list: &mut [usize]) {
    (1..list.len()).for_each(|i| list.swap(i, below(random, i + 1)));
}

/// The cells of the highest dimension, by the blocks of the source.
fn cells(source: &MeshSource) -> Vec<(usize, Vec<usize>)> {
    let most = source.blocks.iter().map(|b| b.dimension).max().unwrap();
    let chosen = source.blocks.iter().enumerate().filter(|(_, block)| block.dimension == most);
    let each = |(i, block): (usize, &SourceBlock)| {
        block.connectivity.chunks_exact(block.nodes_per_cell).map(|c| (i, c.to_vec())).collect::<Vec<_>>()
    };
    chosen.flat_map(each).collect()
}

/// Adds a cell of the kind of a block, in no group.
fn push(source: &mut MeshSource, block: usize, nodes: Vec<usize>) {
    source.blocks.push(SourceBlock { connectivity: nodes, groups: Vec::new(), ..source.blocks[block].clone() });
}

/// Adds a point, and returns its place.
fn point(source: &mut MeshSource, at: [f64; 3]) -> usize {
    source.points.push(at);
    source.numbers.push(source.numbers.iter().max().unwrap() + 1);
    source.points.len() - 1
}

/// Runs `mutate` on random sound meshes.
fn mutations(seed: u64, mut mutate: impl FnMut(&str, MeshSource, &mut Random)) {
    let all = sound();
    let mut random = Random(seed);
    for i in 0..MUTATIONS {
        // Every mesh has its turn.
        let (name, source) = &all[i % all.len()];
        mutate(&format!("{name}, mutation {i}"), source.clone(), &mut random);
    }
}

#[test]
fn sound_meshes_have_no_fault() {
    for (name, source) in sound() {
        let mesh = resolve(&source, Below::Warn).unwrap();
        let quality = &mesh.quality;
        assert_eq!((quality.coincident, quality.hanging), (Some(0), Some(0)), "{name}");
        assert_eq!((quality.duplicates, quality.folded, &quality.turned), (0, 0, &None), "{name}");
        assert_eq!((quality.pieces, flood(&mesh)), (Some(1), 1), "{name}");
        assert_eq!(Mesh::resolve(&source, &[], 1.0).unwrap().quality, mesh.quality, "{name}");
    }
}

/// A repeated cell would double stiffness and mass. Its nodes may come in any order, or be others at the same places.
#[test]
fn repeated_cells_are_refused_or_left_out() {
    mutations(1, |name, mut source, random| {
        let (cells, whole) = (cells(&source), resolve(&source, Below::Warn).unwrap());
        let count = 1 + below(random, 3);
        let first = below(random, cells.len());
        for i in 0..count {
            let (block, mut nodes) = cells[(first + i) % cells.len()].clone();
            if random.next() > 0.0 {
                nodes = nodes
                    .iter()
                    .map(|&p| {
                        let at = source.points[p];
                        point(&mut source, at)
                    })
                    .collect();
            }
            shuffle(random, &mut nodes);
            push(&mut source, block, nodes);
        }
        for gate in [Below::Warn, Below::Refuse] {
            let error = resolve(&source, gate).unwrap_err();
            assert_eq!(error.key(), Some("cells"), "{name}: {error}");
            assert!(error.problem().contains(&format!("found {count} of {} ", cells.len() + count)), "{name}: {error}");
            assert_eq!(error.problem().matches(" cell ").count(), count + 2, "{name}: {error}");
        }
        let mesh = resolve(&source, Below::Skip).unwrap();
        assert_eq!((mesh.quality.duplicates, mesh.cell_count()), (count, whole.cell_count()), "{name}");
        assert_eq!((mesh.points, mesh.quality.coincident), (whole.points, Some(0)), "{name}");
        assert!(mesh.blocks.iter().zip(&whole.blocks).all(|(a, b)| a.connectivity == b.connectivity), "{name}");
        // The cells that are left stay in their groups.
        assert!(mesh.groups.iter().all(|(name, group)| whole.groups[name].cells == group.cells), "{name}");
    });
}

/// A corner that has gone through its cell.
#[test]
fn folded_cells_are_refused_or_left_out() {
    mutations(2, |name, mut source, random| {
        let cells = cells(&source);
        let (_, nodes) = &cells[below(random, cells.len())];
        // Corners come first in all formats.
        let p = nodes[below(random, 3)];
        let mean = |k: usize| nodes.iter().map(|&q| source.points[q][k]).sum::<f64>() / nodes.len() as f64;
        let way: [f64; 3] = std::array::from_fn(|k| mean(k) - source.points[p][k]);
        (0..3).for_each(|k| source.points[p][k] += 2.2 * way[k]);
        let error = resolve(&source, Below::Warn).expect_err(name);
        let key = error.key().unwrap();
        assert!(key == "cells" || key.contains(" cell "), "{name}: {error}");
        let mesh = resolve(&source, Below::Skip).unwrap();
        let out = mesh.quality.folded + mesh.quality.skipped;
        assert!(out > 0 && out + mesh.cell_count() == cells.len(), "{name}: {:?}", mesh.quality);
    });
}

#[test]
fn pieces_without_support_are_found() {
    mutations(3, |name, mut source, random| {
        let whole = resolve(&source, Below::Warn).unwrap();
        let cells = cells(&source);
        let (block, nodes) = cells[below(random, cells.len())].clone();
        let far = 10.0 + random.next();
        let copy = nodes.iter().map(|&p| {
            let [x, y, z] = source.points[p];
            point(&mut source, [x + far, y, z])
        });
        let copy: Vec<usize> = copy.collect();
        let count = copy.len();
        push(&mut source, block, copy);
        let mesh = resolve(&source, Below::Warn).unwrap();
        let d = mesh.dimension;
        let support = support_at(&mesh, &(0..whole.point_count()).collect::<Vec<_>>());
        assert_eq!((mesh.quality.pieces, flood(&mesh)), (Some(2), 2), "{name}");
        let unheld = unheld_bodies(&mesh, &support);
        assert_eq!(unheld.len(), 1, "{name}");
        assert_eq!((unheld[0].points, unheld[0].motions), (count, d * (d + 1) / 2), "{name}");
    });
}

/// Points at one place have translations alone, and those whose distances are no numbers count as not held.
#[test]
fn springs_between_points_at_one_place_are_counted() {
    let spring = |points| LengthSpring { points, constant: 1.0, rest: 1.0 };
    let network = Network { dimension: 3, lengths: vec![spring([0, 1]), spring([2, 3])], ..Network::default() };
    let mut points = vec![0.5; 12];
    points[6..].copy_from_slice(&[3.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    let found = |points: &[f64], held: &[usize]| {
        let mut support = Support { prescribed: vec![None; points.len()] };
        support.fix(held, &[0, 1, 2], 3);
        let unheld = unheld_parts(&network, points, &support);
        unheld.iter().map(|part| (part.first_point, part.points, part.motions)).collect::<Vec<_>>()
    };
    assert_eq!(found(&points, &[]), [(0, 2, 3), (2, 2, 5)]);
    assert_eq!(found(&points, &[1, 2, 3]), []);
    points[6..].copy_from_slice(&[f64::MAX, 0.0, 0.0, f64::MAX, 1.0, 0.0]);
    assert_eq!(found(&points, &[0, 2, 3]), [(2, 2, 6)]);
}

/// The cells beyond a plane have nodes of their own, as where two parts were meshed each for itself.
#[test]
fn unmerged_nodes_and_pieces_are_counted() {
    let mut cut = 0;
    mutations(4, |name, mut source, random| {
        let axis = below(random, 2);
        let all = cells(&source);
        let middle = |nodes: &[usize]| nodes.iter().map(|&p| source.points[p][axis]).sum::<f64>() / nodes.len() as f64;
        let (_, pivot) = &all[below(random, all.len())];
        let limit = middle(pivot);
        let beyond: Vec<bool> = all.iter().map(|(_, nodes)| middle(nodes) > limit).collect();
        let mut sides: BTreeMap<usize, [bool; 2]> = BTreeMap::new();
        for ((_, nodes), side) in all.iter().zip(&beyond) {
            nodes.iter().for_each(|&p| sides.entry(p).or_default()[usize::from(*side)] = true);
        }
        let mut copies = HashMap::new();
        for (p, _) in sides.into_iter().filter(|(_, sides)| *sides == [true, true]) {
            let at = source.points[p];
            copies.insert(p, point(&mut source, at));
        }
        let most = source.blocks.iter().map(|block| block.dimension).max().unwrap();
        let mut side = beyond.iter();
        for block in source.blocks.iter_mut().filter(|block| block.dimension == most) {
            for nodes in block.connectivity.chunks_exact_mut(block.nodes_per_cell) {
                if *side.next().unwrap() {
                    nodes.iter_mut().for_each(|p| *p = *copies.get(p).unwrap_or(p));
                }
            }
        }
        for gate in [None, Some(Gate::default())] {
            let mesh = Mesh::resolve_within(&source, &[], 1.0, gate).unwrap();
            assert_eq!(mesh.quality.coincident, Some(copies.len()), "{name}");
            assert_eq!(mesh.quality.pieces, Some(flood(&mesh)), "{name}");
            cut += usize::from(mesh.quality.pieces > Some(1));
        }
    });
    assert!(cut > MUTATIONS, "{cut} meshes in pieces");
}

/// Connected parts by flooding, from cell to cell.
fn flood(mesh: &Mesh) -> usize {
    let cells: Vec<&[usize]> = mesh.blocks.iter().flat_map(|block| block.cells()).collect();
    let mut around = vec![Vec::new(); mesh.point_count()];
    cells.iter().enumerate().for_each(|(cell, nodes)| nodes.iter().for_each(|&p| around[p].push(cell)));
    let (mut met, mut count) = (vec![false; cells.len()], 0);
    for seed in 0..cells.len() {
        let mut wet = if met[seed] { Vec::new() } else { vec![seed] };
        count += wet.len();
        while let Some(cell) = wet.pop() {
            if !std::mem::replace(&mut met[cell], true) {
                wet.extend(cells[cell].iter().flat_map(|&p| &around[p]));
            }
        }
    }
    count
}

/// One of two cells that share a side is divided by a new point on that side or on an edge of it, at any place, and its neighbours
/// are not.
#[test]
fn hanging_nodes_are_counted() {
    mutations(5, |name, mut source, random| {
        let mesh = resolve(&source, Below::Warn).unwrap();
        let d = mesh.dimension;
        let element = mesh.blocks[0].element.clone();
        let corners: Vec<usize> = (0..element.cell.corners().len()).map(|c| element.corner_node(c).unwrap()).collect();
        let all: Vec<&[usize]> = mesh.blocks[0].cells().collect();
        let side_of =
            |nodes: &[usize], side: &Side| -> Vec<usize> { side.corners.iter().map(|&c| nodes[corners[c]]).collect() };
        let sorted = |mut points: Vec<usize>| {
            points.sort_unstable();
            points
        };
        let mut met: HashMap<Vec<usize>, usize> = HashMap::new();
        for side in all.iter().flat_map(|nodes| element.cell.sides().iter().map(|side| side_of(nodes, side))) {
            *met.entry(sorted(side)).or_default() += 1;
        }
        let (cell, chosen) = loop {
            let cell = below(random, all.len());
            let side = &element.cell.sides()[below(random, element.cell.sides().len())];
            if met[&sorted(side_of(all[cell], side))] == 2 {
                break (cell, side);
            }
        };
        let nodes = all[cell];
        // Somewhere on one of its edges, or inside it.
        let on = side_of(nodes, chosen);
        let share = (random.next() + 1.0) / 2.0 * 0.8 + 0.1;
        let weights: Vec<f64> = match (on.len(), random.next() > 0.0) {
            (2, _) => vec![share, 1.0 - share],
            (count, true) => (0..count).map(|i| [share, 1.0 - share, 0.0, 0.0][i]).collect(),
            (3, false) => vec![0.5 * share, 0.5 - 0.5 * share, 0.5],
            (_, false) => vec![0.3 * share, 0.3 * (1.0 - share), 0.7 * (1.0 - share), 0.7 * share],
        };
        let mut at = [0.0; 3];
        for (&p, w) in on.iter().zip(&weights) {
            (0..d).for_each(|k| at[k] += w * mesh.point(p)[k]);
        }
        let touched: Vec<usize> = on.iter().zip(&weights).filter(|(_, w)| **w > 0.0).map(|(p, _)| *p).collect();
        let mut cones = Vec::new();
        for side in element.cell.sides() {
            let base = side_of(nodes, side);
            if touched.iter().all(|p| base.contains(p)) {
                continue;
            }
            let (cell_type, mut cone) = match side.cell {
                Cell::Interval => (TRIANGLE, base),
                Cell::Triangle => (TETRAHEDRON, base),
                _ => (PYRAMID, base),
            };
            cone.push(mesh.point_count());
            cones.push((cell_type, cone));
        }
        // The mesh without groups, whose points have the same numbers.
        source = source_of(&mesh);
        assert_eq!(point(&mut source, at), mesh.point_count());
        let n = element.nodes();
        source.blocks[0].connectivity.drain(cell * n..(cell + 1) * n);
        for (cell_type, connectivity) in cones {
            let nodes_per_cell = connectivity.len();
            source.blocks.push(SourceBlock {
                dimension: d,
                cell_type,
                nodes_per_cell,
                connectivity,
                groups: Vec::new(),
                is_marker: true,
                runs: Vec::new(),
            });
        }
        let fine = resolve(&source, Below::Warn).unwrap();
        let found = fine.quality.hanging.unwrap();
        // The middles of the cell's own edges are on straight edges now.
        match n == corners.len() {
            true => assert_eq!(found, 1, "{name}"),
            false => assert!(found > 0, "{name}"),
        }
        assert_eq!((fine.quality.coincident, fine.quality.folded), (Some(0), 0), "{name}");
    });
}

/// The signs of the volumes of tetrahedra are an independent count of those that are folded: a point of a box of 3 × 3 × 3 cubes goes
/// through some of its cells.
#[test]
fn a_mesh_folded_in_part_names_the_cells() {
    let element = loaded("tet4");
    let spec = BoxMesh { element, size: vec![3.0; 3], cells: vec![3; 3], origin: vec![0.0; 3] };
    let whole = spec.build().unwrap();
    let inner = (0..whole.point_count()).find(|&p| whole.point(p) == [1.0; 3]).unwrap();
    let mut source = source_of(&whole);
    source.points[inner] = [1.0, 1.3, 2.2];
    let volume = |nodes: &[usize]| {
        let edge = |i: usize| std::array::from_fn(|k| source.points[nodes[i]][k] - source.points[nodes[0]][k]);
        let [a, b, c]: [[f64; 3]; 3] = [edge(1), edge(2), edge(3)];
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]
    };
    let folded: Vec<usize> =
        whole.blocks[0].cells().enumerate().filter(|(_, n)| volume(n) < 0.0).map(|c| c.0).collect();
    assert!((2..20).contains(&folded.len()), "{folded:?}");
    let error = resolve(&source, Below::Warn).unwrap_err();
    assert_eq!(error.key(), Some("cells"));
    assert!(error.problem().contains(&format!("found {} of 162 folded", folded.len())), "{error}");
    for cell in folded.iter().take(6) {
        assert!(error.problem().contains(&format!("tet4 cell {} at ", cell + 1)), "{error}");
    }
    let mesh = resolve(&source, Below::Skip).unwrap();
    assert_eq!((mesh.quality.folded, mesh.reversed, mesh.cell_count()), (folded.len(), 0, 162 - folded.len()));
}

/// A mesh that is numbered the other way round in whole or in part, and lies where it should, is turned.
#[test]
fn cells_numbered_the_other_way_round_are_turned() {
    for (name, source) in sound() {
        let whole = resolve(&source, Below::Warn).unwrap();
        if whole.blocks.iter().any(|block| block.element.space() > block.element.dimension()) {
            continue;
        }
        let most = source.blocks.iter().map(|block| block.dimension).max().unwrap();
        for every in [1, 3] {
            let mut other = source_of(&whole);
            let mut turned = 0;
            for (block, known) in other.blocks.iter_mut().zip(&whole.blocks) {
                let reflection = known.element.reflection.clone().unwrap();
                let order = known.element.formats.gmsh.clone().unwrap().order;
                for nodes in block.connectivity.chunks_exact_mut(block.nodes_per_cell).step_by(every) {
                    let own: Vec<usize> = match &order {
                        Some(order) => order.iter().map(|&place| nodes[place]).collect(),
                        None => nodes.to_vec(),
                    };
                    for (a, &from) in reflection.iter().enumerate() {
                        nodes[order.as_ref().map_or(a, |order| order[a])] = own[from];
                    }
                    turned += 1;
                }
            }
            assert_eq!(other.blocks[0].dimension, most);
            let mesh = resolve(&other, Below::Refuse).unwrap();
            assert_eq!((mesh.reversed, mesh.quality.folded), (turned, 0), "{name}");
            assert_eq!(mesh.quality.turned.is_some(), every > 1, "{name}");
            assert!(mesh.blocks.iter().zip(&whole.blocks).all(|(a, b)| a.connectivity == b.connectivity), "{name}");
        }
    }
}
