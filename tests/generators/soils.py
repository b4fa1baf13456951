"""Soils with sources, and soils drawn around them.

k_c of a table is folded into k_phi for the wheel's width: at one width the two are one parameter.
"""

import numpy as np

# n, k_c N/m^(n+1), k_phi N/m^(n+2), cohesion Pa, friction angle deg, shear modulus m, c1, c2.
TABLE = {
    "dry sand (Wong)": (1.1, 990.0, 1528.43e3, 1040.0, 28.0, 0.015, 0.43, 0.32),
    "LETE sand (Wong)": (0.793, 102e3, 5301e3, 1300.0, 31.1, 0.012, 0.40, 0.20),
    "HIT-LSS1 (Ding)": (1.1, 15.6e3, 2407.4e3, 250.0, 31.9, 0.0114, 0.40, 0.20),
    "lunar regolith": (1.0, 1.4e3, 820e3, 170.0, 35.0, 0.018, 0.40, 0.15),
    "simulant (Ishigami)": (1.0, 1.37e3, 814e3, 800.0, 37.2, 0.024, 0.40, 0.15),
}
# Of these a 10 kg rover climbs and descends 8 degrees on every draw.
FIRM = ("dry sand (Wong)", "LETE sand (Wong)", "HIT-LSS1 (Ding)", "simulant (Ishigami)")

# The names of the model's parameters that a default calibration frees.
CALIBRATED = ("cohesion", "friction_angle", "k_phi", "exponent", "shear_modulus", "c1", "c2")
# How far it takes them (`bekker calibrate` prints its bounds); the lowest cohesion, c1 and c2 are above zero, where a share has no meaning.
BOUNDS = {
    "cohesion": (1.0, 5e3),
    "friction_angle": (0.02, 0.8),
    "k_phi": (1e4, 1e8),
    "exponent": (0.3, 1.5),
    "shear_modulus": (1e-3, 0.1),
    "c1": (1e-3, 0.6),
    "c2": (1e-3, 0.5),
}


def draw(rng, width, firm=False):
    """A soil of the table with its values scattered by a tenth or so; name and parameters (SI)."""
    name = rng.choice(FIRM if firm else list(TABLE))
    n, k_c, k_phi, cohesion, angle, modulus, c1, c2 = TABLE[name]
    spread = lambda size: float(np.exp(size * np.clip(rng.standard_normal(), -2.0, 2.0)))
    soil = {
        "cohesion": cohesion * spread(0.15),
        "friction_angle": float(np.radians(angle)) * spread(0.04),
        "k_phi": (k_c / width + k_phi) * spread(0.15),
        "exponent": n * spread(0.05),
        "shear_modulus": modulus * spread(0.12),
        "c1": c1 * spread(0.08),
        "c2": c2 * spread(0.15),
    }
    return str(name), soil


def thesis():
    """The soil that the model has by default (Iagnemma 2001, 4.4.1)."""
    return {
        "cohesion": 1000.0,
        "friction_angle": float(np.radians(29.0)),
        "k_phi": 850e3,
        "exponent": 1.0,
        "shear_modulus": 0.03,
        "c1": 0.4,
        "c2": 0.2,
    }
