//! Files of surfaces: STL, OBJ, PLY and OFF.

mod faces;
mod obj;
mod off;
mod ply;
mod stl;

pub use obj::parse as parse_obj;
pub use off::parse as parse_off;
pub use ply::parse as parse_ply;
pub use stl::parse as parse_stl;
