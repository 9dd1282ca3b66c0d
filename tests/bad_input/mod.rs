//! Every fault of an input ends with exit code 2 and one line that names it; nothing is printed or written besides.
//!
//! A case gives the place that the line has to name (`scene.toml:5: material.poisson`) and, where the value that was found
//! matters, a few words of the problem. The wording is otherwise free; `whole_messages` has examples of it.

mod elements;
mod expressions;
mod fits;
mod inputs;
mod lines;
mod meshes;
mod message;
mod options;
mod outputs;
mod refusals;
mod sampled_fits;
mod scenes;
mod selections;
mod whole_messages;
mod whole_object_fits;
