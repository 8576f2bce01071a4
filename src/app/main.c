/* SPDX-License-Identifier: MIT
 * The command line. */
#include "sphfsi.h"

#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "usage: sphfsi CASE.cfg [options]\n"
    "  --out DIR         folder of the results (runs/<case name>)\n"
    "  --threads N       threads to use at most (as many as are useful)\n"
    "  --until TIME      simulated time to end at, in s or as 50ms (end_time of the case)\n"
    "  --set KEY=VALUE   replace a value of the case: dp=1mm, \"solid gate.young=12MPa\"; "
    "repeatable\n"
    "  --restart [FILE]  continue from the newest valid checkpoint of the run, or from FILE\n"
    "  --fork FILE       start a new run, with other physics, from a checkpoint, or the\n"
    "                    newest one in a run's folder\n"
    "  --quiet           no progress, only warnings, results and how to go on\n"
    "instead of running:\n"
    "  --preview         draw the scene with names, clamps, probes and a grid: preview-<case "
    "name>.svg,\n"
    "                    or the file that --out names\n"
    "  --explain         say what would be simulated and what it would cost\n"
    "  --effective       print the case in effect, every default spelled out\n"
    "  --cite            print the sources of the methods that the case uses\n"
    "  --inspect FILE    describe a checkpoint, or the newest one in a run's folder\n"
    "  --new NAME        print a commented case to start from; without a name, list them\n"
    "  --keys [--json]   print all sections and keys of a case file\n"
    "  --version, --help\n"
    "exit status: 0 finished, 1 wrong input, 2 stopped by a guard or a failure,\n"
    "             129, 130 or 143 interrupted with a checkpoint, or before the first step\n"
    "SIGUSR1: write a checkpoint and continue\n";

/* What the program does: RUN unless an option says otherwise. */
enum mode { RUN, PREVIEW, EXPLAIN, EFFECTIVE, CITE, INSPECT, NEW, KEYS, KEYS_JSON, VERSION, HELP };

/* Whether an option takes an operand. */
enum takes { NOTHING, OPERAND, MAYBE };

static const struct option {
    const char *name;
    enum takes takes;
    enum mode mode;
} options[] = {
    {"--out", OPERAND, RUN},         {"--threads", OPERAND, RUN},
    {"--until", OPERAND, RUN},       {"--set", OPERAND, RUN},
    {"--restart", MAYBE, RUN},       {"--fork", OPERAND, RUN},
    {"--quiet", NOTHING, RUN},       {"--preview", NOTHING, PREVIEW},
    {"--explain", NOTHING, EXPLAIN}, {"--effective", NOTHING, EFFECTIVE},
    {"--cite", NOTHING, CITE},       {"--inspect", OPERAND, INSPECT},
    {"--new", MAYBE, NEW},           {"--keys", NOTHING, KEYS},
    {"--json", NOTHING, KEYS_JSON},  {"--version", NOTHING, VERSION},
    {"--help", NOTHING, HELP},       {"-h", NOTHING, HELP},
};
enum { OPTION_COUNT = sizeof options / sizeof options[0] };

struct command {
    struct sphfsi_options options;
    enum mode mode;
    const char *operand; /* of the option that chose the mode */
    int quiet;
    int terminal, line_open; /* stderr is a terminal; it shows a progress line */
    double last_fraction, last_line;
};

static struct sphfsi_requests requests;

/* While the case is sampled, nothing is written and there is nothing to save. */
static void on_signal(int number)
{
    if (number != SIGUSR1 && !requests.begun) _exit(128 + number);
    if (number == SIGUSR1)
        requests.checkpoint = 1;
    else
        requests.stop = number;
}

/* A second SIGINT ends the program at once; batch systems send SIGTERM more than once. */
static void install_signals(void)
{
    struct sigaction once = {.sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND};
    struct sigaction again = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    sigaction(SIGINT, &once, NULL);
    sigaction(SIGTERM, &again, NULL);
    sigaction(SIGUSR1, &again, NULL);
    /* nohup asks for SIGHUP to be ignored. */
    struct sigaction inherited;
    if (sigaction(SIGHUP, NULL, &inherited) == 0 && inherited.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &again, NULL);
    /* A file that may not grow is a failed write, which is reported; so is a closed pipe. */
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
}

static void clear_line(struct command *c)
{
    if (c->line_open) fputs("\r\033[K", stderr);
    c->line_open = 0;
}

static void on_message(void *context, enum sphfsi_message kind, const char *text)
{
    struct command *c = context;
    clear_line(c);
    if (kind == SPHFSI_WARNING)
        fprintf(stderr, "warning: %s\n", text);
    else if (!c->quiet || kind == SPHFSI_RESULT)
        printf("%s\n", text);
    fflush(stdout);
}

static void text_of_remaining(double seconds, char text[32])
{
    if (seconds < 0)
        snprintf(text, 32, "?");
    else if (seconds < 3600)
        snprintf(text, 32, "%d:%02d", (int)seconds / 60, (int)seconds % 60);
    else
        snprintf(text, 32, "%.1f h", seconds / 3600);
}

