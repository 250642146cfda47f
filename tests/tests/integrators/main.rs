//! Integrators against each other, against closed forms and tables.
