/* SPDX-License-Identifier: MIT
 * The active set follows from what the case says, and from nothing else; who called for an effect
 * is known; phases and field groups follow from the set. */
#include "rig.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define TOP "dp = 1 cm\nend_time = 1\n"
#define FLUID "[fluid w]\nshape = box 0, 0, 0.2, 0.1\nsound_speed = 20\n"
#define WALL "[wall bed]\nshape = box -0.03, -0.03, 0.23, 0\n"
#define SOLID \
    "[solid s]\nshape = box 0.05, 0.12, 0.15, 0.16\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"
#define PLAIN_SOLID SOLID "hourglass = 0\nartificial_viscosity = 0\n"

/* Each with the lines that call for it, and no other effect that this does not bring along. */
static const struct {
    const char *text;
    effect_set effects;
    enum effect effect;
    const char *source;
} scenes[] = {
    {TOP FLUID, FX_FLUID, EFFECT_FLUID, "line 3: [fluid w]"},
    {TOP FLUID "artificial_viscosity = 0.1\n", FX_FLUID | FX_VISCOSITY, EFFECT_VISCOSITY,
     "line 6: [fluid w] artificial_viscosity"},
    {TOP FLUID "density_diffusion = 0.1\n", FX_FLUID | FX_DIFFUSION, EFFECT_DIFFUSION,
     "line 6: [fluid w] density_diffusion"},
    {TOP FLUID "density_diffusion = 0.1\ndiffusion_form = fourtakas\n",
     FX_FLUID | FX_DIFFUSION | FX_FOURTAKAS, EFFECT_FOURTAKAS, "line 7: [fluid w] diffusion_form"},
    {TOP FLUID "density_diffusion = 0.1\ndiffusion_form = antuono\n",
     FX_FLUID | FX_DIFFUSION | FX_ANTUONO, EFFECT_ANTUONO, "line 7: [fluid w] diffusion_form"},
    {TOP FLUID "density_diffusion = 0.1\ndiffusion_limiter = strain\n",
     FX_FLUID | FX_DIFFUSION | FX_LIMITER, EFFECT_LIMITER, "line 7: [fluid w] diffusion_limiter"},
    {TOP FLUID "[inflow i]\nfrom = 0, 0.1\nto = 0, 0\nspeed = 1\n", FX_FLUID | FX_INFLOW,
     EFFECT_INFLOW, "line 6: [inflow i]"},
    {TOP FLUID "[outflow o]\nfrom = 0, 0.1\nto = 0, 0\npressure = 1\n", FX_FLUID | FX_OUTFLOW,
     EFFECT_OUTFLOW, "line 6: [outflow o]"},
    {TOP FLUID "laminar_viscosity = 1e-3\n", FX_FLUID | FX_LAMINAR, EFFECT_LAMINAR,
     "line 6: [fluid w] laminar_viscosity"},
    {TOP FLUID "laminar_viscosity = 1e-3\n" WALL "slip = none\n",
     FX_FLUID | FX_LAMINAR | FX_WALL | FX_NO_SLIP, EFFECT_NO_SLIP, "line 9: [wall bed] slip"},
    {TOP FLUID "tensile_control = 0.2\n", FX_FLUID | FX_TENSILE, EFFECT_TENSILE,
     "line 6: [fluid w] tensile_control"},
    {TOP FLUID "wall_repulsion = 0.1\n" WALL, FX_FLUID | FX_WALL | FX_REPULSION, EFFECT_REPULSION,
     "line 6: [fluid w] wall_repulsion"},
    {TOP FLUID "wall_repulsion = 0.1\nwall_damping = 1\n" WALL,
     FX_FLUID | FX_WALL | FX_REPULSION | FX_WALL_DAMPING, EFFECT_WALL_DAMPING,
     "line 7: [fluid w] wall_damping"},
    {TOP FLUID "[numerics]\nsides = one\n" WALL, FX_FLUID | FX_WALL | FX_ONE_SIDED,
     EFFECT_ONE_SIDED, "line 7: [numerics] sides"},
    {TOP FLUID "acoustic_damper = 0.2\n", FX_FLUID | FX_DAMPER, EFFECT_DAMPER,
     "line 6: [fluid w] acoustic_damper"},
    {TOP FLUID "particle_mass = hydrostatic\nsurface = 0.1\n", FX_FLUID | FX_MASSES, EFFECT_MASSES,
     "line 6: [fluid w] particle_mass"},
    {TOP FLUID "particle_mass = hydrostatic\npressure = 10\n", FX_FLUID | FX_MASSES, EFFECT_MASSES,
     "line 6: [fluid w] particle_mass"},
    /* The scheme calls for what it sets; masses where the fluid starts under pressure. */
    {TOP "scheme = standard\n" FLUID WALL,
     FX_FLUID | FX_WALL | FX_DIFFUSION | FX_ANTUONO | FX_LIMITER | FX_DAMPER | FX_REPULSION |
         FX_WALL_DAMPING,
     EFFECT_ANTUONO, "line 4: [fluid w] diffusion_form"},
    {TOP "scheme = standard\n" FLUID "density_diffusion = 0\nsurface = 0.1\n" PLAIN_SOLID,
     FX_FLUID | FX_SOLID | FX_COUPLING | FX_IMPEDANCE | FX_MASSES | FX_REPULSION | FX_WALL_DAMPING |
         FX_CONTACT,
     EFFECT_REPULSION, "line 4: [fluid w] wall_repulsion"},
    {TOP FLUID "shifting = 2\n", FX_FLUID | FX_SHIFTING, EFFECT_SHIFTING,
     "line 6: [fluid w] shifting"},
    {TOP "gravity = 0, -9.81\n" FLUID, FX_FLUID | FX_GRAVITY, EFFECT_GRAVITY, "line 3: gravity"},
    {TOP FLUID "[domain]\nlower = 0, 0\nupper = 0.4, 0.4\nperiodic = y\n", FX_FLUID | FX_PERIODIC,
     EFFECT_PERIODIC, "line 9: [domain] periodic"},
    {TOP FLUID WALL, FX_FLUID | FX_WALL, EFFECT_WALL, "line 6: [wall bed]"},
    {TOP FLUID WALL "motion = m\n[motion m]\nx = t\n", FX_FLUID | FX_WALL | FX_MOTION,
     EFFECT_MOTION, "line 8: [wall bed] motion"},
    {TOP FLUID "[wall bed]\nshape = polyline thickness 0: 0, 0.3; 0.1, 0.3\n",
     FX_FLUID | FX_WALL | FX_THIN, EFFECT_THIN, "line 7: [wall bed] shape"},
    {TOP FLUID "[rigid r]\nshape = box 0, 0.2, 0.1, 0.3\ndensity = 500\n",
     FX_FLUID | FX_WALL | FX_MOTION | FX_RIGID, EFFECT_RIGID, "line 6: [rigid r]"},
    {TOP "[beam b]\nshape = polyline: 0, 0; 1, 0\nmass = 1\naxial_stiffness = 1\n"
         "bending_stiffness = 1\n",
     FX_BEAM, EFFECT_BEAM, "line 3: [beam b]"},
    {TOP FLUID "[damping d]\nto = 1, 0\nrate = 5\n", FX_FLUID | FX_DAMPING_ZONE,
     EFFECT_DAMPING_ZONE, "line 6: [damping d]"},
    {TOP PLAIN_SOLID, FX_SOLID | FX_CONTACT, EFFECT_SOLID, "line 3: [solid s]"},
    {TOP SOLID "artificial_viscosity = 0\n", FX_SOLID | FX_CONTACT | FX_HOURGLASS, EFFECT_HOURGLASS,
     "line 3: [solid s] hourglass"},
    {TOP SOLID "hourglass = 0\n", FX_SOLID | FX_CONTACT | FX_SOLID_VISCOSITY,
     EFFECT_SOLID_VISCOSITY, "line 3: [solid s] artificial_viscosity"},
    {TOP FLUID PLAIN_SOLID, FX_FLUID | FX_SOLID | FX_CONTACT | FX_COUPLING | FX_IMPEDANCE,
     EFFECT_COUPLING, "line 6: [solid s]"},
    {TOP FLUID PLAIN_SOLID, FX_FLUID | FX_SOLID | FX_CONTACT | FX_COUPLING | FX_IMPEDANCE,
     EFFECT_IMPEDANCE, "default: [numerics] multirate"},
    {TOP FLUID PLAIN_SOLID, FX_FLUID | FX_SOLID | FX_CONTACT | FX_COUPLING | FX_IMPEDANCE,
     EFFECT_FORCE_EXTRAPOLATION, "line 6: [solid s]"},
    {TOP PLAIN_SOLID "damping_time = 1e-4\n", FX_SOLID | FX_CONTACT | FX_KELVIN_VOIGT,
     EFFECT_KELVIN_VOIGT, "line 10: [solid s] damping_time"},
    {TOP PLAIN_SOLID "mass_damping = 10\n", FX_SOLID | FX_CONTACT | FX_MASS_DAMPING,
     EFFECT_MASS_DAMPING, "line 10: [solid s] mass_damping"},
    {TOP PLAIN_SOLID "[relax]\ntolerance = 0.01\n", FX_SOLID | FX_CONTACT | FX_RELAX, EFFECT_RELAX,
     "line 11: [relax] tolerance"},
    {TOP PLAIN_SOLID "[solid t]\nlike = s\nshape = box 0.15, 0.12, 0.2, 0.16\njoined = s\n",
     FX_SOLID | FX_CONTACT | FX_JOINED, EFFECT_JOINED, "line 13: [solid t] joined"},
    {TOP PLAIN_SOLID "[contact c]\n[solid t]\nlike = s\nshape = box 0.15, 0.12, 0.2, 0.16\n",
     FX_SOLID | FX_CONTACT, EFFECT_CONTACT, "line 10: [contact c]"},
    {TOP PLAIN_SOLID, FX_SOLID | FX_CONTACT, EFFECT_CONTACT, "line 3: [solid s]"},
    {TOP PLAIN_SOLID "[contact c]\nenabled = off\n", FX_SOLID, EFFECT_SOLID, "line 3: [solid s]"},
    {TOP PLAIN_SOLID WALL "[contact c]\nbetween = s, bed\nenabled = off\n", FX_SOLID | FX_CONTACT,
     EFFECT_CONTACT, "line 3: [solid s]"},
    {TOP PLAIN_SOLID "[contact c]\n" WALL, FX_SOLID | FX_CONTACT | FX_CONTACT_WALL,
     EFFECT_CONTACT_WALL, "line 10: [contact c]"},
    {TOP PLAIN_SOLID "[contact c]\nfriction = 0.1\n", FX_SOLID | FX_CONTACT | FX_FRICTION,
     EFFECT_FRICTION, "line 11: [contact c] friction"},
    {TOP PLAIN_SOLID "[load l]\nbody = s\nshape = box 0.05, 0.12, 0.06, 0.16\nforce = 1, 0\n",
     FX_SOLID | FX_CONTACT | FX_LOAD, EFFECT_LOAD, "line 10: [load l]"},
    {TOP PLAIN_SOLID "clamp = box 0.05, 0.12, 0.07, 0.16\nclamp_motion = m\n[motion m]\n",
     FX_SOLID | FX_CONTACT | FX_CLAMP_MOTION, EFFECT_CLAMP_MOTION,
     "line 11: [solid s] clamp_motion"},
    {TOP PLAIN_SOLID "hinge = 0.07, 0.15\n", FX_SOLID | FX_CONTACT | FX_HINGE, EFFECT_HINGE,
     "line 10: [solid s] hinge"},
    {TOP FLUID WALL "[probe p]\nquantity = force\nbody = bed\n", FX_FLUID | FX_WALL | FX_WALL_FORCE,
     EFFECT_WALL_FORCE, "line 9: [probe p] quantity"},
    {TOP "integrator = verlet\n" FLUID, FX_FLUID | FX_VERLET, EFFECT_VERLET, "line 3: integrator"},
    {TOP "integrator = verlet\n" FLUID PLAIN_SOLID "[numerics]\nmultirate = on\n",
     FX_FLUID | FX_VERLET | FX_SOLID | FX_CONTACT | FX_COUPLING | FX_FORCE_EXTRAPOLATION |
         FX_IMPEDANCE | FX_SPLIT_IMPULSE,
     EFFECT_SPLIT_IMPULSE, "line 3: integrator"},
    {TOP "integrator = leapfrog\n" FLUID, FX_FLUID, EFFECT_LEAPFROG, "line 3: integrator"},
    {TOP PLAIN_SOLID "[numerics]\nsolid_steps = implicit\n", FX_SOLID | FX_CONTACT | FX_IMPLICIT,
     EFFECT_IMPLICIT, "line 11: [numerics] solid_steps"},
    {TOP FLUID "[output]\nenergy_account = on\n", FX_FLUID, EFFECT_ENERGY_ACCOUNT,
     "line 7: [output] energy_account"},
};

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static void test_the_set_follows_from_the_case(void)
{
    effect_set tested = EFFECT_BIT(EFFECT_MULTIRATE); /* follows from the bounds: test_timestep.c */
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        rig_open(&rig, scenes[k].text, NULL);
        /* The default integrator is an effect of the fluid and extrapolates the force on
         * structures, and the energy account is on. */
        const bool by_default = scenes[k].effects & FX_FLUID && !(scenes[k].effects & FX_VERLET);
        const effect_set always = (by_default ? FX_LEAPFROG : 0) | FX_ENERGY_ACCOUNT |
                                  (scenes[k].effects & FX_COUPLING ? FX_FORCE_EXTRAPOLATION : 0);
        tested |= EFFECT_BIT(scenes[k].effect);
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(scenes[k].effects | always,
                                        rig.sim.effects & ~(effect_set)FX_MULTIRATE,
                                        scenes[k].text);
        struct effect_source by;
        TEST_ASSERT_TRUE(effect_enabled(&rig.scene, scenes[k].effect, &by));
        TEST_ASSERT_EQUAL_STRING(scenes[k].source, effect_source_text(&rig.scene, &by).text);
    }
    for (int k = 0; k < EFFECT_COUNT; k++)
        TEST_ASSERT_TRUE_MESSAGE(tested & EFFECT_BIT(k), effect_table[k].name);
}

