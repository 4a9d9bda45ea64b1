"""Holds what is drawn from seeds 1 to 200 against what scripts/prove wild promises. Pure Python, without Blender."""

import collections
import math

import draw
import effects
import library


def main():
    plans = [draw.draw(seed) for seed in range(1, 201)]
    assert plans[:20] == [draw.draw(seed) for seed in range(1, 21)], "a seed gives one case"
    assert set(effects.ALL) == set(library.RIGHT), "every effect has its line in right.json"
    for hundred in (plans[:100], plans[100:]):
        count = collections.Counter(len(plan["effects"]) for plan in hundred)
        assert 30 <= count[0] <= 37 and count[2] >= 12, count
        there = {e["name"] for plan in hundred for e in plan["effects"]}
        assert len(there) >= 0.9 * len(effects.ALL), set(effects.ALL) - there
    assert len({o["mesh"]["kind"] for plan in plans for o in plan["objects"]}) >= 30
    for plan in plans:
        assert 2 <= len(plan["cameras"]) <= 5 and 1 <= len(plan["lamps"]) <= 4 and 4 <= len(plan["pictures"]) <= 16
        assert 1 <= len(plan["objects"]) <= 4
        for lamp in plan["lamps"]:
            seen = lamp["kind"] != "sun" and any(draw.in_view(lamp["position_m"], c, 0) for c in plan["cameras"])
            assert not seen, "no lamp stands in a picture"
        kinds = [lamp["kind"] for lamp in plan["lamps"]]
        for value in (v for e in plan["effects"] for v in library.values(e, kinds, 1.0)):
            assert math.isfinite(value["value"]), value
    print("200 seeds hold")


main()
