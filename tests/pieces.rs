//! Images and grids of VTK in pieces, put together by their places.

use crate::voxels::{cells, error, label};
use springfit_mesh::mesh::MeshSource;

/// An image of labels as the pieces of parallel programs: cells from `bounds[k][i]` to `bounds[k][i + 1]` along each axis. Labels belong to
/// cells, or to points, of which neighbouring pieces share some.
fn image(bounds: &[Vec<usize>; 3], of_points: bool) -> String {
    let mut text = String::from(
        "<VTKFile type=\"ImageData\"><ImageData Origin=\"1 2 3\" Spacing=\"0.5 1 2\" WholeExtent=\"0 1 0 1 0 1\">",
    );
    let parts = |k: usize| bounds[k].windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>();
    for z in parts(2) {
        for y in parts(1) {
            for x in parts(0) {
                let ends = [x, y, z];
                let extent = ends.as_flattened().iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
                let section = if of_points { "PointData" } else { "CellData" };
                let last = |k: usize| ends[k][1] + usize::from(of_points);
                let mut labels = Vec::new();
                for k in ends[2][0]..last(2) {
                    for j in ends[1][0]..last(1) {
                        labels.extend((ends[0][0]..last(0)).map(|i| label([i, j, k]).to_string()));
                    }
                }
                text += &format!(
                    "<Piece Extent=\"{extent}\"><{section}><DataArray type=\"Int32\" Name=\"label\" format=\"ascii\">{}\
                     </DataArray></{section}></Piece>",
                    labels.join(" ")
                );
            }
        }
    }
    text + "</ImageData></VTKFile>"
}

#[test]
fn an_image_in_pieces_is_the_image() {
    for of_points in [false, true] {
        let read =
            |bounds: [Vec<usize>; 3]| cells(&MeshSource::parse(image(&bounds, of_points).as_bytes(), "vti").unwrap());
        let whole = read([vec![0, 5], vec![0, 4], vec![0, 3]]);
        assert!(whole.len() > 30);
        assert_eq!(read([vec![0, 2, 5], vec![0, 1, 4], vec![0, 3]]), whole);
        assert_eq!(read([vec![0, 1, 2, 3, 4, 5], vec![0, 4], vec![0, 1, 2, 3]]), whole);
    }
    let halves = image(&[vec![0, 2, 5], vec![0, 4], vec![0, 3]], false);
    let place = halves.rfind("Name=\"label\"").unwrap();
    let other = format!("{}{}", &halves[..place], halves[place..].replacen("label", "tissue", 1));
    let expected = "CellData: expected the arrays label of the first piece in each, found tissue";
    assert!(error(other.as_bytes(), "vti").contains(expected), "{}", error(other.as_bytes(), "vti"));
}

