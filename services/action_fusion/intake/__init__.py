"""What the streams bring: samples, how long they are kept, and whether any of a segment are lost."""
