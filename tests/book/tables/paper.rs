//! Table 1 of the paper.

use super::markdown;
use springfit::study::{Index, PaperRow, run_paper, write_experiments};

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
