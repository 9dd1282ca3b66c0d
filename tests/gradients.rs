//! Derivatives of spring constants: products with the Jacobian in both directions are transposes, for every element and objective.

use crate::shapes::{Random, elements, valid};
use springfit_element::element::Element;
use springfit_element::material::Moduli;
use springfit_element::springs::Springs;
use springfit_fit::fit::{
    CellFunction, CellNumbers, ExactFit, Fit, GradientFit, Higher, Inputs, Objective, VolumeSprings, Weight,
};

/// The objectives that have derivatives, for an element.
fn fits(element: &Element) -> Vec<(GradientFit, Springs)> {
    let selected = Springs::select(element, None).unwrap();
    let weights = [Weight::None, Weight::OffDiagonal, Weight::Modal(Higher::new(0.3).unwrap())];
    let closed = weights.iter().flat_map(|weight| [false, true].map(|tied| (*weight, tied)));
    let closed = closed.map(|(weight, tied)| {
        let fit = Fit { tied, ..Fit::new(Objective::Frobenius(weight)) };
        (GradientFit::Closed(fit), selected.clone())
    });
    let exact = [VolumeSprings::Points, VolumeSprings::Cells].map(|volume| {
        let fit = ExactFit { volume, ..ExactFit::default() };
        (GradientFit::Exact(fit), fit.springs(element))
    });
    closed.chain(exact).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn size(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a * b).abs()).sum()
}

#[test]
fn products_in_both_directions_are_transposes_and_second_ones_are_symmetric() {
    let mut random = Random(11);
    let mut count = 0;
    for element in elements() {
        let (n, d) = (element.nodes(), element.dimension());
        if element.space() != d || d == 1 {
            continue;
        }
        // Three cells, so that lanes are filled in part.
        let cells = 3;
        let mut points = Vec::new();
        while points.len() < cells * n * d {
            points.extend(valid(&element, &mut random));
        }
        let connectivity: Vec<usize> = (0..cells * n).collect();
        let moduli: Vec<Moduli> =
            (0..cells).map(|cell| Moduli { lambda: 1.0 + cell as f64, mu: 2.0 - 0.3 * cell as f64 }).collect();
        for (fit, springs) in fits(&element) {
            let Ok(function) = CellFunction::new(&element, &springs, &points, &connectivity, &moduli[..], fit) else {
                // Springs on angles, areas and other measures have no closed form.
                assert!(!springs.functions().is_empty(), "{}: {fit:?}", element.name);
                continue;
            };
            let mut numbers = |count: usize| (0..count).map(|_| random.next()).collect::<Vec<f64>>();
            let mut change = || Inputs { points: numbers(points.len()), moduli: numbers(cells * 2) };
            let (t, s) = (change(), change());
            let weights = CellNumbers {
                constants: numbers(cells * springs.len()),
                rests: numbers(cells * (springs.len() - springs.pairs().len())),
            };
            // Springs that are linearly dependent under an objective have no derivatives.
            let Ok(moved) = function.along(&[&t]) else { continue };
            count += 1;
            let name = format!("{}: {fit:?}", element.name);
            let gradient = function.gradient(&weights, None).unwrap();
            let one = dot(&moved.constants, &weights.constants) + dot(&moved.rests, &weights.rests);
            let other = dot(&gradient.points, &t.points) + dot(&gradient.moduli, &t.moduli);
            let scale = size(&gradient.points, &t.points) + size(&gradient.moduli, &t.moduli);
            // Distorted cells of many nodes have equations of a condition of a thousand.
            assert!((one - other).abs() <= 1e-9 * scale, "{name}: {one} {other} of {scale}");
            let bent = function.along(&[&t, &s]).unwrap();
            let turned = function.gradient(&weights, Some(&t)).unwrap();
            let one = dot(&bent.constants, &weights.constants) + dot(&bent.rests, &weights.rests);
            let other = dot(&turned.points, &s.points) + dot(&turned.moduli, &s.moduli);
            let scale = size(&turned.points, &s.points) + size(&turned.moduli, &s.moduli);
            assert!((one - other).abs() <= 1e-8 * scale, "{name}, second: {one} {other} of {scale}");
        }
    }
    assert!(count > 50, "{count} elements and objectives have derivatives");
}
