//! Every tolerance, limit and threshold of the simulator of rigid bodies that the presets do not set
//! ([`Accuracy`](crate::accuracy::Accuracy)): meaning, unit, what is usual, and what goes wrong with other values.
//!
//! None can be set by a user. A length is over a body's size or over the gap at which bodies touch, a speed over what
//! gravity makes on that length, so all hold for a marble and for a rock. To change one, run the laws
//! (`tests/laws_*.rs`), the golden traces, and the examples `contact_cases` and `convergence`.

// Bodies and worlds

/// Overlap at the start that counts as touching, over the size. Danger: larger values start bodies inside each other.
pub(super) const START_OVERLAP: f64 = 1e-6;

/// How far moments of inertia may be off by rounding: 1e-9.
pub(super) const INERTIA_ROUNDING: f64 = 1e-9;

/// Least radius of gyration, in spans: so a cube's span is still its size, which is half of its edge.
pub(super) const SPAN_PER_GYRATION: f64 = 1.2;

/// Maximum number of convex pieces of a body: names of points of contact count them.
pub(super) const MAX_PIECES: usize = 256;

/// How far the length of a plane's normal may be from 1: rounding.
pub(super) const NORMAL_LENGTH_ERROR: f64 = 1e-12;

/// Rounds of [`Table::project`] for a ball: each reduces the error by the ratio of the ball's radius to the surface's
/// radius of curvature.
pub(super) const PROJECTION_ROUNDS: usize = 4;

/// Most rounds of looking for a ring's nearest point to an edge.
pub(super) const RING_EDGE_ROUNDS: usize = 10;

/// Angles by which such a round turns: after the smallest it is the last, as Newton's method leaves its square; and the
/// largest, half of the angle between the points that it may begin from.
pub(super) const RING_EDGE_STEPS: [f64; 2] = [1e-5, 0.4];

/// Maximum number of points of a body that may touch fixed parts at once; further ones are left out. A cuboid in a
/// corner has 7.
pub(super) const MAX_STATIC_CONTACTS: usize = 16;

/// Points of a rim that are tried for where it is farthest from the axis of a curved track: 16. A rim has two such
/// places at most.
pub(super) const RIM_SAMPLES: usize = 16;

/// Number of points whose forces are kept: as many as a die on a face has.
pub(super) const WARM_STARTED_CONTACTS: usize = 4;

/// Number of events within the window after which contacts count as lasting. No sequence of real bounces of one body is
/// that fast.
pub(super) const CHATTER_EVENTS: u32 = 16;

/// Times, as a fraction of the clock's time, that the clock cannot tell apart. Some of its last digits.
pub(super) const CLOCK_RESOLUTION: f64 = 1e-15;

// Contact

/// Gap that lasting contacts keep, over the gap at which bodies touch. Below 1, so that they go on touching.
pub(super) const KEPT_GAP: f64 = 0.75;

/// Gap up to which a point counts as touching, over the gap at which bodies touch: so the gaps that a step leaves are
/// not taken for new impacts. This is the preset's gap.
pub(super) const CONTACT_MARGIN: f64 = 2.0;

/// Distance from the wanted gap up to which a step needs no correction, over the gap.
pub(super) const GAP_ERROR: f64 = 0.2;

/// Largest speed at which a point is pushed out of an overlap, over the speed below which bounces last. It acts on the
/// drift only, not on the velocities.
pub(super) const PUSH_OUT_SPEED: f64 = 1.0;

/// Sine of the angle by which a normal may lean into the triangle beside an edge, and the distance, over a triangle's
/// longest side, up to which a point counts as on its edge. Rounding of nearest points that are a thousandth of a gap
/// away.
pub(super) const EDGE_LEAN: f64 = 1e-6;

/// Distance over a body's size up to which points of contact on several pieces of a part count as one. For a corner
/// over the edge between two triangles.
pub(super) const SAME_POINT: f64 = 1e-6;

/// How far apart flush pieces may be, and how near to a seam a point is at it, over the smaller reach. 1e-5: far above
/// the rounding of places, far below a step that anybody means. Danger: larger values hide low steps.
pub(super) const FLUSH_DISTANCE: f64 = 1e-5;

/// How far apart flush pieces may be for a point whose normal is that of a face, over the reach of its piece: bodies
/// that press into the corner between a floor and a wall overlap the wall a little, and stand on the floor all the
/// same.
pub(super) const FLUSH_FACE_DISTANCE: f64 = 1e-2;

/// Share of a face's normal in that of a contact below which the face plays no part in it. 1e-6: rounding of normals.
pub(super) const LEAST_NORMAL_SHARE: f64 = 1e-6;

/// Least extent of a box that a body of revolution meets by its balls and rings, over the radius of the rim of its
/// foot: 4.
pub(super) const LARGE_BOX: f64 = 4.0;

/// Height over the size by which a corner is farther than it may be from a triangle's plane, beyond rounding.
pub(super) const FAR_ABOVE: f64 = 1e-9;

