"""Occlusion: markers that a hand covers in part or entirely, added to the detected ones of an image.

The second of three steps: `detection`, then occlusion, then `pose`. It imports `detection`, never `pose`.
"""
