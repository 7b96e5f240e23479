//! Triangle meshes as surfaces.
