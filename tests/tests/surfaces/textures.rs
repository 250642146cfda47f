//! Pictures and textures.
