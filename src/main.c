/* SPDX-License-Identifier: MIT
 * The command line. */
#include "sphfsi.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "usage: sphfsi CASE.cfg [options]\n"
    "  --out DIR         folder of the results (runs/<case name>)\n"
    "  --threads N       threads to use (all)\n"
    "  --until TIME      simulated time in s to end at (end_time of the case)\n"
    "  --set KEY=VALUE   value in effect over the case: dp=1mm, \"solid gate.young=12MPa\"; "
    "repeatable\n"
    "  --restart [FILE]  go on from the newest valid checkpoint of the run, or from FILE\n"
    "  --fork FILE       start a new run, with other physics, from the checkpoint (or a run's "
    "newest)\n"
    "  --inspect FILE    say what a checkpoint holds\n"
    "  --explain         say what would be simulated and what it would cost; run nothing\n"
    "  --effective       print the case in effect, every default spelled out; run nothing\n"
    "  --quiet           no progress, warnings only\n"
    "  --version, --help\n"
    "exit status: 0 finished, 1 wrong input, 2 stopped by a guard or a failure,\n"
    "             130 or 143 interrupted with a checkpoint (SIGUSR1: checkpoint and go on)\n";

static const char *const option_names[] = {"--out",       "--threads", "--until",   "--set",
                                           "--restart",   "--explain", "--fork",    "--inspect",
                                           "--effective", "--quiet",   "--version", "--help"};
enum { OPTION_COUNT = sizeof option_names / sizeof option_names[0] };

struct command {
    struct sphfsi_options options;
    const char *inspect;
    int explain, effective, quiet, done; /* done: nothing more to do */
    int terminal, line_open;             /* a progress line stands on the terminal */
    double last_share, last_line;
};

static struct sphfsi_requests requests;

static void on_signal(int number)
{
    if (number == SIGUSR1)
        requests.checkpoint = 1;
    else
        requests.stop = number;
}

/* A second SIGINT while the checkpoint is written ends the program at once, for whoever cannot wait;
 * a second SIGTERM does not, since batch systems send several. */
static void install_signals(void)
{
    struct sigaction once = {.sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND};
    struct sigaction again = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    sigaction(SIGINT, &once, NULL);
    sigaction(SIGTERM, &again, NULL);
    sigaction(SIGUSR1, &again, NULL);
    /* A file that may not grow further is a failed write, which is reported; so is a closed pipe. */
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
    else if (!c->quiet)
        printf("%s\n", text);
    fflush(stdout);
}

static void remaining(double seconds, char text[32])
{
    if (seconds < 0)
        snprintf(text, 32, "?");
    else if (seconds < 3600)
        snprintf(text, 32, "%d:%02d", (int)seconds / 60, (int)seconds % 60);
    else
        snprintf(text, 32, "%.1f h", seconds / 3600);
}

/* One live line on a terminal; elsewhere a line for every tenth of the way or half a minute. */
static void on_progress(void *context, const struct sphfsi_progress *p)
{
    struct command *c = context;
    const double way = p->end_time - p->start_time;
    const double share = way > 0 ? (p->time - p->start_time) / way : 1;
    if (!c->terminal && !p->finished && floor(10 * share) <= floor(10 * c->last_share) &&
        p->wall_seconds - c->last_line < 30)
        return;
    c->last_share = share;
    c->last_line = p->wall_seconds;
    if (p->finished) {
        clear_line(c);
        return;
    }
    char left[32];
    remaining(p->seconds_left, left);
    fprintf(stderr, "%s%5.1f %%  t %.5g s  dt %.3g s (%s)  %.3g M particle steps/s  %s left%s",
            c->terminal ? "\r" : "", 100 * share, p->time, p->dt, p->bound,
            1e-6 * p->particle_steps_per_second, left, c->terminal ? "\033[K" : "\n");
    fflush(stderr);
    c->line_open = c->terminal;
}

static int complain(const char *format, const char *a, const char *b)
{
    fputs("sphfsi: ", stderr);
    fprintf(stderr, format, a, b);
    fputs("; --help lists the options\n", stderr);
    return 1;
}

static int read_number(const char *option, const char *text, double low, double high, double *value)
{
    char *end;
    *value = strtod(text, &end);
    if (end != text && *end == '\0' && *value >= low && *value <= high) return 0;
    return complain(strcmp(option, "--threads") == 0 ? "%s %s: a number from 1 to 4096 is wanted"
                                                     : "%s %s: a time in seconds above 0 is wanted",
                    option, text);
}

static int is_checkpoint(const char *text)
{
    const size_t n = strlen(text);
    return n > 5 && strcmp(text + n - 5, ".ckpt") == 0;
}

