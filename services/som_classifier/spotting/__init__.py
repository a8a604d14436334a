"""Finds actions in a person's stream of postures without marks.

The search uses only past postures and their stamps, so live and replayed streams give the same answers. By default:

1. Windows. Ten times a second, the search scores eight windows that end with the newest frame. Their durations are
   quantiles (4 % to 96 %) of the durations of the labelled actions.
2. Completeness. One linear head per action estimates how complete that action is in the window: 1 from an overlap
   (intersection over union) of 0.85 on, 0 up to an overlap of 0.25, linear in between.
3. Gain. A window gains (completeness + weight * log-likelihood of its duration - threshold) * duration, with log-normal
   durations. Negative gains are dropped.
4. Decoding. The search takes the set of disjoint windows with the largest total gain (segmental Viterbi on a
   semi-Markov chain). A window of that set becomes final 0.2 s after its end. A window may begin before the end of the
   previous final window: an overlap of up to 15 % of the later window's length is cut off its start, and a window that
   overlaps more is dropped.
5. The gate. The classifier recognises the window like a marked segment. A window recognised as `unknown` is not
   published.
6. Familiarity. People mark where an action is done; a part of what the search finds is none, though it may look like
   one. The familiarity of a found segment is therefore that of a marked one, multiplied by the precision: the share of
   found segments in which any action was done, counted on people left out of the training.

After half a second without a usable frame the search starts again. Partial actions come from the window with the
largest completeness. A logistic regression, fitted on people left out of the training, computes their confidence from
this completeness.
"""
