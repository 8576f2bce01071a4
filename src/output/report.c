/* SPDX-License-Identifier: MIT
 * summary.json, and the parts of it that --explain prints as JSON, too. */
#include "output/report.h"
#include "base/files.h"

#include <stdlib.h>

static void write_shapes(struct json *j, const char *key, const struct shape_list *list)
{
    static const char *const names[] = {"box", "polygon", "polyline", "circle"};
    json_open(j, key, '[');
    for (int k = 0; k < list->n; k++) {
        const struct shape *shape = &list->item[k];
        json_open(j, NULL, '{');
        json_text(j, "kind", names[shape->kind]);
        json_open(j, "points", '[');
        for (int i = 0; i < shape->n; i++) json_numbers(j, NULL, shape->pt[i], 2);
        json_close(j, ']');
        if (shape->kind == SHAPE_CIRCLE) json_number(j, "radius", shape->size);
        if (shape->kind == SHAPE_POLYLINE) json_number(j, "thickness", shape->size);
        json_close(j, '}');
    }
    json_close(j, ']');
}

static void write_hinges(struct json *j, const char *key, const struct hinge_list *list)
{
    json_open(j, key, '[');
    for (int k = 0; k < list->n; k++) {
        json_open(j, NULL, '{');
        json_numbers(j, "point", list->item[k].at, 2);
        json_text(j, "other", list->item[k].other);
        json_close(j, '}');
    }
    json_close(j, ']');
}

static void write_value(struct json *j, const struct param *param, const void *value)
{
    const struct scene_expr *const field = value;
    switch (param->type) {
    case PARAM_REAL: json_number(j, param->key, *(const double *)value); break;
    case PARAM_INTEGER: json_integer(j, param->key, *(const int *)value); break;
    case PARAM_CHOICE:
        json_text(j, param->key, param_choice(param, *(const int *)value).text);
        break;
    case PARAM_TEXT: json_text(j, param->key, value); break;
    case PARAM_VECTOR: json_numbers(j, param->key, value, 2); break;
    case PARAM_EXPR:
        json_open(j, param->key, '[');
        for (int k = 0; k < param->count; k++)
            if (field->e[k]) json_text(j, NULL, expr_source(field->e[k]));
        json_close(j, ']');
        break;
    case PARAM_SHAPES: write_shapes(j, param->key, value); break;
    case PARAM_HINGES: write_hinges(j, param->key, value); break;
    }
}

static void write_section(struct json *j, enum section_id id, const void *section)
{
    for (int k = 0; k < PARAM_COUNT; k++)
        if (param_table[k].section == id)
            write_value(j, &param_table[k], (const char *)section + param_table[k].offset);
}

/* Keys of the top of the case first; then sections by word, named ones by name below it. */
void report_parameters(struct json *j, const struct scene *scene)
{
    json_open(j, "parameters", '{');
    write_section(j, SECTION_top, section_at(scene, SECTION_top, 0));
    for (int at = 0; at < SECTION_COUNT; at++) {
        const enum section_id id = (enum section_id)at;
        if (id == SECTION_top || section_count(scene, id) == 0) continue;
        json_open(j, section_table[id].word, '{');
        for (int k = 0; k < section_count(scene, id); k++) {
            const struct scene_section_common *section = section_at(scene, id, k);
            if (section_table[id].named) json_open(j, section->name, '{');
            write_section(j, id, section);
            if (section_table[id].named) json_close(j, '}');
        }
        json_close(j, '}');
    }
    json_close(j, '}');
}

void report_derived(struct json *j, const struct scene *scene)
{
    json_open(j, "derived", '{');
    json_number(j, "h", scene->h);
    json_number(j, "c0", scene->c0);
    json_number(j, "rho0", scene->rho0);
    json_numbers(j, "domain_lower", scene->domain_lower, 2);
    json_numbers(j, "domain_upper", scene->domain_upper, 2);
    json_close(j, '}');
}