/// The depth in m of a block that has no other end: large enough that nothing gets there, small enough that rounding of
/// its faces' places stays below 1e-12 m.
pub(super) const ENDLESS_DEPTH: f64 = 1e4;

/// Stride over the balls of two rows in the first search; the best local minima are then followed ball by ball.
pub(super) const SPHERE_STRIDE: usize = 4;

/// Maximum number of local minima that are followed.
pub(super) const FOLLOWED_MINIMA: usize = 4;

// Motion

/// Fraction of the gap at which bodies touch by which a search may see a body off its path.
pub(super) const PATH_ERROR: f64 = 0.1;

/// Fraction of the gap at which a body touches by which a leg may stray from the closed form. A first contact may be
/// found that much early.
pub(super) const LEG_ERROR: f64 = 0.5;

/// Angle in radians by which a body with a force that turns with it may turn within a leg, and the angle that a torque
/// may add. What Gauss's rule leaves is 5e-7 times the sixth power of it, over the force's impulse: 8e-9.
pub(super) const OWN_FORCE_TURN: f64 = 0.5;

/// Angle in radians by which a ball's orientation may be off half way through a leg. No contact depends on it.
pub(super) const LEG_BALL_TURN: f64 = 1e-3;

/// Decay `z` below which series replace differences of nearly equal numbers. Their twelve terms leave `0.5¹²/14!`,
/// which is below rounding.
pub(super) const SMALL_DECAY: f64 = 0.5;

// Times of impact

/// Least advancement, over the gap at which the bodies touch: it makes every search end.
pub(super) const LEAST_FLIGHT_ADVANCE: f64 = 1e-3;

/// Rounds of approaching the root of a bound.
pub(super) const BOUND_ROOT_ROUNDS: usize = 4;

/// Rounds of approaching the first root. Each about squares the error; more rounds would save no advancement of the
/// surrounding search.
pub(super) const RIM_ROOT_ROUNDS: usize = 4;

/// Bisections for the time from which an overlapping ring can sink. To 2⁻⁴⁰ of the bracket.
pub(super) const RIM_BISECTIONS: usize = 40;

/// Maximum number of advancements of one search. When they are used up, the time reached is handed on as an event, and
/// the body is examined anew.
pub(super) const MAX_STATIC_ADVANCES: usize = 200;

/// Sine of the lean from which the lowest point of a rim is followed. Smaller values take more advancements, larger
/// ones see impacts a little early.
pub(super) const LEANING_RIM: f64 = 0.02;

/// Distance of the capsule around a body from a plane, over the body's size, below which its skin is examined. Smaller
/// values test capsules more often.
pub(super) const PLANE_CAPSULE_MARGIN: f64 = 0.05;

/// How far ahead the table below is examined at once, over the body's reach. Larger values create more of the table,
/// smaller ones examine it more often.
pub(super) const TABLE_LOOKAHEAD: f64 = 0.5;

/// Least fraction of the distance to a box that an advancement covers, at the body's speed at that point.
pub(super) const LEAST_BOX_ADVANCE: f64 = 1e-3;

/// Difference of two gaps, over the gap at which bodies touch, that counts as rounding.
pub(super) const SAME_BOX_GAP: f64 = 1e-6;

/// Distance, over the radius, for which the triangles ahead are collected at first. Then twice as far each time, up to
/// 4 if there are any.
pub(super) const MESH_LOOKAHEAD: [f64; 2] = [0.25, 4.0];

/// Approach over the speed that is lost in rounding.
pub(super) const APPROACH_ROUNDING: f64 = 1e-12;

/// Maximum number of advancements of one search. After that the time reached is handed on as an event.
pub(super) const MAX_SPHERE_ADVANCES: usize = 100;

/// Bisections of a step that ended in overlap: to 2⁻⁴⁰ of the step.
pub(super) const SPHERE_BISECTIONS: usize = 40;

/// Distance of the capsules around two bodies, over their size, below which their skins are examined.
pub(super) const PAIR_CAPSULE_MARGIN: f64 = 0.02;

/// Distance over the size that two skins may move between two looks, in addition to the distance between them. Larger
/// values miss grazes as deep as half of this.
pub(super) const SKIN_SKIP: f64 = 0.05;

/// Maximum number of advancements of one search. After that the time reached is handed on as an event, and the bodies
/// are examined anew.
pub(super) const MAX_CONVEX_ADVANCES: usize = 400;

/// For how much longer than the next look needs it a pair of pieces is proved to be apart, so that later looks may
/// leave it out, but no longer than the bounds hold. Times of impact depend on it within the gap.
pub(super) const PAIR_LOOKAHEAD: f64 = 4.0;

/// The part of the last step from a look on within which a pair of pieces is looked at too, though it is known to be
/// apart for that long. Times of impact depend on it within the gap.
pub(super) const PAIR_SOON: f64 = 0.5;

/// Least advancement near contact: the time in which points move by this fraction of the gap at which bodies touch.
pub(super) const LEAST_CONVEX_ADVANCE: f64 = 0.1;

