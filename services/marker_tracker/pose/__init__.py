"""Pose: from the markers of an image to the poses of the objects that carry them, filtered over time.

The last of three steps: `detection`, then `occlusion`, then pose. It imports the two before it, which do not import it.
"""
