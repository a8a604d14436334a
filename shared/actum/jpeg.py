"""What a JPEG costs to decode, beside its size."""

SCAN = b"\xff\xda"
"""The marker "start of scan", which the coded pixels never hold."""
MOST_SCANS = 64
"""Most scans of an image: progressive JPEGs have about ten. Each decodes all pixels anew, and may take 30 bytes."""


def has_too_many_scans(data: bytes) -> bool:
    """Tell whether decoding would take many times as long as an image of its size should."""
    return data.count(SCAN) > MOST_SCANS