/// Distance, over the body's reach, for which the fixed parts ahead are collected at once.
pub(super) const STATIC_LOOKAHEAD: f64 = 2.0;

/// Distance, over the size, that a body may move between two looks while its nearest point to a piece is none that can
/// touch: below the plane of a triangle, beside it, or at a seam.
pub(super) const BELOW_TRIANGLE_ADVANCE: f64 = 0.01;

/// Looks for when a ball beside a curved track comes over it, beyond its surface, and bisections of the time: 32 and
/// 50. What is over a corner of it for less than a look is missed, and found by the next search.
pub(super) const ARC_ENTRY_LOOKS: u32 = 32;
pub(super) const ARC_ENTRY_BISECTIONS: u32 = 50;

/// Angle in rad between the normal of a curved track under a ball and that of what it leads on to: 0.02. At the draft
/// preset the edge of a flush box is within the gap from 0.01 before it.
pub(super) const FLUSH_WITH_ARC: f64 = 0.02;

/// Bodies of more pieces are first seen as the capsule around them: 8.
pub(super) const FEW_PIECES: usize = 8;

/// Distance over the size beyond which pieces are kept apart by one of their axes, without their nearest points.
pub(super) const SEPARATING_AXIS_DISTANCE: f64 = 0.1;

/// Number of times that bodies in lasting contact are examined within one of their steps.
pub(super) const CONVEX_LOOKS_PER_STEP: u32 = 8;

/// How often the time between two such times is halved at most, or cut where the rate of the point says that it
/// touches. 24: far beyond what the finest preset's gap needs, as all but a few end after about five.
pub(super) const CONVEX_LOOK_HALVINGS: usize = 24;

/// Part of half the gap at which bodies touch by which the gap that is found may be smaller. 1e-6: how the search began
/// must not be seen.
pub(super) const CONVEX_LOOK_CLOSE: f64 = 1e-6;

/// Part of the time between two such times after which a point that touches has done so from the start. 1/4096: far
/// above rounding, and far shorter than any step.
pub(super) const CONVEX_LOOK_AT_ONCE: f64 = 1.0 / 4096.0;

/// Distance over the size within which a point counts as part of the lasting contact.
pub(super) const HELD_DISTANCE: f64 = 0.25;

/// Distance over a rim's radius within which a point of it counts as part of the lasting contact: far more than a rim
/// rolls in one step.
pub(super) const HELD_RIM_DISTANCE: f64 = 0.5;

/// Least cosine of the angle between the normals of points that are part of one contact.
pub(super) const HELD_NORMAL_COSINE: f64 = 0.995;

// Impacts

/// Normal speed, over the fastest speed of any point of the bodies, that is none. 1e-10: far above what rounding and
/// the solver of an earlier impact leave, far below any motion.
pub(super) const GRAZE: f64 = 1e-10;

/// Slip, over the relative velocity, that has no direction of which tilts of the normal are told. 1e-9: far above
/// rounding, far below any slip that is seen.
pub(super) const UNTOLD_SLIP: f64 = 1e-9;

/// Largest tilt of an impact's normal in rad: 80°.
pub(super) const MOST_TILT: f64 = 80.0 * std::f64::consts::PI / 180.0;

/// Approach, over the speed below which a bounce lasts, that is left to the solver of lasting contacts. Larger values
/// lose the order of slow impacts.
pub(super) const UNSTRUCK_APPROACH: f64 = 0.1;

/// Halvings of the interval that holds the largest factor of the restitutions that makes no energy.
pub(super) const RESTITUTION_HALVINGS: usize = 16;

/// Part of the restitutions that is given up first where joints hold. What the solver may leave of velocities: a
/// halving would give up 1e-5, which a cradle shows.
pub(super) const RESTITUTION_GIVEN_UP: f64 = 1e-8;

/// Maximum number of sweeps over points struck at once. About 20 are taken, or a few hundred where impulses are
/// redundant.
pub(super) const MAX_IMPACT_SWEEPS: u32 = 2000;

/// Change of velocity, over the fastest before the impact, at which points struck at once count as solved. Rounding.
pub(super) const IMPACT_SOLVED: f64 = 1e-13;

/// Energy, over that of impulses and velocities, that counts as zero: rounding.
pub(super) const NO_IMPACT_ENERGY: f64 = 1e-12;

// Solver: one contact

/// How near to the edge of its cone an impulse must be to count as sliding: rounding of the projection.
pub(super) const CONE_EDGE: f64 = 1e-12;

/// Largest force of a driven body at a point, over the mass of all other bodies times the acceleration of what it
/// moves: `speed²/reach`, and gravity. A body that turns about an axis near the line of the force would have to turn
/// infinitely fast; with this limit, it is at most about `30^⅓` times as fast as the driven body.
pub(super) const DRIVEN_FORCE_LIMIT: f64 = 30.0;

/// Largest rotation in one round, in radians.
pub(super) const SLIP_TURN_LIMIT: f64 = 0.5;

