//! The exact network of linear tetrahedra by a plain loop: from a binary file of Gmsh to a table of springs, without checks.

use springfit_foundation::text::{push_exponential, push_list, push_whole};
use std::io::{BufWriter, Write};
use std::path::Path;

fn long(bytes: &[u8]) -> u64 {
    u64::from_le_bytes(bytes[..8].try_into().expect("eight bytes"))
}

/// What follows the line with this mark.
fn after<'a>(bytes: &'a [u8], mark: &[u8]) -> &'a [u8] {
    let at = bytes.windows(mark.len()).position(|window| window == mark).expect("the file has the section");
    &bytes[at + mark.len()..]
}

/// Coordinates, and the nodes of each cell, from 0. The nodes have the tags 1, 2, …
fn read(path: &Path) -> (Vec<[f64; 3]>, Vec<[u32; 4]>) {
    let bytes = std::fs::read(path).expect("it was written");
    let nodes = after(&bytes, b"$Nodes\n");
    let count = long(&nodes[8..]) as usize;
    // Four counts, three numbers of the block and its count, the tags.
    let places = &nodes[52 + 8 * count..];
    let points = places[..24 * count].as_chunks::<24>().0.iter();
    let points = points.map(|x| std::array::from_fn(|k| f64::from_bits(long(&x[8 * k..])))).collect();
    let elements = after(&places[24 * count..], b"$Elements\n");
    let cells = elements[52..52 + 40 * long(&elements[8..]) as usize].as_chunks::<40>().0.iter();
    (points, cells.map(|cell| std::array::from_fn(|a| long(&cell[8 + 8 * a..]) as u32 - 1)).collect())
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `k_ab = −μ V ∇N_a·∇N_b` between nodes, added over the cells, and `k = (λ + μ)/V` with the rest content `V (1 + μ/(λ + μ))` of each cell.
pub fn exact_network(mesh: &Path, to: &Path, young: f64, poisson: f64) {
    let (points, cells) = read(mesh);
    let mu = young / (2.0 * (1.0 + poisson));
    let both = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) + mu;
    // Springs to higher nodes, side by side for each lower one.
    let pairs = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    let mut starts = vec![0_u32; points.len() + 1];
    for cell in &cells {
        pairs.iter().for_each(|[a, b]| starts[cell[*a].min(cell[*b]) as usize + 1] += 1);
    }
    (1..starts.len()).for_each(|p| starts[p] += starts[p - 1]);
    let mut next = starts.clone();
    let mut shares = vec![(0_u32, 0.0); 6 * cells.len()];
    let mut contents = Vec::with_capacity(cells.len());
    for cell in &cells {
        let x = cell.map(|p| points[p as usize]);
        let edge = |a: usize| -> [f64; 3] { std::array::from_fn(|k| x[a][k] - x[0][k]) };
        let (a, b, c) = (edge(1), edge(2), edge(3));
        // 6 V ∇N of the nodes.
        let mut g = [[0.0; 3], cross(b, c), cross(c, a), cross(a, b)];
        g[0] = std::array::from_fn(|k| -(g[1][k] + g[2][k] + g[3][k]));
        let six = dot(&a, &g[1]);
        contents.push(six / 6.0);
        for [i, j] in pairs {
            let (low, high) = (cell[i].min(cell[j]), cell[i].max(cell[j]));
            shares[next[low as usize] as usize] = (high, -mu / (6.0 * six) * dot(&g[i], &g[j]));
            next[low as usize] += 1;
        }
    }
    let mut file = BufWriter::new(std::fs::File::create(to).expect("the folder can be written"));
    let mut text = b"kind,points,constant,rest,unit,nodes\n".to_vec();
    for low in 0..points.len() {
        let own = &mut shares[starts[low] as usize..starts[low + 1] as usize];
        own.sort_unstable_by_key(|(high, _)| *high);
        for spring in own.chunk_by(|a, b| a.0 == b.0) {
            let high = spring[0].0;
            text.extend(b"length,");
            push_list(&mut text, &[low as u64, u64::from(high)]);
            text.push(b',');
            push_exponential(&mut text, spring.iter().map(|(_, k)| k).sum());
            text.extend(b",0e0,N/m,");
            push_list(&mut text, &[low as u64 + 1, u64::from(high) + 1]);
            text.push(b'\n');
        }
        file.write_all(&text).expect("there is room");
        text.clear();
    }
    for (cell, content) in cells.iter().zip(contents) {
        text.extend(b"volume,");
        push_list(&mut text, &cell.map(u64::from));
        text.push(b',');
        push_exponential(&mut text, both / content);
        text.push(b',');
        push_exponential(&mut text, content * (1.0 + mu / both));
        text.extend(b",N/m^5,");
        for (a, node) in cell.iter().enumerate() {
            push_whole(&mut text, u64::from(*node) + 1);
            text.push(if a < 3 { b' ' } else { b'\n' });
        }
        file.write_all(&text).expect("there is room");
        text.clear();
    }
    file.flush().expect("there is room");
}

/// That two tables have the same springs, up to rounding.
pub fn compare(one: &str, other: &str) {
    let (lines, own) = (one.lines().count(), other.lines().count());
    assert!(lines == own, "{lines} and {own} lines");
    for (line, own) in one.lines().zip(other.lines()).skip(1) {
        let fields = |line: &str| line.split(',').map(str::to_string).collect::<Vec<_>>();
        let (a, b) = (fields(line), fields(own));
        let number = |text: &String| text.parse::<f64>().expect("it is a number");
        let near = |column: usize| (number(&a[column]) - number(&b[column])).abs() <= 1e-7 * number(&a[column]).abs();
        assert!(a[1] == b[1] && a[5] == b[5] && near(2) && near(3), "{line}\n{own}");
    }
}