/* A line, updated on a terminal; elsewhere one for each tenth of the run or half a minute. */
static void on_progress(void *context, const struct sphfsi_progress *p)
{
    struct command *c = context;
    const double span = p->end_time - p->start_time;
    const double fraction = span > 0 ? (p->time - p->start_time) / span : 1;
    if (!c->terminal && !p->finished && floor(10 * fraction) <= floor(10 * c->last_fraction) &&
        p->wall_seconds - c->last_line < 30)
        return;
    if (fraction >= 1 && !p->finished) return; /* the last call follows */
    c->last_fraction = fraction;
    c->last_line = p->wall_seconds;
    if (p->finished) {
        clear_line(c);
        return;
    }
    char left[32];
    text_of_remaining(p->seconds_left, left);
    fprintf(stderr, "%s%5.1f %%  t %.5g s  dt %.3g s (%s)  %.3g M particle steps/s  %s left%s",
            c->terminal ? "\r" : "", 100 * fraction, p->time, p->dt, p->bound,
            1e-6 * p->particle_steps_per_second, left, c->terminal ? "\033[K" : "\n");
    fflush(stderr);
    c->line_open = c->terminal;
}

static int usage_error(const char *format, const char *a, const char *b)
{
    fputs("sphfsi: ", stderr);
    fprintf(stderr, format, a, b);
    fputs("; --help lists the options\n", stderr);
    return 1;
}

static int read_threads(const char *text, int *threads)
{
    char *end;
    const double value = strtod(text, &end);
    if (end == text || *end || !(value >= 1 && value <= INT_MAX) || value != floor(value))
        return usage_error("%s %s: give a whole number from 1 to 2147483647", "--threads", text);
    *threads = (int)value;
    return 0;
}

/* A simulated time, above 0 and at most 1e9 s; without a unit it is in s. */
static int read_time(const char *text, double *seconds)
{
    static const struct {
        const char *unit;
        double seconds;
    } units[] = {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}, {"h", 3600}, {"", 1}};
    char *end;
    const double number = strtod(text, &end);
    while (end != text && *end == ' ') end++;
    for (size_t k = 0; k < sizeof units / sizeof units[0]; k++)
        if (end != text && strcmp(end, units[k].unit) == 0) {
            *seconds = number * units[k].seconds;
            if (*seconds >= 1e-300 && *seconds <= 1e9) return 0;
        }
    return usage_error("%s %s: give a time such as 0.5, 0.5s or 500ms, above 0 and at most 1e9 s",
                       "--until", text);
}

static int apply_option(struct command *c, const struct option *option, const char *operand)
{
    struct sphfsi_options *o = &c->options;
    const char *const name = option->name;
    const char *const word = operand ? operand : ""; /* only --restart may go without */
    if (option->mode != RUN) {
        if (option->mode == KEYS_JSON && c->mode != KEYS)
            return usage_error("%s follows --keys%s", name, "");
        c->mode = option->mode;
        c->operand = operand;
    } else if (strcmp(name, "--out") == 0) {
        o->out = operand;
    } else if (strcmp(name, "--threads") == 0) {
        return read_threads(word, &o->threads);
    } else if (strcmp(name, "--until") == 0) {
        return read_time(word, &o->until);
    } else if (strcmp(name, "--set") == 0) {
        if (!strchr(word, '='))
            return usage_error("%s %s: give key=value or section.key=value", name, operand);
        ((const char **)(uintptr_t)o->sets)[o->n_sets++] = operand;
    } else if (strcmp(name, "--restart") == 0) {
        o->restart = 1;
        o->restart_file = operand;
    } else if (strcmp(name, "--fork") == 0) {
        o->fork = operand;
    } else {
        c->quiet = 1;
    }
    return 0;
}

/* The known option in `argument`, "--name" or "--name=operand", or NULL. */
static const struct option *find_option(const char *argument, const char **operand)
{
    const size_t length = strcspn(argument, "=");
    *operand = argument[length] == '=' ? argument + length + 1 : NULL;
    for (int k = 0; k < OPTION_COUNT; k++)
        if (strlen(options[k].name) == length && strncmp(options[k].name, argument, length) == 0)
            return &options[k];
    return NULL;
}

/* Options of earlier versions that are tools now. */
static int names_a_tool(const char *argument)
{
    static const char *const moved[][2] = {
        {"--refine", "tools/refine.py -n N CASE"},
        {"--ratio", "tools/refine.py --ratio R CASE"},
        {"--budget", "tools/budget.py TIME CASE"},
    };
    for (size_t k = 0; k < sizeof moved / sizeof moved[0]; k++)
        if (strncmp(argument, moved[k][0], strcspn(argument, "=")) == 0 &&
            strlen(moved[k][0]) == strcspn(argument, "="))
            return usage_error("%s is a tool now: %s", moved[k][0], moved[k][1]);
    return 0;
}

/* Whether the word after an option with an optional operand is its operand. After --restart it is
 * the checkpoint, unless no case has been named yet and it does not end in .ckpt. */
static int is_operand(const struct command *c, const struct option *option, const char *next)
{
    if (!next || next[0] == '-') return 0;
    const size_t n = strlen(next);
    const int checkpoint = n > 5 && strcmp(next + n - 5, ".ckpt") == 0;
    return option->mode == NEW || c->options.case_path || checkpoint;
}

