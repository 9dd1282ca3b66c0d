//! What a fill is beside its surface, in figures and words.

use super::place::{counted, length, place};
use super::repair::Repair;

/// A difference of volumes that must be known, percent.
// A ball of stepped cubes differs by 25 % with five across, 11 % with seven, 6 % with ten and 2 % with thirteen.
const FAR: f64 = 10.0;
/// The area of steps, relative to that of their surface, which matters to a traction.
// The steps of a plane with the normal n have `|n_x| + |n_y| + |n_z|` times its area: 1.05 where it is tilted by 3°
// against the lattice, and 1.5 in the mean over a sphere. Sides along the lattice alone stay below.
const STEPPED: f64 = 1.05;

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
    /// How many there are and one of them, in words; `scale` is the unit of the file, m.
    pub fn words(&self, scale: f64) -> String {
        let [one, other] = &self.faces;
        format!("{} pairs of faces cross, such as {one} and {other} at {}", self.pairs, place(self.at, scale))
    }
}

/// What a fill is beside its surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Filled {
    /// The volume that the surface encloses, by the divergence theorem, m³.
    pub surface_volume: f64,
    /// The volume of the cells, m³.
    pub volume: f64,
    /// The area of the surface, m².
    pub surface_area: f64,
    /// The area of the outer sides of cells with a stepped boundary, m².
    pub stepped_area: Option<f64>,
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
    /// Metres per unit of the file, in which words name places.
    pub scale: f64,
    /// What was mended in the surface before, if that was asked for.
    pub repair: Option<Repair>,
    /// The edge of a cube, m.
    pub edge: f64,
    /// The number of points.
    pub points: usize,
    /// About how many points were asked for, if the edge was chosen for them.
    pub asked: Option<usize>,
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

    /// By how many percent the volume of the cells exceeds that inside the surface; `None` if the surface has layers, whose
    /// common volume the divergence theorem counts more than once, or less.
    pub fn excess(&self) -> Option<f64> {
        let has_layers = self.overlaps.is_some() || self.inverted.is_some();
        (!has_layers).then(|| 100.0 * (self.volume / self.surface_volume - 1.0))
    }

    /// Edges that are as long as the body is half thick in the mean, and the two volumes in words, if that of the cells is twice that inside the surface
    /// or more, or half of it or less.
    pub(super) fn another_body(&self) -> Option<(f64, String)> {
        self.excess().filter(|excess| !(-50.0..=100.0).contains(excess))?;
        // A plate has the volume of its area times its thickness, and two sides: the quotient is half of the thickness.
        let most = self.surface_volume / self.surface_area;
        Some((most, format!("{:.3e} m³ of {:.3e} m³", self.volume, self.surface_volume)))
    }

    /// That the volume of the cells is far from that inside the surface.
    pub fn far_off(&self) -> Option<String> {
        let excess = self.excess().filter(|excess| excess.abs() > FAR)?;
        let more = if excess > 0.0 { "more" } else { "less" };
        // What is left out may be a part that smaller cells would not fill either.
        let why = match self.loose {
            0 => "smaller cells come nearer".into(),
            loose => {
                format!("{} that hung on others by an edge or a corner alone were left out", counted(loose, "cell"))
            }
        };
        Some(format!(
            "the cells that fill the surface have {:.0} % {more} volume than it encloses; {why}",
            excess.abs()
        ))
    }

    /// How the area of a stepped boundary differs from that of the surface, if it does; smaller cells do not change that.
    pub fn steps(&self) -> Option<String> {
        let area = self.stepped_area.filter(|area| *area > STEPPED * self.surface_area)?;
        let (of, more) = (self.surface_area, 100.0 * (area / self.surface_area - 1.0));
        Some(format!(
            "the steps have an area of {area:.4e} m² in place of the {of:.4e} m² of the surface, {more:+.0} %"
        ))
    }

    /// The fill beside its surface, and what is wrong with the surface, in lines of words.
    pub fn lines(&self) -> Vec<String> {
        let (cells, of) = (self.volume, self.surface_volume);
        let compared = match self.excess() {
            Some(more) => format!("{cells:.4e} m³ of {of:.4e} m³, {more:+.2} %"),
            None => format!("{cells:.4e} m³, which cannot be compared with its {of:.4e} m³, a sum over its layers"),
        };
        let mut lines = vec![format!(
            "{} a surface: {compared}",
            if self.cells == 1 { "1 cell fills".into() } else { format!("{} cells fill", self.cells) }
        )];
        if let Some(asked) = self.asked {
            let (edge, points) = (length(self.edge, self.scale), self.points);
            lines.push(format!("cubes have edges of {edge}, chosen for about {asked} points: there are {points}"));
        }
        lines.extend(self.repair.iter().flat_map(|repair| repair.lines(self.scale)));
        if let Some([least, largest]) = self.angles {
            lines.push(format!("dihedral angles are from {least:.1} to {largest:.1} degrees"));
        }
        if self.turned && self.repair.is_none() {
            lines.push("all normals of the surface were inwards and were turned".into());
        }
        if self.flat > 0 && self.repair.is_none() {
            let were = if self.flat == 1 { "was" } else { "were" };
            lines.push(format!("{} without an area {were} left out", counted(self.flat, "triangle")));
        }
        if let Some((count, at)) = self.branched {
            let (edges, have) = (counted(count, "edge"), if count == 1 { "has" } else { "have" });
            lines.push(format!(
                "{edges} of the surface {have} more than two triangles, one at {}",
                place(at, self.scale)
            ));
        }
        if let Some(crossings) = &self.crossings {
            let is_filled = self.overlaps.is_none() && self.inverted.is_none();
            let effect = if is_filled { ": no place of the lattice is inside several layers" } else { "" };
            lines.push(format!("{}{effect}", crossings.words(self.scale)));
        }
        if let Some((count, at)) = self.overlaps {
            let (places, are) = (counted(count, "place"), if count == 1 { "is" } else { "are" });
            let words = format!("{places} of the lattice {are} inside several layers of the surface");
            lines.push(format!("{words}, one at {}: each is filled once", place(at, self.scale)));
        }
        if let Some((count, at)) = self.inverted {
            let (places, are) = (counted(count, "place"), if count == 1 { "is" } else { "are" });
            let words = format!("{places} of the lattice {are} inside a part of the surface that is inside out");
            lines.push(format!("{words}, and {are} not filled, one at {}", place(at, self.scale)));
        }
        if self.loose > 0 {
            let were = if self.loose == 1 { "was" } else { "were" };
            let cells = counted(self.loose, "cell");
            lines.push(format!("{cells} that hung on others by an edge or a corner alone {were} left out"));
        }
        lines
    }
}
