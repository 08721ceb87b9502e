"""The table of hard cases, from which the tests (tests/test_hard.py), docs/evidence/hard-cases.md and the long forms
are made."""
from hard import conversions, facets, far, meeting, ratios, solids, steps, strength, turning, zones

FAMILIES = {
    "Bodies that turn": turning.CASES,
    "Masses, sizes, stiffnesses": ratios.CASES,
    "Contacts that begin and end": meeting.CASES,
    "A step for what is not there yet": steps.CASES,
    "Triangles": facets.CASES,
    "Far, slow, fast, quiet": far.CASES,
    "Laws and values at their ends": strength.CASES,
    "Finite elements": solids.CASES,
    "Particles and elements as one": zones.CASES + conversions.CASES,
}
CASES = [case for cases in FAMILIES.values() for case in cases]
NAMES = [case.name for case in CASES]
assert len(set(NAMES)) == len(NAMES), sorted(name for name in NAMES if NAMES.count(name) > 1)
