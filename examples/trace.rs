use springfit::element::Element;
use springfit::fit::*;
use springfit::material::Material;
use springfit::springs::Springs;
use springfit::study::random_shapes;
use std::time::Instant;
fn main() {
    for name in ["quad9", "tet10", "hex20", "hex27"] {
        let element = Element::load(name).unwrap();
        let count = 32;
        let x = random_shapes(&element, count, 2026).unwrap();
        let every: Vec<String> = element.springs.iter().map(|g| g.name.clone()).collect();
        let springs = Springs::select(&element, Some(&every[..])).unwrap();
        let moduli = Material::for_body(element.dimension(), 1e4, 0.3, None, None).unwrap().moduli();
        let n = element.nodes();
        let cells: Vec<usize> = (0..count * n).collect();
        for objective in [Objective::Frobenius(Weight::None), Objective::Frobenius(Weight::Modal { higher: 0.316 }), Objective::Spectral(Weight::None), Objective::Spectral(Weight::Modal { higher: 0.316 })] {
        for nonnegative in [false, true] {
            let fit = Fit { nonnegative, ..Fit::new(objective) };
            let start = Instant::now();
            let f = fit_cells(&element, &springs, &x, &cells, moduli, &fit, &mut |_| {}).unwrap();
            let time = start.elapsed().as_secs_f64() / (count as f64);
            let gap = f.certificates.iter().map(|c| c.gap()).fold(0.0, f64::max);
            println!("{name} {} {} {nonnegative}: us {:.2} unreached {} gap {gap:.1e}", springs.len(), objective.title(), 1e6 * time, f.unreached);
        }
        }
    }
}
