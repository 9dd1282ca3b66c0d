//! README and book: links lead somewhere, commands print what the pages say, files are read, figures are measured again.

mod figures;
mod gallery;
mod keys;
mod links;
mod markdown;
mod printed;
mod readme;
mod reference;
mod snippets;
mod tables;
mod transcripts;