void report_effects(struct json *j, const struct simulation *sim)
{
    json_open(j, "effects", '[');
    for (int k = 0; k < EFFECT_COUNT; k++)
        if (sim->effects & EFFECT_BIT(k)) json_text(j, NULL, effect_table[k].name);
    json_close(j, ']');
    json_open(j, "effects_called_by", '{');
    for (int k = 0; k < EFFECT_COUNT; k++) {
        struct effect_source source;
        if (!(sim->effects & EFFECT_BIT(k))) continue;
        const bool enabled = effect_enabled(sim->scene, (enum effect)k, &source);
        json_text(j, effect_table[k].name,
                  enabled ? effect_source_text(sim->scene, &source).text : "decided at the start");
    }
    json_close(j, '}');
}

static void number_if(struct json *j, bool known, const char *name, double value)
{
    json_number(j, name, known ? value : (double)NAN);
}

static void write_time_step(struct json *j, const struct simulation *sim)
{
    const struct state *st = &sim->state;
    int most = -1; /* the bound that limited the most steps */
    for (int k = 0; k < BOUND_COUNT; k++)
        if (st->bound_steps[k] > (most < 0 ? 0 : st->bound_steps[most])) most = k;
    json_open(j, "time_step", '{');
    json_number(j, "last", st->dt);
    number_if(j, st->steps, "smallest", st->dt_min);
    number_if(j, st->steps, "largest", st->dt_max);
    number_if(j, st->steps, "mean", st->time / (double)st->steps);
    number_if(j, sim->dt_solid > 0, "solid", sim->dt_solid);
    json_integer(j, "substeps", sim->substeps);
    json_text(j, "bound", most < 0 ? "none" : bound_table[most].name);
    json_open(j, "bound_steps", '{');
    for (int k = 0; k < BOUND_COUNT; k++) json_integer(j, bound_table[k].name, st->bound_steps[k]);
    json_close(j, '}');
    json_close(j, '}');
}

static void write_ledger(struct json *j, const char *name, const struct ledger *l)
{
    json_open(j, name, '{');
#define LEDGER(column, unit, meaning) json_number(j, #column, l->column);
    LEDGER_COLUMNS(LEDGER)
#undef LEDGER
    json_close(j, '}');
}

static double energy_of(const struct ledger *l)
{
    return l->kinetic + l->potential + l->internal + l->elastic + l->hourglass;
}

/* The most that a region has gained by each term of the account (T-46). */
static void write_gains(struct json *j, const struct simulation *sim)
{
    static const char *const names[] = {"fluid", "interface", "solid", "boundaries"};
    const struct energy_account *const account = &sim->state.energy;
    const double available = account->largest_available;
    const bool known = sim->effects & FX_ENERGY_ACCOUNT;
    number_if(j, known, "gain", sim->state.gain);
    number_if(j, known, "gain_over_available_energy", sim->state.gain_share);
    json_open(j, "gains_by_term", '{');
    for (int t = 0; t < ENERGY_TERMS; t++) {
        json_open(j, names[t], '{');
        number_if(j, known, "gain", account->most[t]);
        number_if(j, available > 0, "gain_over_available_energy", account->most[t] / available);
        json_close(j, '}');
    }
    json_close(j, '}');
}

/* Changes over the run. `moved` was converted: kinetic energy and changes of the others. */
static void write_drift(struct json *j, const struct simulation *sim, const struct record *r)
{
    const struct ledger *a = &r->first, *b = &r->last;
    const double moved = fabs(b->potential - a->potential) + fabs(b->internal - a->internal) +
                         fabs(b->elastic - a->elastic) + max2(a->kinetic, b->kinetic);
    json_open(j, "drift", '{');
    json_number(j, "energy_start", energy_of(a));
    json_number(j, "energy_end", energy_of(b));
    json_number(j, "wall_work", sim->state.wall_work);
    json_number(j, "energy_lost_with_particles", sim->state.lost_energy);
    json_number(j, "dissipated", b->dissipated);
    write_gains(j, sim);
    number_if(j, moved > 0, "dissipated_over_moved", b->dissipated / moved);
    json_number(j, "momentum_x", b->momentum_x - a->momentum_x);
    json_number(j, "momentum_y", b->momentum_y - a->momentum_y);
    json_number(j, "mass", b->mass - a->mass);
    json_close(j, '}');
}

