"""Which effects that a diagnosis leaves possible, or names, are like the hidden ones: decided by the generator's own fits.

A rival is fitted in the place of the hidden effect, together with the soil (`Detector.cosine_in_place`). That takes 20 to 90 s on a
traverse, so that it is done for those effects only that the diagnosis names or leaves possible.
"""

import cases
import score
from detect import ties


def beside(effects, result):
    """What a diagnosis names or leaves possible beside the hidden effects, sorted; nothing where there is none."""
    if "error" in result:
        return []
    return sorted((set(score.named(result)) | score.tied(result) | score.beside(result)) - {effect["case"] for effect in effects})


def judge(detector, kind, effects, said):
    """Gives each hidden effect its `cosines` with the effects of the library that were `said` beside it, and its `allowed_ties`. `detector`
    may be None where nothing was said or only outsiders are hidden."""
    hidden = {cases.find(kind, effect["case"], effect["form"]): effect["strength"] for effect in effects}
    for effect, own in zip(effects, hidden):
        known = set() if effect["outside"] or not said else {form.case for form in detector.rivals} & set(said)
        effect["cosines"] = {rival: round(detector.cosine_in_place(hidden, own, rival), 4) for rival in sorted(known)}
        effect["allowed_ties"] = ties(effect["cosines"], effect["case"])
