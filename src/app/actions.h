/* SPDX-License-Identifier: MIT
 * What the program does with a case or a file, each action in the .c file that its group names.
 * Lines of text go through the message callback. */
#ifndef SPHFSI_APP_ACTIONS_H
#define SPHFSI_APP_ACTIONS_H

#include "app/session.h"
#include "output/report.h"

/* --- run.c --- */

/* A run from its case to its files: outputs, restart, requests, failures. */
enum err run_case(const struct sphfsi_options *o, struct diag *d) SPHFSI_CHECKED;

/* --- case_change.c --- */

/* Compares two effective cases line by line: the checkpoint's, `old`, and the present one. A
 * restart may change end_time and output. A fork may also change physics, but not what the state
 * depends on: particles, masses, sound speed, kernel, integrator. ERR_INPUT names the first line
 * that must not differ. */
enum err case_change_check(const char *old, const char *now, bool fork, struct diag *d)
    SPHFSI_CHECKED;

/* --- explain.c --- */

/* Prints effects, memory, time step and cost of a scene, as text or as JSON. Takes some steps in
 * memory to measure the cost. */
enum err explain_text(struct session *x, const struct sphfsi_options *o, const char *unused,
                      struct diag *d) SPHFSI_CHECKED;
enum err explain_json(struct session *x, const struct sphfsi_options *o, const char *unused,
                      struct diag *d) SPHFSI_CHECKED;

/* --- evidence.c --- */

/* Prints the error that the accuracy study (docs/accuracy.md) lets expect of each body. */
void evidence_say(const struct scene *scene, const struct sphfsi_options *o);

/* --- preview.c --- */

/* Draws the bodies as they are sampled, with sizes, clamps, probes, axes and a legend, as SVG. */
enum err preview_draw(const struct scene *scene, const char *path, struct diag *d) SPHFSI_CHECKED;

/* --- inspect.c --- */

/* Prints the contents of a checkpoint: of a file, or of the newest valid one in the folder of a
 * run. ERR_INPUT: there is no valid checkpoint. */
enum err inspect_file(const char *path, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;

/* --- manual.c --- */

/* Prints every section and key with type, unit, default, range, meaning and example, in Markdown.
 */
void manual_keys(const struct sphfsi_options *o);

/* The same as one JSON text (docs/formats.md). */
enum err manual_keys_json(const struct sphfsi_options *o, struct diag *d) SPHFSI_CHECKED;

/* Writes the example of a key to `text`: from src/app/data/key_examples.cfg, or its default; "". */
struct param;
void manual_example(const struct param *param, char *text, size_t size);

/* A commented case as a template, or NULL. manual_template_name: the k-th name, NULL at the end. */
const char *manual_template(const char *name);
const char *manual_template_name(int k);

/* Prints the publications of the methods that a scene uses. */
void manual_cite(const struct scene *scene, effect_set effects, const struct sphfsi_options *o);

#endif
