"""One posterior over sets of causes: balances come in, causes with figures and odds go out.

Read in this order: `hypothesis` (what is believed beforehand), `linearisation` (rows and sums),
`model` (a set of hypotheses, its noise and evidence), `ordinary` (what every machine has), `pool`
and `proposals` (candidates), `posterior` (the moves), `identify` (what is claimed), `figures`.
What was identified is confirmed by simulation in `confirm` and told by `infer`.
"""
