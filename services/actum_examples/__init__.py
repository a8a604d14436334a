"""Examples of actions: marked segments of recordings, how they are recorded, cut, corrected and stored."""
