"""What may be asked of a scene and written in scenes and studies."""
