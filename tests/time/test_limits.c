/* SPDX-License-Identifier: MIT
 * What an effect adds to a step vanishes with its parameter: a scene that has it at next to
 * nothing, so that its code runs, keeps the bits of one that has not. */
#include "rig.h"
#include "unity.h"

#include <string.h>

static const char fluid[] =
    "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n[numerics]\nfixed_step = 5e-5\n"
    "[fluid w]\nshape = box 0, 0, 0.06, 0.04\nsound_speed = 20\nsurface = 0.04\n"
    "velocity = 20*y, -30*x + y\n"
    "[wall tank]\nshape = polyline thickness -0.02: 0, 0.08; 0, 0; 0.06, 0; 0.06, 0.08\n"
    "[motion still]\nx = 0\n";

static const char solid[] =
    "dp = 1 cm\nend_time = 1\n[numerics]\nfixed_step = 1e-5\n"
    "[solid a]\nshape = box 0, 0, 0.1, 0.05\ndensity = 1100\nyoung = 2e6\npoisson = 0.4\n"
    "hourglass = 0\nartificial_viscosity = 0\nvelocity = 8*y, 0.5 - 200*x*x\n";

static const struct {
    const char *scene;
    enum effect effect;
    const char *set, *another;
} limits[] = {
    {fluid, EFFECT_VISCOSITY, "w.artificial_viscosity=1e-300", ""},
    {fluid, EFFECT_DIFFUSION, "w.density_diffusion=1e-300", ""},
    {fluid, EFFECT_FOURTAKAS, "w.density_diffusion=1e-300", "w.diffusion_form=fourtakas"},
    {fluid, EFFECT_ANTUONO, "w.density_diffusion=1e-300", "w.diffusion_form=antuono"},
    {fluid, EFFECT_LIMITER, "w.density_diffusion=1e-300", "w.diffusion_limiter=strain"},
    {fluid, EFFECT_LAMINAR, "w.laminar_viscosity=1e-300", ""},
    {fluid, EFFECT_NO_SLIP, "w.laminar_viscosity=1e-300", "tank.slip=none"},
    {fluid, EFFECT_TENSILE, "w.tensile_control=1e-300", ""},
    {fluid, EFFECT_REPULSION, "w.wall_repulsion=1e-300", ""},
    {fluid, EFFECT_SHIFTING, "w.shifting=1e-300", ""},
    {fluid, EFFECT_MOTION, "tank.motion=still", ""},
    {solid, EFFECT_HOURGLASS, "a.hourglass=1e-300", ""},
    {solid, EFFECT_HOURGLASS, "a.hourglass=1e-300", "a.hourglass_form=printed"},
    {solid, EFFECT_SOLID_VISCOSITY, "a.artificial_viscosity=1e-300", ""},
    {solid, EFFECT_SOLID_VISCOSITY, "a.artificial_viscosity=1e-300", "a.viscosity_form=printed"},
    {solid, EFFECT_KELVIN_VOIGT, "a.damping_time=1e-300", ""},
};

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* Where the particles are after some steps, and how fast. */
static uint64_t hash_of(const char *scene, const char *set, const char *another)
{
    rig_open(&rig, scene, set, *another ? another : "title=limit", NULL);
    rig_steps(&rig, 12, 1);
    uint64_t h = HASH_START;
    const struct particles *const particles =
        &rig.sim.particles[scene == fluid ? KIND_FLUID : KIND_SOLID];
    const double *const fields[] = {particles->x, particles->y, particles->vx, particles->vy};
    for (size_t f = 0; f < COUNT_OF(fields); f++)
        for (int64_t i = 0; i < particles->n; i++) {
            uint64_t bits;
            memcpy(&bits, &fields[f][i], sizeof bits);
            h = (h ^ bits) * HASH_PRIME;
        }
    return h;
}

static void test_next_to_nothing_changes_no_bit(void)
{
    for (size_t k = 0; k < COUNT_OF(limits); k++) {
        const uint64_t without = hash_of(limits[k].scene, "title=without", "");
        TEST_ASSERT_FALSE_MESSAGE(rig.sim.effects & EFFECT_BIT(limits[k].effect), limits[k].set);
        const uint64_t with = hash_of(limits[k].scene, limits[k].set, limits[k].another);
        TEST_ASSERT_TRUE_MESSAGE(rig.sim.effects & EFFECT_BIT(limits[k].effect), limits[k].set);
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(without, with, limits[k].set);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_next_to_nothing_changes_no_bit);
    return UNITY_END();
}
