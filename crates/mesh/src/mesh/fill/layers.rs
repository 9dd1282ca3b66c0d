//! What happens if a surface has several layers around a place.

use super::filled::Filled;
use super::place::place;
use crate::error::{Error, Result};

/// What happens if a surface winds around a place more than once, or the other way round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FillLayers {
    /// It is an error.
    #[default]
    Refuse,
    /// What any layer encloses is filled once; a part that is inside out is left out.
    Union,
}

crate::named!(FillLayers { "refuse" => Refuse, "union" => Union });

impl FillLayers {
    /// # Errors
    /// A place of the lattice is inside several layers or inside a part that is inside out, and that is refused.
    pub(super) fn check(self, filled: &Filled) -> Result<()> {
        let places = |(count, at): (usize, [f64; 3])| {
            format!("{count} places of the lattice, one at {},", place(at, filled.scale))
        };
        let (expected, found, way_out) = match (self, &filled.crossings, filled.overlaps, filled.inverted) {
            (FillLayers::Union, ..) | (_, _, None, None) => return Ok(()),
            (FillLayers::Refuse, Some(crossings), Some(faulty), _) => (
                "a surface that does not cross itself",
                format!("{}; {} are inside several layers", crossings.words(filled.scale), places(faulty)),
                "a modelling program unites the layers, or layers = \"union\" (--fill-layers union) fills what any of them encloses",
            ),
            (FillLayers::Refuse, Some(crossings), None, Some(faulty)) => (
                "a surface that does not cross itself",
                format!("{}; {} are inside a part that is inside out", crossings.words(filled.scale), places(faulty)),
                "a modelling program mends it, or layers = \"union\" (--fill-layers union) leaves such parts out",
            ),
            (FillLayers::Refuse, None, Some(faulty), _) => (
                "one layer around each place",
                format!("{} inside a part that is inside another, or is there twice", places(faulty)),
                "normals inwards make the inner part a cavity, and layers = \"union\" (--fill-layers union) fills it once",
            ),
            (FillLayers::Refuse, None, None, Some(faulty)) => (
                "normals that all point outwards",
                format!("{} inside a part that is inside out", places(faulty)),
                "a modelling program turns it, or layers = \"union\" (--fill-layers union) leaves it out",
            ),
        };
        Err(Error::expected("surface", expected, found).followed_by(format!("; {way_out}")))
    }
}
