//! CUDA C++: functions for the device, in double precision.

use super::c::{C, braced, end, signature};
use super::syntax::{Arguments, Syntax};
use crate::generate::code::{Array, Function};

/// CUDA.
#[derive(Debug)]
pub struct Cuda;

impl Syntax for Cuda {
    fn file(&self, prefix: &str) -> [Vec<String>; 2] {
        let guard = format!("{}_CUH", prefix.to_uppercase());
        let first = [
            format!("#ifndef {guard}"),
            format!("#define {guard}"),
            String::new(),
            "#include <math.h>".into(),
            String::new(),
        ];
        [first.into(), vec![format!("#endif // {guard}")]]
    }

    fn entry(&self, array: &Array, name: &str, at: &str) -> String {
        C.entry(array, name, at)
    }

    fn equal(&self, a: &str, b: &str) -> String {
        C.equal(a, b)
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        C.select(greater, than, yes, no)
    }

    fn define(&self, name: &str, value: &str) -> String {
        C.define(name, value)
    }

    fn store(&self, entry: &str, value: &str) -> String {
        C.store(entry, value)
    }

    fn memory(&self, name: &str, length: usize) -> String {
        C.memory(name, length)
    }

    fn table(&self, name: &str, length: usize, is_integer: bool, entries: &[String]) -> Vec<String> {
        let kind = if is_integer { "int" } else { "double" };
        braced(format!("static __device__ const {kind} {name}[{length}] = {{"), entries)
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        C.repeat(variable, from, to)
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        C.guard(greater, than, status)
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        vec![format!("static __device__ __forceinline__ {} {{", signature(function, lists))]
    }

    fn close(&self, function: &Function, _: &Arguments, value: Option<&str>) -> Vec<String> {
        end(function, value)
    }
}
