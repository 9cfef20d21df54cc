"""Channels first: a wrong sign or unit, a model logged as a measurement, a noisy sensor.

Comes in: `Prepared`. Goes out: `ChannelCheck`, findings of channels and the study with what can be
mended mended. Next: select.
"""
