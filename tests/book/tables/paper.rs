//! Table 1 of the paper, and the sizes of its meshes.

use super::markdown;
use crate::book::markdown::root;
use springfit_studies::study::{Index, PaperRow, Scene, run_paper, write_experiments};

const FITS: [&str; 2] = ["spectral", "frobenius"];

pub fn first() -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = write_experiments(folder.path()).unwrap();
    let paper = run_paper(&Index::shipped().unwrap(), &["1".into()], &path, &mut |_| {}).unwrap();
    let table = &paper.tables[0];
    let pair = |figures: [f64; 2]| format!("{:.2} / {:.2}", figures[0], figures[1]);
    let row = |object: &str| {
        let own: Vec<&PaperRow> = table.rows.iter().filter(|row| row.object == object).collect();
        let found = |row: &PaperRow| pair([0, 1].map(|i| row.found[i].unwrap()));
        let of = |fit: &str| own.iter().find(|row| row.fit == fit).unwrap();
        let printed = FITS.map(|fit| of(fit).printed.as_ref().map_or("–".into(), |p| pair([p[0], p[1]])));
        let ours = FITS.map(|fit| found(of(fit)));
        // Neither exact networks nor fits to the whole object are fits of single elements.
        let single =
            |row: &&&PaperRow| row.stands && !row.published && row.fit != "exact" && !row.fit.starts_with("whole");
        let best =
            own.iter().filter(single).min_by(|a, b| a.found[0].unwrap().total_cmp(&b.found[0].unwrap())).unwrap();
        let whole = own.iter().find(|row| row.fit.starts_with("whole +")).unwrap();
        let mut cells = vec![object.to_string()];
        cells.extend(printed.into_iter().chain(ours));
        cells.extend([format!("{} (`{}`)", found(best), best.fit), found(whole)]);
        cells
    };
    let rows: Vec<Vec<String>> = table.objects().into_iter().map(row).collect();
    let header = [
        "object",
        "printed: 2-norm",
        "printed: Frobenius",
        "ours: certified 2-norm",
        "ours: Frobenius",
        "best fit of single elements",
        "`whole` with volume springs",
    ];
    markdown(&header, &rows)
}

/// The objects of table 1 with their scenes, and the nodes and elements that it prints.
const MESHES: [(&str, &str, [usize; 2]); 7] = [
    ("tissue, triangles", "tissue_tri", [210, 366]),
    ("tissue, quadrilaterals", "tissue_quad", [445, 405]),
    ("cylinder, tetrahedra", "cylinder_tet", [124, 381]),
    ("cylinder, hexahedra", "cylinder_hex", [675, 496]),
    ("cylinder with a hole, tetrahedra", "cylinder_hole_tet", [404, 1559]),
    ("cube, tetrahedra", "cube_tet", [170, 592]),
    ("cube, hexahedra", "cube_hex", [729, 512]),
];

/// The sizes of the meshes of the paper beside ours.
pub fn meshes() -> String {
    let row = |(object, name, printed): &(&str, &str, [usize; 2])| {
        let path = root().join(format!("scenes/paper/{name}.toml"));
        let mesh = Scene::load(&path).unwrap().build_mesh().unwrap();
        let ours = [mesh.point_count(), mesh.cell_count()];
        let mut cells = vec![object.to_string()];
        cells.extend([0, 1].map(|i| format!("{} / {}", printed[i], ours[i])));
        cells
    };
    markdown(
        &["object", "nodes: printed / ours", "elements: printed / ours"],
        &MESHES.iter().map(row).collect::<Vec<_>>(),
    )
}