static void write_extremes(struct json *j, const struct simulation *sim)
{
    const bool fluid = sim->particles[KIND_FLUID].n > 0, solid = sim->particles[KIND_SOLID].n > 0;
    json_open(j, "extremes", '{');
    number_if(j, fluid, "density_lowest", sim->state.dens_low);
    number_if(j, fluid, "density_highest", sim->state.dens_high);
    number_if(j, fluid, "speed_highest", sim->state.speed_high);
    number_if(j, solid, "det_F_lowest", sim->state.det_low);
    json_close(j, '}');
}

double report_rate(const struct simulation *sim, const struct record *r)
{
    const double steps = (double)(sim->state.particle_steps - r->start_particle_steps);
    return r->wall_seconds > 0 ? steps / r->wall_seconds : 0;
}

static void write_cost(struct json *j, const struct simulation *sim, const struct record *r)
{
    json_integer(j, "steps", sim->state.steps);
    json_integer(j, "solid_substeps", sim->state.solid_substeps);
    json_number(j, "wall_seconds", r->wall_seconds);
    json_open(j, "phase_seconds", '{');
    for (int k = 0; k < PHASE_COUNT; k++)
        if (phase_runs((enum phase)k, sim->effects))
            json_number(j, phase_table[k].name, sim->phase_seconds[k]);
    json_close(j, '}');
    json_number(j, "particle_steps_per_second", report_rate(sim, r));
    json_integer(j, "threads", r->threads);
    json_integer(j, "memory_bytes", (int64_t)sim->arena.bytes);
}

/* Mass, momentum and energy that open boundaries have brought in, less what has left there. */
static void write_open(struct json *j, const struct simulation *sim)
{
    const struct open_boundaries *const o = &sim->open;
    if (o->n == 0) return;
    json_open(j, "open_boundaries", '{');
    for (int k = 0; k < o->n; k++) {
        const int64_t entered = o->count[k][OPEN_ENTERED], left = o->count[k][OPEN_LEFT];
        json_open(j, o->boundary[k].common->name, '{');
        json_integer(j, "particles_made", entered);
        json_integer(j, "particles_ended", left);
        json_number(j, "mass", sim->fluid.k.mass * (double)(entered - left));
        json_number(j, "momentum_x", o->sum[k][OPEN_MOMENTUM_X]);
        json_number(j, "momentum_y", o->sum[k][OPEN_MOMENTUM_Y]);
        json_number(j, "energy", o->sum[k][OPEN_ENERGY]);
        json_number(j, "mean_flow", o->sum[k][OPEN_MEAN_FLOW]);
        json_close(j, '}');
    }
    json_close(j, '}');
}

static void write_counters(struct json *j, const struct state *st)
{
    json_open(j, "counters", '{');
    json_integer(j, "evaluations", st->evaluations);
    json_integer(j, "solid_evaluations", st->solid_evaluations);
    json_integer(j, "sorts", st->sorts);
    json_integer(j, "particle_steps", st->particle_steps);
    json_number(j, "exchanged_impulse", st->exchanged);
    json_integer(j, "tension_limited", st->tension_limited);
    json_close(j, '}');
}

/* --- loads: the largest means of forces over time, and their impulse (T-76b) --- */

/* The mean of largest magnitude over as many intervals between rows as come next to the window, two
 * at least, and where it begins. `sum` is the integral up to each row. */
static double largest_mean(const struct curve *c, const double *sum, double window, double *from)
{
    const double n = c->n > 1 ? nearbyint(window / (c->t[1] - c->t[0])) : 0;
    double mean = *from = (double)NAN;
    for (int k = 0, end = (int)n; n >= 2 && n < c->n && end < c->n; k++, end++) {
        const double here = (sum[end] - sum[k]) / (c->t[end] - c->t[k]);
        if (!(fabs(here) <= fabs(mean))) mean = here, *from = c->t[k];
    }
    return mean;
}

