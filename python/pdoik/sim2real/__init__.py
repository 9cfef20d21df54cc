"""Where and why recordings of a robot and its model disagree: `pdoik diagnose` in Python.

    from pdoik import sim2real

    examination = sim2real.examine("study.yaml")
    for finding in examination.diagnosis.findings:
        print(finding.statement)
    sim2real.write("report", examination)

Needs the extra: pip install 'pdoik[sim2real]'. SI units and radians; joint arrays are (T, n) in the
order of the study's joints.
"""

from pdoik._extras import asks_for

with asks_for("sim2real"):
    from pdoik.recordings import Recording

    from .diagnose import UnanswerableError, diagnose, examine, preprocess
    from .effects import CATALOGUE, register
    from .evidence import evidence_of, model_of, servo_model, write
    from .export import export_mjcf, export_urdf
    from .findings import (
        ControllerEstimate,
        Diagnosis,
        Equivalent,
        Estimate,
        Evidence,
        Finding,
        JointFit,
        OrdinaryPart,
        Residue,
        Support,
    )
    from .identify import Identified
    from .infer import Examination, conclude
    from .model import Model, load_model, predict, replay
    from .motion import Prepared, prepare
    from .propose import NothingToSettleError, Proposal, Wishes, propose
    from .simulation import SimulationError, Simulator, Stepper
    from .study import Controller, Payload, Setup, Study, Trust, load_study
    from .study_check import StudyCheck, check_study
    from .study_draft import Draft, draft_study
    from .thresholds import Thresholds
    from .watch import Alarm, Watch, calibrated

__all__ = [
    "CATALOGUE",
    "Alarm",
    "Controller",
    "ControllerEstimate",
    "Diagnosis",
    "Draft",
    "Equivalent",
    "Estimate",
    "Evidence",
    "Examination",
    "Finding",
    "Identified",
    "JointFit",
    "Model",
    "NothingToSettleError",
    "OrdinaryPart",
    "Payload",
    "Prepared",
    "Proposal",
    "Recording",
    "Residue",
    "Setup",
    "SimulationError",
    "Simulator",
    "Stepper",
    "Study",
    "StudyCheck",
    "Support",
    "Thresholds",
    "Trust",
    "UnanswerableError",
    "Watch",
    "Wishes",
    "calibrated",
    "check_study",
    "conclude",
    "diagnose",
    "draft_study",
    "evidence_of",
    "examine",
    "export_mjcf",
    "export_urdf",
    "load_model",
    "load_study",
    "model_of",
    "predict",
    "prepare",
    "preprocess",
    "propose",
    "register",
    "replay",
    "servo_model",
    "write",
]
