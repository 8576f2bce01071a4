/* SPDX-License-Identifier: MIT */
#include "app/budget.h"

#include "app/forecast.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Candidates for dp: these times a power of ten, m. */
static const double round_numbers[] = {1, 1.25, 2, 2.5, 4, 5, 8};
/* Candidates with more particles are skipped. */
static const double most_particles = 2e7;

/* Whether the case can be read with this spacing and all bodies are on the lattice; `why` not. */
static bool fits(const struct sphfsi_options *o, double dp, const char **why)
{
    struct diag d = {.code = ERR_OK};
    struct session *const s = calloc(1, sizeof *s);
    const char **const sets = calloc((size_t)o->n_sets + 1, sizeof *sets);
    char set[40];
    snprintf(set, sizeof set, "dp=%.17g", dp);
    struct sphfsi_options mine = *o;
    *why = "the case refuses it";
    if (s && sets) {
        for (int k = 0; k < o->n_sets; k++) sets[k] = o->sets[k];
        sets[o->n_sets] = set;
        mine.sets = sets;
        mine.n_sets++;
        if (session_read(s, &mine, &d) == ERR_OK) {
            *why = s->scene.off_lattice ? "bodies off the lattice" : "";
            scene_free(&s->scene);
        }
    }
    free(sets);
    free(s);
    return !**why;
}

static void say_one(const struct sphfsi_options *o, double dp, const struct forecast *f,
                    const char *remark)
{
    session_say(o, "  dp %-9.4g m %10.3g particles %10.3g steps %10.3g s %8.3g MB  %s", dp,
                f->particles, f->steps, f->seconds, 1e-6 * f->memory, remark);
}

static void propose(const struct session *x, const struct unit_costs *c, int threads,
                    double seconds, const struct sphfsi_options *o)
{
    const double dp0 = x->scene.top.dp;
    double best = 0;
    session_say(o, "budget of %.4g s with %d thread%s on this machine when idle", seconds, threads,
                threads == 1 ? "" : "s");
    for (int power = (int)ceil(log10(dp0)) + 1; power > -9; power--)
        for (int k = (int)COUNT_OF(round_numbers) - 1; k >= 0; k--) {
            const double dp = round_numbers[k] * pow(10, power), scale = dp / dp0;
            const struct forecast f = forecast_run(c, &x->simulation, threads, scale);
            /* Prints candidates from a tenth of the budget to three times the budget. */
            if (f.seconds < 0.1 * seconds || f.seconds > 3 * seconds ||
                f.particles > most_particles)
                continue;
            const char *why = "";
            const bool good = fits(o, dp, &why);
            if (good && f.seconds <= seconds) best = dp;
            say_one(o, dp, &f, good ? f.seconds <= seconds ? "fits" : "too long" : why);
        }
    const struct forecast own = forecast_run(c, &x->simulation, threads, 1);
    say_one(o, dp0, &own, "the case's own");
    if (best > 0)
        session_say(o, "finest dp within the budget: --set dp=%.6g", best);
    else
        session_say(o,
                    "no listed dp both fits all bodies to the lattice and runs within the budget; "
                    "allow more time or choose another dp");
}

enum err budget_session(struct session *x, int threads, double seconds,
                        const struct sphfsi_options *o, struct diag *d)
{
    struct unit_costs c;
    TRY(forecast_calibrate(&c, &x->simulation, d));
    propose(x, &c, threads, seconds, o);
    forecast_say_errors(&x->scene, o);
    return ERR_OK;
}
