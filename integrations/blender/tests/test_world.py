"""Worlds and the scenarios that they become, as Plaus reads them."""

import math
import tomllib

import numpy as np
import plaus
import pytest
from mathutils import Euler

from plaus_blender import levels, wishes, world
from plaus_blender.shapes import Solid


def box(name, role="body", place=(0, 0, 500), edge=100.0, **keys):
    """A box in mm."""
    place = np.array(place, dtype=float)
    half = np.full(3, edge / 2)
    return world.Thing(name, role, [Solid("box", (edge,) * 3)], place, np.eye(3), place - half, place + half, **keys)


def test_angles_are_turns_about_x_then_y_then_z():
    generator = np.random.default_rng(1)
    for _ in range(100):
        turn = np.array(Euler(generator.uniform(-3, 3, 3)).to_matrix(), dtype=float)
        made = np.array(Euler([math.radians(each) for each in world.angles(turn)]).to_matrix())
        assert np.abs(made - turn).max() < 1e-6
    upright = np.array(Euler((0.4, math.pi / 2, 0.9)).to_matrix(), dtype=float)
    made = np.array(Euler([math.radians(each) for each in world.angles(upright)]).to_matrix())
    assert np.abs(made - upright).max() < 1e-6, "where x and z turn about one axis"


def test_a_scenario_is_what_plaus_reads():
    made = world.World([box("Die", vary={"position": 0.05, "mass": 0.1, "friction": 0.1, "bounce": 0.2})])
    made.things.append(box("Slab", "fixed", (0, 0, -50)))
    wish = wishes.Wish("SIDE_UP", "Die", axis="minus_x", said="Die this side up -X")
    tables = world.scenario(made, [wishes.requirement(wish, made)], seed=7)
    text = world.to_toml(tables)
    assert tomllib.loads(text) == tables
    read = plaus.Scenario.from_text(text).check()
    custom = read["world"]["custom"]
    assert read["sampler"]["seed"] == 7
    [die], [slab] = custom["bodies"], custom["fixed"]
    assert die["at_mm"][0] == {"normal": [0, 50]} and slab["at_mm"] == [0, 0, -50]
    stuff = {each["name"]: each for each in custom["materials"]}
    # A kilogram in a litre; Blender multiplies coefficients, Plaus takes the root of the product.
    assert stuff[die["material"]]["density"]["log_normal"]["median"] == pytest.approx(1000.0)
    assert stuff[slab["material"]]["friction"] == 0.25
    assert stuff[die["material"]]["rolling"] > 0 < stuff[slab["material"]]["spinning"]


@pytest.mark.parametrize("kind", wishes.KINDS)
def test_every_wish_is_a_requirement_that_plaus_accepts(kind):
    made = world.World([box("A", vary={"position": 0.01}), box("B", place=(300, 0, 500))])
    spot = wishes.Place(np.zeros(3), -np.ones(3), np.ones(3), "B")
    wish = wishes.Wish(kind, "A", spot, 20.0, "y", 12, said="some wish")
    assert wishes.lacks(wish, made) == ""
    plaus.Scenario.from_text(world.to_toml(world.scenario(made, [wishes.requirement(wish, made)], 1)))
    if "other" in wishes.KINDS[kind][2]:
        assert "other" in wishes.lacks(wishes.Wish(kind, "A"), made)
    assert "moves" in wishes.lacks(wishes.Wish(kind, "C"), made)


def test_the_bodys_axes_are_known_where_a_shape_lies_across():
    # A cylinder along the object's y axis: the body's z axis is the object's y axis.
    turn = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    can = box("Can")
    can.solids = [Solid("cylinder", (10.0, 50.0), turn=turn)]
    assert can.axis("y") == "z" and can.axis("z") == "minus_y" and can.axis("minus_y") == "minus_z"
    assert np.allclose(can.frame()[0], turn)


def test_a_wide_level_floor_counts_as_ground():
    wide = box("Floor", "fixed", (0, 0, -500), 1000.0)
    made = world.World([box("A", place=(0, 0, 50)), wide])
    assert world.find_ground(made) == "Floor"
    for far in (box("A", place=(600, 0, 50)), box("A", place=(0, 0, -900))):
        assert world.find_ground(world.World([far, wide])) == ""
    step = box("Step", "fixed", (0, 0, -600), 100.0)
    assert world.find_ground(world.World([box("A", place=(0, 0, 50)), wide, step])) == "", "something is below it"


def test_what_stands_varies_on_the_level_only():
    stands, flies = (box("A", place=(0, 0, height), vary={"position": 0.01, "rotation": 10.0}) for height in (50, 500))
    for thing, uncertain in ((stands, 2), (flies, 3)):
        made = world.World([thing, box("Floor", "fixed", (0, 0, -500), 1000.0)])
        [body] = world.scenario(made, [], 1)["world"]["custom"]["bodies"]
        assert sum(isinstance(each, dict) for each in body["at_mm"]) == uncertain
        assert isinstance(body["turn_deg"][2], dict) and isinstance(body["turn_deg"][0], dict) == (uncertain == 3)


def test_names_are_plain_and_differ():
    assert world.plain_name("Cube.001", []) == "Cube_001"
    assert world.plain_name("Cube 001", ["Cube_001"]) == "Cube_001_2"


def test_levels_grow():
    for what in levels.NUMBERS:
        rising = [levels.amount(what, level, 0.0, 0.02, 9.81) for level in levels.LEVELS[:4]]
        assert rising == sorted(rising) and rising[0] == 0.0 < rising[1]
    assert levels.amount("position", levels.OWN, 0.3, 1.0, 9.81) == 0.3