/// Fraction of the response to a normal force that friction must leave; if it leaves less, it wedges the contact.
pub(super) const WEDGED_RESPONSE: f64 = 1e-3;

/// Compliance of a contact over its response to an impulse. Smaller values lose digits to rounding, larger ones take
/// more rounds.
pub(super) const CONTACT_COMPLIANCE: f64 = 1e-7;

/// Compliance, over the response, with which the first states are guessed from impulses and velocities. A stiff guess
/// would see the velocities only, and forget that an impulse already holds a contact.
pub(super) const GUESS_COMPLIANCE: f64 = 3.0;

// Solver: all contacts of an island

/// Rounds over the direction of slip per visit; the sweeps around it do the rest.
pub(super) const SLIP_ROUNDS: u32 = 1;

/// Rounds over the direction of slip if there is no other contact: the direction is then found once and for all.
pub(super) const SLIP_ROUNDS_ALONE: u32 = 6;

/// Least angle in radians that is asked for; rounding is smaller.
pub(super) const LEAST_SLIP_TURN: f64 = 1e-9;

/// How much finer Newton's rule is solved than sweeps would be: it takes one more round at most.
pub(super) const NEWTON_ACCURACY: f64 = 1e-3;

/// Rounds that a large island always gets, whatever the preset. With fewer, the lowest bodies sink.
pub(super) const LEAST_NNCG_ROUNDS: u32 = 60;

/// Rounds for a time-stepped island of bodies with faces; where bodies bear each other in many levels, as many as carry
/// loads through these. What they leave is found in the next step, which starts from their impulses; with 60 for low
/// heaps, steps cost twice as much and end as deep.
pub(super) const NNCG_ROUNDS_WITH_FACES: u32 = 20;

/// From how many rounds to the next points without an impulse are visited too. Rounds that converge do not end before
/// all points were, so they depend on it within the solver's error; those that are cut off depend on it more.
pub(super) const NNCG_WHOLE_ROUNDS: u32 = 4;

/// Rounds for such an island over those that carry loads through its levels where nothing slips. With 1, some towers of
/// forty boxes fall a few thousandths of a box into each other where they land; 3 and 5 cost more and change nothing.
pub(super) const ROUNDS_FOR_HEIGHT: u32 = 2;

/// Number of the preset's sweeps that are made where Newton's rule fails, because friction wedges bodies.
pub(super) const SWEEPS_AFTER_NEWTON: u32 = 60;

/// Compliance of a contact in the first convex problem, over its response to an impulse. With smaller values each round
/// makes less progress, and many problems of dominoes that lie on each other are not solved at all.
pub(super) const FIRST_COMPLIANCE: f64 = 0.1;

/// Compliance of each next convex problem over the last: it starts nearer to its solution.
pub(super) const COMPLIANCE_RATIO: f64 = 0.1;

/// Least compliance of a convex problem. With smaller values rounds make less progress, and what the compliance leaves,
/// the next problem removes.
pub(super) const LEAST_COMPLIANCE: f64 = 1e-3;

/// Change of velocity that rounding makes, over the fastest body's speed. Ten times rounding, over the compliance.
pub(super) const VELOCITY_ROUNDING: f64 = 1e-8;

/// By how much velocities may break Coulomb's law, over the fastest body's speed. In bodies that wedge each other, some
/// error never goes away.
pub(super) const LAW_ERROR: f64 = 1e-5;

/// By how much velocities may break Coulomb's law where a driven body leaves others no way, over the fastest body's
/// speed: what gives way does not move by any law.
pub(super) const TRAPPED_LAW_ERROR: f64 = 1e-3;

/// How often the shift is renewed there.
pub(super) const TRAPPED_SHIFT_RENEWALS: usize = 5;

/// Rounds of the plain rule. 19 of 20 problems take fewer than 12.
pub(super) const MAX_NEWTON_ROUNDS: usize = 30;

/// Rounds of the plain rule in a large island of bodies with faces: at rest the rule takes two or three; where bodies
/// slide over each other, four of five problems are not solved in 20 either.
pub(super) const MAX_NEWTON_ROUNDS_WITH_FACES: usize = 5;

/// A round counts as lost if more than this fraction of the contacts open, close, begin or cease to slide in it, and
/// more than [`FEW_CHANGES`]. Problems that the rule solves have few such rounds, all at first.
pub(super) const LOST_ROUND_CHANGES: f64 = 0.25;

/// So few changing contacts never count. Small problems cost little, and impacts need their exact solution.
pub(super) const FEW_CHANGES: usize = 8;

/// Lost rounds after which the plain rule is given up.
pub(super) const MAX_LOST_ROUNDS: usize = 5;

/// Rounds count as alternating if the same contacts slide, stick and are open again after at most this many.
pub(super) const LONGEST_CYCLE: usize = 4;

/// How often the shift is renewed. Each time leaves a tenth of the error, or a half in bodies that wedge each other.
pub(super) const SHIFT_RENEWALS: usize = 20;

