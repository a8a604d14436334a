"""The marker tracker: objects by the fiducial markers on them.

Each image flows through three steps, each a sub-package: `detection` of markers, `occlusion`, which adds covered ones,
and `pose` of the objects. `node` strings them together; `scene_file` and `settings` say what carries which marker. No
step imports a later one.
"""
