//! What springs on angles gain: over elements and Poisson's ratios in both norms, and on bodies.

use super::{fit, markdown, outcome, root};
use crate::shapes::{Random, distorted, text_with_angles, with_angles};
use springfit_bodies::solve::Standing;
use springfit_element::element::{Element, SHIPPED};
use springfit_element::material::Material;
use springfit_element::springs::Springs;
use springfit_element::stiffness::Geometry;
use springfit_fit::fit::{Fit, MotionWeight, Objective, Weight, element_errors, fit_cells};
use springfit_studies::study::{FitEntry, FitOutcome, Scene, Setting};

const RATIOS: [f64; 4] = [0.0, 0.3, 0.45, 0.49];
/// An odd number of shapes has one in the middle.
const SHAPES: usize = 11;
/// A body of each simplex and of a quadrilateral, and its element.
const BODIES: [(&str, &str); 3] = [("tissue_tri", "tri3"), ("square_quad", "quad4"), ("cube_tet", "tet4")];

/// The median over random shapes of `‖R − K‖/‖R‖` by lengths alone and with angles: least squares in the Frobenius norm, the 2-norm in the 2-norm.
pub fn table() -> String {
    let mut rows = Vec::new();
    for name in SHIPPED.iter().map(|file| file.name).filter(|name| !name.starts_with("bar")) {
        let elements = [Element::load(name).unwrap(), with_angles(name)];
        let mut random = Random(1);
        let table = &elements[0].tabulation;
        let is_untangled = |x: &Vec<f64>| Geometry::new(table).set(table, x).is_ok();
        let shapes = std::iter::repeat_with(|| distorted(&elements[0], &mut random)).filter(is_untangled);
        let shapes: Vec<Vec<f64>> = shapes.take(SHAPES).collect();
        for spectral in [false, true] {
            let cell = |nu: &f64| {
                let [without, with] = elements.each_ref().map(|element| error(element, &shapes, *nu, spectral));
                format!("{without:.3} → {with:.3}")
            };
            let norm = if spectral { "2-norm" } else { "Frobenius" };
            rows.push([name.to_string(), norm.to_string()].into_iter().chain(RATIOS.iter().map(cell)).collect());
        }
    }
    gains(&["element", "norm"], &rows)
}

/// `e_rms` of the bodies by lengths alone and with angles, in percent of the largest displacement of the finite elements of the mesh.
pub fn bodies() -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = Vec::new();
    for (name, element) in BODIES {
        let path = folder.path().join(format!("{element}.toml"));
        std::fs::write(&path, text_with_angles(element)).unwrap();
        let lengths = Element::load(element).unwrap().springs.into_iter().filter(|group| !group.optional);
        let lengths: Vec<String> = lengths.map(|group| group.name).collect();
        let bounded = FitEntry::new("frobenius").with("nonnegative", Some(true));
        let entries = [FitEntry::new("frobenius"), FitEntry::new("spectral"), bounded];
        let both =
            |entry: &FitEntry| [Some(lengths.clone()), None].map(|groups| fit(entry.clone().with_springs(groups)));
        let fits: Vec<_> = entries.iter().flat_map(both).collect();
        let outcomes = RATIOS.map(|nu| {
            // Cells of a file are of the first element of their type, those of a box of the element that it names.
            let own = if name == "square_quad" { "mesh.box.element={path}" } else { "mesh.elements=[{path}]" };
            let own = own.replace("{path}", &format!("{path:?}"));
            let settings = [own, format!("material.poisson={nu}")];
            let settings = settings.map(|setting| Setting::parse(&setting).unwrap());
            let scene = Scene::load_with(&root().join(format!("scenes/{name}.toml")), &settings).unwrap();
            outcome(&scene.judged_by_cells().with_fits(fits.clone()))
        });
        for (l, load) in outcomes[0].loads.iter().enumerate() {
            for (i, norm) in ["`frobenius`", "`spectral`", "`frobenius`, k ≥ 0"].into_iter().enumerate() {
                let own = [format!("`{name}`"), load.name.clone(), norm.to_string()];
                let cell = |fits: &[FitOutcome]| {
                    let [without, with] = [0, 1].map(|with| shown(&fits[2 * i + with], l));
                    format!("{without} → {with}")
                };
                rows.push(own.into_iter().chain(outcomes.iter().map(|outcome| cell(&outcome.fits))).collect());
            }
        }
    }
    gains(&["scene", "load", "fit"], &rows)
}

/// The error of a network under a load; † where it is not stable.
fn shown(fit: &FitOutcome, load: usize) -> String {
    let is_stable = fit.stability.as_ref().is_some_and(|stability| stability.standing == Standing::Stable);
    let mark = if is_stable { "" } else { " †" };
    fit.loads[load].error.map_or("–".into(), |error| format!("{:.2}{mark}", error.rms))
}

fn gains(about: &[&str], rows: &[Vec<String>]) -> String {
    let ratios = RATIOS.map(|nu| format!("ν = {nu}"));
    let header: Vec<&str> = about.iter().copied().chain(ratios.iter().map(String::as_str)).collect();
    markdown(&header, rows)
}

fn error(element: &Element, shapes: &[Vec<f64>], nu: f64, spectral: bool) -> f64 {
    let springs = Springs::select(element, None).unwrap();
    let moduli = Material::for_body(element.dimension(), 1.0, nu, None, None).unwrap().moduli();
    let objective = if spectral { Objective::Spectral(MotionWeight::None) } else { Objective::Frobenius(Weight::None) };
    let cell = (0..element.nodes()).collect::<Vec<_>>();
    let of = |x: &Vec<f64>| {
        let fits = fit_cells(element, &springs, x, &cell, moduli, &Fit::new(objective), &mut |_| {}).unwrap();
        let errors = element_errors(element, x, &cell, moduli, &fits).unwrap();
        if spectral { errors.spectral[0] } else { errors.frobenius[0] }
    };
    let mut errors: Vec<f64> = shapes.iter().map(of).collect();
    errors.sort_by(f64::total_cmp);
    errors[shapes.len() / 2]
}
