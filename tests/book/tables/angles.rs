//! What springs on angles gain, over elements and Poisson's ratios, in both norms.

use super::markdown;
use crate::shapes::with_angles;
use springfit::element::Element;
use springfit::fit::{Fit, MotionWeight, Objective, Weight, element_errors, fit_cells};
use springfit::material::Material;
use springfit::springs::Springs;

const RATIOS: [f64; 5] = [0.0, 0.25, 0.3, 0.45, 0.49];

/// `‖R − K‖/‖R‖` of the reference cell by lengths alone and with angles: least squares in the Frobenius norm, the 2-norm in the 2-norm.
pub fn table() -> String {
    let mut rows = Vec::new();
    for name in ["tri3", "quad4", "tet4", "wedge6", "hex8"] {
        for spectral in [false, true] {
            let cell = |nu: &f64| {
                let [without, with] =
                    [Element::load(name).unwrap(), with_angles(name)].map(|element| error(&element, *nu, spectral));
                format!("{without:.3} → {with:.3}")
            };
            let norm = if spectral { "2-norm" } else { "Frobenius" };
            rows.push([name.to_string(), norm.to_string()].into_iter().chain(RATIOS.iter().map(cell)).collect());
        }
    }
    let ratios = RATIOS.map(|nu| format!("ν = {nu}"));
    let header: Vec<&str> = ["element", "norm"].into_iter().chain(ratios.iter().map(String::as_str)).collect();
    markdown(&header, &rows)
}

fn error(element: &Element, nu: f64, spectral: bool) -> f64 {
    let springs = Springs::select(element, None).unwrap();
    let moduli = Material::for_body(element.dimension(), 1.0, nu, None, None).unwrap().moduli();
    let objective = if spectral { Objective::Spectral(MotionWeight::None) } else { Objective::Frobenius(Weight::None) };
    let (x, cell) = (&element.positions, (0..element.nodes()).collect::<Vec<_>>());
    let fits = fit_cells(element, &springs, x, &cell, moduli, &Fit::new(objective), &mut |_| {}).unwrap();
    let errors = element_errors(element, x, &cell, moduli, &fits).unwrap();
    if spectral { errors.spectral[0] } else { errors.frobenius[0] }
}