/// Least part of a change of the shifts that is taken. Below, it takes more renewals than it saves.
pub(super) const LEAST_AITKEN_FACTOR: f64 = 0.3;

/// Accuracy of a convex problem, over the change that is wanted from one shift to the next.
pub(super) const CONVEX_ACCURACY: f64 = 0.1;

/// Rounds for one convex problem.
pub(super) const CONVEX_ROUNDS: usize = 30;

/// A line search ends where the slope has fallen to this fraction.
pub(super) const LINE_SEARCH_SLOPE: f64 = 0.1;

/// Maximum number of points that a line search tries.
pub(super) const LINE_SEARCH_POINTS: usize = 12;

/// Maximum number of bodies in an island that is solved in this way.
pub(super) const MAX_NEWTON_BODIES: usize = 256;

/// Mass of a driven body where masses are needed, over that of the heaviest other member. Beyond all stiffness, so that
/// it does not move at all. No difference of large numbers is taken.
pub(super) const DRIVEN_MASS_RATIO: f64 = 1e30;

/// A matrix counts as singular if a pivot is below this fraction of the entry that was there at first. Other entries of
/// the block have other units: the answer must not depend on the bodies' size.
pub(super) const SINGULAR_PIVOT: f64 = 1e-14;

/// How far the response of a point to an impulse along its normal may lean, over its length, for normal and tangent to
/// count as independent. Rounding, for balls.
pub(super) const INDEPENDENT_RESPONSE: f64 = 1e-9;

/// Change of velocity at which rounds end, over that at which sweeps end. A round changes little of what is still
/// wrong, and a large island that keeps sinking by it never comes to rest.
pub(super) const NNCG_ACCURACY: f64 = 0.01;

/// Largest factor by which more is done than would stop the body if nothing touched it. A cylinder that rolls needs 3,
/// a pin that turns about the line through two points of contact some tens.
pub(super) const MAX_RESISTANCE_GAIN: f64 = 100.0;

/// Fraction of what is needed that may be missing. Rounding.
pub(super) const RESISTANCE_ROUNDING: f64 = 1e-9;

/// Problems, each stiffer than the last, by which the impulses are sought. Each leaves a tenth of the velocity or less
/// where they exist.
pub(super) const EQUILIBRIUM_PROBLEMS: usize = 8;

/// Part of the velocity that a problem may leave for the next to be tried.
pub(super) const EQUILIBRIUM_PROGRESS: f64 = 0.7;

// Steps of an island

/// Distance that a body may move within the unit of a step's length, over its size; with joints, over its span.
pub(super) const STEP_TRAVEL: f64 = 4.0;

/// Angle in radians that the lowest point of a ring may run around within the unit of a step's length. The point's path
/// is curved, a step's is straight.
pub(super) const STEP_RING_TURN: f64 = 0.25;

/// Sine of the tilt of a ring below which that angle may be larger: a step's error is as the tilt times the cube of the
/// angle. A thick coin takes half as many steps until it lies, each with the error of one at 0.1.
pub(super) const LOW_RING_TILT: f64 = 0.1;

/// Passes over the end of a step: the first predicts where points end, the others correct that.
pub(super) const STEP_PASSES: usize = 2;

/// Passes over the end of a step if cuboids touch each other: a corner of one turns against a face that also turns.
/// Passes end when all gaps are right.
pub(super) const STEP_PASSES_WITH_CUBOIDS: usize = 8;

/// Passes over the end of a step of a time-stepped island.
pub(super) const STEP_PASSES_TIME_STEPPED: usize = 3;

/// How often a step is shortened so that points that have just left are not back within it. Each time aims at half
/// their speed.
pub(super) const MAX_SHORTENINGS: usize = 4;

/// Least fraction of a step that one shortening leaves.
pub(super) const LEAST_SHORTENING: f64 = 0.1;

/// Fraction of the push out of overlaps that a jam gets if the whole push adds too much energy.
pub(super) const GENTLE_PUSH: f64 = 0.0625;

/// Overlap with a driven body, over the smaller size, from which on a body counts as crushed. Some times the overlap of
/// what is pushed aside by a long lever.
pub(super) const CRUSHED_OVERLAP: f64 = 0.01;

/// Rounds of lifting a body out of overlaps when it lies down: each deals with its deepest point.
pub(super) const LIFT_ROUNDS: usize = 4;

/// Spread of the gaps at rest that is left as it is, over the gap at which bodies touch. Rounding is far smaller.
pub(super) const TIDY_GAP: f64 = 1e-3;

/// What a contact may pass, over the angular momentum that speeds can hold. Of 32,000 contacts of the tests that pass
/// more than 0.003, one in a hundred passes more than 0.09, up to 5e11 where bodies are wedged.
pub(super) const MAX_MOMENTUM_TRANSPORT: f64 = 0.1;

/// Fraction of a step at whose ends an interruption changes nothing. Joints are apart there by less than they may be
/// between two steps.
pub(super) const UNTRUNCATED_ENDS: f64 = 1e-9;

