//! Code that is independent of a language: functions of straight-line code and loops, in which equal operations are
//! computed once.
//!
//! [`Value`] is a number of the kernels. The kernels that fit springs to cells thus write the code that computes the same.

mod body;
mod function;
mod index;
mod node;
mod room;
mod uses;
mod value;

pub use body::Body;
pub use function::{Array, Function, Result, Role, Statement, Status};
pub use index::{Atom, Index};
pub use node::Node;
pub use room::Room;
pub use uses::Uses;
pub use value::{Constant, Value};
