"""Pictures of particles: camera, colours, axes and the painter that puts them together."""
