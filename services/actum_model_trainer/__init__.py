"""Models from labelled recordings, and their evaluation."""
