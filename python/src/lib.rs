//! The module `springfit._core`: what Python calls. Everything that needs no other program's types is in the Python files beside it.

mod adjoint;
mod arguments;
mod arrays;
mod body;
mod calibration;
mod called;
mod command;
mod distributed;
mod element;
mod ends;
mod entry;
mod equilibrium;
mod error;
mod factorized;
mod filled;
mod fit;
mod functions;
mod given_springs;
mod gradient;
mod laws;
mod matrix;
mod measure;
mod mesh;
mod motion;
mod network;
mod pickled;
mod progress;
mod sampled;
mod shapes;
mod sparse;
mod springs;
mod stated;
mod studies;
mod study;
mod sweep;
mod value;

use pyo3::prelude::*;

#[pymodule]
fn _core(module: &Bound<PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SpringfitError", error::class(module.py())?)?;
    let [missing, of_files] = error::classes_of_files(module.py())?;
    module.add("MissingFileError", missing)?;
    module.add("FileError", of_files)?;
    module.add_class::<element::Element>()?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<network::Network>()?;
    module.add_class::<study::Ran>()?;
    module.add_class::<factorized::Factorized>()?;
    module.add_class::<sweep::Sweep>()?;
    module.add_class::<sweep::Studies>()?;
    module.add_class::<distributed::DistributedBody>()?;
    module.add_class::<distributed::BodyShare>()?;
    module.add_class::<distributed::NetworkShare>()?;
    module.add_class::<gradient::CellConstants>()?;
    module.add_class::<adjoint::SpringBody>()?;
    module.add_class::<adjoint::Tangent>()?;
    module.add_function(wrap_pyfunction!(adjoint::spring_numbers, module)?)?;
    module.add_function(wrap_pyfunction!(element::shipped_elements, module)?)?;
    module.add_function(wrap_pyfunction!(element::parsed_element, module)?)?;
    module.add_function(wrap_pyfunction!(mesh::restored_mesh, module)?)?;
    module.add_function(wrap_pyfunction!(filled::filled_mesh, module)?)?;
    module.add_function(wrap_pyfunction!(filled::voxel_mesh, module)?)?;
    module.add_function(wrap_pyfunction!(stated::checked_material, module)?)?;
    module.add_function(wrap_pyfunction!(command::command_line, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit, module)?)?;
    module.add_function(wrap_pyfunction!(fit::learning_curve, module)?)?;
    module.add_function(wrap_pyfunction!(fit::finite_elements, module)?)?;
    module.add_function(wrap_pyfunction!(fit::masses, module)?)?;
    module.add_function(wrap_pyfunction!(measure::measure_arrays, module)?)?;
    module.add_function(wrap_pyfunction!(measure::measure_file, module)?)?;
    module.add_function(wrap_pyfunction!(matrix::read_matrix, module)?)?;
    module.add_function(wrap_pyfunction!(matrix::fit_stiffness, module)?)?;
    module.add_function(wrap_pyfunction!(study::run, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::study_line, module)?)?;
    module.add_function(wrap_pyfunction!(calibration::calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(studies::compare_scene, module)?)?;
    module.add_function(wrap_pyfunction!(studies::compare_cases, module)?)?;
    module.add_function(wrap_pyfunction!(studies::is_comparison, module)?)?;
    module.add_function(wrap_pyfunction!(studies::compare_element, module)?)?;
    module.add_function(wrap_pyfunction!(studies::converge, module)?)?;
    module.add_function(wrap_pyfunction!(studies::stability, module)?)?;
    module.add_function(wrap_pyfunction!(studies::stability_of_scene, module)?)?;
    Ok(())
}
