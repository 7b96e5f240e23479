//! One file per format (and a folder beside it where one file is not enough).

pub(crate) mod csv;
pub(crate) mod gltf;
pub(crate) mod obj;
