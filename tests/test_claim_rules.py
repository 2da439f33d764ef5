"""Each rule of judging gives its verdict on made-up evidence, and another one on a change of it.

A case is a rule, evidence on which it holds, and changes that must cost it that verdict: the
value is off, a run ends elsewhere, or the two methods disagree. Evidence is a stand-in with the
names that the rule reads.
"""

from __future__ import annotations

import inspect
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paper_checks.claim import Claim, Verdict
from paper_checks.claims import equations as eqs
from paper_checks.claims import (
    expectations,
    fig02,
    fig03,
    fig04,
    fig05,
    fig06,
    fig07,
    fig08,
    fig09,
    fig10,
    fig11,
    fig12,
    fig13,
    fig14,
    fig15,
    fig16,
    fig17,
    fig18,
    text_friction,
    text_nuclei,
    text_simplified,
    text_vdp,
)
from paper_checks.discover import find_entries
from paper_checks.ruling import Ruling

HOLDS, PARTLY, FAILS, CORRECTED = (
    Verdict.REPRODUCED, Verdict.PARTIAL, Verdict.NOT_REPRODUCED, Verdict.CORRECTED,
)  # fmt: skip
STATES = {"front": 3, "breather": 3, "fixed point": 3}
ORBIT = np.array([0.0, 0, 0, 0, 0.3, 2.8, 0.3, 0, 0, 0, 0])


