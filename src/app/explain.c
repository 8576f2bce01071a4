/* SPDX-License-Identifier: MIT
 * --explain: what would be simulated and what it would cost, as text and as JSON. */
#include "app/session.h"
#include "check/check.h"
#include "output/report.h"
#include "time/timestep.h"

static void say_scene(const struct session *session, const struct sphfsi_options *o)
{
    const struct scene *scene = &session->scene;
    session_say(o, "%s: %s", scene->path, scene->top.title);
    session_say(o, "  dp %g m, h %g m, simulated time %g s", scene->top.dp, scene->h,
                scene->top.end_time);
    if (scene->c0 > 0)
        session_say(o, "  speed of sound %g m/s, density %g kg/m^3", scene->c0, scene->rho0);
    for (int k = 0; k < KIND_COUNT; k++)
        session_say(o, "  %-6s %10lld particles", kind_names[k],
                    (long long)session->simulation.particles[k].n);
}

/* How bodies are sampled where the lattice is not simply the common one. */
static void say_lattices(const struct scene *scene, const struct sphfsi_options *o)
{
    const double degrees = 180 / PI;
    if (scene->lattice.angle != 0)
        session_say(o, "  fluid and walls are sampled on a lattice at %.4g degrees",
                    scene->lattice.angle * degrees);
    for (int k = 0; k < scene->n_solid; k++) {
        const struct scene_lattice *const l = &scene->solid_lattice[k];
        const double off = fabs(l->area_error) < 5e-5 ? 0 : l->area_error;
        if (l->angle == 0 && !l->fitted && off == 0) continue;
        session_say(o,
                    "  [solid %s] lattice at %.4g degrees, cells of %.5g x %.5g m, area off by "
                    "%.2g %%, bending stiffness of a thin body by about %.2g %%",
                    scene->solid[k].common.name, l->angle * degrees, l->spacing[0], l->spacing[1],
                    100 * off, 100 * (square(1 + off) * (1 + off) - 1));
    }
}

static void say_effects(const struct simulation *sim, const struct sphfsi_options *o)
{
    session_say(o, "enabled effects, and the setting that enables each");
    for (int k = 0; k < EFFECT_COUNT; k++) {
        if (!(sim->effects & EFFECT_BIT(k))) continue;
        struct effect_source source;
        const bool enabled = effect_enabled(sim->scene, (enum effect)k, &source);
        session_say(o, "  %-16s %-42s %s%s%s", effect_table[k].name,
                    enabled ? effect_source_text(sim->scene, &source).text : effect_table[k].key,
                    effect_table[k].meaning, effect_table[k].equation[0] ? "; " : "",
                    effect_table[k].equation);
    }
    session_say(o, "disabled effects, and the setting that would enable each");
    for (int k = 0; k < EFFECT_COUNT; k++)
        if (!(sim->effects & EFFECT_BIT(k)))
            session_say(o, "  %-16s %-42s %s", effect_table[k].name, effect_table[k].key,
                        effect_table[k].meaning);
}

static void say_fields(const struct simulation *sim, const struct sphfsi_options *o)
{
    session_say(o, "memory");
    for (int k = 0; k < KIND_COUNT; k++) {
        const struct particles *particles = &sim->particles[k];
        if (particles->capacity == 0) continue;
        const size_t bytes = particles_bytes(particles);
        session_say(o, "  %-6s %.3g MB, %zu bytes per particle", kind_names[k],
                    1e-6 * (double)bytes, bytes / (size_t)particles->capacity);
    }
    session_say(
        o, "  total %.3g MB (fields, cells, packed copies, stencils), and %.3g MB for the case",
        1e-6 * (double)sim->arena.bytes, 1e-6 * (double)sim->scene->arena.bytes);
}

static bool is_known(const struct simulation *sim, enum bound bound)
{
    return isfinite(sim->dt_bound[bound]) && sim->dt_bound[bound] > 0;
}

struct amount {
    char text[32];
};

static struct amount text_of_bytes(double bytes)
{
    struct amount to;
    const bool large = bytes >= 1e9;
    snprintf(to.text, sizeof to.text, "%.3g %s", (large ? 1e-9 : 1e-6) * bytes,
             large ? "GB" : "MB");
    return to;
}

