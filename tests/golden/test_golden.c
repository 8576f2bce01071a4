/* SPDX-License-Identifier: MIT
 * The bits are the same on every compiler, instruction set, vector width, optimisation and number
 * of threads: the state of a small gate after 60 steps, held against hashes that are kept here.
 * They change where a law or the order of a sum changes, and then on purpose: the test prints the
 * new ones. */
#include "rig.h"
#include "base/simd.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

static const char gate[] =
    "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.14\nsound_speed = 23.4\nsurface = 0.14\n"
    "artificial_viscosity = 0.05\ndensity_diffusion = 0.1\n"
    "[wall tank]\nshape = polyline thickness -0.02: 0, 0.2; 0, 0; 0.2, 0\n"
    "[wall lid]\nshape = box 0.1, 0.08, 0.115, 0.16\nmotion = lift\n"
    "[motion lift]\ny = t*(0.1 + 2*t)\n"
    "[solid gate]\nshape = box 0.1, 0, 0.115, 0.08\nclamp = box 0.1, 0.06, 0.115, 0.08\n"
    "density = 1100\nyoung = 8e6\npoisson = 0.4\n[contact none]\nenabled = off\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static uint64_t add(uint64_t h, const double *field, int64_t n)
{
    return hash_bytes(h, field, (size_t)n * sizeof *field);
}

static uint64_t hash_after(const char *integrator, const char *precision)
{
    rig_open(&rig, gate, integrator, precision, NULL);
    rig_steps(&rig, 60, 1);
    uint64_t h = HASH_START;
    for (int kind = 0; kind < KIND_COUNT; kind += 2) {
        const struct particles *const particles = &rig.sim.particles[kind];
        h = add(h, particles->x, particles->n);
        h = add(h, particles->y, particles->n);
        h = add(h, particles->vx, particles->n);
        h = add(h, particles->vy, particles->n);
    }
    return add(h, rig.sim.particles[KIND_FLUID].dens, rig.sim.particles[KIND_FLUID].n);
}

static const struct {
    const char *integrator, *precision;
    uint64_t hash;
} golden[] = {
    {"integrator=leapfrog", "precision=mixed", 0x2bcbc9ce7acecf1b},
    {"integrator=symplectic", "precision=mixed", 0x92012387d9a1b42d},
    {"integrator=verlet", "precision=double", 0xf7f7388ff6507559},
};

static void test_bits(void)
{
    char text[160], wrong[1024] = "";
    for (size_t k = 0; k < COUNT_OF(golden); k++) {
        const uint64_t hash = hash_after(golden[k].integrator, golden[k].precision);
        snprintf(text, sizeof text, "\n%s, %s, %d lanes: 0x%016llx", golden[k].integrator,
                 golden[k].precision, LANES_FLOAT, (unsigned long long)hash);
        if (hash != golden[k].hash) strcat(wrong, text);
    }
    if (*wrong) TEST_FAIL_MESSAGE(wrong);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bits);
    return UNITY_END();
}
