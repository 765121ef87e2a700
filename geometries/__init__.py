"""Set-ups of capacitive sensors: scenes, studies and families of set-ups, triangle meshes. See SCENE.md."""