static void say_bounds(const struct simulation *sim, const struct sphfsi_options *o)
{
    const enum bound binding = timestep_binding(sim);
    const struct scene *const scene = sim->scene;
    if (!(sim->effects & FX_FLUID))
        session_say(o, "bounds of the time step");
    else
        session_say(o, "bounds of the time step, C_CFL = %g", scene->numerics.cfl);
    for (int k = 0; k < BOUND_COUNT; k++) {
        const bool known = is_known(sim, (enum bound)k);
        char value[32] = "-";
        if (known) snprintf(value, sizeof value, "%.4g s", sim->dt_bound[k]);
        session_say(o, "  %-10s %12s  %s%s", bound_table[k].name, value, bound_table[k].source,
                    known && k == (int)binding ? "  <- limits the step" : "");
    }
    if (sim->stiffest)
        session_say(o, "  the step `solid` is that of [spring %s]; a softer one lengthens it",
                    scene->spring[sim->stiffest - 1].common.name);
    if (sim->particles[KIND_SOLID].n == 0) return;
    session_say(o, "  stable step of the solid: %.4g s", sim->dt_solid);
    if (sim->effects & FX_COUPLING)
        session_say(o, "  %d solid sub-step%s in each fluid step", sim->substeps,
                    sim->substeps == 1 ? "" : "s");
    if (sim->effects & FX_COUPLING)
        session_say(o,
                    "  sub-steps alone: %.0f in each fluid step; an implicit step costs as much as "
                    "%.0f sub-steps for bodies %.3g particles across (T-94)",
                    whole_parts(timestep_fluid_limit(sim) / sim->dt_solid),
                    implicit_pays_from(&sim->solid, &sim->particles[KIND_SOLID]),
                    implicit_across(&sim->solid, &sim->particles[KIND_SOLID]));
    if (sim->solid.implicit && sim->effects & FX_CONTACT)
        session_say(o, "  while surfaces are near each other: sub-steps, because the springs of "
                       "contact are not in the matrix");
}

static struct amount text_of_seconds(double seconds)
{
    struct amount to;
    const double unit = seconds < 120 ? 1 : seconds < 7200 ? 60 : 3600;
    snprintf(to.text, sizeof to.text, "%.3g %s", seconds / unit,
             unit == 1    ? "s"
             : unit == 60 ? "min"
                          : "h");
    return to;
}

/* Time over forecast: 0.83 to 1.34 in 90 % of 250 runs of `make forecast` on an idle machine with
 * two cores, on one and two threads, of half a second and more. */
static const double least_of_forecast = 0.8, most_of_forecast = 1.35;

static void say_cost(const struct simulation *sim, const struct forecast *f,
                     const struct sphfsi_options *o)
{
    const int threads = sim->team.most;
    char coarse[64] = "";
    if (f->coarse_dp > 0)
        snprintf(coarse, sizeof coarse, " and a run at dp = %.3g m", f->coarse_dp);
    session_say(o, "cost with %s%d thread%s, measured in 0.3 s of trial steps%s",
                threads > 1 ? "up to " : "", threads, threads == 1 ? "" : "s", coarse);
    for (int k = 0; k < PHASE_COUNT; k++)
        if (k != PHASE_output && f->phase_fraction[k] > 0)
            session_say(o, "  %-7s %5.1f %% of a step  %s", phase_table[k].name,
                        100 * f->phase_fraction[k], phase_table[k].meaning);
    if (f->fluid > 0) session_say(o, "  %.3g ns per fluid particle and evaluation", 1e9 * f->fluid);
    if (f->solid > 0) session_say(o, "  %.3g ns per solid particle and step", 1e9 * f->solid);
    session_say(o, "  about %.3g steps of %.3g s", f->steps, f->dt);
    if (f->substeps > f->steps) session_say(o, "  about %.3g solid sub-steps", f->substeps);
    session_say(o, "  %s on this machine when idle, memory %s, disk at most %s",
                text_of_seconds(f->seconds).text, text_of_bytes(f->memory).text,
                text_of_bytes(f->disk).text);
    session_say(o, "  nine of ten runs take %s to %s; more on a busy machine",
                text_of_seconds(least_of_forecast * f->seconds).text,
                text_of_seconds(most_of_forecast * f->seconds).text);
    if (sim->effects & FX_RELAX)
        session_say(o, "  this is without the time that [relax] needs to find the state of rest");
}

static enum err forecast_cost(struct forecast *f, struct session *session,
                              const struct sphfsi_options *o, struct diag *d)
{
    const enum err e = forecast_run(f, session, o, d);
    check_simulation(&session->simulation, d); /* bounds of the step are known now */
    return e;
}

static enum err say_trial(struct session *session, const struct sphfsi_options *o, struct diag *d)
{
    struct simulation *const sim = &session->simulation;
    struct forecast f;
    TRY(forecast_cost(&f, session, o, d));
    say_bounds(sim, o);
    say_cost(sim, &f, o);
    evidence_say(sim->scene, o);
    return ERR_OK;
}