static int apply(struct command *c, const char *option, const char *operand)
{
    struct sphfsi_options *o = &c->options;
    double number = 0;
    if (strcmp(option, "--out") == 0) {
        o->out = operand;
    } else if (strcmp(option, "--threads") == 0) {
        if (read_number(option, operand, 1, 4096, &number)) return 1;
        o->threads = (int)number;
    } else if (strcmp(option, "--until") == 0) {
        if (read_number(option, operand, 1e-300, 1e9, &number)) return 1;
        o->until = number;
    } else if (strcmp(option, "--set") == 0) {
        if (!strchr(operand, '='))
            return complain("%s %s: key=value or section.key=value is wanted", option, operand);
        ((const char **)(uintptr_t)o->sets)[o->n_sets++] = operand;
    } else if (strcmp(option, "--restart") == 0) {
        o->restart = 1;
        o->restart_file = operand;
    } else if (strcmp(option, "--fork") == 0) {
        o->fork = operand;
    } else if (strcmp(option, "--inspect") == 0) {
        c->inspect = operand;
    } else if (strcmp(option, "--explain") == 0) {
        c->explain = 1;
    } else if (strcmp(option, "--effective") == 0) {
        c->effective = 1;
    } else if (strcmp(option, "--quiet") == 0) {
        c->quiet = 1;
    } else {
        fputs(strcmp(option, "--help") == 0 ? usage : sphfsi_version(), stdout);
        if (strcmp(option, "--version") == 0) putchar('\n');
        c->done = 1;
    }
    return 0;
}

/* 1: the option takes an operand; 2: it may have one; 0: none. */
static int operands(const char *option)
{
    static const char *const needing[] = {"--out", "--threads", "--until",
                                          "--set", "--fork",    "--inspect"};
    for (size_t k = 0; k < sizeof needing / sizeof needing[0]; k++)
        if (strcmp(option, needing[k]) == 0) return 1;
    return strcmp(option, "--restart") == 0 ? 2 : 0;
}

/* Name of a known option in `argument`, "--name" or "--name=operand", or NULL. */
static const char *find_option(const char *argument, const char **operand)
{
    const size_t length = strcspn(argument, "=");
    *operand = argument[length] == '=' ? argument + length + 1 : NULL;
    for (int k = 0; k < OPTION_COUNT; k++)
        if (strlen(option_names[k]) == length && strncmp(option_names[k], argument, length) == 0)
            return option_names[k];
    return NULL;
}

static int unknown_option(const char *argument)
{
    const char *near = sphfsi_nearest(argument, option_names, OPTION_COUNT);
    return near ? complain("unknown option %s; the nearest one is %s", argument, near)
                : complain("unknown option %s%s", argument, "");
}

static int parse(struct command *c, int argc, char **argv)
{
    for (int k = 1; k < argc && !c->done; k++) {
        if (argv[k][0] != '-') {
            if (c->options.case_path)
                return complain("one case at a time is run, not %s and %s", c->options.case_path,
                                argv[k]);
            c->options.case_path = argv[k];
            continue;
        }
        const char *operand, *option = find_option(argv[k], &operand);
        if (!option) return unknown_option(argv[k]);
        const char *next = k + 1 < argc ? argv[k + 1] : NULL;
        const int takes = operands(option);
        if (takes == 0 && operand)
            return complain("%s takes no operand, not '%s'", option, operand);
        if (takes == 1 && !operand && !next)
            return complain("%s: its operand is missing%s", option, "");
        /* A word behind --restart is the checkpoint, unless it can only be the case. */
        const int optional = takes == 2 && !operand && next && next[0] != '-' &&
                             (c->options.case_path || is_checkpoint(next));
        if ((takes == 1 && !operand) || optional) {
            operand = next;
            k++;
        }
        if (apply(c, option, operand)) return 1;
    }
    if (!c->done && !c->inspect && !c->options.case_path) {
        fputs(usage, stderr);
        return complain("%s%s", "no case is given", "");
    }
    return 0;
}

static int execute(struct command *c)
{
    c->terminal = isatty(STDERR_FILENO);
    c->options.message = on_message;
    c->options.progress = c->quiet ? NULL : on_progress;
    c->options.context = c;
    c->options.requests = &requests;
    if (!c->explain && !c->inspect && !c->effective) install_signals();
    const enum sphfsi_status status = c->inspect     ? sphfsi_inspect(c->inspect, &c->options)
                                      : c->effective ? sphfsi_effective(&c->options, "/dev/stdout")
                                      : c->explain   ? sphfsi_explain(&c->options)
                                                     : sphfsi_run(&c->options);
    clear_line(c);
    if (status) fprintf(stderr, "sphfsi: %s\n", sphfsi_error());
    return sphfsi_exit_status(status, requests.stop);
}

int main(int argc, char **argv)
{
    struct command c = {0};
    const char **sets = calloc((size_t)argc + 1, sizeof *sets);
    if (!sets) return complain("%s%s", "no memory", "");
    c.options.sets = sets;
    int status = parse(&c, argc, argv);
    if (!status && !c.done) status = execute(&c);
    free(sets);
    return status;
}
