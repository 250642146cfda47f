//! Which light is sampled, how, and how often.
