//! The matrix errors of cells, computed side by side, are those of the matrices.

use crate::shapes::statics::dense;
use crate::shapes::{Random, distorted, elements, loaded, materials};
use nalgebra::DMatrix;
use springfit_bodies::model::{Network, finite_elements};
use springfit_element::element::Element;
use springfit_element::material::Material;
use springfit_element::springs::Springs;
use springfit_element::stiffness::Geometry;
use springfit_fit::fit::{
    CellFits, ExactEnergy, ExactFit, Fit, Objective, Rest, VolumeSprings, Weight, element_errors, fit_cells, fit_exact,
};
use springfit_mesh::mesh::{CellBlock, Mesh};
use springfit_numerics::dense::eigenvalues;
use std::sync::Arc;

/// More than lanes, and not a multiple of them.
const CELLS: usize = 11;

/// Cells without common nodes; the fourth is so thin that it is computed alone.
fn cells(element: &Element, random: &mut Random) -> Vec<f64> {
    let (d, mut points) = (element.dimension(), Vec::new());
    for cell in 0..CELLS {
        let x = loop {
            let mut x = distorted(element, random);
            if cell == 3 && d > 1 {
                x.iter_mut().skip(1).step_by(d).for_each(|y| *y *= 1e-4);
            }
            if Geometry::new(&element.tabulation).set(&element.tabulation, &x).is_ok() {
                break x;
            }
        };
        points.extend(x);
    }
    points
}

fn fits(element: &Element, points: &[f64], nodes: &[usize], material: Material) -> Vec<(String, CellFits)> {
    let plain = Springs::select(element, None).unwrap();
    let groups: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
    let all = Springs::select(element, Some(&groups)).unwrap();
    let mut found = Vec::new();
    for (name, springs, rest) in
        [("plain", &plain, Rest::Mesh), ("all groups", &all, Rest::Mesh), ("free rest", &plain, Rest::Free)]
    {
        let fit = Fit { rest, ..Fit::new(Objective::Frobenius(Weight::None)) };
        // Some elements have too few springs for rest lengths of their own, some groups too many for a thin cell.
        if let Ok(fits) = fit_cells(element, springs, points, nodes, material.moduli(), &fit, &mut |_| {}) {
            found.push((name.to_string(), fits));
        }
    }
    for energy in [ExactEnergy::StableNeoHookean, ExactEnergy::StableMooneyRivlin { share: 0.3 }] {
        for volume in [VolumeSprings::Points, VolumeSprings::Cells] {
            let exact = ExactFit { energy, volume, ..ExactFit::default() };
            if let Ok(fits) = fit_exact(element, points, nodes, material, &exact, &mut |_| {}) {
                found.push((format!("{energy:?} {volume:?}"), fits));
            }
        }
    }
    found
}

#[test]
fn errors_of_cells_side_by_side_are_those_of_their_matrices() {
    let mut random = Random(77);
    let mut compared = 0;
    for element in elements() {
        let element = Arc::new(element);
        let (n, d) = (element.nodes(), element.dimension());
        let points = cells(&element, &mut random);
        let nodes: Vec<usize> = (0..CELLS * n).collect();
        // One ratio of large elements, whose reference takes long.
        let every = if n * d > 24 { 4 } else { 1 };
        for material in materials(d).into_iter().skip(2).step_by(every) {
            for (name, fits) in fits(&element, &points, &nodes, material) {
                let errors = element_errors(&element, &points, &nodes, material.moduli(), &fits).unwrap();
                let what = format!("{} {name} {material:?}", element.name);
                let mesh = Mesh::of_cells(
                    d,
                    points.clone(),
                    vec![CellBlock { element: element.clone(), connectivity: nodes.clone() }],
                );
                let size = points.len();
                let r = dense(size, &finite_elements(&mesh, material.moduli()));
                let k = dense(size, &Network::assemble(&mesh, std::slice::from_ref(&fits)).stiffness(&points));
                for cell in 0..CELLS {
                    let of =
                        |matrix: &DMatrix<f64>| matrix.view((cell * n * d, cell * n * d), (n * d, n * d)).into_owned();
                    let (r, left) = (of(&r), of(&r) - of(&k));
                    let spectral = eigenvalues(left.clone()).amax() / eigenvalues(r.clone()).amax();
                    let frobenius = left.norm() / r.norm();
                    for (found, known) in [(errors.spectral[cell], spectral), (errors.frobenius[cell], frobenius)] {
                        // A thin cell's matrices have six digits less.
                        let bound = if cell == 3 { 1e-6 } else { 1e-11 } * (1.0 + known);
                        assert!((found - known).abs() < bound, "{what}, cell {cell}: {found:e} and {known:e}");
                        compared += 1;
                    }
                }
            }
        }
    }
    println!("{compared} errors");
    assert!(compared > 3000);
}

/// K = R of an exact network on linear simplices: what rounding leaves is not worth eigenvalues, and the bound is not below the 2-norm. A
/// constant that is wrong in its tenth digit is found, with the 2-norm of its matrix.
#[test]
fn rounded_differences_have_a_bound_and_wrong_constants_their_error() {
    let mut random = Random(5);
    for name in ["tri3", "tet4"] {
        let element = loaded(name);
        let (n, d) = (element.nodes(), element.dimension());
        let points: Vec<f64> = (0..CELLS).flat_map(|_| distorted(&element, &mut random)).collect();
        let nodes: Vec<usize> = (0..CELLS * n).collect();
        let (mut bounded, mut all) = (0, 0);
        for material in materials(d) {
            let Ok(mut fits) = fit_exact(&element, &points, &nodes, material, &ExactFit::default(), &mut |_| {}) else {
                continue;
            };
            let errors = element_errors(&element, &points, &nodes, material.moduli(), &fits).unwrap();
            for (frobenius, spectral) in errors.frobenius.iter().zip(&errors.spectral) {
                // A cell beside a thin one has eigenvalues, which rounding may put a little above their bound.
                let bound = ((n * d) as f64).sqrt() * frobenius;
                assert!(
                    *frobenius < 1e-11 && *spectral <= 2.0 * bound,
                    "{name} {material:?}: {frobenius:e} {spectral:e}"
                );
                (bounded, all) = (bounded + usize::from((spectral - bound).abs() <= 1e-15 * bound), all + 1);
            }
            fits.constants[0] *= 1.0 + 1e-10;
            let errors = element_errors(&element, &points, &nodes, material.moduli(), &fits).unwrap();
            let (frobenius, spectral) = (errors.frobenius[0], errors.spectral[0]);
            assert!(frobenius > 1e-13 && spectral > 1e-13, "{name} {material:?}: {frobenius:e}, {spectral:e}");
            assert!(spectral <= frobenius * ((n * d) as f64).sqrt(), "{name} {material:?}: {spectral:e}");
        }
        assert!(2 * bounded > all, "{name}: {bounded} of {all}");
    }
}
