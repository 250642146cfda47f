//! The `woodcock` command.
fn main() {}
