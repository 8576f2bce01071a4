/* SPDX-License-Identifier: MIT
 * Variants compiled for a set of effects against the generic one that decides at run time: the same
 * bits after many steps. */
#include "rig.h"
#include "unity.h"

#include "base/base.h"

#include <stdio.h>
#include <string.h>

static const char scene[] =
    "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.2, 0.15\nsound_speed = 20\nsurface = 0.15\n"
    "[wall tank]\nshape = polyline thickness -0.03: 0, 0.25; 0, 0; 0.4, 0; 0.4, 0.25\n"
    "[solid gate]\nshape = box 0.2, 0, 0.23, 0.2\nclamp = box 0.2, 0.17, 0.23, 0.2\n"
    "density = 1100\nyoung = 1e6\npoisson = 0.4\n"
    "[contact c]\nbetween = gate, tank\nenabled = off\n"; /* a thin line has none */

#define STANDARD                                                                                  \
    "water.diffusion_form=antuono", "water.diffusion_limiter=strain", "water.wall_repulsion=0.3", \
        "water.wall_damping=1"

/* The sets of effects of fluid/variants.def, as case files ask for them, and one without a variant.
 */
static const struct {
    const char *name, *alpha, *delta, *set[8], *mass;
    effect_set effects;
} sets[] = {
    {"bare", "0", "0", {NULL}, "equal", 0},
    {"viscous", "0.05", "0", {NULL}, "equal", FX_VISCOSITY},
    {"dam_break", "0.05", "0.1", {NULL}, "equal", FX_VISCOSITY | FX_DIFFUSION},
    {"sluice",
     "0.05",
     "0.1",
     {"water.wall_repulsion=0.1"},
     "equal",
     FX_VISCOSITY | FX_DIFFUSION | FX_REPULSION},
    {"hydrostatic",
     "0.05",
     "0.1",
     {"water.diffusion_form=fourtakas"},
     "equal",
     FX_VISCOSITY | FX_DIFFUSION | FX_FOURTAKAS},
    {"standard",
     "0.05",
     "0.1",
     {STANDARD},
     "hydrostatic",
     FX_VISCOSITY | FX_DIFFUSION | FX_ANTUONO | FX_LIMITER | FX_REPULSION | FX_WALL_DAMPING |
         FX_MASSES},
    {"standard_inviscid_thin",
     "0",
     "0.1",
     {STANDARD, "tank.shape=polyline thickness 0: 0, 0.25; 0, 0; 0.4, 0; 0.4, 0.25"},
     "hydrostatic",
     FX_DIFFUSION | FX_ANTUONO | FX_LIMITER | FX_REPULSION | FX_WALL_DAMPING | FX_MASSES | FX_THIN},
    {"standard_inviscid",
     "0",
     "0.1",
     {STANDARD},
     "hydrostatic",
     FX_DIFFUSION | FX_ANTUONO | FX_LIMITER | FX_REPULSION | FX_WALL_DAMPING | FX_MASSES},
    {"standard_equal",
     "0.05",
     "0.1",
     {STANDARD},
     "equal",
     FX_VISCOSITY | FX_DIFFUSION | FX_ANTUONO | FX_LIMITER | FX_REPULSION | FX_WALL_DAMPING},
    {"standard_inviscid_equal",
     "0",
     "0.1",
     {STANDARD},
     "equal",
     FX_DIFFUSION | FX_ANTUONO | FX_LIMITER | FX_REPULSION | FX_WALL_DAMPING},
    {"channel",
     "0",
     "0",
     {"water.laminar_viscosity=1e-3", "tank.slip=none"},
     "equal",
     FX_LAMINAR | FX_NO_SLIP},
    {"stream",
     "0",
     "0.1",
     {STANDARD, "water.laminar_viscosity=1e-3", "tank.slip=none", "water.shifting=2"},
     "equal",
     FX_DIFFUSION | FX_ANTUONO | FX_LIMITER | FX_LAMINAR | FX_NO_SLIP | FX_REPULSION |
         FX_WALL_DAMPING | FX_SHIFTING},
    {"body_in_flow",
     "0",
     "0.1",
     {STANDARD, "water.laminar_viscosity=1e-3", "tank.slip=none", "water.shifting=2",
      "numerics.sides=one"},
     "equal",
     FX_DIFFUSION | FX_ANTUONO | FX_LIMITER | FX_LAMINAR | FX_NO_SLIP | FX_REPULSION |
         FX_WALL_DAMPING | FX_SHIFTING | FX_ONE_SIDED},
    {"any", "0", "0.1", {NULL}, "hydrostatic", ANY_EFFECTS},
};

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static uint64_t run(int set, const char *precision, bool generic)
{
    char alpha[64], delta[64], mass[64];
    snprintf(alpha, sizeof alpha, "water.artificial_viscosity=%s", sets[set].alpha);
    snprintf(delta, sizeof delta, "water.density_diffusion=%s", sets[set].delta);
    snprintf(mass, sizeof mass, "water.particle_mass=%s", sets[set].mass);
    rig_switches.generic_variant = generic;
    rig_open(&rig, scene, precision, alpha, delta, mass, sets[set].set[0], sets[set].set[1],
             sets[set].set[2], sets[set].set[3], sets[set].set[4], sets[set].set[5],
             sets[set].set[6], sets[set].set[7], NULL);
    rig_switches.generic_variant = false;
    rig_steps(&rig, 40, 1);
    return simulation_hash(&rig.sim);
}