CASES: list[tuple[Any, dict[str, Any], Verdict, list[tuple[dict[str, Any], Verdict]]]] = [
    (fig02.rule_two_states,
     {"gap": 1e-9, "inside_slides": True, "outside_sticks": True, "settles": True}, HOLDS,
     [({"gap": 5e-6}, FAILS), ({"inside_slides": False}, FAILS), ({"settles": False}, FAILS),
      ({"outside_sticks": False}, FAILS)]),
    (fig02.rule_regions, {"hopf": 1.1, "end": 1.8, "seen": ((True, True),),
                          "expected": ((True, True),)}, HOLDS,
     [({"seen": ((True, False),)}, FAILS), ({"end": 1.0}, FAILS)]),
    (fig02.rule_subcritical, {"ratios": (0.99, 0.999, 0.9999), "repels": (True, True)}, HOLDS,
     [({"ratios": (0.9, 0.9, 0.9)}, FAILS), ({"repels": (True, False)}, FAILS)]),
    (fig02.rule_friction_law, {"printed": (1.5, 1.0), "corrected": (1.0, 0.5),
                               "required": (1.0, 0.5), "slope_gap": 0.0, "reference_gap": 0.0},
     CORRECTED,
     [({"reference_gap": 5e-10}, FAILS),
      ({"printed": (1.0, 0.5)}, HOLDS),
      ({"corrected": (1.1, 0.5)}, FAILS), ({"slope_gap": 5e-7}, FAILS)]),
    (fig02.rule_stick, {"gap": 1e-9, "largest": 0.99, "at_release": 1e-12}, HOLDS,
     [({"largest": 1.01}, FAILS), ({"at_release": 5e-6}, FAILS), ({"gap": 5e-6}, FAILS)]),
    (fig02.rule_switch_model, {"defaults": 2e-3, "tight": 1e-6}, HOLDS,
     [({"defaults": 0.02}, FAILS), ({"tight": 0.02}, FAILS)]),
    (fig03.rule_superimposed, {"stuck": (15, 16, 17), "apart": 0.015, "gap": 1e-9}, HOLDS,
     [({"apart": 0.03}, FAILS), ({"stuck": (14, 15, 16, 17)}, FAILS), ({"gap": 0.1}, FAILS)]),
    (fig03.rule_vanishing, {"stuck": (15, 16, 17), "beside": (0.01, 0, 0), "core": 1.4,
                            "gap": 1e-9}, HOLDS,
     [({"beside": (0.2, 0.03, 0.003)}, PARTLY), ({"stuck": (15, 16, 17, 18)}, FAILS),
      ({"gap": 0.1}, FAILS)]),
    (fig03.rule_front, {"arrived": (6, 11, 15), "trailing": (1.0, 2.0), "ahead": (0.01, 0.02),
                        "gap": 1e-8}, HOLDS,
     [({"arrived": (6, 6, 15)}, FAILS), ({"ahead": (0.01, 0.5)}, FAILS), ({"gap": 0.1}, FAILS)]),
    (fig04.rule_edge, {"gap": 1e-6, "apart": 1e-6, "falls": (38.8, 38.8)}, HOLDS,
     [({"falls": (38.8, 30.0)}, FAILS), ({"falls": (50.0,)}, FAILS), ({"apart": 1e-3}, FAILS),
      ({"gap": 0.5}, FAILS)]),
    (fig04.rule_bulk, {"gap": 1e-6, "apart": 1e-6, "bulk_rest": 0.03, "bulk_fall": 0.05}, HOLDS,
     [({"bulk_fall": 0.16}, PARTLY), ({"bulk_rest": 0.2}, FAILS), ({"gap": 0.5}, FAILS),
      ({"apart": 1e-3}, FAILS)]),
    (fig04.rule_divides, {"below": (1, 3, 1, 3, 7), "left": 2, "gap": 1e-6}, HOLDS,
     [({"below": (1, 3, 1, 3, 8)}, FAILS), ({"left": 3}, FAILS), ({"left": 28}, FAILS),
      ({"gap": 0.5}, FAILS)]),
    (fig05.rule_map, {"counts": STATES, "widths": (3, 1, 0), "highest": 0.02, "gap": 1e-8,
                      "seen": (7, 1, 1), "undecided": 1, "points": 100}, HOLDS,
     [({"counts": {"front": 9}}, FAILS), ({"widths": (1, 3, 0)}, FAILS),
      ({"widths": (1, 1, 0)}, HOLDS),
      ({"widths": (3, 1, 1)}, FAILS), ({"highest": 0.08}, FAILS), ({"gap": 0.5}, FAILS),
      ({"seen": (7, 2, 1)}, FAILS), ({"undecided": 20}, FAILS)]),
    (fig05.rule_lasting, {"active": (31, 31, 0, 0), "gap": 1e-8}, HOLDS,
     [({"active": (31, 9, 0, 0)}, FAILS), ({"active": (0, 0, 0, 31)}, FAILS),
      ({"active": (31, 0, 31, 0)}, FAILS), ({"active": (0,) * 4}, FAILS),
      ({"active": (31,) * 4}, FAILS), ({"active": (31, 0, 0, 0)}, HOLDS),
      ({"active": (31, 31, 31, 0)}, HOLDS), ({"gap": 0.5}, FAILS)]),
    (fig06.rule_linear, {"residual": 0.009, "gap": 1e-8}, HOLDS,
     [({"residual": 0.03}, FAILS), ({"gap": 0.5}, FAILS)]),
    (fig06.rule_rapid, {"slopes": (2.1, 0.9), "gap": 1e-8}, HOLDS,
     [({"slopes": (1.0, 0.9)}, FAILS), ({"gap": 0.5}, FAILS)]),
    (fig06.rule_no_propagation, {"arrived": (1, 1), "threshold": 0.0106, "gap": 1e-6}, HOLDS,
     [({"arrived": (1, 2)}, FAILS), ({"threshold": 0.009}, FAILS), ({"threshold": 0.01}, FAILS),
      ({"gap": 0.5}, FAILS)]),
    (fig07.rule_localised, {"gap": 1e-9, "stable": True, "orbit": ORBIT}, HOLDS,
     [({"gap": 5e-4}, FAILS), ({"stable": False}, FAILS), ({"orbit": ORBIT + 0.1}, FAILS)]),
    (fig07.rule_decay, {"gap": 1e-9, "rate": -2.3, "off": 0.004}, HOLDS,
     [({"off": 0.04}, FAILS), ({"rate": -0.1}, FAILS), ({"gap": 5e-4}, FAILS)]),
    (fig08.rule_amplitudes, {"closing": 1e-11, "off": (0.003, 0.046)}, HOLDS,
     [({"off": (0.003, 0.1)}, FAILS), ({"closing": 5e-6}, FAILS)]),
    (fig08.rule_assumptions, {"averaged": 1e-11, "orders": (1.0, 1.0), "share": 0.015,
                              "turn": 0.003}, HOLDS,
     [({"share": 0.2}, FAILS), ({"turn": 0.2}, FAILS), ({"averaged": 1e-3}, FAILS),
      ({"orders": (0.5, 1.0)}, FAILS)]),
    (fig08.rule_neglected, {"averaged": 1e-11, "orders": (1.0, 1.0), "neglected": 0.02}, HOLDS,
     [({"neglected": 0.2}, FAILS), ({"averaged": 1e-3}, FAILS)]),
    (fig09.rule_multipliers, {"gap": 1e-9, "even": 0.1952, "odd": 0.1951, "true_odd": 0.191},
     HOLDS,
     [({"even": 0.1969, "odd": 0.1966}, PARTLY), ({"even": 0.1956, "odd": 0.1953}, PARTLY),
      ({"even": 0.1953, "odd": 0.1956}, PARTLY), ({"even": 0.2}, FAILS), ({"gap": 5e-4}, FAILS)]),
    (fig09.rule_escape, {"gap": 1e-9, "inside": (0.98, 0.98), "outside": (1.01, 1.01)}, HOLDS,
     [({"gap": 1e-2}, FAILS), ({"inside": (1.02, 1.02)}, FAILS),
      ({"outside": (0.9, 0.9)}, FAILS)]),
    (fig10.rule_in_phase, {"localised": True, "gap": 1e-3, "symmetric_change": 1e-3,
                           "end_steps": np.zeros(2)}, HOLDS,
     [({"end_steps": np.full(2, 0.5)}, PARTLY), ({"localised": False}, FAILS),
      ({"symmetric_change": 0.3}, FAILS), ({"gap": 0.3}, FAILS)]),
    (fig11.rule_values,
     {"folds": SimpleNamespace(agree=True, orbit={1: 0.19161, 3: 0.20112}, error=1e-9),
      "exponents": {1: 0.66, 3: 0.66}, "late": {1: 4e-4, 3: 1e-3}, "ratio": 1.1}, HOLDS,
     [({"folds": SimpleNamespace(agree=True, orbit={1: 0.1911, 3: 0.1996}, error=1e-9)},
       CORRECTED),
      ({"folds": SimpleNamespace(agree=True, orbit={1: 0.1911, 3: 0.1996}, error=1e-9),
        "ratio": 5.4}, FAILS),
      ({"folds": SimpleNamespace(agree=True, orbit={1: 0.1911, 3: 0.1996}, error=1e-9),
        "exponents": {1: 0.3, 3: 0.66}}, FAILS),
      ({"folds": SimpleNamespace(agree=True, orbit={1: 0.19161, 3: 0.1996}, error=1e-9)},
       CORRECTED),
      ({"folds": SimpleNamespace(agree=True, orbit={1: 0.1911, 3: 0.1996}, error=1e-9),
        "exponents": {1: 2 / 3 + 0.051, 3: 0.66}}, FAILS),
      ({"folds": SimpleNamespace(agree=True, orbit={1: 0.1911, 3: 0.1996}, error=1e-9),
        "late": {1: 0.0, 3: 1e-3}}, FAILS),
      ({"folds": SimpleNamespace(agree=False, orbit={1: 0.19161, 3: 0.20112}, error=1e-9)},
       FAILS)]),
    (fig11.rule_order, {"agree": True, "orbit": {1: 0.191, 3: 0.1996, 5: 0.1988}}, HOLDS,
     [({"orbit": {1: 0.1999, 3: 0.1996, 5: 0.1988}}, FAILS),
      ({"orbit": {1: 0.1988, 3: 0.1996, 5: 0.1988}}, FAILS),
      ({"orbit": {1: 0.191, 3: 0.1986, 5: 0.1988}}, FAILS), ({"agree": False}, FAILS)]),
    (fig11.rule_converged, {"agree": True, "spread": 4e-5, "step": 8e-4}, HOLDS,
     [({"spread": 4e-4}, FAILS), ({"step": 1e-5}, FAILS), ({"agree": False}, FAILS)]),
    (fig11.rule_stable, {"solvers_apart": 1e-7, "odd_stable": (3, 5, 7),
                         "growth_mirrored": {3: -0.1, 5: -0.1}}, HOLDS,
     [({"odd_stable": ()}, PARTLY), ({"odd_stable": (3,)}, PARTLY),
      ({"growth_mirrored": {3: -0.1, 5: 0.0}}, HOLDS),
      ({"growth_mirrored": {3: -0.1, 5: 0.01}}, FAILS), ({"solvers_apart": 1e-2}, FAILS)]),
    (fig11.rule_all_lost, {"solvers_apart": 1e-7, "last_stable": (6, 0.1995),
                           "seeded_runs": (41, 41), "stable_left": {18: 0.20114}}, HOLDS,
     [({"last_stable": (6, 0.2012)}, FAILS), ({"stable_left": {}}, HOLDS),
      ({"stable_left": {14: 0.20116, 18: 0.20114}}, PARTLY),
      ({"stable_left": {14: fig11.LAST + fig11.CONVERGED}}, PARTLY),
      ({"stable_left": {8: 0.20116, 18: 0.20116}}, FAILS), ({"seeded_runs": (41, 8)}, FAILS),
      ({"seeded_runs": (41, 9)}, HOLDS), ({"solvers_apart": 5e-3}, FAILS)]),
    (fig12.rule_steady, {"velocities": (0.7182, 0.7184), "spread": 0.03, "in_order": True,
                         "gap": 1e-5}, HOLDS,
     [({"velocities": (0.7, 0.72)}, FAILS), ({"spread": 0.2}, FAILS), ({"in_order": False}, FAILS),
      ({"gap": 0.5}, FAILS)]),
    (fig13.rule_scaling, {"residual": 0.01, "exponent": 0.99, "last": (100.0, 100.01),
                          "gap": 1e-6}, HOLDS,
     [({"residual": 0.05}, FAILS), ({"exponent": 0.5}, FAILS), ({"last": (100.0, 110.0)}, FAILS),
      ({"gap": 0.1}, FAILS)]),
    (fig13.rule_law, {"worst": 1e-3, "outrun": True, "settled": [0] * 12, "belt_agrees": True},
     HOLDS,
     [({"belt_agrees": False}, FAILS), ({"worst": 1e-2}, FAILS), ({"outrun": False}, FAILS),
      ({"settled": [0] * 9}, FAILS), ({"settled": [0] * 10}, HOLDS)]),
    (fig14.rule_collapse, {"apart": 1e-5, "scipy_apart": 1e-9, "varies": 5.0}, HOLDS,
     [({"apart": 1.0e-2}, FAILS), ({"scipy_apart": 5e-4}, FAILS), ({"varies": 1.0}, FAILS)]),
    (fig15.rule_map, {"counts": STATES, "same": 95, "points": 100, "undecided": 3,
                      "confirmed": True}, HOLDS,
     [({"confirmed": False}, FAILS), ({"counts": {"front": 9}}, FAILS), ({"same": 50}, FAILS),
      ({"undecided": 30}, FAILS)]),
    (fig15.rule_alike, {"one": set(fig15.CORE), "two": set(fig15.CORE),
                        "first_at": {"I": (1.2, 1.4, 1.8), "II": (0.01, 0.05, 0.13)},
                        "confirmed": True}, HOLDS,
     [({"confirmed": False}, FAILS), ({"one": set(fig15.CORE[:2])}, FAILS),
      ({"two": set(fig15.CORE[:2])}, FAILS),
      ({"first_at": {"I": (1.8, 1.4, 1.2), "II": (0.01, 0.05, 0.13)}}, FAILS)]),
    (fig16.rule_admissible,
     {"phi": np.array([1.0, 0.1]), "zeta": np.array([-1.0, 1.0]), "threshold": 0.4,
      "admissible": True, "chain_gap": 1e-12, "series_gap": 1e-10, "series_error": 1e-9}, HOLDS,
     [({"admissible": False}, FAILS), ({"phi": np.array([0.3, 0.1])}, FAILS),
      ({"phi": np.array([1.0, 0.5])}, FAILS), ({"chain_gap": 1e-3}, FAILS),
      ({"phi": np.array([0.4, 0.1])}, FAILS), ({"phi": np.array([1.0, 0.4])}, FAILS),
      ({"phi": np.array([-1.0, -0.1])}, HOLDS), ({"phi": np.array([1.0, -0.5])}, FAILS),
      *(({"zeta": np.array(zeta), "phi": np.array(phi)}, verdict) for zeta, phi, verdict in (
          ([-2.0, -1.0, 1.0, 2.0], [1.0, 0.3, 0.1, 0.1], FAILS),
          ([-2.0, -1.0, 1.0, 2.0], [1.0, 1.0, 0.1, 0.5], FAILS),
          ([-1.0, 0.5, 1.0], [1.0, 0.1, 0.1], HOLDS),
          ([-1.0, 0.5, 1.5], [1.0, 0.9, 0.1], FAILS),
          ([-1.0, 0.0, 1.0], [1.0, 0.4, 0.1], HOLDS),  # where (47) has the equality
      )),
      ({"series_gap": 1e-3}, FAILS)]),
    (fig16.rule_limits,
     {"behind": 1e-12, "ahead": 1e-15, "bounds": (1e-10, 1e-12), "chain_behind": 1e-11,
      "chain_gap": 1e-12, "series_gap": 1e-10, "series_error": 1e-9}, HOLDS,
     [({"behind": 5e-9}, FAILS), ({"ahead": 5e-9}, FAILS), ({"chain_behind": 5e-6}, FAILS),
      ({"chain_gap": 1e-3}, FAILS)]),
    (fig17.rule_scaling, {"gap": 1e-12, "series_gap": 1e-9, "last": 0.99}, HOLDS,
     [({"last": 0.5}, FAILS), ({"last": 0.9}, FAILS), ({"gap": 5e-7}, FAILS),
      ({"series_gap": 5e-3}, FAILS)]),
    (fig17.rule_implicit, {"gap": 1e-12, "above": 1}, HOLDS,
     [({"gap": 5e-7}, FAILS), ({"above": 0}, FAILS)]),
    (fig17.rule_admissibility, {"runs": 7, "gap": 1e-12, "reached": (False,)}, HOLDS,
     [({"gap": 5e-7}, FAILS), ({"reached": (True, False)}, FAILS), ({"runs": 2}, FAILS)]),
    (fig18.rule_alike, {"simplified": (0.6, 0.2), "averaged": (1.1, 0.4), "gap": 1e-12,
                        "scipy_gap": 1e-9}, HOLDS,
     [({"simplified": (0.2, 0.6)}, FAILS), ({"averaged": (0.4, 1.1)}, FAILS),
      ({"simplified": (0.6, 0.6)}, FAILS), ({"gap": 5e-6}, FAILS), ({"scipy_gap": 1e-2}, FAILS)]),
    (fig18.rule_any_set, {"rows": ((0.5, 0.03, 1, 0.3, "steady"),), "gap": 1e-12}, HOLDS,
     [({"rows": ((0.5, 0.03, 1, 0.3, "steady"), (0.3, 0.03, 0, None, "pinned"))}, PARTLY),
      *(({"rows": ((0.5, 0.03, 1, 0.3, "steady"), (0.3, 0.03, 0, v, "retreating"))}, PARTLY)
        for v in (-0.1, 0.0)),
      ({"rows": ((0.5, 0.03, 1, None, "pinned"),)}, FAILS), ({"gap": 5e-6}, FAILS)]),
    (fig18.rule_explicit, {"gap": 1e-16, "bound": 1e-14, "strong": (0.74, 0.7401), "weak": 1.0,
                           "rest": 1e-5}, PARTLY,
     [({"gap": 1e-3}, FAILS), ({"weak": 2.0}, HOLDS), ({"rest": 0.5}, HOLDS),
      ({"weak": 0.5}, HOLDS), ({"rest": 0.01}, HOLDS), ({"rest": 0.0099}, PARTLY),
      *(({"strong": strong}, HOLDS) for strong in ((0.74, 0.8), (0.8, 0.74)))]),
    (text_friction.rule_spring, {"right": 1e-16, "printed": 0.1}, CORRECTED,
     [({"printed": 0.0}, HOLDS), ({"right": 5e-10}, FAILS), ({"printed": 5e-10}, FAILS),
      ({"printed": 1e-4}, FAILS)]),
    (text_friction.rule_length, {"right": 1e-10, "printed": 0.1}, CORRECTED,
     [({"printed": 0.0}, HOLDS), ({"right": 5e-6}, FAILS),
      ({"right": 0.1, "printed": 5e-6}, FAILS)]),
    (text_friction.rule_ends, {"free": 1e-18}, HOLDS, [({"free": 5e-10}, FAILS)]),
    (text_friction.rule_trapezoid, {"drift": 1e-13, "factor": 1e-16}, HOLDS,
     [({"drift": 5e-8}, FAILS), ({"factor": 5e-8}, FAILS)]),
    (text_friction.rule_patterns, {"kept": 5, "ends": {1.05: 1, 1.95: 1}, "gap": 1e-9}, HOLDS,
     [({"kept": 4}, FAILS), ({"ends": {1.05: 5, 1.95: 1}}, FAILS), ({"gap": 0.5}, FAILS)]),
    (text_friction.rule_nucleation,
     {"ends": {"held", "front"}, "outward": (True,) * 9, "gap": 1e-8}, HOLDS,
     [({"ends": {"held"}}, FAILS), ({"outward": (True, True, False)}, FAILS),
      ({"outward": (True, True)}, FAILS), ({"outward": (True,) * 3}, HOLDS),
      ({"gap": 0.5}, FAILS)]),
    (text_vdp.rule_cells,
     {"rest": (0.97, 0.5), "inner": ((1.4, 1.05), (1.2, 1.1)),
      "outer": ((2.8, 0.8), (2.5, 0.7)), "predicted": 1e-3,
      "friction_inner": (0.64, 1.13), "friction_inside": True, "friction_outside": True,
      "sticks": True}, HOLDS,
     [({"rest": (1.1, 0.5)}, FAILS), ({"inner": ((1.4, 0.9), (1.2, 1.1))}, FAILS),
      ({"outer": ((2.8, 1.2), (2.5, 0.7))}, FAILS), ({"friction_inner": (0.64, 0.9)}, FAILS),
      ({"sticks": False}, FAILS), ({"friction_inside": False}, FAILS),
      ({"friction_outside": False}, FAILS),
      ({"predicted": 0.2}, FAILS)]),
    (text_vdp.rule_small, {"ripple": (0.01, 0.04), "orders": (1.0, 1.0)}, HOLDS,
     [({"ripple": (0.01, 0.4)}, FAILS), ({"orders": (0.2, 1.0)}, FAILS)]),
    (text_vdp.rule_substitution, {"has_wave": {10: False, 11: True, 15: True}, "same": True},
     CORRECTED,
     [({"has_wave": {10: True, 11: True, 15: True}}, HOLDS),
      ({"has_wave": {10: False, 11: False, 15: True}}, FAILS),
      ({"has_wave": {10: False, 11: True, 15: False}}, FAILS), ({"same": False}, FAILS)]),
    (text_vdp.rule_extraction, {"gap": 1e-12}, HOLDS, [({"gap": 5e-6}, FAILS)]),
    (text_vdp.rule_uniquely, {"gap": 1e-12, "number": 1}, HOLDS,
     [({"number": 4}, PARTLY), ({"gap": 5e-6}, FAILS)]),
    (text_vdp.rule_unknowns, {"names": ("R", "k_1", "omega_1")}, HOLDS,
     [({"names": ("R",)}, FAILS)]),
    (text_vdp.rule_displays, {"wave": 0.0, "envelope": 1e-10}, HOLDS,
     [({"wave": 5e-10}, FAILS), ({"envelope": 5e-6}, FAILS)]),
    (text_nuclei.rule_to_larger,
     {"confirmed": True, "gap": 0.01, "ripple": 0.05,
      "ends": {k: {0.193: "larger nucleus", 0.203: "front"} for k in (None, 1, 2)}}, HOLDS,
     [({"ends": {None: {0.193: "larger nucleus", 0.203: "front"}, 1: {0.193: "creep"},
                 2: {0.193: "creep"}}}, PARTLY),
      ({"ends": {None: {0.193: "larger nucleus", 0.203: "front"},
                 1: {0.193: "larger nucleus", 0.203: "front"}, 2: {0.193: "creep"}}}, PARTLY),
      ({"confirmed": False}, FAILS), ({"gap": 0.5}, FAILS),
      ({"ends": {k: {0.193: "front"} for k in (None, 1, 2)}}, FAILS)]),
    (text_simplified.rule_gauge, {"order": 1.0, "gaps": (0.04, 0.02, 0.01)}, HOLDS,
     [({"order": 0.3}, FAILS), ({"gaps": (0.4, 0.3, 0.2)}, FAILS)]),
    (text_simplified.rule_equilibria, {"rest": 1e-9, "cycle": 1e-9, "rates": (0.5, 0.5),
                              "envelope_rates": (0.5, 3.0)}, HOLDS,
     [({"rest": 5e-4}, FAILS), ({"cycle": 5e-4}, FAILS), ({"envelope_rates": (0.5, -1.0)}, FAILS)]),
    (text_simplified.rule_quantitative, {"gap": 1e-12, "ratio": 1.8}, HOLDS,
     [({"ratio": 1.01}, FAILS), ({"gap": 5e-6}, FAILS)]),
    (text_simplified.rule_captions, {"averaged": 0.72, "averaged_error": 1e-6, "kinetic": 0.39,
                            "gap": 1e-12}, CORRECTED,
     [({"averaged": 0.39}, HOLDS), ({"gap": 5e-6}, FAILS)]),
    (eqs.rule, {"number": 8, "kind": "holds", "passes": True, "derived_passes": True,
                "confirmed": True, "style": "", "numbers_agree": True}, HOLDS,
     [({"numbers_agree": False}, FAILS),
      ({"passes": False}, FAILS), ({"confirmed": False}, FAILS), ({"derived_passes": False}, FAILS),
      ({"passes": False, "kind": "misprint"}, CORRECTED),
      ({"passes": False, "kind": "misprint", "style": "< for ≤."}, HOLDS),
      ({"passes": False, "kind": "misprint", "style": "x.", "number": 33}, CORRECTED)]),
    (expectations.rule, {"reason": "the sense is not given."}, Verdict.UNTESTABLE, []),
]  # fmt: skip


