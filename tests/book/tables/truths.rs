//! Networks on bodies with dimensions that are drawn, against quadratic elements on halved cells.

use super::markdown;
use crate::shapes::Random;
use springfit_element::element::Element;
use springfit_mesh::mesh::{BoxMesh, Mesh};
use springfit_studies::study::{Outcome, Scene, run};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// Another number draws other bodies.
const SEED: u64 = 20_261_127;
const RATIOS: [f64; 4] = [0.3, 0.45, 0.49, 0.4999];
/// The interior points are moved by up to this share of a cell.
const MOVED: f64 = 0.15;
/// Errors that differ by less, relative to the larger, have no order.
const ALIKE: f64 = 0.1;
/// The test compares the error of the reference, as a run prints it, with the reference on cells that are halved once more. It does so for bodies of at most
/// this number of cells and at this Poisson's ratio, because others take minutes.
const FEW: usize = 50;
const PROVED: f64 = 0.49;

/// A body: a box of cells whose points are mapped, with supports and a load.
struct Drawn {
    name: &'static str,
    cells: [usize; 3],
    /// The place in the body of a place in the unit cube.
    map: Box<dyn Fn([f64; 3]) -> [f64; 3]>,
    /// `[[fix]]` and `[[load]]`.
    conditions: String,
}

/// Eight bodies of a few centimetres, each dimension within 20 % of a usual one. Loads strain them by some percent.
fn bodies(random: &mut Random) -> Vec<Drawn> {
    let mut near = |usual: f64| usual * (1.0 + 0.2 * random.next());
    let fixed = |condition: &str, axes: &str| {
        let axes = if axes.is_empty() { String::new() } else { format!("axes = [{axes}]\n") };
        format!("[[fix]]\nwhere = \"{condition}\"\n{axes}")
    };
    let load = |condition: &str, what: &str| format!("[[load]]\nname = \"load\"\nwhere = \"{condition}\"\n{what}\n");
    let mut all = Vec::new();

    let (inner, outer, height) = (near(0.02), near(0.035), near(0.01));
    let quarter = fixed("x < 1e-9", "\"x\"") + &fixed("y < 1e-9", "\"y\"") + &fixed("z < 1e-9", "\"z\"");
    all.push(Drawn {
        name: "pressed ring",
        cells: [7, 3, 1],
        map: Box::new(move |[s, t, z]| {
            let (angle, r) = (s * std::f64::consts::FRAC_PI_2, outer + (inner - outer) * t);
            [r * angle.cos(), r * angle.sin(), height * z]
        }),
        conditions: quarter
            + &load(
                &format!("x*x + y*y < {:?}", (1.001 * inner).powi(2)),
                &format!("traction = [\"{p:?}*x\", \"{p:?}*y\", 0]", p = 300.0 / inner),
            ),
    });

    let (inner, outer) = (near(0.02), near(0.028));
    let rim = 0.6f64.tan();
    all.push(Drawn {
        name: "pressed dome",
        cells: [5, 5, 2],
        map: Box::new(move |[s, t, u]| {
            let [a, b] = [s, t].map(|s| (1.2 * s - 0.6).tan());
            let r = (inner + (outer - inner) * u) / (1.0 + a * a + b * b).sqrt();
            [r * a, r * b, r]
        }),
        conditions: fixed(&format!("abs(x) > {rim:?}*z || abs(y) > {rim:?}*z", rim = 0.9999 * rim), "")
            + &load(
                &format!("x*x + y*y + z*z > {:?}", (0.9999 * outer).powi(2)),
                &format!("traction = [\"-{p:?}*x\", \"-{p:?}*y\", \"-{p:?}*z\"]", p = 400.0 / outer),
            ),
    });

    let (length, side) = (near(0.08), near(0.02));
    let stretched = |size: [f64; 3]| -> Box<dyn Fn([f64; 3]) -> [f64; 3]> {
        Box::new(move |at| std::array::from_fn(|k| size[k] * at[k]))
    };
    let end = |x: f64| format!("x > {:?}", 0.9999 * x);
    let (about, p) = (side / 2.0, 300.0 / side);
    all.push(Drawn {
        name: "twisted shaft",
        cells: [7, 3, 3],
        map: stretched([length, side, side]),
        conditions: fixed("x < 1e-9", "")
            + &load(&end(length), &format!("traction = [0, \"-{p:?}*(z - {about:?})\", \"{p:?}*(y - {about:?})\"]")),
    });

    let (radius, side) = (near(0.03), near(0.012));
    all.push(Drawn {
        name: "bracket",
        cells: [8, 2, 2],
        map: Box::new(move |[s, t, z]| {
            let (angle, r) = (s * std::f64::consts::FRAC_PI_2, radius - side * t);
            [r * angle.cos(), r * angle.sin(), side * z]
        }),
        conditions: fixed("y < 1e-9", "") + &load("x < 1e-9", "traction = [0, 40, 40]"),
    });

    let (length, thickness) = (near(0.05), near(0.005));
    all.push(Drawn {
        name: "thin plate",
        cells: [7, 6, 1],
        map: stretched([length, length, thickness]),
        conditions: fixed("x < 1e-9", "") + &load("x > -1", "body = [0, 0, -300]"),
    });

    let (length, width, depth) = (near(0.06), near(0.02), near(0.008));
    all.push(Drawn {
        name: "notched bar",
        cells: [8, 3, 2],
        map: Box::new(move |[s, t, z]| {
            let bottom = depth * (-((s - 0.5) / 0.12).powi(2)).exp();
            [length * s, bottom + (width - bottom) * t, 0.01 * z]
        }),
        conditions: fixed("x < 1e-9", "") + &load(&end(length), "traction = [500, 0, 0]"),
    });

    let (side, height) = (near(0.03), near(0.05));
    all.push(Drawn {
        name: "own weight",
        cells: [4, 4, 5],
        map: stretched([side, side, height]),
        conditions: fixed("z < 1e-9", "") + &load("x > -1", "body = [2000, 0, -8000]"),
    });

    let (side, height) = (near(0.03), near(0.025));
    let walls = format!("x < 1e-9 || {}", end(side));
    all.push(Drawn {
        name: "confined block",
        cells: [5, 4, 4],
        map: stretched([side, side, height]),
        conditions: fixed(&walls, "\"x\"")
            + &fixed(&walls.replace('x', "y"), "\"y\"")
            + &fixed("z < 1e-9", "")
            + &load(&format!("z > {:?} && x < {:?}", 0.9999 * height, 0.61 * side), "traction = [0, 0, -500]"),
    });
    all
}