static void compare(const char *precision)
{
    for (int k = 0; k < (int)COUNT_OF(sets); k++) {
        const uint64_t generic = run(k, precision, true);
        TEST_ASSERT_EQUAL_HEX64(ANY_EFFECTS, rig.sim.fluid.variant->effects);
        const uint64_t stamped = run(k, precision, false);
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(sets[k].effects, rig.sim.fluid.variant->effects,
                                        sets[k].name);
        TEST_ASSERT_EQUAL_INT(0, strncmp(rig.sim.fluid.variant->name, sets[k].name,
                                         strlen(sets[k].name)));
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(generic, stamped, sets[k].name);
    }
}

static void test_mixed(void) { compare("precision=mixed"); }

static void test_double(void) { compare("precision=double"); }

/* Every row of fluid/variants.def is in the table above, so that none goes untested. */
static void test_every_variant_is_compared(void)
{
    const struct fluid_variant *row = fluid_sweeps_mixed.variants;
    for (; row->effects != ANY_EFFECTS; row++) {
        bool found = false;
        for (int k = 0; k < (int)COUNT_OF(sets); k++) found |= sets[k].effects == row->effects;
        TEST_ASSERT_TRUE_MESSAGE(found, row->name);
    }
    for (int k = 0; k + 1 < (int)COUNT_OF(sets); k++) {
        const struct fluid_variant *other = fluid_sweeps_double.variants;
        while (other->effects != ANY_EFFECTS && other->effects != sets[k].effects) other++;
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(sets[k].effects, other->effects, sets[k].name);
    }
}

/* Everything that has a pair law, but FOURTAKAS, which excludes ANTUONO in a case. */
static const char all[] =
    "dp = 1 cm\nend_time = 1\ngravity = 1, -9.81\nprecision = double\n"
    "[numerics]\nsides = one\nsuction = on\n"
    "[fluid water]\nshape = box 0, 0, 0.2, 0.15\nsound_speed = 20\nsurface = 0.15\n"
    "artificial_viscosity = 0.05\nlaminar_viscosity = 0.05\ndensity_diffusion = 0.1\n"
    "diffusion_form = antuono\ndiffusion_limiter = strain\ntensile_control = 0.3\n"
    "wall_repulsion = 0.3\nwall_damping = 1\nshifting = 1\nparticle_mass = hydrostatic\n"
    "[wall tank]\nshape = polyline thickness -0.03: 0, 0.25; 0, 0; 0.4, 0\nslip = none\n"
    "[solid gate]\nshape = box 0.2, 0, 0.23, 0.2\nclamp = box 0.2, 0.17, 0.23, 0.2\n"
    "density = 1100\nyoung = 1e6\npoisson = 0.4\nslip = none\n"
    "[wall line]\nshape = polyline: 0.19, 0.05; 0.19, 0.12\n"
    "[contact c]\nbetween = gate, line\nenabled = off\n";

/* Hashes of the sums of an evaluation with a set of effects: over the fluid, and the force on the
 * solid. */
static void sums_with(effect_set effects, uint64_t *fluid, uint64_t *force)
{
    rig.sim.effects = rig.sim.fluid.effects = effects;
    rig_evaluate(&rig);
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID],
                                  *const s = &rig.sim.particles[KIND_SOLID];
    const double *const of_fluid[] = {particles->ax,       particles->ay,       particles->ddens,
                                      particles->grad_c_x, particles->grad_c_y, particles->div_r};
    *fluid = *force = HASH_START;
    for (size_t k = 0; k < COUNT_OF(of_fluid); k++)
        *fluid = hash_bytes(*fluid, of_fluid[k], (size_t)particles->n * sizeof(double));
    *force = hash_bytes(*force, s->fx, (size_t)s->n * sizeof(double));
    *force = hash_bytes(*force, s->fy, (size_t)s->n * sizeof(double));
}

/* Each effect that case/effects.def gives a law in the pair sums changes them; those of surfaces
 * change the force on the solid too. An effect without its law, or without its key in the case
 * above, fails. */
static void test_every_pair_effect_has_a_law(void)
{
    rig_switches.generic_variant = true;
    rig_open(&rig, all, NULL);
    rig_switches.generic_variant = false;
    uint64_t seed = 3, fluid, force, fluid_without, force_without;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        struct particles *const particles = &rig.sim.particles[kind];
        for (int64_t i = 0; i < particles->n; i++) {
            particles->x[i] += 0.002 * noise(&seed);
            particles->y[i] += 0.002 * noise(&seed);
            if (kind != KIND_FLUID) continue;
            particles->vx[i] = noise(&seed);
            particles->vy[i] = noise(&seed);
            particles->dens[i] = 0.02 * noise(&seed);
            particles->m[i] = 1 + 0.1 * noise(&seed);
        }
    }
    rig_sort(&rig);
    const effect_set every = rig.sim.effects | FX_FOURTAKAS;
    sums_with(every, &fluid, &force);
    for (int k = 0; k < EFFECT_COUNT; k++) {
        const effect_set bit = EFFECT_BIT(k);
        if (!(bit & PAIR_EFFECTS)) continue;
        TEST_ASSERT_TRUE_MESSAGE(every & bit, effect_table[k].name);
        sums_with(every & ~bit, &fluid_without, &force_without);
        TEST_ASSERT_TRUE_MESSAGE(fluid != fluid_without, effect_table[k].name);
        const bool on_surface = bit & SURFACE_EFFECTS;
        TEST_ASSERT_TRUE_MESSAGE(!on_surface || force != force_without, effect_table[k].name);
    }
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_mixed);
    RUN_TEST(test_double);
    RUN_TEST(test_every_variant_is_compared);
    RUN_TEST(test_every_pair_effect_has_a_law);
    return UNITY_END();
}
