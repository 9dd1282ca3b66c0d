//! Texts of inputs stay texts: whatever a title, a name, a group or a path says, a reader of each file that is written finds one text, or
//! the input is refused when it is read; and messages are short and printable.

mod code;
mod hostile;
mod messages;
mod networks;
mod readers;
mod reading;
mod runs;
mod tables;