/// The file of a body's mesh with irregular cells.
fn file(body: &Drawn, element: &str, random: &mut Random) -> String {
    let element = Arc::new(Element::load(element).unwrap());
    let mesh =
        BoxMesh { element, size: vec![1.0; 3], cells: body.cells.to_vec(), origin: vec![0.0; 3] }.build().unwrap();
    let mut text = format!(
        "# vtk DataFile Version 3.0\nbody\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n",
        mesh.point_count()
    );
    for at in mesh.points.chunks_exact(3) {
        let inside = at.iter().all(|x| *x > 1e-9 && *x < 1.0 - 1e-9);
        let at: [f64; 3] = std::array::from_fn(|k| {
            let moved = MOVED * random.next() / body.cells[k] as f64;
            if inside { at[k] + moved } else { at[k] }
        });
        let [x, y, z] = (body.map)(at).map(|x| if x.abs() < 1e-15 { 0.0 } else { x });
        writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
    }
    text + &cells(&mesh)
}

fn cells(mesh: &Mesh) -> String {
    let block = &mesh.blocks[0];
    let (count, nodes) = (block.cells().len(), block.element.nodes());
    let mut text = format!("CELLS {count} {}\n", count * (nodes + 1));
    for cell in block.cells() {
        writeln!(text, "{nodes} {}", cell.iter().map(usize::to_string).collect::<Vec<_>>().join(" ")).unwrap();
    }
    text + &format!("CELL_TYPES {count}\n") + &format!("{}\n", if nodes == 4 { 10 } else { 12 }).repeat(count)
}