static void test_a_set_is_named_as_the_caller(void)
{
    struct effect_source by;
    rig_open(&rig, TOP FLUID, "w.artificial_viscosity=0.1", NULL);
    TEST_ASSERT_TRUE(effect_enabled(&rig.scene, EFFECT_VISCOSITY, &by));
    TEST_ASSERT_EQUAL_STRING("--set: [fluid w] artificial_viscosity",
                             effect_source_text(&rig.scene, &by).text);
}

/* Fluid only: no field of a solid; solid only: no cells, no packed fields, no field of a fluid; a
 * wall that neither fluid nor solid meets is nothing. */
static void test_nothing_is_allocated_that_is_not_needed(void)
{
    rig_open(&rig, TOP FLUID WALL, NULL);
    TEST_ASSERT_EQUAL_INT64(0, rig.sim.particles[KIND_SOLID].capacity);
    TEST_ASSERT_NULL(rig.sim.particles[KIND_FLUID].ux);
    TEST_ASSERT_NULL(rig.sim.particles[KIND_WALL].ax);
    TEST_ASSERT_NULL(rig.sim.particles[KIND_WALL].X);
    TEST_ASSERT_NULL(rig.sim.fluid.sticks[KIND_WALL]);
    TEST_ASSERT_EQUAL_INT(PACKED_FIELDS, rig.sim.fluid.packed[KIND_WALL].n);
    rig_open(&rig, TOP SOLID WALL "[contact none]\nenabled = off\n", NULL);
    TEST_ASSERT_EQUAL_INT64(0, rig.sim.particles[KIND_FLUID].capacity);
    TEST_ASSERT_EQUAL_INT64(0, rig.sim.particles[KIND_WALL].capacity);
    TEST_ASSERT_NULL(rig.sim.cells.list[KIND_SOLID].start);
    TEST_ASSERT_NULL(rig.sim.fluid.neighbour_scratch);
    TEST_ASSERT_NULL(rig.sim.particles[KIND_SOLID].p);
    TEST_ASSERT_NULL(rig.sim.particles[KIND_SOLID].fx);
}

