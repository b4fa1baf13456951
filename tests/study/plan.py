"""Which experiments a study consists of."""

import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "generators"))

import cases  # noqa: E402
import conditions  # noqa: E402

FIRST_SEED = {"development": 1000, "report": 50000}

PAIRS = {
    cases.WHEEL: (
        "slip_sinkage+coulomb_friction",
        "slip_sinkage+rate",
        "rate+drag",
        "exit_angle+viscous_friction",
        "bulldozing+coulomb_friction",
    ),
    cases.ROVER: (
        "multi_pass+coulomb_friction",
        "slip_sinkage+centre_of_mass",
        "soft_patch+drag",
        "tether+pitch_bias",
        "payload+viscous_friction",
    ),
}


# Forms that join a set behind all others, so that those keep their order.
MORE_FORMS = {
    cases.WHEEL: (("slip_sinkage", "lyasko"), ("slip_sinkage", "reece"), ("flexible_wheel", "load")),
    cases.ROVER: (("slip_sinkage", "gradual"),),
}


@dataclass(frozen=True)
class Job:
    set_name: str
    kind: str
    size: str
    case: str
    form: str
    noise: float
    seed: int
    conditions: tuple = ()

    @property
    def name(self):
        size = "" if self.kind == cases.WHEEL else f"_{self.size}"
        under = "_drawn" if self.conditions else ""
        return f"{self.set_name}_{self.kind}{size}_{self.case}_{self.form or 'none'}_{self.noise:g}_{self.seed}{under}"


def form_for(set_name, kind, case):
    """The library's form for the development, another one of the literature for the report (where there is one)."""
    parts = []
    for one in case.split("+"):
        known = [f for f in cases.FORMS if f.case == one and kind in f.kinds]
        if not known:
            return ""
        others = [f for f in known if not f.library]
        parts.append((others if set_name == "report" and others else known)[0].form)
    return "+".join(parts)


def all_cases(kind, under=()):
    jointed = "rocker_bogie" in under
    return ["clean", *cases.cases_of(kind, jointed), *PAIRS[kind], *cases.CAUTION]


def jobs(set_name, kinds, size, wanted, noises, seeds, first_seed=None, drawn=False):
    """All experiments; where `drawn`, those of a traverse are under the conditions, the noise among them, that their seed draws."""
    first = FIRST_SEED[set_name] if first_seed is None else first_seed
    made, more = [], []
    for kind in kinds:
        for seed in range(first, first + seeds):
            under = conditions.drawn(seed) if drawn and kind == cases.ROVER else ()
            levels = [conditions.noise(under)] if drawn and kind == cases.ROVER else noises
            for case in wanted or all_cases(kind, under):
                if case in all_cases(kind, under):
                    form = form_for(set_name, kind, case)
                    made += [Job(set_name, kind, size, case, form, level, seed, under) for level in levels]
                others = [form for of, form in MORE_FORMS[kind] if of == case]
                more += [Job(set_name, kind, size, case, form, level, seed, under) for form in others for level in levels]
    return made + more


def quick():
    """The small fixed part that CI runs: library forms, fixed seeds."""
    wheel = ("clean", "slip_sinkage", "drag", "hump")
    made = [Job("development", cases.WHEEL, "full", c, form_for("development", cases.WHEEL, c), 0.02, 1000) for c in wheel]
    rover = ("multi_pass",)
    return made + [
        Job("development", cases.ROVER, "reduced", c, form_for("development", cases.ROVER, c), 0.02, 1000) for c in rover
    ]