/// A grid of 5 × 4 × 3 cells in pieces: sheared and bent if it is structured, with steps of several lengths if it is rectilinear.
fn grid(is_structured: bool, bounds: &[Vec<usize>; 3]) -> String {
    let place = |at: [usize; 3]| -> [f64; 3] {
        let [x, y, z] = at.map(|i| i as f64 + 0.1 * (i * i) as f64);
        if is_structured { [x + 0.5 * y, y + 0.1 * x * z, z] } else { [x, y, z] }
    };
    let kind = if is_structured { "StructuredGrid" } else { "RectilinearGrid" };
    let parts = |k: usize| bounds[k].windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>();
    let array = |kind: &str, name: &str, components: usize, values: Vec<String>| {
        let values = values.join(" ");
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{values}</DataArray>"
        )
    };
    let mut text = format!("<VTKFile type=\"{kind}\"><{kind} WholeExtent=\"0 5 0 4 0 3\">");
    for z in parts(2) {
        for y in parts(1) {
            for x in parts(0) {
                let ends = [x, y, z];
                let all = |more: usize| {
                    let range = |k: usize| ends[k][0]..ends[k][1] + more;
                    range(2)
                        .flat_map(move |k| range(1).flat_map(move |j| range(0).map(move |i| [i, j, k])))
                        .collect::<Vec<_>>()
                };
                let extent = ends.as_flattened().iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
                let labels = all(0).into_iter().map(|at| label(at).to_string()).collect();
                let moved = all(1).into_iter().flat_map(|at| place(at).map(|x| (2.0 * x).to_string())).collect();
                text += &format!(
                    "<Piece Extent=\"{extent}\"><PointData>{}</PointData><CellData>{}</CellData>",
                    array("Float64", "moved", 3, moved),
                    array("Int32", "label", 1, labels)
                );
                text += &if is_structured {
                    let points = all(1).into_iter().flat_map(|at| place(at).map(|x| x.to_string())).collect();
                    format!("<Points>{}</Points>", array("Float64", "Points", 3, points))
                } else {
                    let axis = |k: usize| (ends[k][0]..=ends[k][1]).map(|i| place([i; 3])[k].to_string()).collect();
                    let axes = [0, 1, 2].map(|k| array("Float64", "x", 1, axis(k)));
                    format!("<Coordinates>{}</Coordinates>", axes.concat())
                };
                text += "</Piece>";
            }
        }
    }
    text + &format!("</{kind}></VTKFile>")
}

#[test]
fn a_grid_in_pieces_is_the_grid() {
    for is_structured in [true, false] {
        let ending = if is_structured { "vts" } else { "vtr" };
        let read =
            |bounds: &[Vec<usize>; 3]| MeshSource::parse(grid(is_structured, bounds).as_bytes(), ending).unwrap();
        let whole = read(&[vec![0, 5], vec![0, 4], vec![0, 3]]);
        assert_eq!((cells(&whole).len(), whole.points.len()), (60, 6 * 5 * 4));
        assert!(whole.blocks.len() > 1 && whole.blocks.iter().all(|block| block.groups.len() == 1));
        for bounds in
            [[vec![0, 2, 5], vec![0, 1, 4], vec![0, 3]], [vec![0, 1, 2, 3, 4, 5], vec![0, 4], vec![0, 1, 2, 3]]]
        {
            assert_eq!(read(&bounds), whole);
        }
    }
    let halves = grid(true, &[vec![0, 2, 5], vec![0, 4], vec![0, 3]]);
    let place = halves.rfind("Name=\"Points\"").unwrap();
    let apart = format!("{}{}", &halves[..place], halves[place..].replacen('>', ">9", 1));
    let found = error(apart.as_bytes(), "vts");
    assert!(found.contains("Points: expected pieces that share their points, such as that at ["), "{found}");
    let other = halves.replacen("Name=\"moved\"", "Name=\"u\"", 1);
    let expected = "PointData: expected the arrays u of 3 numbers of the first piece in each, found moved of 3 numbers";
    assert!(error(other.as_bytes(), "vts").contains(expected), "{}", error(other.as_bytes(), "vts"));
    // As many cells as places, of which some are there twice.
    let piece = |extent: &str, counts: [usize; 3]| {
        let axis = |n: usize| {
            format!(
                "<DataArray type=\"Int32\" format=\"ascii\">{}</DataArray>",
                (0..n).map(|i| format!("{i} ")).collect::<String>()
            )
        };
        format!("<Piece Extent=\"{extent}\"><Coordinates>{}</Coordinates></Piece>", counts.map(axis).concat())
    };
    let pieces =
        piece("0 2 0 1 0 1", [3, 2, 2]).repeat(2) + &piece("5 6 0 1 0 1", [2, 2, 2]) + &piece("5 6 0 1 0 1", [2, 2, 2]);
    let text = format!("<VTKFile type=\"RectilinearGrid\"><RectilinearGrid>{pieces}</RectilinearGrid></VTKFile>");
    let found = error(text.as_bytes(), "vtr");
    assert!(found.contains("Piece.Extent: expected pieces that fill the grid, found none at point 3"), "{found}");
}
