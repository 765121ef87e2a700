"""Set-ups of capacitive sensors: scene files, study files, families of set-ups, triangle meshes. See SCENE.md."""
