"""model.json: a robot with what a diagnosis found out about it (schema pdoik.model/1)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from pdoik._files import write_whole
from pdoik.errors import LoadError
from pdoik.recordings import FloatArray, Recording

from ..effects import not_simulated, parts_of_finding
from ..findings import Diagnosis, Finding
from ..simulation import (
    STANDARD_GRAVITY,
    ExternalForce,
    Inertial,
    LinkChange,
    Part,
    Simulator,
    Stepper,
    Vector,
    flat_mjcf,
    link_carrying,
    nearest,
    read_description,
)
from ..study import Controller, Payload, Study
from .content import array_of, controller_content, controller_of, findings_of, listed, required
from .healthy import Healthy

SCHEMA = "pdoik.model/1"
FILE_NAME = "model.json"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Model:
    """What simulation and prediction need: the user's robot, its controller and the findings."""

    joints: tuple[str, ...]
    robot: str | None = None  # text of a URDF, or of an MJCF without shapes
    base: str | None = None  # link that floats; None: it is fixed
    tip: str | None = None  # link; the last joint's otherwise
    controller: Controller | None = None
    rotor_inertia: FloatArray | None = None  # (n,) known before the diagnosis [kg m^2]
    gravity: Vector = STANDARD_GRAVITY  # in the base frame [m/s^2]
    findings: tuple[Finding, ...] = ()
    rigid_body: Mapping[str, FloatArray] = field(default_factory=dict)
    """Ten corrected parameters by link, instead of the robot's own, in `Inertial.ten`'s order."""
    cutoff: float | None = None  # of the filter that the findings were made with [Hz]
    healthy: Healthy | None = None  # what the model leaves of a healthy machine's torques
    study: str | None = None  # the YAML file that was diagnosed

    def __repr__(self) -> str:
        found = ", ".join(finding.effect for finding in self.findings) or "nothing"
        return f"Model of {len(self.joints)} joints with {found}"

    @classmethod
    def of_study(
        cls,
        study: Study,
        findings: tuple[Finding, ...] = (),
        rigid_body: Mapping[str, FloatArray] | None = None,
        cutoff: float | None = None,
    ) -> Model:
        """A study's robot with findings.

        Raises:
            LoadError: the robot's file cannot be read.
        """
        return cls(
            joints=study.joints,
            robot=None if study.robot is None else robot_text(study.robot),
            base=None if study.base is None else study.base.link,
            tip=study.tip,
            controller=study.controller,
            rotor_inertia=study.rotor_inertia,
            findings=findings,
            rigid_body=rigid_body or {},
            cutoff=cutoff,
            study=None if study.source is None else str(study.source),
        )

    def with_robot(self, robot: str | Path) -> Model:
        """The same findings on another description of the robot, as with a known load in its hand.

        Corrected parameters of links are corrected by as much.

        Args:
            robot: file of a URDF or an MJCF.

        Raises:
            LoadError: it cannot be read.
            ValueError: it has no such link.
        """
        text = robot_text(Path(robot))
        if not self.rigid_body or self.robot is None:
            return replace(self, robot=text)
        old, new = (read_description(each).inertials for each in (self.robot, text))
        corrected = {}
        for link, ten in self.rigid_body.items():
            change = ten - old[nearest(link, old, "link")].ten()
            corrected[link] = new[nearest(link, new, "link")].ten() + change
        return replace(self, robot=text, rigid_body=corrected)

    def parts(self, *, findings: bool = True, held: Payload | None = None) -> tuple[Part, ...]:
        """What the simulation adds to the robot's description.

        Args:
            findings: whether to add them.
            held: the known body attached to the robot's hand; what was found of others is left out.
        """
        if not findings:
            return ()
        corrected = tuple(
            LinkChange(link=link, inertial=Inertial.from_ten(ten.tolist()), replace=True)
            for link, ten in self.rigid_body.items()
        )
        parts = sum((parts_of_finding(finding) for finding in self.findings), corrected)
        label = "" if held is None else held.label
        parts = tuple(part for part in parts if _acts_with(part, label))
        if self.tip is None or not any(isinstance(part, ExternalForce) for part in parts):
            return parts
        carrier = link_carrying(self.description, self.joints, self.tip)
        return tuple(_pushed_at_tip(part, carrier, self.tip) for part in parts)

    @property
    def not_simulated(self) -> tuple[str, ...]:
        """Findings that the simulation leaves out, in words."""
        reasons = (not_simulated(finding) for finding in self.findings)
        return tuple(dict.fromkeys(reason for reason in reasons if reason))

    def simulator(self, *, findings: bool = True, timestep: float = 1e-3) -> Simulator:
        """Closed-loop simulation with what was found, or as it was before.

        Raises:
            ValueError: the study had no robot, or one whose base floats.
        """
        return Simulator(
            self.of_fixed_base.description,
            self.joints,
            self.controller,
            self.rotor_inertia,
            self.parts(findings=findings),
            tip=self.tip,
            gravity=self.gravity,
            timestep=timestep,
        )

    def stepper(self, *, findings: bool = True, timestep: float = 1e-3) -> Stepper:
        """The same without controller, a step at a time.

        Raises:
            ValueError: the study had no robot, or one whose base floats.
        """
        return Stepper(
            self.of_fixed_base.description,
            self.joints,
            self.parts(findings=findings),
            rotor_inertia=self.rotor_inertia,
            tip=self.tip,
            gravity=self.gravity,
            timestep=timestep,
        )

    @property
    def of_fixed_base(self) -> Model:
        """Itself.

        Raises:
            ValueError: its base floats, which nothing that runs or predicts it knows yet.
        """
        if self.base is not None:
            raise ValueError(
                f"the base of this model, link {self.base!r}, floats: it can be diagnosed, but not"
                " simulated, predicted or watched yet; improved.xml and improved.urdf have"
                " what was found for a simulator of your own"
            )
        return self

    @property
    def description(self) -> str:
        """Text of the robot's URDF or MJCF.

        Raises:
            ValueError: the study had no robot.
        """
        if self.robot is None:
            raise ValueError("the study had no robot description, so nothing can be simulated")
        return self.robot

    def save(self, folder: str | Path) -> Path:
        """Write model.json into a folder that exists; gives its path."""
        path = Path(folder) / FILE_NAME
        write_whole(path, self.to_json())
        return path

    @classmethod
    def load(cls, path: str | Path) -> Model:
        """The model of a file, or of the model.json in a folder.

        Raises:
            LoadError: there is none, or it is not one.
        """
        path = Path(path)
        path = path / FILE_NAME if path.is_dir() else path
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise LoadError(f"{path}: {error}") from None
        try:
            return cls.from_json(text)
        except LoadError as error:
            raise LoadError(f"{path}: {error}") from None

    def to_json(self) -> str:
        """Text of model.json."""
        found = Diagnosis(verdict="mismatch_explained", findings=self.findings, joints={})
        content = {
            "schema": SCHEMA,
            "joints": list(self.joints),
            "base": self.base,
            "tip": self.tip,
            "controller": controller_content(self.controller),
            "rotor_inertia": listed(self.rotor_inertia),
            "gravity": list(self.gravity),
            "cutoff": self.cutoff,
            "findings": json.loads(found.to_json())["findings"],
            "rigid_body": {link: listed(ten) for link, ten in self.rigid_body.items()},
            "healthy": None if self.healthy is None else self.healthy.content(),
            "study": self.study,
            "robot": self.robot,
        }
        return json.dumps(content, indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str) -> Model:
        """The model whose `to_json` is `text`.

        Raises:
            LoadError: it is not of this schema; the message names the key.
        """
        try:
            content = json.loads(text)
        except json.JSONDecodeError as error:
            raise LoadError(f"not JSON: {error}") from None
        schema = content.get("schema") if isinstance(content, dict) else None
        if schema != SCHEMA:
            raise LoadError(f"schema: expected {SCHEMA!r}, got {schema!r}")
        key = "joints"
        try:
            joints = tuple(str(each) for each in content["joints"])
            n = len(joints)
            key = "controller"
            controller = controller_of(content["controller"], n)
            key = "rotor_inertia"
            rotor_inertia = array_of(content["rotor_inertia"], n)
            key = "gravity"
            x, y, z = (float(each) for each in content["gravity"])
            key = "findings"
            findings = findings_of(content["findings"])
            key = "rigid_body"
            rigid_body = {
                str(link): required(array_of(ten, 10))
                for link, ten in content["rigid_body"].items()
            }
            key = "cutoff"
            cutoff = None if content.get("cutoff") is None else float(content["cutoff"])
            key = "healthy"
            figures = content.get("healthy")
            healthy = None if figures is None else Healthy.of_content(figures, n)
            key = "study"
            study = None if content.get("study") is None else str(content["study"])
            key = "robot"
            robot, tip = content["robot"], content["tip"]
            if robot is not None and not isinstance(robot, str):
                raise ValueError(f"expected the text of a URDF or MJCF, got {robot!r:.40}")
        except KeyError as error:
            raise LoadError(f"{key}: the key {error} is missing") from None
        except (TypeError, ValueError, AttributeError) as error:
            raise LoadError(f"{key}: {error}") from None
        return cls(
            joints=joints,
            robot=robot,
            base=content.get("base"),
            tip=tip,
            controller=controller,
            rotor_inertia=rotor_inertia,
            gravity=(x, y, z),
            findings=findings,
            rigid_body=rigid_body,
            cutoff=cutoff,
            healthy=healthy,
            study=study,
        )


def robot_text(robot: Path) -> str:
    """What model.json keeps of a robot's file: a URDF as it is, an MJCF without shapes.

    Raises:
        LoadError: it is neither.
    """
    try:
        text = robot.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise LoadError(f"{robot}: {error}") from None
    described = read_description(robot)
    return text if described.format == "urdf" else flat_mjcf(robot)


def _acts_with(part: Part, held: str) -> bool:
    """Whether a part acts while a known body of this label is attached; "" for none."""
    return not isinstance(part, LinkChange) or part.held in ("", held)


def _pushed_at_tip(part: Part, carrier: str, tip: str) -> Part:
    """A push on the link that has the tip acts at the tip, as the diagnosis has it."""
    if isinstance(part, ExternalForce) and part.link in (carrier, "") and not part.at_origin:
        return replace(part, link=tip)
    return part


def load_model(path: str | Path) -> Model:
    """The model of a file, or of the model.json in a folder; see `Model.load`."""
    return Model.load(path)


def replay(model: Model, commands: Recording, *, findings: bool = True) -> Recording:
    """The motion that a model makes of commands, see `Simulator.replay`."""
    return model.simulator(findings=findings).replay(commands)
