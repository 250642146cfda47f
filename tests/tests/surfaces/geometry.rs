//! Where rays meet surfaces, and how points on them are sampled.
