//! Truths about the levels and what they solve.

mod columns;
mod definite;
mod elastic;
mod matrices;
mod solutions;
