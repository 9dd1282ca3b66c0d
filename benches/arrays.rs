//! The fit of a body from arrays to arrays, beside which `python/benches/arrays.py` times the same call from Python.
//!
//! The folder that is given has `points.f64`, `[points × 3]`, and `cells.i64`, `[cells × 4]`, of tetrahedra. Each line of the input is one
//! run; its answer is the seconds of the processor, the sum of all constants and the number of springs.

mod clock;

use clock::clock;
use springfit_element::element::Element;
use springfit_element::material::{Material, State};
use springfit_fit::fit::{Fit, Objective, Weight};
use springfit_mesh::mesh::{Gate, MeshArrays};
use springfit_studies::study::{NamedFit, Reference, fit_mesh};
use std::collections::BTreeMap;
use std::fs;
use std::io::stdin;
use std::path::Path;
use std::sync::Arc;

fn words(path: &Path) -> Vec<[u8; 8]> {
    fs::read(path).expect("the script has written it").as_chunks::<8>().0.to_vec()
}

fn main() {
    let folder = std::env::args().skip(1).find(|argument| !argument.starts_with("--"));
    let Some(folder) = folder else {
        println!("arrays: python/benches/arrays.py runs this");
        return;
    };
    let folder = Path::new(&folder);
    let points: Vec<f64> = words(&folder.join("points.f64")).into_iter().map(f64::from_le_bytes).collect();
    let cells: Vec<usize> = words(&folder.join("cells.i64")).into_iter().map(usize::from_le_bytes).collect();
    let element = Arc::new(Element::load("tet4").expect("it is shipped"));
    let material = Material::new(1e4, 0.3, State::Solid).expect("it is valid");
    let named = NamedFit::new(Fit::new(Objective::Frobenius(Weight::OffDiagonal)), None);
    for _ in stdin().lines() {
        let start = clock();
        // As Python, whose arrays stay its own.
        let arrays = MeshArrays {
            dimension: 3,
            points: points.clone(),
            blocks: vec![(element.clone(), cells.clone())],
            groups: BTreeMap::new(),
            cell_groups: BTreeMap::new(),
        };
        let mesh = arrays.build(Gate::default()).expect("the cells are sound");
        let fit = fit_mesh(&mesh, material, &Reference::default(), &named, &mut |_| {}).expect("it has springs");
        let lengths = &fit.network.lengths;
        let springs: Vec<i32> = lengths.iter().flat_map(|spring| spring.points.map(|p| p as i32)).collect();
        let constants: Vec<f64> = lengths.iter().map(|spring| spring.constant).collect();
        let rest: Vec<f64> = lengths.iter().map(|spring| spring.rest).collect();
        let seconds = clock() - start;
        assert_eq!(springs.len(), 2 * rest.len());
        println!("{seconds} {:?} {}", constants.iter().sum::<f64>(), rest.len());
    }
}
