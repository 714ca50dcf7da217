"""Meshes of a robot's file, read and simplified until MuJoCo can compile them.

- `mesh_files` finds and reads those that a document names, in the formats of `stl`, `obj`,
  `collada` and `gltf`; `decimation` simplifies them.
"""
