//! What a repair has changed in a surface, in figures and words.

use crate::mesh::fill::place::{counted, length, place};

/// What a repair has changed in a surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Repair {
    /// The volume by the divergence theorem of the triangles as they were given, with its sign and with whatever holes, m³.
    pub given_volume: f64,
    /// The number of triangles that were given, without those that have a point twice.
    pub given: usize,
    /// The volume that the surface encloses now, m³.
    pub volume: f64,
    /// Corners of open edges that were put together with another, and the largest distance between two of them, m.
    pub welded: (usize, f64),
    /// Triangles with the corners of another, which were left out.
    pub doubles: usize,
    /// Triangles without an area, which were left out.
    pub flat: usize,
    /// Triangles of sheets that hang on the surface and enclose nothing, which were left out.
    pub sheets: usize,
    /// Triangles at which the surface turns over, so that they cannot be turned like all their neighbours, which were left out.
    pub twisted: usize,
    /// Triangles of the body that were turned round.
    pub turned: usize,
    /// Holes that were closed.
    pub holes: usize,
    /// The share of the surface that closes them.
    pub closed: f64,
    /// The largest of them: the number of its edges, its length and one of its points, m.
    pub largest_hole: Option<(usize, f64, [f64; 3])>,
    /// Pieces apart from the body, which were left out.
    pub fragments: Fragments,
    /// Pieces inside the body with their normals outwards, or open, which were left out.
    pub inner: Fragments,
    /// Pieces inside the body with their normals inwards, which were kept.
    pub cavities: usize,
    /// Pieces that pass through each other, of which the body consists.
    pub layers: usize,
}

/// Pieces of a surface that were left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Fragments {
    /// Their number.
    pub count: usize,
    /// The number of their triangles.
    pub triangles: usize,
    /// Their share of the area that was given.
    pub share: f64,
    /// One of their points, m.
    pub at: [f64; 3],
}

impl Fragments {
    fn words(&self, what: &str, scale: f64) -> Option<String> {
        let were = if self.count == 1 { "was" } else { "were" };
        (self.count > 0).then(|| {
            format!(
                "{} {what} {were} left out, {} and {:.2} % of the area, one at {}",
                counted(self.count, "piece"),
                counted(self.triangles, "triangle"),
                100.0 * self.share,
                place(self.at, scale)
            )
        })
    }
}

impl Repair {
    /// What was changed, in lines of words with places in the unit of the file, `scale` metres.
    pub(in crate::mesh::fill) fn lines(&self, scale: f64) -> Vec<String> {
        let were = |count: usize| if count == 1 { "was" } else { "were" };
        let mut lines = vec![format!(
            "the surface was repaired: it encloses {:.4e} m³; as it was given, {:.4e} m³",
            self.volume, self.given_volume
        )];
        let (welded, within) = self.welded;
        if welded > 0 {
            let corners = counted(welded, "corner");
            lines.push(format!(
                "{corners} of open edges {} put together with others within {}",
                were(welded),
                length(within, scale)
            ));
        }
        for (count, what) in [
            (self.doubles, "with the corners of another"),
            (self.flat, "without an area"),
            (self.sheets, "of sheets that hang on the surface and enclose nothing"),
            (self.twisted, "at which the surface turns over"),
        ] {
            if count > 0 {
                lines.push(format!("{} {what} {} left out", counted(count, "triangle"), were(count)));
            }
        }
        if self.turned > 0 {
            lines.push(format!("{} of {} triangles {} turned round", self.turned, self.given, were(self.turned)));
        }
        if let Some((edges, around, at)) = self.largest_hole {
            lines.push(format!(
                "{} {} closed by {:.2} % of the area, the largest of {} and {} around, at {}",
                counted(self.holes, "hole"),
                were(self.holes),
                100.0 * self.closed,
                counted(edges, "edge"),
                length(around, scale),
                place(at, scale)
            ));
        }
        lines.extend(self.fragments.words("apart from the body", scale));
        lines.extend(self.inner.words("inside the body and no cavity", scale));
        if self.cavities > 0 {
            let are = if self.cavities == 1 { "is a cavity" } else { "are cavities" };
            lines
                .push(format!("{} inside the body {are}, by the side of the normals", counted(self.cavities, "piece")));
        }
        if self.layers > 1 {
            lines.push(format!("the body has {} pieces that pass through each other", self.layers));
        }
        lines
    }
}
