//! One file per format (and a folder beside it where one file is not enough).

pub(crate) mod csv;
pub(crate) mod gltf;
pub(crate) mod gltf_create;
pub(crate) mod gltf_motion;
pub(crate) mod obj;
pub(crate) mod off;
pub(crate) mod ply;
pub(crate) mod stl;