static void check_phases(const char *text, const char *expected)
{
    rig_open(&rig, text, NULL);
    char names[256] = "";
    for (int k = 0; k < PHASE_COUNT; k++) {
        if (!phase_runs((enum phase)k, rig.sim.effects)) continue;
        strcat(names, phase_table[k].name);
        strcat(names, " ");
    }
    TEST_ASSERT_EQUAL_STRING(expected, names);
    rig_steps(&rig, 3, 1);
    for (int k = 0; k < PHASE_COUNT; k++)
        TEST_ASSERT_TRUE(phase_runs((enum phase)k, rig.sim.effects) ||
                         rig.sim.phase_seconds[k] == 0);
}

static void test_phases_run_by_need(void)
{
    check_phases(TOP FLUID, "sort packed fluid update output ");
    check_phases(TOP FLUID WALL, "sort packed wall fluid update output ");
    check_phases(TOP FLUID "density_diffusion = 0.1\ndiffusion_form = antuono\nshifting = 1\n",
                 "sort packed slope fluid shift update output ");
    check_phases(TOP SOLID, "solid contact update output ");
    check_phases(TOP SOLID "[contact none]\nenabled = off\n", "solid update output ");
    check_phases(TOP SOLID "[contact c]\n" WALL, "solid contact update output ");
    check_phases(TOP FLUID SOLID, "sort packed wall fluid solid contact update output ");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_the_set_follows_from_the_case);
    RUN_TEST(test_a_set_is_named_as_the_caller);
    RUN_TEST(test_nothing_is_allocated_that_is_not_needed);
    RUN_TEST(test_phases_run_by_need);
    return UNITY_END();
}
