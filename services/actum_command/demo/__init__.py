"""The demo: simulated people act before live processes, and what is recognised is scored beside the paper."""