const FITS: [(&str, &str); 2] = [
    (
        "tet4",
        "[[fit]]\nobjective = \"exact\"\n[[fit]]\nname = \"smoothed\"\nobjective = \"exact\"\nshear = \"edges\"\nvolume = \"patches\"\n[[fit]]\nobjective = \"offdiag\"\nnonnegative = true\n",
    ),
    (
        "hex8",
        "[[fit]]\nobjective = \"exact\"\n[[fit]]\nname = \"cells\"\nobjective = \"exact\"\nvolume = \"cells\"\n[[fit]]\nobjective = \"offdiag\"\nnonnegative = true\n",
    ),
];

fn solved(body: &Drawn, fits: &str, poisson: f64, reference: &str, folder: &Path) -> Outcome {
    let text = format!(
        "[mesh]\nfile = \"body.vtk\"\n[material]\nyoung = 1e4\npoisson = {poisson}\n{fits}{}{reference}",
        body.conditions
    );
    let scene = Scene::parse(&text, &folder.join("body.toml")).unwrap();
    run(&scene, &mut |_| {}).unwrap_or_else(|e| panic!("{}: {e}", body.name))
}

/// e_rms of each network, percent.
fn errors(outcome: &Outcome) -> Vec<f64> {
    outcome.fits.iter().map(|fit| fit.loads[0].error.map_or(f64::NAN, |error| error.rms)).collect()
}

/// A row for each body and element, with the errors of its three networks at each of Poisson's ratios; proves on the way that the errors that a run
/// prints where cells lock have the order of those under quadratic elements on halved cells; and that errors under the reference are no farther from those
/// under quadratic elements on cells halved twice than the run says that the reference is off.
pub fn table() -> String {
    let mut random = Random(SEED);
    let (mut rows, mut proved) = (Vec::new(), 0);
    for body in bodies(&mut random) {
        for (element, fits) in FITS {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("body.vtk"), file(&body, element, &mut random)).unwrap();
            let mut row = vec![body.name.to_string(), element.to_string()];
            for poisson in RATIOS {
                let truth = "[reference]\nfrom = \"quadratic\"\nrefine = 1\n";
                let known = errors(&solved(&body, fits, poisson, truth, folder.path()));
                if poisson >= 0.4 {
                    let printed = solved(&body, fits, poisson, "", folder.path());
                    check(&body, element, poisson, &printed, &known);
                    if element == "hex8" && poisson == PROVED && body.cells.iter().product::<usize>() <= FEW {
                        let finer = truth.replace("refine = 1", "refine = 2");
                        let finest = errors(&solved(&body, fits, poisson, &finer, folder.path()));
                        proved += usize::from(check_reference(&body, &printed, &finest));
                    }
                }
                row.push(known.iter().map(|error| format!("{error:.1}")).collect::<Vec<_>>().join(" / "));
            }
            rows.push(row);
        }
    }
    assert!(proved > 1, "the error of {proved} references was proved");
    let heads = RATIOS.map(|poisson| format!("ν = {poisson}"));
    let header: Vec<&str> = ["body", "element"].into_iter().chain(heads.iter().map(String::as_str)).collect();
    markdown(&header, &rows)
}

fn check(body: &Drawn, element: &str, poisson: f64, printed: &Outcome, known: &[f64]) {
    let place = format!("{} {element} {poisson}", body.name);
    let measured = printed.loads[0].measured.as_ref().unwrap_or_else(|| panic!("{place}: no reference"));
    assert!(measured.points > 0, "{place}");
    let found = errors(printed);
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let is_apart = (known[i] - known[j]).abs() > ALIKE * known[i].max(known[j]);
        assert!(
            !is_apart || (known[i] < known[j]) == (found[i] < found[j]),
            "{place}: {found:?} under the truth {known:?}"
        );
    }
}

/// `|e − e'| ≤ ‖u_ref − u_true‖/‖u_ref‖`, and the right side is at most what the run says of two levels, the finer of which is the reference.
/// Whether the run has two levels.
fn check_reference(body: &Drawn, printed: &Outcome, finest: &[f64]) -> bool {
    let measured = printed.loads[0].measured.as_ref().unwrap_or_else(|| panic!("{}: no reference", body.name));
    let Some(said) = measured.uncertainty_rms else { return false };
    for (found, truth) in errors(printed).iter().zip(finest) {
        assert!(
            (found - truth).abs() <= said,
            "{}: {found}, {truth} on finer cells; the reference is said to be off by {said}",
            body.name
        );
    }
    true
}
