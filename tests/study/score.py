"""What a diagnosis is worth, given the truth: the rules of the study."""

# A tie of more effects than this helps nobody.
MOST_TIED = 3
# What a condition of the experiment is besides an effect: to name it is not wrong (tests/generators/conditions.py).
ALSO_TRUE = {"delay": {"sensor_lag", "tracking_delay"}}
# A true model that removes at least this share of the removable left-out error asks the named effect for as much.
WHOLE = 0.9
CAUTION = ("wrong_prior", "noise_half", "noise_double", "poor")


def named(result):
    """Effects that the diagnosis names."""
    return list(result.get("effects", [])) if result["verdict"] == "effect_missing" else []


def tied(result):
    """Effects that the diagnosis leaves possible where it does not decide."""
    return {c["effect"] for c in result.get("candidates", []) if c.get("tied")}


def beside(result):
    """Effects one of which may act beside those that are named, by the diagnosis; or these act in another form."""
    return set(result.get("possible_beside", []))


def without(result, also_true):
    """The diagnosis without the names of what is also true; where nothing else is named, it has explained the measurements."""
    left = [c | {"tied": c.get("tied") and c["effect"] not in also_true} for c in result.get("candidates", [])]
    result = result | {"candidates": left, "possible_beside": sorted(beside(result) - also_true)}
    others = [name for name in result.get("effects", []) if name not in also_true]
    if result.get("verdict") != "effect_missing" or len(others) == len(result["effects"]):
        return result
    return result | ({"effects": others} if others else {"effects": [], "verdict": "explained"})


def outcome(truth, result):
    """One word. Good are right, right_tie and cautious; bad are wrong and false_alarm; the rest says too little."""
    case, effects = truth["case"], truth["effects"]
    also_true = set().union(*(ALSO_TRUE.get(name, set()) for name in truth.get("conditions", [])))
    result = without(result, also_true - {e["case"] for e in effects})
    if "error" in result:
        return "error"
    verdict = result["verdict"]
    if case == "clean":
        return "right" if verdict == "explained" and not beside(result) else "false_alarm"
    if case in CAUTION:
        allowed = {e["case"] for e in effects}
        return "wrong" if set(named(result)) - allowed else "cautious"
    if not all(e["visible"] for e in effects):
        true = {e["case"] for e in effects}
        return "wrong" if set(named(result)) - true - tied_allowed(effects) else "cautious"
    if all(e["outside"] for e in effects):
        return {"unexplained": "right", "effect_missing": "wrong", "explained": "missed"}.get(verdict, "undecided")
    return single(effects[0], result) if len(effects) == 1 else pair(effects, result)


def tied_allowed(effects):
    return {name for e in effects for name in e["allowed_ties"]}


def tie(possible, true, allowed):
    """A member whose signature is not like the true one's, or too many of them, make a tie that does not help."""
    return "right_tie" if possible - {true} <= set(allowed) and len(possible) <= MOST_TIED else "broad_tie"


def single(effect, result):
    true, verdict = effect["case"], result["verdict"]
    if verdict == "effect_missing" and set(named(result)) == {true}:
        return "right"
    if verdict == "undetermined":
        possible = tied(result)
        if true in possible:
            return tie(possible, true, effect["allowed_ties"])
    if verdict == "effect_missing":
        return "extra" if true in named(result) else "wrong"
    if verdict == "unexplained":
        return "partial" if true in result.get("effects", []) else "unexplained"
    if true in beside(result):
        return tie(beside(result), true, effect["allowed_ties"])  # beside a name that is also true
    return "missed" if verdict == "explained" else "undecided"


def pair(effects, result):
    true, verdict = {e["case"] for e in effects}, result["verdict"]
    if verdict == "effect_missing" and set(named(result)) == true:
        return "right"
    allowed = true | tied_allowed(effects)
    if verdict == "undetermined" and true <= tied(result) <= allowed:
        return "right_tie"
    if verdict == "effect_missing":
        if set(named(result)) - allowed:
            return "wrong"
        missing = true - set(named(result))
        if len(missing) == 1 and missing <= beside(result) <= allowed and len(beside(result)) <= MOST_TIED:
            return "right_tie"
        return "one_of_two" if set(named(result)) & true else "wrong"
    if verdict == "unexplained":
        return "partial" if set(result.get("effects", [])) & true else "unexplained"
    return "missed" if verdict == "explained" else "undecided"


def removed_share(truth, result, last=None):
    """Share of the removable held-out error (over the true noise, in squares, signals pooled) that the last step removed, or
    that a model with the held-out errors `last` (by signal) would remove.

    None where nothing was added or less than half of the noise variance was removable.
    """
    steps = result.get("steps", [])
    if len(steps) < 2 or not truth["effects"]:
        return None
    first, last = steps[0].get("heldout_rmse", {}), last or steps[-1].get("heldout_rmse", {})
    gone = removable = 0.0
    for signal, noise in truth["deviation"].items():
        if noise > 0.0 and first.get(signal) is not None and last.get(signal) is not None:
            gone += (first[signal] ** 2 - last[signal] ** 2) / noise**2
            removable += max(first[signal] ** 2 / noise**2 - 1.0, 0.0)
    return gone / removable if removable > 0.5 else None
