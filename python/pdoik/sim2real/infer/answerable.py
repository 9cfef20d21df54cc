"""Whether anything could be found in a study at all."""

from __future__ import annotations

from ..channels import ChannelCheck
from ..controllers import ControllerCheck
from ..motion import Prepared

_LISTED = 6  # numerics: joints in one sentence


def why_unanswerable(prepared: Prepared, control: ControllerCheck, check: ChannelCheck) -> str:
    """Why no finding is possible, in words; "" where one may be.

    Nothing can be found where no balance has a row that counts, in held-out recordings either, no
    controller was estimated and no channel is wrong.
    """
    balances = prepared.fit
    if control.findings or check.findings or any(each.effort for each in control.estimates):
        return ""
    # Events may be in held-out recordings only.
    held_out = {} if prepared.validate is None else prepared.validate.mask
    if any(mask.any() for mask in (*balances.mask.values(), *held_out.values())):
        return ""
    if balances.keys:
        return f"nothing can be found: {_motion(prepared)}"
    return (
        "nothing can be found: of positions alone, with nothing else, a model cannot be"
        f" wrong; the recordings to fit have {_channels(prepared)}. Log the torque (tau, or current"
        " or duty), the commanded torque (tau_cmd) or the commanded positions (q_des)"
    )


def _channels(prepared: Prepared) -> str:
    names = dict.fromkeys(name for each in prepared.study.fit for name in each.channels)
    return " and ".join((", ".join([*names][:-1]), [*names][-1])) if len(names) > 1 else "only q"


def _motion(prepared: Prepared) -> str:
    """What moves too little, and what would be enough."""
    limits, balances = prepared.study.thresholds.noise, prepared.fit
    still = [name for j, name in enumerate(prepared.study.joints) if not balances.excited[j]]
    named = ", ".join(still[:_LISTED]) + (" and others" if len(still) > _LISTED else "")
    return (
        f"no joint moves enough in the recordings to fit ({named or 'none is in motion for long'});"
        f" expected one at least that moves over more than {limits.least_range:g} rad and for more"
        f" than {100 * limits.least_moving:g} % of the time"
    )
