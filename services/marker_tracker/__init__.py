"""The marker tracker: estimates the poses of objects from the fiducial markers on them.

Each image passes three steps, each a sub-package: `detection` finds markers, `occlusion` adds covered ones, and `pose`
estimates the objects' poses. `node` calls them in turn; `scene_file` and `settings` state which object carries which
marker. No step imports a later one.
"""