def _name(case: tuple[Any, ...]) -> str:
    return f"{case[0].__module__.rpartition('.')[2]}.{case[0].__name__}"


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_a_rule_gives_its_verdict_and_loses_it_on_changed_evidence(case: tuple[Any, ...]) -> None:
    rule, good, verdict, changes = case
    assert rule(SimpleNamespace(**good)).verdict is verdict
    for change, other in changes:
        assert rule(SimpleNamespace(**good | change)).verdict is other, change


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_every_part_of_the_evidence_that_a_rule_reads_is_changed_once(
    case: tuple[Any, ...],
) -> None:
    rule, good, _, changes = case
    words = ("number", "kind", "expected", "required", "zeta", "threshold", "core", "series_error",
             "ripple", "bound", "bounds", "points", "true_odd", "averaged_error", "kinetic",
             "reason", "late", "trailing", "hopf", "strong", "rates", "stuck", "two",
             "friction_outside", "confirmed", "gap", "orders", "series_gap", "chain_gap", "apart",
             "odd", "even")  # fmt: skip
    changed = {name for change, _ in changes for name in change}
    assert set(good) - changed <= set(words), rule


def _claims() -> list[Claim]:
    return [entry.claim for entry in find_entries()]


def test_what_cannot_be_judged_says_why_and_remarks_on_it_in_a_sentence_of_its_own() -> None:
    for claim in expectations.CLAIMS:
        missing: Any = claim.evidence()
        assert missing.reason[0].islower()  # it follows the verdict
        assert not missing.remark[:1].islower()


