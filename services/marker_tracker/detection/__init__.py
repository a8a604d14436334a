"""Detection: from a colour image to the square markers in it, with corners to a fraction of a pixel.

The first of three steps: detection, then `occlusion`, then `pose`. It imports neither of the other two.
"""
