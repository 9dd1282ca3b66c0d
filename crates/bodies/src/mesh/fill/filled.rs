//! What a fill is beside its surface, in figures and words.

/// Faces that pass through each other.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceCrossings {
    /// The number of pairs, or the least number if the surface has too many faces at one place to compare them all.
    pub pairs: usize,
    /// The faces of one pair in words, by their places in the file from 1.
    pub faces: [String; 2],
    /// Where these two cross, m.
    pub at: [f64; 3],
}

impl FaceCrossings {
    /// How many there are and one of them, in words.
    pub fn words(&self) -> String {
        let [one, other] = &self.faces;
        format!("{} pairs of faces cross, such as {one} and {other} at {}", self.pairs, at(self.at))
    }
}

/// What a fill is beside its surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Filled {
    /// The volume that the surface encloses, by the divergence theorem, m³.
    pub surface_volume: f64,
    /// The volume of the cells, m³.
    pub volume: f64,
    /// The least and the largest angle between sides of a cell with a smooth boundary, degrees.
    pub angles: Option<[f64; 2]>,
    /// The number of cells.
    pub cells: usize,
    /// Cells that hung on others by an edge or a corner alone, and were left out.
    pub loose: usize,
    /// Whether all normals were inwards and have been turned.
    pub turned: bool,
    /// Triangles without an area, which were left out.
    pub flat: usize,
    /// Places of the lattice, such as centres of cells, that are inside several layers of the surface, and one of them.
    pub overlaps: Option<(usize, [f64; 3])>,
    /// Places of the lattice around which the surface winds the other way round, and one of them: a part of it is inside out.
    pub inverted: Option<(usize, [f64; 3])>,
    /// Faces of the surface that pass through each other.
    pub crossings: Option<FaceCrossings>,
    /// Edges with more than two triangles, and the middle of one.
    pub branched: Option<(usize, [f64; 3])>,
}

impl Filled {
    /// Notes a place that is inside several layers, or inside a part that is inside out.
    pub(super) fn note(&mut self, winding: i32, at: impl Fn() -> [f64; 3]) {
        let place = match winding {
            0 | 1 => return,
            2.. => &mut self.overlaps,
            _ => &mut self.inverted,
        };
        match place {
            Some((count, _)) => *count += 1,
            None => *place = Some((1, at())),
        }
    }

    /// The fill beside its surface, and what is wrong with the surface, in lines of words.
    pub fn lines(&self) -> Vec<String> {
        let (cells, of) = (self.volume, self.surface_volume);
        let more = 100.0 * (cells / of - 1.0);
        let mut lines =
            vec![format!("{} cells fill a surface: {cells:.4e} m³ of {of:.4e} m³, {more:+.2} %", self.cells)];
        if let Some([least, largest]) = self.angles {
            lines.push(format!("dihedral angles are from {least:.1} to {largest:.1} degrees"));
        }
        if self.turned {
            lines.push("all normals of the surface were inwards and were turned".into());
        }
        if self.flat > 0 {
            lines.push(format!("{} triangles without an area were left out", self.flat));
        }
        if let Some((count, place)) = self.branched {
            lines.push(format!("{count} edges of the surface have more than two triangles, one at {}", at(place)));
        }
        if let Some(crossings) = &self.crossings {
            let is_filled = self.overlaps.is_none() && self.inverted.is_none();
            let effect = if is_filled { ": no place of the lattice is inside several layers" } else { "" };
            lines.push(format!("{}{effect}", crossings.words()));
        }
        if let Some((count, place)) = self.overlaps {
            let words = "places of the lattice are inside several layers of the surface";
            lines.push(format!("{count} {words}, one at {}: each is filled once", at(place)));
        }
        if let Some((count, place)) = self.inverted {
            let words = "places of the lattice are inside a part of the surface that is inside out, and are not filled";
            lines.push(format!("{count} {words}, one at {}", at(place)));
        }
        if self.loose > 0 {
            lines.push(format!("{} cells that hung on others by an edge or a corner alone were left out", self.loose));
        }
        lines
    }
}

/// A place in words.
pub(super) fn at([x, y, z]: [f64; 3]) -> String {
    format!("({x:.4e}, {y:.4e}, {z:.4e}) m")
}
