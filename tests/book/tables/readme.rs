//! How good it is, in five rows. Times are not compared.

use super::{all_groups, fit, markdown, outcome, scene, signed};
use springfit::study::{FitEntry, converge, converge_to};

/// Nanoseconds to fit one tetrahedron on one core: `cargo bench --bench fit -- tet4`.
const TIMES: [&str; 2] = ["23 ns", "26 ns (`offdiag`), 43 µs (`spectral`)"];

/// e_rms under the two loads of a scene.
fn errors(name: &str, entry: FitEntry) -> String {
    let outcome = outcome(&scene(name).with_fits(vec![fit(entry)]));
    let errors: Vec<String> = outcome.fits[0].loads.iter().map(|load| signed(load.error.unwrap().rms, 2)).collect();
    format!("{} %", errors.join(" / "))
}

/// Errors of the compliance against the truth on the first and the last level, of the finite elements and of two fits.
fn block() -> [String; 3] {
    let convergence = converge(&scene("converge/block_tet"), Some(3), &mut |_| {}).unwrap();
    let load = &convergence.loads[0];
    [0, 1, 2].map(|model| {
        let errors = load.of_truth(&load.models[model]);
        format!("{} → {} %", signed(errors[0].unwrap(), 1), signed(errors[2].unwrap(), 1))
    })
}

/// Of a cantilever of ν = 0.45: of the finite elements, of patches, with shear springs on edges, of `offdiag` and of `divergence`.
fn cantilever() -> [String; 5] {
    let of_ratio = |name: &str| scene(name).of_material(1.0, Some(0.45));
    let (body, truth) = (of_ratio("converge/cantilever_tet"), of_ratio("converge/cantilever_truth"));
    let convergence = converge_to(&body, &truth, Some(3), &mut |_| {}).unwrap();
    let load = &convergence.loads[0];
    [0, 2, 3, 4, 5].map(|model| format!("{} %", signed(load.of_truth(&load.models[model])[2].unwrap(), 1)))
}

pub fn table() -> String {
    let bounded = |entry: FitEntry| entry.with("nonnegative", Some(true));
    let modal = bounded(FitEntry::new("modal").with_springs(all_groups(&scene("cube_hex"))));
    let [block_elements, block_exact, block_classical] = block();
    let [elements, patches, edges, offdiag, divergence] = cantilever();
    let rows: [[String; 4]; 5] = [
        [
            "cube of 412 tetrahedra: displacements, tension / shear".into(),
            "reference".into(),
            errors("cube_tet", FitEntry::new("exact")),
            errors("cube_tet", bounded(FitEntry::new("offdiag"))) + " (`offdiag`, k ≥ 0)",
        ],
        [
            "cube of 512 hexahedra: the same".into(),
            "reference".into(),
            errors("cube_hex", FitEntry::new("exact")),
            errors("cube_hex", modal) + " (`modal` with volume springs)",
        ],
        [
            "structured box of tetrahedra: compliance, cells halved twice".into(),
            block_elements,
            block_exact,
            block_classical + " (`offdiag`, k ≥ 0)",
        ],
        [
            "cantilever of tetrahedra, ν = 0.45: compliance".into(),
            elements,
            format!("{edges} (`shear = \"edges\"`), {patches} (with patches alone)"),
            format!("{offdiag} (`offdiag`, k ≥ 0), {divergence} (`divergence` with volume springs)"),
        ],
        ["time to fit one tetrahedron, one core".into(), "–".into(), TIMES[0].into(), TIMES[1].into()],
    ];
    markdown(&["error of", "finite elements", "exact network", "classical network"], &rows.map(Vec::from))
}