/// Steps of the Runge–Kutta method within a step of a body that pivots. With 2, twenty edges of a hexagonal prism are
/// off by 6e-4 at the draft preset.
pub(super) const PIVOT_SUBSTEPS: u32 = 2;

/// Least speed of slip, over what gravity makes in a step, that counts as one; otherwise what the preset lets the
/// solver leave. 1e-6: what impacts at several points leave is far less, and the energy changes by far less than it.
pub(super) const PIVOT_SLIP: f64 = 1e-6;

/// Difference between two normals that counts as none, so that both are of one face: rounding.
pub(super) const PIVOT_NORMAL_ERROR: f64 = 1e-9;

/// Error of the energy of such a step, over its kinetic energy, up to which the step is taken: it is then removed by a
/// change of speed. A larger one shows that the step is too long for the method.
pub(super) const PIVOT_ENERGY_ERROR: f64 = 1e-3;

/// Least kinetic energy at the end of such a step, over that at its start. A body that comes to a stop within the step
/// cannot have its energy corrected by a change of speed.
pub(super) const PIVOT_SLOW: f64 = 0.1;

/// Steps of the Runge–Kutta method within a step of a ball on a curved track: 4. They leave 1e-7 of the energy at the
/// draft preset, which a change of speed removes.
pub(super) const ARC_SUBSTEPS: u32 = 4;

/// Halvings of such a step that ends where the ball leaves the track: to 2⁻⁵⁰ of the step.
pub(super) const ARC_END_BISECTIONS: u32 = 50;

/// Least part of a step's length to which the end of a curved track shortens it: 1e-6. Smaller values would take steps
/// without end before it.
pub(super) const ARC_LEAST_STEP: f64 = 1e-6;

/// Rounds of finding the spin of a free rotation between two orientations: each leaves about the angle of the rotation
/// of the error. Fewer leave an error of the orientation at the end of a pivot's step.
pub(super) const PIVOT_SPIN_ROUNDS: usize = 12;

/// Error of a rotation, in radians, that counts as none.
pub(super) const PIVOT_TURN_ERROR: f64 = 1e-15;

/// Overlap over the size that cuboids in lasting contact may have half way through a step. For smaller values, the cost
/// of fast turning in contact grows as their inverse root.
pub(super) const MID_STEP_DRIFT: f64 = 1e-3;

/// How much deeper than their goal bodies other than cuboids may end a step, over the gap at which they touch. Which is
/// 40 µm for a pin at the standard preset. With closer limits, steps of pins get shorter and cost half as much again.
pub(super) const STEP_OVERLAP: f64 = 300.0;

/// How much deeper than their goal points of a large island of bodies with faces may end a step, over the gap at which
/// they touch, if it is not more than [`DEEPEST_STEP_OVERLAP`] of the size.
pub(super) const STEP_OVERLAP_WITH_FACES: f64 = 30.0;

/// Overlap over the size that a step of a time-stepped island may leave where the preset's gap does not allow more.
pub(super) const DEEPEST_STEP_OVERLAP: f64 = 3e-4;

/// Distance from the wanted gap up to which a step of a time-stepped island needs no correction, and depth from which
/// on a point that was not part of the step is taken up, both over how deep it may end. The next step corrects what is
/// left.
pub(super) const GAP_ERROR_TIME_STEPPED: f64 = 1.0 / 3.0;

/// Number of members from which an island counts as a large island. More than ten pins and a ball.
pub(super) const LARGE_ISLAND: usize = 13;

/// Least number of members of a time-stepped island, whatever the preset says.
pub(super) const LEAST_TIME_STEPPED: usize = 4;

/// Fraction of [`MID_STEP_DRIFT`] up to which points of a large island that separate half way through a step belong to
/// its contacts. A straight drift leaves a curve by half of the bound to which steps are shortened, an eighth of 4
/// times `MID_STEP_DRIFT`.
pub(super) const LARGE_ISLAND_DRIFT: f64 = 0.5;

/// How far points that separate half way through a step of a smaller island may be and still belong to its contacts,
/// over the gap at which bodies touch.
pub(super) const SMALL_ISLAND_DRIFT: f64 = 50.0;

/// Distance over its size that the fastest body of a large island may move within the unit of a step's length.
pub(super) const TIME_STEP_TRAVEL: f64 = 1.0;

/// By how much nearer bodies may come within a step than their velocities before it say, over the way of the fastest
/// body. A ball that is struck by another of the same mass without rebound.
pub(super) const TIME_STEP_SLACK: f64 = 0.5;

/// Time-stepped islands of more bodies are solved by conjugate gradients instead of Newton's method. In a hundred
/// balls, these take a twentieth of the time.
pub(super) const MAX_DIRECT_BODIES: usize = 40;

/// The part of the last step's impulses from which the next are sought. Where rigid bodies leave open how they share a
/// load, what they carried is forgotten in some ten steps, and the least impulses are found, which equally elastic
/// contacts would have.
pub(super) const WARM_START: f64 = 0.9;

