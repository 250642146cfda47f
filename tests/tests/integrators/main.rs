//! Integrators against each other, against closed forms and tables.

mod closed_forms;
mod surfaces;
mod tables;
