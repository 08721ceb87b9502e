"""`gneiss convert`: particles and meshes of other programs to files that gneiss reads, and back."""