def test_every_rule_of_a_claim_is_tested() -> None:
    tested = {case[0] for case in CASES}
    assert {claim.rule for claim in _claims()} <= tested


def test_rules_are_a_few_lines() -> None:
    for claim in _claims():
        assert len(inspect.getsource(claim.rule).splitlines()) <= 20, claim.key


@pytest.mark.parametrize(
    ("verdict", "because", "part"),
    [
        (Verdict.PARTIAL, "it fails.", ""),
        (Verdict.PARTIAL, "", "some words"),
        (Verdict.NOT_REPRODUCED, "", ""),
        (Verdict.NOT_REPRODUCED, "It fails. And more.", ""),
        (Verdict.NOT_REPRODUCED, "it fails.", "some words"),
        (Verdict.CORRECTED, "no stop", ""),
        (Verdict.REPRODUCED, "for no reason.", ""),
        (Verdict.REPRODUCED, "", "some words"),
    ],
)
def test_a_ruling_needs_its_reason_in_one_sentence_and_its_part(
    verdict: Verdict, because: str, part: str
) -> None:
    with pytest.raises(ValueError, match=r"reproduced|because|part"):
        Ruling(verdict, because, part)


def test_partly_names_words_of_the_quote() -> None:
    quotes = {claim.rule: claim.quote.replace("$", "") for claim in _claims()}
    for rule, good, verdict, changes in CASES:
        for change, other in [({}, verdict), *changes]:
            if other is PARTLY:
                part = rule(SimpleNamespace(**good | change)).part
                assert part.replace("$", "") in quotes[rule], rule
