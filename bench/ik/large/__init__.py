"""Ten thousand shapes, meshes of a million triangles, a hundred thousand points."""
