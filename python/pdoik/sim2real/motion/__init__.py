"""What moved, and what the model says of it.

Comes in: a `Study`. Goes out: `Prepared`, with a smooth `Motion` for each recording and `Balances`:
what was measured less what the model says, through one filter, with noise floors. Next: channels.
"""
