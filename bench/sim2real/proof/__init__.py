"""The proof: worlds concealed, sealed, diagnosed blind, and only then scored.

    python -m bench.sim2real.proof --out DIR

Run from the repository's root. `bench.sim2real.concealed` makes the worlds and knows nothing of the
diagnosis; the diagnosis runs in processes that know nothing of either. Here alone both meet.
"""