/// The part of the last step's impulses from which conjugate gradients start, which find the load of deep islands in
/// many steps.
pub(super) const WARM_START_OF_NNCG: f64 = 0.99;

/// Terms of the series of a free rotation that searches for first contacts and steps of a crowd leave out, over the
/// preset's gap. Far less than a point moves by the solver's error.
pub(super) const TURN_ERROR: f64 = 1e-3;

/// Bias in m/s of a point that has left: no velocity is as large.
pub(super) const INACTIVE_BIAS: f64 = 1e100;

/// How far bodies of a crowd may stray within a step from the path that their points were looked for on, over the size.
/// Only the cost depends on it: of smaller values, points are looked for more often, of larger ones more are listed
/// that nothing touches. With 0.1, dominoes, shards and hulls in a bowl cost 5 % more, with 0.05 the hulls a fifth.
pub(super) const CROWD_REACH: f64 = 0.2;

/// Length of a crowd's substep over the preset's step. An impact is felt up to a substep too early, and the impulse
/// that is left of it a substep later. Waves of dominoes are then off by at most 1.1 % at draft and 0.6 % at standard;
/// in substeps half as long by half of this, at nearly twice the cost.
pub(super) const CROWD_SUBSTEP: f64 = 0.125;

/// Rounds of shifts that move overlapping bodies apart, in each substep. What they leave, the next substeps undo, so
/// two are as good as four; of bodies that are about to rest, up to [`SLEEP_PATIENCE`] times as many undo all.
pub(super) const CROWD_PROJECTIONS: u32 = 2;

/// Rounds of shifts end when they move no point by more than this part of the gap up to which points touch: a stack of
/// ten then comes out of its overlaps.
pub(super) const PROJECTED: f64 = 0.01;

/// The preset's sweeps over the rounds that find the impulses of a substep while bodies are too fast to be tested for
/// rest. What these leave, the next substep measures, and starts from their impulses. With 1, dominoes cost a fifth
/// more, and waves in them are as far off. Bodies that are nearly still keep creeping with 4.
pub(super) const CROWD_ROUNDS: u32 = 4;

/// How often points that a step's drift brought into each other are looked for.
pub(super) const MISSED_POINT_ROUNDS: usize = 3;

/// Overlap, over the gap, at which a large island of bodies with faces that is still may rest: its impulses are found
/// roughly, so points end their steps that much off. At draft, a thousandth of the size.
pub(super) const STILL_OVERLAP: f64 = 10.0;

/// How often a step is halved because bodies end it deeper in each other than they should.
pub(super) const TIME_STEP_HALVINGS: usize = 3;

/// Energy that a step may add, over the weight times the gap at which bodies touch. Rounding and the solver's error.
pub(super) const ENERGY_ERROR: f64 = 0.01;

/// The part of the first kick that is moved at first to keep energy.
pub(super) const FIRST_ENERGY_PART: f64 = 0.02;

/// The largest such part.
pub(super) const MAX_ENERGY_PART: f64 = 0.9;

/// The number of attempts at it.
pub(super) const ENERGY_ROUNDS: usize = 4;

/// How much farther to go than the chord says.
pub(super) const ENERGY_OVERSHOOT: f64 = 1.05;

/// Rounds in which resistance and contacts find what stops bodies. Each leaves a tenth or so.
pub(super) const RESISTANCE_ROUNDS: usize = 12;

/// Fraction of the velocity that one round may leave for the next to go on.
pub(super) const RESISTANCE_PROGRESS: f64 = 0.9;

// Sleep

/// Fraction of a motion that may remain after contacts try to stop it. Friction that is too weak leaves all of it.
pub(super) const STOPPED_MOTION: f64 = 0.1;

/// Velocity over `g · step` that counts as none when contacts are tested. Above the solver's error.
pub(super) const NO_MOTION: f64 = 1e-6;

/// Sine of the slope up to which ground counts as level under a ball. Rounding of a triangle's normal.
pub(super) const LEVEL_UNDER_BALL: f64 = 1e-9;

/// Factor by which the test of a large island may take more sweeps, and by which their last change must be smaller.
/// Also the factor by which a slow island of bodies with faces may take more rounds. With 4, the top of a pyramid may
/// go on trembling.
pub(super) const SLEEP_PATIENCE: u32 = 10;

/// Overlap over the size up to which a body may lie down; it is then lifted out. A hundred times the overlap that steps
/// of the draft preset leave.
pub(super) const SLEEP_OVERLAP: f64 = 1e-3;

/// Sine of the angle below which points count as opposite.
pub(super) const OPPOSITE_POINTS: f64 = 1e-6;

// Balls that roll

/// Sine of the slope up to which ground counts as level. Rounding of a triangle's normal.
pub(super) const LEVEL_TRIANGLE: f64 = 1e-9;

/// Distance over the gap at which bodies touch that is too short to matter: to slide until the ball rolls, or to roll
/// until it stops.
pub(super) const SHORT_ROLL: f64 = 0.1;

