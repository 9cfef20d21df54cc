"""Where and why recordings of a robot and its model disagree: `pdoik diagnose` in Python.

    from pdoik import sim2real

    examination = sim2real.examine("study.yaml")
    for finding in examination.diagnosis.findings:
        print(finding.statement)
    sim2real.write("report", examination)

Needs the extra: pip install 'pdoik[sim2real]'. SI units and radians; joint arrays are (T, n) in the
order of the study's joints.
"""

from .conclude import Examination, conclude
from .diagnose import diagnose, examine
from .effects import CATALOGUE
from .evidence import evidence_of, files_of, model_of, write
from .export import export_mjcf, export_urdf
from .findings import Diagnosis, Equivalent, Estimate, Evidence, Finding, JointFit
from .model_file import Model, load_model, replay
from .predict import predict
from .prepare import Prepared, prepare
from .read_study import load_study
from .recording import Recording
from .search import search
from .simulation import SimulationError, Simulator, Stepper
from .study import Controller, Study, Trust
from .trial import Search

__all__ = [
    "CATALOGUE",
    "Controller",
    "Diagnosis",
    "Equivalent",
    "Estimate",
    "Evidence",
    "Examination",
    "Finding",
    "JointFit",
    "Model",
    "Prepared",
    "Recording",
    "Search",
    "SimulationError",
    "Simulator",
    "Stepper",
    "Study",
    "Trust",
    "conclude",
    "diagnose",
    "evidence_of",
    "examine",
    "export_mjcf",
    "export_urdf",
    "files_of",
    "load_model",
    "load_study",
    "model_of",
    "predict",
    "prepare",
    "replay",
    "search",
    "write",
]
