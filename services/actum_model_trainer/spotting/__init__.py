"""Trains the search for actions without marks, on whole streams.

Everything between labelled segments is background. The heads of the search are ridge regressions on up to 5,000 windows
of actions and background. False alarms on people left out become further background examples.

The threshold of the search is chosen on people left out of training. It maximises the sum of event F1 and F1 at an
overlap of 0.5, minus 0.1 for each false alarm per minute beyond 0.5. The model stores a table of rates and thresholds
for `--false-alarms-per-min`. With each threshold it stores the precision: the share of the segments found in which any
action was done, as if 12 further segments had been found with a precision of 0.9. With fewer than three people, thirds
of each stream are left out instead.
"""
