//! Small worlds that users could describe, for comparisons of chains with weighted draws of the prior.

pub(crate) const BALL: &str = "[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\n";

/// Small worlds: settings of the world, what follows the ball's shape, and what is required. Scales are wide, so that
/// the prior reaches what is asked for.
pub(crate) const CASES: &[[&str; 3]] = &[
    [
        "duration_s = 0.6",
        "at_mm = [0, 0, 300]\nvelocity_m_s = [{ normal = [1, 0.3] }, { uniform = [-0.5, 0.5] }, 0]",
        "passes = { x_mm = 400, y_mm = 100, z_mm = 150, within_mm = 30, scale_mm = 60 }",
    ],
    [
        "duration_s = 0.6\n[[world.custom.materials]]\nname = 'rubber'\nrestitution = { triangular = [0.2, 0.5, 1] }",
        "material = 'rubber'\nat_mm = [0, 0, { uniform = [150, 400] }]",
        "path_length = { at_least_mm = 420, scale_mm = 50 }",
    ],
    [
        "duration_s = 0.5",
        "at_mm = [0, 0, { log_normal = { median = 250, spread = 0.3 } }]\n\
         velocity_m_s = [0, 0, { truncated = { mean = 0, sd = 1, from = -1, to = 0.5 } }]",
        "impact = { when = { at_s = 0.2, within_ms = 10, scale_ms = 30 } }",
    ],
    [
        "duration_s = 0.5\n[[world.custom.fixed]]\nname = 'ramp'\nshape = { box = { size_mm = [400, 400, 20] } }\n\
         turn_deg = [0, { von_mises = { mean = 10, concentration = 20 } }, 0]",
        "at_mm = [{ normal = [0, 20] }, 0, 200]",
        "inside = { x_mm = [50, 200], how = 'at_end', scale_mm = 60 }",
    ],
    [
        "duration_s = 0.5\ngravity = 0\n[[world.custom.quantities]]\nname = 'heading'\n\
         value = { von_mises = { mean = 170, concentration = 2 } }",
        "at_mm = [0, 0, 200]\nvelocity_m_s = ['cos(heading)', 'sin(heading)', 0]",
        "passes = { x_mm = -300, y_mm = -200, z_mm = 200, within_mm = 40, scale_mm = 60 }",
    ],
    [
        "duration_s = 0.5",
        "at_mm = [0, 0, 200]\nvelocity_m_s = [{ choice = { of = [0.5, 1, 2], weights = [1, 2, 3] } }, 0, 0]\n\
         spin_deg_s = [0, { normal = [0, 1000] }, 0]",
        "speed = { after = true, at_most = 1.3, scale = 0.3 }",
    ],
    [
        "duration_s = 0.5\n[[world.custom.quantities]]\nname = 'push'\nvalue = { uniform = [0.2, 1.4] }\n\
         [[world.custom.bodies]]\nname = 'other'\nshape = { ball = { radius_mm = { uniform = [15, 45] } } }\n\
         at_mm = [300, 0, 45]\nvelocity_m_s = ['push', 0, 0]",
        "at_mm = [0, 0, 30]\nvelocity_m_s = ['push', { normal = [0, 0.2] }, 0]",
        "relative = { body = 'ball', to = 'other', x_mm = -330, y_mm = 60, within_mm = 20, scale_mm = 40 }",
    ],
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'brick'\nany_turn = true\npips = true\n\
         shape = { box = { size_mm = [30, 50, 80] } }\nat_mm = [500, 0, { uniform = [80, 200] }]",
        "at_mm = [0, 0, 100]",
        "all = [{ faces_up = { body = 'brick', axis = 'z', within_deg = 30, scale_deg = 30, when = { at_s = 0.05 } } },\
         { sum = { of = 'brick', at_most = 4, when = { at_s = 0.05 } } }]",
    ],
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'other'\nshape = { ball = { radius_mm = 40 } }\n\
         at_mm = [{ uniform = [-100, 100] }, 0, 100]",
        "at_mm = [60, { normal = [0, 80] }, 100]\nvelocity_m_s = [0, { normal = [0, 0.3] }, 0]",
        "touches = { body = 'ball', with = 'other' }",
    ],
    // A camera, past a screen.
    [
        "duration_s = 0.3\n[[world.custom.fixed]]\nname = 'screen'\nshape = { box = { size_mm = [60, 10, 400] } }\n\
         at_mm = [100, -500, 200]",
        "at_mm = [0, { normal = [0, 50] }, 100]\nvelocity_m_s = [{ uniform = [-1, 1] }, 0, 0]",
        "in_view = { camera = { at_mm = [0, -2000, 100], look_at_mm = [150, 0, 100], fov_deg = 8 }, scale = 0.3, \
         scale_deg = 2, when = { at_s = 0.2 } }",
    ],
    // Impacts that scatter, and nothing else that is uncertain.
    [
        "duration_s = 0.6\n[[world.custom.materials]]\nname = 'rubber'\nrestitution = 0.7\n\
         scatter = { normal_deg = 6, restitution = 0.2 }",
        "material = 'rubber'\nat_mm = [0, 0, 150]\nvelocity_m_s = [0.5, 0, 0]",
        "passes = { x_mm = 250, y_mm = 100, z_mm = 60, within_mm = 20, scale_mm = 40 }",
    ],
    // Impacts that scatter, in throws that moves lead.
    [
        "duration_s = 0.7\n[[world.custom.materials]]\nname = 'rubber'\nrestitution = 0.7\n\
         scatter = { normal_deg = 3, restitution = 0.1 }",
        "material = 'rubber'\nat_mm = [{ normal = [0, 50] }, { normal = [0, 50] }, 150]\n\
         velocity_m_s = [{ normal = [0.5, 0.3] }, { normal = [0, 0.3] }, 0]",
        "inside = { x_mm = [300, 400], y_mm = [60, 160], how = 'at_end', scale_mm = 80 }",
    ],
    // Arithmetic: laws within formulas, and a shared quantity that two numbers depend on.
    [
        "duration_s = 0.5\n[[world.custom.quantities]]\nname = 'push'\nvalue = 'max(0.2, normal(0.8, 0.4))'",
        "at_mm = [0, 0, '100 + 50 * push * uniform(0.5, 1.5)']\n\
         velocity_m_s = ['push', 'normal(0, 0.2) - 0.1 * push', 0]",
        "passes = { x_mm = 300, y_mm = 0, z_mm = 100, within_mm = 40, scale_mm = 80 }",
    ],
    // An array whose members each have a number of their own.
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'marble'\ncount = 3\n\
         shape = { ball = { radius_mm = 'uniform(8, 12) + 2 * i' } }\n\
         at_mm = ['80 * (i + 1)', { normal = [0, 10] }, 'uniform(40, 80)']",
        "at_mm = [0, 0, 31]\nvelocity_m_s = [{ uniform = [0, 2] }, 0, 0]",
        "relative = { body = 'marble_1', to = 'marble_3', y_mm = 15, within_mm = 20, scale_mm = 40 }",
    ],
    // Forces and damping are uncertain.
    [
        "duration_s = 0.5",
        "at_mm = [0, 0, 200]\nvelocity_m_s = [1, 0, 0]\ngravity_scale = { uniform = [-0.5, 1] }\n\
         damping = { uniform = [0, 3] }\nforce_n = [0, { normal = [0, 0.3] }, 0]",
        "passes = { x_mm = 300, y_mm = 60, z_mm = 150, within_mm = 30, scale_mm = 60 }",
    ],
    // A table with random bumps and friction, which alone decide where the ball goes.
    [
        "duration_s = 0.45\n[[world.custom.fixed]]\nname = 'table'\nat_mm = [0, 0, { normal = [0, 5] }]\n\
         shape = { table = { bumps_mm = 3, spacing_mm = 30, friction = { mean = 0.4, sd = 0.1 } } }",
        "at_mm = [0, 0, 250]",
        "inside = { x_mm = [40, 300], how = 'at_end', scale_mm = 30 }",
    ],
    // Slanted tables: how the slope lies is uncertain, and so is every bump of it.
    [
        "duration_s = 0.26\n[[world.custom.fixed]]\nname = 'slope'\nturn_deg = [0, { normal = [15, 5] }, 0]\n\
         shape = { table = { bumps_mm = 3, spacing_mm = 30, friction = { mean = 0.4, sd = 0.1 } } }",
        "at_mm = [0, 0, 150]",
        "inside = { y_mm = [20, 300], how = 'at_end', scale_mm = 10 }",
    ],
    // A box with bumps on all its faces, which alone decide where the ball goes.
    [
        "duration_s = 0.24\n[[world.custom.fixed]]\nname = 'block'\nturn_deg = [0, 10, 0]\n\
         shape = { box = { size_mm = [60, 60, 25] } }\nbumps = { sd_mm = 5, spacing_mm = 80 }",
        "at_mm = [0, 0, 130]",
        "inside = { y_mm = [10, 300], how = 'at_end', scale_mm = 6 }",
    ],
    // The hull of a file falls onto the triangles of another; where the triangles are, and how large both shapes are,
    // is uncertain.
    [
        "duration_s = 0.2\n[[world.custom.fixed]]\nname = 'roof'\n\
         shape = { mesh = { file = 'roof.obj', up = 'z', unit_mm = { uniform = [0.8, 1.2] } } }\n\
         at_mm = [{ normal = [0, 60] }, 0, 0]\n\
         [[world.custom.bodies]]\nname = 'wedge'\nany_turn = true\nvelocity_m_s = [0, 0, -1.5]\nat_mm = [0, 0, 200]\n\
         shape = { hull_of = { file = 'wedge.obj', up = 'z', unit_mm = { uniform = [0.7, 1.3] } } }",
        "at_mm = [0, 1000, 100]",
        "passes = { body = 'wedge', x_mm = 40, y_mm = 0, z_mm = 140, within_mm = 10, scale_mm = 20 }",
    ],
    // A compound with an uncertain place and an uncertain weight of a piece.
    [
        "duration_s = 0.15\n[[world.custom.bodies]]\nname = 'hammer'\nat_mm = [0, 1000, 90]\n\
         shape = { compound = { pieces = [\n\
         { shape = { box = { size_mm = [120, 16, 16] } } },\n\
         { shape = { box = { size_mm = [30, 60, 30] } }, at_mm = [{ uniform = [20, 60] }, 0, 0], \
         density = { log_normal = { median = 3, spread = 0.5 } } },\n] } }",
        "at_mm = [0, 0, 100]",
        "passes = { body = 'hammer', x_mm = 45, y_mm = 1000, z_mm = 60, within_mm = 3, scale_mm = 8 }",
    ],
    // A ball that another one, which may not be there, may stop. How likely it is there follows from how far the first
    // one gets.
    [
        "duration_s = 0.5\n[[world.custom.bodies]]\nname = 'other'\npresent = 0.7\n\
         shape = { ball = { radius_mm = 40 } }\nat_mm = [{ uniform = [110, 250] }, 0, 41]",
        "at_mm = [0, 0, 31]\nvelocity_m_s = [{ normal = [1, 0.3] }, { normal = [0, 0.1] }, 0]",
        "inside = { body = 'ball', x_mm = [150, 400], how = 'at_end', scale_mm = 60 }",
    ],
    // Laws whose numbers are uncertain.
    [
        "duration_s = 0.5\n[[world.custom.quantities]]\nname = 'wide'\nvalue = { uniform = [0.1, 0.5] }",
        "at_mm = [0, 0, 'triangular(150, uniform(150, 300), 300)']\n\
         velocity_m_s = ['normal(1, wide)', 'uniform(0 - wide, wide)', 'choice(0, wide)']",
        "passes = { x_mm = 300, y_mm = 60, z_mm = 150, within_mm = 30, scale_mm = 60 }",
    ],
    // A ball that starts on a slope, whose angle is uncertain.
    [
        "duration_s = 0.4\n[[world.custom.fixed]]\nname = 'ramp'\nshape = { box = { size_mm = [400, 200, 20] } }\n\
         turn_deg = [0, { normal = [20, 5] }, 0]",
        "within = { surface = { of = 'ramp', above_mm = 'uniform(31, 60)' } }",
        "inside = { x_mm = [50, 300], how = 'at_end', scale_mm = 60 }",
    ],
    // Three balls, two of which must each go somewhere: what is missed says which variables change more often.
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'other'\ncount = 2\n\
         shape = { ball = { radius_mm = 20 } }\nat_mm = ['200 + 200 * i', { normal = [0, 60] }, 100]",
        "at_mm = [0, { normal = [0, 60] }, 100]",
        "passes = { body = 'ball', x_mm = 0, y_mm = 60, z_mm = 80, within_mm = 30, scale_mm = 30 }\n[[require]]\n\
         passes = { body = 'other_1', x_mm = 200, y_mm = -60, z_mm = 80, within_mm = 30, scale_mm = 30 }",
    ],
    // A ball that starts anywhere within a ball of uncertain radius.
    [
        "duration_s = 0.4",
        "at_mm = [0, 0, 300]\nwithin = { ball = { radius_mm = { uniform = [60, 140] } } }\nvelocity_m_s = [1, 0, 0]",
        "passes = { x_mm = 200, y_mm = 40, z_mm = 150, within_mm = 30, scale_mm = 60 }",
    ],
    // From here on each case is there for a kind of requirement. A ball that rolls to its rest.
    [
        "duration_s = 1\n[[world.custom.materials]]\nname = 'felt'\nrolling = 0.3",
        "material = 'felt'\nat_mm = [0, 0, 30]\nvelocity_m_s = [{ normal = [0.5, 0.15] }, { normal = [0, 0.1] }, 0]",
        "rests_at = { x_mm = 90, y_mm = 20, within_mm = 5, scale_mm = 20 }",
    ],
    [
        "duration_s = 1\n[[world.custom.materials]]\nname = 'felt'\nrolling = 0.3",
        "material = 'felt'\nat_mm = [0, 0, 30]\nvelocity_m_s = [{ normal = [0.5, 0.15] }, { normal = [0, 0.1] }, 0]",
        "rests = { when = { to_s = 0.2, scale_ms = 50 } }",
    ],
    // It starts on a box, and may roll off it.
    [
        "duration_s = 1\n[[world.custom.materials]]\nname = 'felt'\nrolling = 0.3\n\
         [[world.custom.fixed]]\nname = 'step'\nshape = { box = { size_mm = [160, 160, 50] } }\n\
         [[world.custom.fixed]]\nname = 'floor'\nshape = { plane = {} }",
        "material = 'felt'\nat_mm = [0, 0, 55]\nvelocity_m_s = [{ normal = [0.5, 0.2] }, { normal = [0, 0.1] }, 0]",
        "rests_on = { body = 'ball', on = 'floor' }",
    ],
    [
        "duration_s = 0.7\n[[world.custom.materials]]\nname = 'rubber'\nrestitution = { uniform = [0.2, 0.9] }",
        "material = 'rubber'\nat_mm = [0, 0, { uniform = [80, 400] }]",
        "bounces = { at_least = 3, nats_each = 1.5 }",
    ],
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'other'\nshape = { ball = { radius_mm = 20 } }\n\
         at_mm = [300, 0, { uniform = [60, 300] }]",
        "at_mm = [0, 0, { triangular = [60, 150, 400] }]",
        "before = { first = { body = 'other' }, then = { body = 'ball' }, by_ms = 30, scale_ms = 40 }",
    ],
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'other'\nshape = { ball = { radius_mm = 20 } }\n\
         at_mm = [300, 0, { uniform = [60, 300] }]",
        "at_mm = [0, 0, { triangular = [60, 150, 400] }]",
        "apart = { one = { body = 'other' }, other = { body = 'ball' }, at_most_ms = 10, scale_ms = 30 }",
    ],
    [
        "duration_s = 0.5",
        "at_mm = [0, 0, { uniform = [60, 400] }]\nvelocity_m_s = [0, 0, { normal = [0, 0.5] }]",
        "beats = { every_s = 0.2, within_ms = 10, scale_ms = 30, each = 'impact', faster_than = 0.3 }",
    ],
    [
        "duration_s = 0.4",
        "at_mm = [0, 0, 100]\nvelocity_m_s = [{ uniform = [0, 1] }, { normal = [0, 0.2] }, { normal = [0, 0.5] }]",
        "spin = { after = true, at_least = 15, scale = 5 }",
    ],
    [
        "duration_s = 0.4",
        "at_mm = [0, 0, { uniform = [60, 400] }]\nvelocity_m_s = [0, 0, { normal = [0, 0.5] }]",
        "impulse = { at_most = 0.25, scale = 0.2 }",
    ],
    [
        "duration_s = 0.6",
        "at_mm = [0, 0, { uniform = [60, 400] }]\nvelocity_m_s = [0, 0, { normal = [0, 0.5] }]",
        "air_time = { at_most_s = 0.45, scale_ms = 50 }",
    ],
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'brick'\nany_turn = true\n\
         shape = { box = { size_mm = [30, 50, 80] } }\nat_mm = [500, 0, { uniform = [80, 200] }]",
        "at_mm = [0, 0, 100]",
        "stands = { body = 'brick', within_deg = 30, scale_deg = 30, when = { at_s = 0.05 } }",
    ],
    [
        "duration_s = 0.3\n[[world.custom.bodies]]\nname = 'brick'\nany_turn = true\n\
         shape = { box = { size_mm = [30, 50, 80] } }\nat_mm = [500, 0, { uniform = [80, 200] }]\n\
         spin_deg_s = [0, 0, { normal = [0, 500] }]",
        "at_mm = [0, 0, 100]",
        "all = [{ points = { body = 'brick', axis = 'y', toward = [1, 0, 1], within_deg = 30, scale_deg = 40, \
         when = { at_s = 0.1 } } }, { turns = { body = 'brick', at_least = 0.2, scale = 0.1, when = { to_s = 0.1 } } }]",
    ],
    [
        "duration_s = 0.3\n[[world.custom.bodies]]\nname = 'brick'\nany_turn = true\n\
         shape = { box = { size_mm = [30, 50, 80] } }\nat_mm = [500, 0, { uniform = [80, 200] }]",
        "at_mm = [0, 0, 100]",
        "orientation = { body = 'brick', turn_deg = [0, 30, 90], within_deg = 60, scale_deg = 60 }",
    ],
    // Two planks that lean, and fall one after the other.
    [
        "duration_s = 0.5\n[[world.custom.bodies]]\nname = 'plank'\ncount = 2\n\
         shape = { box = { size_mm = [20, 60, 100] } }\nat_mm = ['200 * i + 200', 0, 60]\n\
         turn_deg = [0, { uniform = [15, 40] }, 0]\nspin_deg_s = [0, { uniform = [0, 100] }, 0]",
        "at_mm = [0, 0, 100]",
        "all = [{ order = { bodies = ['plank_2', 'plank_1'], each = { what = 'fall' }, scale_ms = 60 } }, \
         { falls = { body = 'plank_*', when = { from_s = 0.15, scale_ms = 60 } } }]",
    ],
    [
        "duration_s = 0.4",
        "at_mm = [0, 0, 100]\nvelocity_m_s = [{ normal = [0, 0.5] }, 0, { normal = [1, 0.5] }]",
        "all = [{ height = { at_least_mm = 180, at_most_mm = 200, scale_mm = 30 } }, \
         { speed = { at_least = 0.3, scale = 0.2, which = 'least', when = { to_s = 0.1 } } }]",
    ],
    // A ball that may knock over either of two pins.
    [
        "duration_s = 0.5\n[[world.custom.bodies]]\nname = 'pin'\ncount = 2\n\
         shape = { box = { size_mm = [24, 24, 80] } }\nat_mm = [150, '80 * i - 40', 40]",
        "at_mm = [0, { normal = [0, 40] }, 30]\nvelocity_m_s = [{ normal = [1.5, 0.5] }, 0, 0]",
        "leaves = { pins = [2], within_deg = 30, nats_each = 1.5 }",
    ],
    // A shelf whose weld a ball may break.
    [
        "duration_s = 0.35\nfixed = []\n[[world.custom.bodies]]\nname = 'shelf'\n\
         shape = { box = { size_mm = [200, 100, 10] } }\n\
         [[world.custom.joints]]\nname = 'glue'\nbody = 'shelf'\nat_mm = [-100, 0, 0]\n\
         kind = { weld = { breaks_at_n_s = { uniform = [0.1, 0.6] } } }",
        "at_mm = [0, 0, { uniform = [60, 400] }]",
        "named = { name = 'it gives way', that = { breaks = { joint = 'glue' } } }",
    ],
    // Combinations.
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'marble'\ncount = 3\n\
         shape = { ball = { radius_mm = 10 } }\nat_mm = ['80 * (i + 1)', { normal = [0, 40] }, 60]",
        "at_mm = [0, 0, 31]",
        "count = { of = 'marble_*', at_least = 2, \
         that = { inside = { y_mm = [20, 300], how = 'at_end', scale_mm = 20 } } }",
    ],
    [
        "duration_s = 0.4",
        "at_mm = [0, 0, 200]\nvelocity_m_s = [{ normal = [0, 0.5] }, { normal = [0, 0.5] }, 0]",
        "any = [{ all = [{ inside = { x_mm = [60, 400], how = 'at_end', scale_mm = 40 } }, \
         { not = { inside = { y_mm = [-400, 0], how = 'at_end', scale_mm = 20 } } }] }, \
         { passes = { x_mm = -100, z_mm = 60, within_mm = 10, scale_mm = 20 } }]",
    ],
    [
        "duration_s = 0.4",
        "at_mm = [0, 0, 200]\nvelocity_m_s = [{ normal = [0, 0.5] }, { normal = [0, 0.5] }, { normal = [0, 0.5] }]",
        "at_least = { count = 2, of = [{ inside = { x_mm = [30, 400], how = 'at_end', scale_mm = 40 } }, \
         { inside = { y_mm = [30, 400], how = 'at_end', scale_mm = 40 } }, \
         { impact = { when = { to_s = 0.15, scale_ms = 40 } } }] }",
    ],
];
