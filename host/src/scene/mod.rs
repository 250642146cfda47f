//! Scenes: what a file describes.