static int parse_option(struct command *c, const char *argument, const char *next, int *used_next)
{
    const char *operand;
    const struct option *option = find_option(argument, &operand);
    if (!option && names_a_tool(argument)) return 1;
    if (!option) return usage_error("unknown option %s%s", argument, "");
    if (option->takes == NOTHING && operand)
        return usage_error("%s takes no value, but '%s' is given", option->name, operand);
    if (option->takes == OPERAND && !operand && !next)
        return usage_error("%s needs a value%s", option->name, "");
    *used_next = !operand && (option->takes == OPERAND ||
                              (option->takes == MAYBE && is_operand(c, option, next)));
    return apply_option(c, option, *used_next ? next : operand);
}

static int parse_arguments(struct command *c, int argc, char **argv)
{
    for (int k = 1; k < argc; k++) {
        int used_next = 0;
        /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): argv has argc words */
        if (argv[k][0] == '-') {
            if (parse_option(c, argv[k], k + 1 < argc ? argv[k + 1] : NULL, &used_next)) return 1;
            if (c->mode == HELP || c->mode == VERSION) return 0;
        } else if (c->options.case_path) {
            return usage_error("only one case can be given, not %s and %s", c->options.case_path,
                               argv[k]);
        } else {
            c->options.case_path = argv[k];
        }
        k += used_next;
    }
    if (c->mode >= INSPECT && c->options.case_path)
        return usage_error("%s is not used%s", c->options.case_path, "");
    if (c->mode >= INSPECT || c->options.case_path) return 0;
    fputs(usage, stderr);
    return usage_error("%s%s", "no case is given", "");
}

/* A template on the standard output, or the names of all. */
static enum sphfsi_status print_template(const struct command *c)
{
    const char *text = c->operand ? sphfsi_template(c->operand) : NULL;
    if (text) fputs(text, stdout);
    if (text || c->operand) return text ? SPHFSI_OK : SPHFSI_INPUT;
    for (int k = 0; sphfsi_template_name(k); k++) puts(sphfsi_template_name(k));
    return SPHFSI_OK;
}

static enum sphfsi_status carry_out(struct command *c)
{
    struct sphfsi_options *const o = &c->options;
    switch (c->mode) {
    case RUN: install_signals(); return sphfsi_run(o);
    case PREVIEW: return sphfsi_preview(o);
    case EXPLAIN: return sphfsi_explain(o);
    case EFFECTIVE: return sphfsi_effective(o, "/dev/stdout");
    case CITE: return sphfsi_cite(o);
    case INSPECT: return sphfsi_inspect(c->operand, o);
    case NEW: return print_template(c);
    case KEYS: return sphfsi_keys(o);
    case KEYS_JSON: return sphfsi_keys_json(o);
    case VERSION: puts(sphfsi_version()); break;
    case HELP: fputs(usage, stdout); break;
    }
    return SPHFSI_OK;
}

/* Whether all output has reached the standard output. A run only says what it lost. */
static int output_is_out(int run)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) return 1;
    fputs(
        run ? "warning: messages of this run are lost, as the standard output cannot be written; "
              "summary.json holds its results\n"
            : "sphfsi: the output is not complete, because the standard output cannot be written\n",
        stderr);
    return 0;
}

/* The failure, and what else is wrong with the case, a line each. */
static void print_errors(void)
{
    fprintf(stderr, "sphfsi: %s\n", sphfsi_error());
    for (const char *line = sphfsi_more_errors(); *line; line += strcspn(line, "\n") + 1)
        fprintf(stderr, "sphfsi: %.*s\n", (int)strcspn(line, "\n"), line);
}

static int execute(struct command *c)
{
    c->terminal = isatty(STDERR_FILENO);
    c->options.message = on_message;
    c->options.progress = c->quiet ? NULL : on_progress;
    c->options.context = c;
    c->options.requests = &requests;
    const enum sphfsi_status status = carry_out(c);
    clear_line(c);
    if (status) print_errors();
    const int run = c->mode == RUN;
    if (!status && !output_is_out(run) && !run) return 2;
    return sphfsi_exit_status(status, requests.stop);
}

/* A result file must not get the number of a standard stream that the caller has closed, or it
 * would receive messages. /dev/null is open for reading only: writing still fails. */
static void fill_standard_streams(void)
{
    int fd;
    do fd = open("/dev/null", O_RDONLY);
    while (fd >= 0 && fd <= STDERR_FILENO);
    if (fd >= 0) close(fd);
}

int main(int argc, char **argv)
{
    fill_standard_streams();
    struct command c = {0};
    const char **sets = calloc((size_t)argc + 1, sizeof *sets);
    if (!sets) return usage_error("%s%s", "no memory", "");
    c.options.sets = sets;
    int status = parse_arguments(&c, argc, argv);
    if (!status) status = execute(&c);
    free(sets);
    if (status != 2) return status;
    /* After a failed write HDF5 may crash in its exit handlers: they are skipped. */
    fflush(NULL);
    _exit(status);
}
