"""What the columns of a log mean: channel, joint and unit, from their names or from the study.

Comes in: columns as a log names them. Goes out: which of them is `q.elbow`, which is the time, and
in what units, or a `LoadError` that asks for `columns:`. What a name says is found in `words`;
whose it is, by the joints' names or by their order. Next: check_recording.
"""
