"""Cuts the repetitions of one action out of a person's stream of postures that nobody has marked.

`courses` brings the stream to an even rate, `movement` says when it moves, `bursts` lists what may be a repetition,
`likeness` compares those, `choice` takes the set that explains the stream best, `repetitions` puts it together and
`doubts` says in words what may be wrong.
"""
