"""Every number by which a diagnosis decides, by the stage that it belongs to."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelThresholds(Group):
    """Thresholds of factors, copies and noise in what was logged."""

    least_factor: float = threshold(
        0.4, "times it should be, below which a torque's channel lies: no drive's gain is less"
    )
    most_factor: float = threshold(2.5, "the same above which it lies")
    factor_t: float = threshold(4.0, "errors by which a factor must differ from one", "s.e.")
    least_correlation: float = threshold(
        0.7, "share of a torque's deviation that what it should be must explain"
    )
    tiny: float = threshold(0.15, "size of a factor that noise may drown and is sure all the same")
    tiny_error: float = threshold(0.2, "share of `tiny` that its error may be")
    law_agrees: float = threshold(
        2.0, "factor within which the model must agree with a factor of the controller's law"
    )
    copy_floor: float = threshold(
        1.5, "times the noise, within which a torque copies the model's for the commanded motion"
    )
    copy_nearer: float = threshold(
        0.7, "times what the motion leaves, within which the commanded one must come"
    )
    copied_joints: float = threshold(0.6, "share of the joints that must be such copies")
    slowest: float = threshold(
        0.02, "standard deviation of a speed that says how it is scaled", "rad/s"
    )
    smallest: float = threshold(0.01, "the same of a position", "rad")
    late: float = threshold(
        1 / 3, "share of a period by which a drive may follow its law later than the others"
    )
    drive_gain: float = threshold(
        3.0, "factor within which a torque is its law's, whatever the drive's gain"
    )
    usual_spread: float = threshold(
        1.5, "factor by which sound joints' noise differs, as one standard deviation"
    )
    spread_weight: float = threshold(10.0, "joints that the usual spread counts as", "joints")
    false_alarm: float = threshold(
        0.01, "chance that a sound channel is called noisy", "", "a standard: 1 %"
    )
    unheard: float = threshold(
        0.5, "share of the others' noise in commands, below which a joint's is in the file only"
    )
    unheard_t: float = threshold(4.0, "errors by which that must be clear", "s.e.")
    least_heard: float = threshold(0.05, "share of noise that controllers must hear to be asked")
    heard_scatter: float = threshold(
        0.1, "share of it by which sound joints' shares differ at least"
    )
    noise_gain: float = threshold(
        0.5, "share of the noise's power beyond what is sound, in either half of the recordings"
    )
    white: float = threshold(
        0.5,
        "share of a noise that is as strong in most of the spectrum, without what hums or rings",
    )
    noise_error: float = threshold(0.03, "least error of a noise, as a share of it")
    noise_blur: float = threshold(
        0.3, "the same per jitter over period, as rows are interpolated to even times"
    )


_FITTED = (
    "bench/sim2real/diagnosis/confidence.py: logistic regression on concealed worlds of development"
)
_ON = "the same on opened worlds of bench/sim2real/machines"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfidenceThresholds(Group):
    """Weights of the log odds that a finding is there, and what is made of them."""

    there: float = threshold(
        0.32, "log odds of a cause that few machines have, barely there, gaining half", "", _ON
    )
    odds: float = threshold(0.30, "per logarithm of one and the posterior log odds", "", _ON)
    explains: float = threshold(
        0.16,
        "per log odds of the gain: its share of what all else leaves on rows it was not fitted to",
        "",
        _ON,
    )
    many: float = threshold(2.90, "of what many machines have", "", _ON)
    all: float = threshold(3.01, "of what every machine has", "", _ON)
    base: float = threshold(
        2.16, "log odds of a law's error or an event, as large as what is left", "", _FITTED
    )
    size: float = threshold(
        0.13, "per logarithm of its part over what nothing explains", "", _FITTED
    )
    gain: float = threshold(
        0.36,
        "per log odds of the gain: its share of what all else leaves on rows it was not fitted to",
        "",
        _FITTED,
    )
    event: float = threshold(
        -2.5,
        "of what happens once: the best of hundreds of windows is often good",
        "",
        "chosen; -1.7 fits best, on a dozen events only",
    )
    unsupported: float = threshold(0.9, "confidence of what is wrong with a channel", "", _FITTED)


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerThresholds(Group):
    """Thresholds of laws that are estimated from commands, motion and effort."""

    least_rows: int = threshold(200, "samples below which no law is estimated", "rows")
    most_rows: int = threshold(12_000, "samples of a joint that are used at most", "rows")
    settling: float = threshold(0.15, "time at a recording's begin that is left out", "s")
    least_gain: float = threshold(
        0.05, "share of what a simpler law leaves that a further term must save"
    )
    worth: float = threshold(
        5.0,
        "log odds from which a further term, a delay, a limit or another gain is taken",
        "",
        "Kass and Raftery, JASA 90(430), 1995: very strong",
    )
    gain_t: float = threshold(
        3.0, "standard errors by which a position gain must be above nothing", "s.e."
    )
    gain_error: float = threshold(
        0.005, "least error of a gain, as a share of it: a log's samples are not the controller's"
    )
    believed: float = threshold(
        0.8, "share of the held-out effort that a law must explain to be believed"
    )
    used: float = threshold(0.95, "the same for its gains to stand in for gains not known")
    given_off: float = threshold(
        0.05, "share by which a gain that the study gives must be off to be said wrong"
    )
    given_usual: float = threshold(
        0.3, "by which such a gain usually is off where it is wrong, as a share of it"
    )
    flat: float = threshold(0.002, "share of the highest effort within which its top is flat")
    flat_rows: int = threshold(8, "samples at a flat top", "rows")
    let_go: float = threshold(0.08, "time without effort after which a drive may have let go", "s")
    let_go_over: float = threshold(
        5.0, "error of the law over its usual one where a drive has let go"
    )
    no_effort: float = threshold(1e-3, "share of the highest effort that is none")
    longest_delay: float = threshold(0.12, "delay, and time constant, that are sought", "s")
    slow: float = threshold(
        0.2, "frequency below which a law's error is an integral's or a sensor's zero", "Hz"
    )
    law_block: float = threshold(1.0, "time within which a law's errors count as one", "s")
    followed: float = threshold(
        0.95, "share of the effort in the motion's band that some law must explain to be asked more"
    )
    followed_itself: float = threshold(
        0.9, "the same of a joint that may be late, where the other joints reach it"
    )
    followed_elsewhere: float = threshold(
        0.5,
        "share of other recordings' effort that a law must explain for what it misses, or asks for"
        " beyond a limit, to mean anything: most of it",
    )
    late_gain: float = threshold(
        0.1, "share of what a law leaves that coming late, or a limit, must save"
    )
    later: float = threshold(
        0.008, "by which one joint must act later than the others do: current loops differ", "s"
    )
    most_at: float = threshold(0.6, "share of all rows that may be at a limit for it to be one")
    most_over: float = threshold(0.1, "share of what is at a limit that may lie over it")
    as_given: float = threshold(
        0.9, "share of the limit that the robot's description has, from which a limit is no news"
    )
    steady: float = threshold(
        0.8, "share of an effort's changes that come in time where a controller holds it"
    )
    trifle: float = threshold(
        0.15,
        "share of a sample up to which a delay is none: channels are logged one after the other",
    )
    drive_error: float = threshold(
        0.1,
        "share by which a motor's torque per volt differs from the given one",
        "",
        "copper's resistance grows by 0.4 % per K: windings 25 K warmer",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagnosisThresholds(Group):
    """Standards that all stages share come first; then those of one question each."""

    worth: float = threshold(
        3.0,
        "log posterior odds from which a cause is taken",
        "",
        "Kass and Raftery, JASA 90(430), 1995: strong",
    )
    better: float = threshold(1.0, "log odds by which another set must be better to be taken")
    level: float = threshold(
        4.6, "log odds within which another name is a rival: a hundredth as likely"
    )
    shape_price: float = threshold(
        1.5, "log odds that a nonlinear parameter costs which was moved to its best"
    )
    sure: float = threshold(
        3.0,
        "errors by which something must differ from nothing, or from another, to be clear",
        "s.e.",
    )
    most_of: float = threshold(0.5, "share that is most of something", "", "the meaning of most")
    little: float = threshold(0.05, "share of something that is little of it")
    nothing: float = threshold(0.02, "share of something that is next to nothing of it")
    shown: float = threshold(
        0.1, "share of a variance that must depend on a variable for the data to show that"
    )
    rare: float = threshold(
        3.0,
        "times what others, or other times, show, from which something stands out",
        "",
        "2.7 standard deviations, where joints differ by a factor of 1.5",
    )
    matters: float = threshold(
        0.3, "an ordinary part over what nothing explains, from which it is named"
    )
    matters_more: float = threshold(
        1.0, "the same of an anomalous cause: less is the misfit of another's law"
    )
    matters_common: float = threshold(0.7, "the same of one that many machines have")
    common: float = threshold(
        0.1, "probability of a cause at a place, from which many machines have it"
    )
    judged: float = threshold(
        0.2,
        "share of what all else leaves of recordings that only judge, that an anomalous cause must"
        " explain; of a mismatch, that another source of it must be",
    )
    suspected: float = threshold(0.75, "confidence below which a finding is suspected, not claimed")
    restless: float = threshold(
        1.35,
        "noise that a torque must leave for parts, moments, nameless and simulated causes",
        "sigma",
    )
    scale_off: float = threshold(
        0.08, "share by which a torque's scale must be off to be named, beyond calibration"
    )
    alike: float = threshold(2.0, "factor within which joints' delays may be one cause's")
    linear: float = threshold(
        0.5, "noise by which a cause must change another's columns for a new linearisation", "sigma"
    )
    tilt: float = threshold(
        0.02, "angle of a base from which the weight of unknown bodies acts another way", "rad"
    )
    harmonic_power: float = threshold(
        20.0, "power of a harmonic in what is left, from which it is a candidate", "sigma^2"
    )
    harmonic_rows: int = threshold(50, "rows from which a harmonic can be found", "rows")
    moment_better: float = threshold(
        0.3, "share by which a moment inside a recording must explain more than any border"
    )
    push_gain: float = threshold(80.0, "decrease of the cost within a push's window", "sigma^2")
    push_harm: float = threshold(
        0.002, "share of the gain by which a joint may be worse: a push is not quite constant"
    )
    push_t: float = threshold(
        6.0, "Wald statistic of a push's force: hundreds of windows are looked at", "s.e."
    )
    push_share: float = threshold(
        0.01, "share of the first residual within its window that a held-out push must explain"
    )
    shortest: float = threshold(
        0.2, "time that a push, or a stretch of rows that err alike, lasts at least", "s"
    )
    fewest_stretches: int = threshold(
        12, "stretches in which a term acts, from which its error is estimated", "stretches"
    )
    on_bound: float = threshold(1e-3, "share of a bound within which a figure lies on it")
    silent: float = threshold(
        10.0, "times the variance before any row, from which a session says nothing of a figure"
    )
    spread_p: float = threshold(
        0.01,
        "probability of differences between sessions, below which they are said",
        "",
        "a standard: 1 %",
    )
    delay_given: float = threshold(
        1 / 3, "share of a delay, below which another joint's error says whether it is late too"
    )
    near_floor: float = threshold(
        1.6, "times the noise floor, within which what is left counts as explained"
    )
    quiet: float = threshold(2.0, "times the noise floor, within which what is left needs no name")
    change_blocks: int = threshold(4, "blocks in which a recording must show a friction", "blocks")
    settling: float = threshold(0.7, "beginning of each simulated run that is not judged", "s")
    least_move: float = threshold(
        0.3, "errors that a figure must move by simulation to be worth another run", "s.e."
    )
    own_error: float = threshold(
        0.25, "share of a simulation's correction that is added to its figure's error"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class FeetThresholds(Group):
    """Thresholds of a robot that stands on its feet."""

    height: float = threshold(
        1e-3, "to which a sole's height follows from joints and pose", "m", "calibrated legs: 1 mm"
    )
    tilt: float = threshold(
        5e-3,
        "to which a sole's tilt follows from joints and pose",
        "rad",
        "elastic soles; no rocking",
    )
    friction: float = threshold(
        0.1, "by which a coefficient of friction differs from slip to slip", "", "rubber on floors"
    )
    slipping: float = threshold(
        0.05, "speed of a sole that slips", "m/s", "beyond the creep of elastic soles"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitThresholds(Group):
    """Thresholds of a level, or a line falling with speed, beyond which no torque is given."""

    flat: float = threshold(0.02, "share of the level within which a top is flat despite all noise")
    flatter: float = threshold(0.3, "spread of a top over that of what is asked for beyond it")
    flatter_once: float = threshold(0.1, "the same where it was reached on one occasion only")
    noise: float = threshold(4.0, "what counts as beyond a level, over the noise", "sigma")
    least_rows: int = threshold(6, "samples at a level, their neighbours beyond it too", "rows")
    least_rows_once: int = threshold(15, "the same where it was reached on one occasion", "rows")
    apart: float = threshold(0.2, "time between two occasions", "s")
    missing: float = threshold(
        0.02, "share of the highest torque by which less is given than asked for, of a line"
    )
    least_rows_of_line: int = threshold(30, "samples on a line", "rows")
    least_span: float = threshold(0.01, "range of speeds that a line covers", "rad/s")
    on_line: float = threshold(
        0.02, "share of the stall torque within which a top is straight despite all noise"
    )
    kept: float = threshold(
        0.8, "share of the samples short of what is asked for that must lie on a line"
    )
    falls: float = threshold(0.08, "share of the stall torque that a line falls by")
    falls_clearly: float = threshold(3.0, "fall of a line over its spread")
    fastest: float = threshold(
        50.0, "no-load speed over the highest speed seen, beyond which a line does not fall"
    )
    least_piled: int = threshold(20, "samples at a ceiling that is seen in torques alone", "rows")
    least_share: float = threshold(0.02, "the same as a share of all samples")
    least_occasions: int = threshold(3, "occasions on which it must be reached", "occasions")
    piled: float = threshold(2.0, "samples at such a ceiling over those just below it, per N m")
    over: float = threshold(0.1, "samples beyond a level, line or ceiling, over those at it")
    varies: float = threshold(
        0.7, "spread of gravity or inertia at a ceiling over the width that its noise makes likely"
    )
    above_noise: float = threshold(8.0, "least level of a ceiling over that width")


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseThresholds(Group):
    """Thresholds of the balances by which everything is compared."""

    model_error: float = threshold(
        0.003, "share of a torque's own size below which nothing is claimed: rounding, filters"
    )
    rounding: float = threshold(
        1e-3, "share of a torque's own size below which a log without noise is no better known"
    )
    fit_error: float = threshold(
        0.01, "share of a mismatch's own size to which the catalogue's laws are taken to be exact"
    )
    block: float = threshold(
        1.5, "length of the bootstrap's blocks: longer than residuals remember", "s"
    )
    longest: float = threshold(
        600.0, "recorded time to fit beyond which excerpts are used, spread over all of it", "s"
    )
    shortest: float = threshold(120.0, "time that excerpts last together at least", "s")
    most_rows: int = threshold(
        50_000, "rows of all joints to fit beyond which excerpts are used, as balances are thinned"
    )
    judged_share: float = threshold(0.5, "the same of recordings that only judge, as a share of it")
    folds: int = threshold(4, "parts of cross-validation: recordings, or long stretches of few")
    lowest_cutoff: float = threshold(5.0, "lowest cut-off of the balances that is chosen", "Hz")
    highest_cutoff: float = threshold(20.0, "highest cut-off that is chosen", "Hz")
    cutoff_of_rate: float = threshold(0.11, "highest cut-off as a share of the sampling rate")
    still_speed: float = threshold(
        2e-3, "speed below which a joint is still, whatever its noise", "rad/s"
    )
    least_range: float = threshold(0.05, "range within which a joint has not moved", "rad or m")
    least_moving: float = threshold(0.1, "share of the time that a joint must move to be judged")


@dataclass(frozen=True, slots=True, kw_only=True)
class PriorThresholds(Group):
    """Usual sizes: standard deviations of priors, and of what no recording shows."""

    friction: float = threshold(
        1.0, "standard deviation of each part of a joint's friction, in its usual torques"
    )
    offset: float = threshold(0.3, "the same of a torque's zero", "", "drive calibration")
    torque: float = threshold(
        0.05, "the same of a torque's scale", "", "current sensors and torque constants: 3 to 5 %"
    )
    rotor: float = threshold(
        0.3, "the same of a rotor's torque at the joint's usual acceleration", "", "geared arms"
    )
    bodies: float = threshold(
        0.1,
        "the same of masses, first moments and inertias where the study says nothing",
        "",
        "drawings against identified arms",
    )
    good_bodies: float = threshold(
        0.01, "the same of a model that was identified or is the machine's own, the other choice"
    )
    days: float = threshold(
        0.1,
        "the same of friction between sessions, as a share of it, where one alone was recorded",
        "",
        "repeated identifications: 10 to 30 % from day to day",
    )
    days_more: float = threshold(3.0, "factor by which sessions may differ more or less than that")
    drive_zero: float = threshold(
        0.02, "standard deviation of a drive's zero, in usual torques", "", "current loops"
    )
    drive_scale: float = threshold(0.02, "the same of its scale against its command")
    speed_scale: float = threshold(0.005, "the same of a speed's scale against its position's")
    imu_tilt: float = threshold(
        0.01,
        "standard deviation of an IMU's mounting about each axis",
        "rad",
        "surfaces and boards: half a degree",
    )
    imu_acc: float = threshold(
        0.1,
        "the same of an accelerometer's zero",
        "m/s^2",
        "data sheets of MEMS sensors: 5 to 40 mg",
    )
    imu_gyro: float = threshold(
        0.01, "the same of a gyro's zero", "rad/s", "data sheets of MEMS sensors: 0.1 to 1 degree/s"
    )
    usual_part: float = threshold(
        0.3, "part of an anomalous cause, as a share of what its balance usually is"
    )
    fixed_error: float = threshold(
        0.15, "standard deviation of a coefficient that is 1 by its meaning"
    )
    least_repeats: float = threshold(
        1.5, "rows that say the same at least: three a period of the cut-off, noise up to it"
    )
    torque_scale: float = threshold(
        0.04,
        "standard deviation of a torque's own scale, which intervals of all that follows from"
        " torques include; 'trust: {torque: ...}' of a study says another",
        "",
        "gain errors of current sensors and torque constants: data sheets, 3 to 5 %",
    )
    position_delay: float = threshold(
        0.03,
        "standard deviation of a position's delay by sampling, in periods",
        "",
        "forty studies with nothing wrong: 0.013 root mean square, 0.06 at most",
    )
    torque_delay: float = threshold(
        0.15,
        "the same of a torque's",
        "",
        "twice the 0.08 of such studies: machines differ in when within a tick a torque acts",
    )
    unknown_delay: float = threshold(0.3, "the same of any where the period is not known")
    log_delay: float = threshold(0.01, "part of the same by interpolation, in the log's periods")
    discretisation: float = threshold(
        0.0015, "share of a value that differentiation and sampling may take"
    )
    of_the_model: float = threshold(
        0.03, "share of a torque's size, to which a simulator follows inverse dynamics"
    )
    usual_residue: float = threshold(
        0.1, "what catalogue laws leave of a joint's friction, at least", "", "identified arms"
    )
    usual_change: float = threshold(
        0.08,
        "by which friction differs between recordings at least, as a share",
        "",
        "repeated identifications of one arm: 10 % from day to day",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ProposeThresholds(Group):
    """Thresholds of what is expected along a motion that was not made yet."""

    enough: float = threshold(0.9, "confidence from which a finding needs no further motion")
    decisive: float = threshold(
        10.0,
        "expected log likelihood ratio of two causes, from which more is not sought",
        "",
        "odds of 20 000 to 1",
    )
    gain: float = threshold(
        0.8,
        "share of what is left where a finding acts, from which more is not sought",
        "",
        "well above what confidence.gain asks for `enough`",
    )
    known: float = threshold(
        9.0,
        "decrease of the cost in the recordings from which a rival's figures are known",
        "",
        "three standard errors",
    )
    doubt: float = threshold(
        1.28,
        "standard deviations that a ratio is assumed to fall short of what is expected",
        "s.e.",
        "one motion of ten falls shorter",
    )


_FEW_PAIRS = (
    "logistic regression as in bench.sim2real.simulators.confidence, on 18 findings of seven pairs"
    " of development: few; by gains over all channels"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatorThresholds(Group):
    """Thresholds of candidates that are simulated under recorded commands."""

    false_alarms: float = threshold(
        0.05, "probability, before the data, that any of what few machines have differs"
    )
    differs: float = threshold(
        0.1, "probability, before the data, that what every machine has differs enough to be named"
    )
    least_confidence: float = threshold(
        0.75, "confidence below which a finding is suspected, not claimed"
    )
    clear: float = threshold(
        0.975,
        "probability that a figure lies on its side of the simulator's, or it is suspected",
        "",
        "its 95 % interval leaves the simulator's out",
    )
    least_suspected: float = threshold(
        0.5, "probability of holding on held-out data below which nothing is said of a term"
    )
    base: float = threshold(
        -1.0, "log odds that a finding is true which takes away half of the error", "", _FEW_PAIRS
    )
    per_gain: float = threshold(
        1.96, "per log odds of the share of the error that a finding takes away", "", _FEW_PAIRS
    )
    shows: float = threshold(
        0.5, "times a channel's noise that a finding must change its motion by"
    )
    of_step: float = threshold(
        1.5,
        "times what holding torques for a step looks like (damping kp T/2, armature kd T/2, delay"
        " T/2) up to which a finding may be nothing else, where the controller's period is unknown",
    )
    explained: float = threshold(
        0.8, "share of the squared error above noise that findings of an explained mismatch gain"
    )
    alike: float = threshold(
        1.5, "times the noise of its channel up to which a joint's error counts as none"
    )
    runs_away: float = threshold(
        20.0,
        "times its recorded range, and a turn, by which a joint of a stable simulator may stray",
    )
    of_its_step: float = threshold(
        1.0, "times its recorded motion by which a joint may move otherwise with a truer step"
    )
    rival: float = threshold(
        3.0,
        "log odds by which another term may explain the data worse and be named with it",
        "",
        "Kass and Raftery, JASA 90(430), 1995: strong",
    )
    moves: float = threshold(2e-3, "range from which a joint moved", "rad")
    base_shift: float = threshold(0.02, "by which a stand lets a base move", "m")
    base_spin: float = threshold(0.1, "root mean square at which it lets it turn", "rad/s")
    same_commands: float = threshold(
        0.95, "correlation of commands from which two runs are of the same ones"
    )
    clocks: float = threshold(2e-3, "share by which the clocks of two logs may run apart", "s/s")


@dataclass(frozen=True, slots=True, kw_only=True)
class WatchThresholds(Group):
    """Thresholds of the CUSUM charts of `pdoik watch`."""

    alarms_per_day: float = threshold(
        1.0, "false alarms of all joints together in 24 h of motion", "1/day"
    )
    friction_change: float = threshold(
        0.15,
        "share of its friction by which a healthy joint may differ from the model",
        source="10 to 30 % from day to day, Simoni et al., IROS 2015, and the README",
    )
    friction_drift: float = threshold(
        0.03,
        "the same share within a day, of a minute: friction is learnt while it is watched",
        source="drives that warm up: 10 to 30 % in an hour",
    )
    bodies: float = threshold(
        0.05,
        "share of a link's mass and moments by which the model's are off, before healthy logs",
        source="CAD without cables and screws: 1 to 10 %",
    )
    told_within: float = threshold(
        1.0, "time after which a change of the smallest size that is looked for is reported", "s"
    )
    shortest: float = threshold(0.15, "time that evidence lasts before it is an alarm", "s")
    slides: float = threshold(
        2e-3,
        "travel since a joint turned or rested after which dry friction is at its level",
        "rad",
        source="presliding, Armstrong-Helouvry et al., Automatica 30(7), 1994",
    )
    memory: float = threshold(
        3.0, "time over which residuals are taken to be correlated at most", "s"
    )
    least_motion: float = threshold(
        5.0, "motion of a joint in healthy logs without which it is not watched", "s"
    )
    learn: float = threshold(
        10.0, "motion of the joint after an alarm from which the cause is learnt", "s"
    )
    learn_at_most: float = threshold(
        40.0, "time after an alarm at which the cause is reported", "s"
    )
    revise: float = threshold(
        120.0, "time after an onset within which its cause may be learnt anew", "s"
    )
    gain: float = threshold(
        0.2,
        "standard deviation of a change of a torque's gain",
        source="current sensors and torque constants, heated or demagnetised: 5 to 30 %",
    )