static void write_column(struct json *j, const struct curve *c, double *sum, double window)
{
    const double windows[] = {1e-3, 5e-3, 20e-3, window};
    const int n = window > 0 ? 4 : 3;
    double mean[4], from[4], impulse[4], top[2] = {0};
    for (int k = 0; k < c->n; k++) {
        if (fabs(c->value[k]) > fabs(top[0])) top[0] = c->value[k], top[1] = c->t[k];
        if (k > 0)
            sum[k] = sum[k - 1] + 0.5 * (c->t[k] - c->t[k - 1]) * (c->value[k] + c->value[k - 1]);
    }
    for (int k = 0; k < n; k++) {
        mean[k] = largest_mean(c, sum, windows[k], &from[k]);
        impulse[k] = mean[k] * windows[k];
    }
    json_numbers(j, "window", windows, n);
    json_numbers(j, "largest_mean", mean, n);
    json_numbers(j, "from", from, n);
    json_numbers(j, "impulse", impulse, n);
    json_number(j, "impulse_of_run", c->n > 0 ? sum[c->n - 1] : 0);
    json_number(j, "largest_single_row", top[0]);
    json_number(j, "largest_single_row_time", top[1]);
}

/* By column of each force, reaction and surface pressure, whose files are in the folder. */
static enum err write_loads(struct json *j, const char *folder, const struct probes *probes,
                            const struct scene *scene, struct diag *d)
{
    char path[PATH_BYTES], name[PROBE_COLUMN_TEXT];
    for (int p = 0; p < probes->n; p++) {
        const struct probe *const probe = &probes->probe[p];
        if (probe->given->quantity != PROBE_FORCE && probe->given->quantity != PROBE_REACTION &&
            probe->given->quantity != PROBE_SURFACE_PRESSURE)
            continue;
        TRY(path_join(path, folder, probes->file[probe->file].name, d));
        for (int c = 0; probe_column(&scene->probe[p], c, name, sizeof name); c++) {
            struct curve curve;
            TRY(curve_read(&curve, path, probe->column + c, 1, d));
            json_open(j, name, '{');
            write_column(j, &curve, curve.value + curve.n, scene->probe[p].load_window);
            json_close(j, '}');
            free(curve.t);
        }
    }
    return ERR_OK;
}

/* --- all --- */

static void write_head(struct json *j, const struct simulation *sim, const struct record *r)
{
    json_text(j, "title", sim->scene->top.title);
    json_text(j, "case", sim->scene->path);
    json_text(j, "version", r->version);
    json_text(j, "exit_reason", r->exit_reason);
    json_text(j, "message", r->message);
    json_number(j, "time", simulation_time(sim));
    json_number(j, "end_time", sim->scene->top.end_time);
    json_number(j, "start_time", r->start_time);
    json_text(j, "restarted_from", r->restarted_from);
    json_text(j, "forked_from", r->forked_from);
    json_integer(j, "snapshots_missed", r->snapshots_missed);
}

enum err report_summary(const char *folder, struct simulation *sim, const struct record *r,
                        struct diag *d)
{
    struct atomic_file out;
    TRY(atomic_file_open(&out, folder, "summary.json", d));
    struct json j = {.file = out.file};
    json_open(&j, NULL, '{');
    write_head(&j, sim, r);
    json_open(&j, "particles", '{');
    for (int k = 0; k < KIND_COUNT; k++) json_integer(&j, kind_names[k], sim->particles[k].n);
    json_close(&j, '}');
    json_integer(&j, "fluid_left_domain", sim->state.lost);
    write_cost(&j, sim, r);
    report_effects(&j, sim);
    write_time_step(&j, sim);
    write_extremes(&j, sim);
    write_drift(&j, sim, r);
    write_open(&j, sim);
    write_ledger(&j, "ledger_start", &r->first);
    write_ledger(&j, "ledger_end", &r->last);
    write_counters(&j, &sim->state);
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)simulation_hash(sim));
    json_text(&j, "state_hash", hash);
    if (r->references->scored) references_write(&j, r->references);
    json_open(&j, "loads", '{');
    struct diag why = {.warn = NULL};
    if (r->probes && write_loads(&j, folder, r->probes, sim->scene, &why))
        diag_warn(d, "loads are missing in summary.json: %s", why.text);
    json_close(&j, '}');
    report_derived(&j, sim->scene);
    report_parameters(&j, sim->scene);
    json_close(&j, '}');
    return atomic_file_commit(&out, d);
}