static enum err explain_text(struct session *session, const struct sphfsi_options *o,
                             struct diag *d)
{
    struct simulation *sim = &session->simulation;
    say_scene(session, o);
    say_lattices(&session->scene, o);
    say_effects(sim, o);
    say_fields(sim, o);
    const struct scene_top *const top = &session->scene.top;
    session_say(o,
                "scheme %s, integrator %s, precision %s; compiled loops of the fluid: %s, of the "
                "solid: %s",
                param_choice(param_find(SECTION_top, "scheme"), top->scheme).text,
                param_choice(param_find(SECTION_top, "integrator"), top->integrator).text,
                param_choice(param_find(SECTION_top, "precision"), top->precision).text,
                sim->particles[KIND_FLUID].n > 0 ? sim->fluid.variant->name : "none",
                sim->solid.sweeps ? sim->solid.sweeps->name : "none");
    return say_trial(session, o, d);
}

/* --- the same as JSON --- */

static void write_scene(struct json *j, const struct session *session)
{
    const struct scene *const scene = &session->scene;
    json_text(j, "title", scene->top.title);
    json_text(j, "case", scene->path);
    json_number(j, "dp", scene->top.dp);
    json_number(j, "end_time", scene->top.end_time);
    json_open(j, "particles", '{');
    for (int k = 0; k < KIND_COUNT; k++)
        json_integer(j, kind_names[k], session->simulation.particles[k].n);
    json_close(j, '}');
}

static void write_bounds(struct json *j, const struct simulation *sim)
{
    const enum bound binding = timestep_binding(sim);
    json_open(j, "time_step_bounds", '{');
    for (int k = 0; k < BOUND_COUNT; k++)
        if (is_known(sim, (enum bound)k)) json_number(j, bound_table[k].name, sim->dt_bound[k]);
    json_close(j, '}');
    json_text(j, "time_step_bound", is_known(sim, binding) ? bound_table[binding].name : "none");
    if (sim->particles[KIND_SOLID].n > 0) json_number(j, "solid_time_step", sim->dt_solid);
}

static void write_cost(struct json *j, const struct simulation *sim, const struct forecast *f)
{
    json_open(j, "cost", '{');
    json_integer(j, "threads", sim->team.most);
    json_number(j, "time_step", f->dt);
    json_number(j, "steps", f->steps);
    json_number(j, "solid_substeps", f->substeps);
    json_number(j, "wall_seconds", f->seconds);
    json_number(j, "row_seconds", f->rows);
    json_number(j, "memory_bytes", f->memory);
    json_number(j, "disk_bytes", f->disk);
    json_open(j, "phase_shares", '{');
    for (int k = 0; k < PHASE_COUNT; k++)
        if (k != PHASE_output && f->phase_fraction[k] > 0)
            json_number(j, phase_table[k].name, f->phase_fraction[k]);
    json_close(j, '}');
    json_close(j, '}');
}

struct explained {
    struct session *session;
    const struct call *call;
};

static void write_warnings(struct json *j, const char *line)
{
    char text[sizeof((struct diag *)0)->text];
    json_open(j, "warnings", '[');
    for (; *line; line += strcspn(line, "\n") + 1) {
        snprintf(text, sizeof text, "%.*s", (int)strcspn(line, "\n"), line);
        json_text(j, NULL, text);
    }
    json_close(j, ']');
}

static enum err write_all(struct json *j, void *context, struct diag *d)
{
    const struct explained *const of = context;
    struct session *const session = of->session;
    struct simulation *const sim = &session->simulation;
    struct forecast f;
    json_open(j, NULL, '{');
    write_scene(j, session);
    report_effects(j, sim);
    TRY(forecast_cost(&f, session, &of->call->options, d));
    write_bounds(j, sim);
    write_cost(j, sim, &f);
    report_derived(j, &session->scene);
    report_parameters(j, &session->scene);
    write_warnings(j, of->call->warned.more);
    json_close(j, '}');
    return ERR_OK;
}

static enum err explain_json(struct session *session, const struct sphfsi_options *o,
                             struct diag *d)
{
    return session_json(o, write_all, &(struct explained){session, o->context}, d);
}

enum sphfsi_status sphfsi_explain(const struct sphfsi_options *options)
{
    return call_of_case("explain", options, true, explain_text);
}

enum sphfsi_status sphfsi_explain_json(const struct sphfsi_options *options)
{
    return call_of_case("explain", options, true, explain_json);
}