/// Rate over the speed, and acceleration over gravity, at which the ball neither leaves a face nor presses against it.
/// Far above rounding.
pub(super) const NO_PRESSURE: f64 = 1e-9;

/// Distance over the size from a side of a triangle at which a ball that moves outwards is at the side.
pub(super) const AT_TRIANGLE_SIDE: f64 = 1e-9;

/// Times over the clock's time that the clock cannot tell apart.
pub(super) const ROLL_CLOCK_RESOLUTION: f64 = 1e-15;

/// Speed with which a ball that flies over an edge parts from it, over its own: then it is not found to touch the edge,
/// or the triangle behind, by rounding.
pub(super) const EDGE_PARTING_SPEED: f64 = 1e-8;

/// Triangles and edges that are passed at one time.
pub(super) const MAX_CROSSED_FACES: usize = 8;

/// Angle by which a ball turns about an edge in one step, over the preset's step. 0.1 rad at the standard preset. Half
/// way, it is inside the edge by an eighth of the angle's square, over its radius.
pub(super) const EDGE_TURN: f64 = 0.25;

/// Sine of the slope up to which ground counts as level. Rounding of a normal.
pub(super) const LEVEL_GROUND: f64 = 1e-12;

/// Slip over `√(g R)` that counts as no slip. Rounding of speeds.
pub(super) const NO_SLIP: f64 = 1e-14;

// Joints

/// Maximum number of joints of one body: one bit each notes whether it is torn.
pub(super) const MAX_JOINTS: usize = 32;

/// Largest range of a hinge with limits, in radians. This leaves enough room outside the range to tell which limit was
/// passed.
pub(super) const WIDEST_HINGE: f64 = 6.0;

/// Distance that a step may leave between the points that a joint holds together, over the gap at which its bodies
/// touch. The solver's error is smaller.
pub(super) const JOINT_GAP: f64 = 1e-3;

/// The same at draft and standard: 1e-5 and 1e-6 of the size. Where a body on a hinge also stands on something,
/// friction and the joint cannot both be obeyed more exactly than its points meet at the start of the step, and a
/// solver that is to do so never converges: of a seesaw's problems at draft, a quarter then failed and took three
/// fifths of the time.
pub(super) const ROUGH_JOINT_GAP: f64 = 0.1;

/// Passes over the end of a step with joints: each leaves about half of the angle that the step turns by.
pub(super) const STEP_PASSES_WITH_JOINTS: usize = 12;

/// Length of a step with joints over that of other steps. At the standard preset, a joint is then apart by about a
/// thousandth of its arm half way through a step.
pub(super) const JOINT_STEP_LENGTH: f64 = 0.25;

/// How often a step that would pass a limit is aimed at the limit again.
pub(super) const LIMIT_AIMS: usize = 8;

/// How near to a limit a step aims, over the gap. Below [`KEPT_GAP`], so that the limit then counts as touched.
pub(super) const LIMIT_GAP: f64 = 0.5;

/// Length of a string's free part over a body's size, below which steps do not become shorter with it: the end of a
/// string that is wound up comes as near to its drum as it likes.
pub(super) const SHORT_STRING: f64 = 0.05;

/// Energy that a step may add where strings are taut, over what there is: a usual step adds a tenth of it at draft.
pub(super) const STRING_GAIN: f64 = 0.01;

/// Error of velocities at joints, over the fastest body's speed, from which on they are taken not to fit the joints, as
/// after a kick: far above rounding.
pub(super) const JOINT_VELOCITY_ERROR: f64 = 1e-11;

/// Error that steps of bodies on joints may make in a second, over a body's size and the fourth power of the preset's
/// step: 1 % of the size at draft, 0.1 % at standard. What they make is less, as they are of fifth order and the error
/// is that of their fourth.
pub(super) const JOINT_STEP_ERROR: f64 = 0.04;

/// How far, over its size and the cube of the preset's step, a body on joints may be from the parabola on which
/// searches for a first contact see its centre: 3e-3 at draft, a little less than steps of lasting contact leave a
/// curve at an arm of that length; 6e-4 at standard. Larger values find impacts too early or too late by as much.
pub(super) const ARTICULATED_PATH_ERROR: f64 = 9e-3;

/// Largest angle of a step of bodies on joints in radians, at the rate at which they swing or turn.
pub(super) const JOINT_STEP_TURN: f64 = 1.0;

/// Part of the length that would just keep the errors.
pub(super) const JOINT_STEP_SAFETY: f64 = 0.9;

/// Largest factor from one such step to the next.
pub(super) const JOINT_STEP_GROWTH: f64 = 4.0;

/// How often such a step is shortened at most.
pub(super) const JOINT_STEP_TRIES: usize = 12;

/// Times within such a step at which limits are looked at.
pub(super) const LIMIT_LOOKS: u32 = 8;

/// By how much velocities may be scaled to give a step's energy back, where there is hardly any motion that could take
/// it.
pub(super) const ENERGY_SCALING: f64 = 1e-3;
