//! Truths about the levels of multigrid, their parts, and what they solve.

mod block;
mod columns;
mod definite;
mod elastic;
mod matrices;
mod solutions;
mod tentative;
mod tridiagonal;
