/* SPDX-License-Identifier: MIT
 * What a run is compared with: the curves that its case names, and how far its probes are off. */
#ifndef SPHFSI_OUTPUT_REFERENCE_H
#define SPHFSI_OUTPUT_REFERENCE_H

#include "output/json.h"
#include "case/scene.h"

/* One [reference] section, ready to be compared. */
struct reference {
    const struct scene_reference *from;
    int file, column;  /* of probes.csv, or of another file of probes */
    int n;             /* rows of the file, in the order of time; 1: constant; 0: a formula */
    double *t, *value; /* [n] */
};

struct references {
    int n;
    struct reference *item;
};

/* How far a probe is off one reference; units: those of the column. A peak is the first turn whose size
 * is the largest but for 2 %; NAN: none. */
struct score {
    int points;                /* compared; 0: the run has none in the reference's time */
    double rms, largest, mean; /* of probe - reference; largest of its size */
    double peak, peak_time;
    double peak_wanted, peak_when; /* of the reference */
    double probe_mean;
    double scale; /* largest size of the reference */
};

/* Reads the files of the scene's references and finds their columns among those of the n files of probes.
 * ERR_INPUT: a file is missing or malformed, or there is no such column. Memory: the arena's. */
enum err references_open(struct references *r, const struct scene *s, int n,
                         const char *const *header, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* Compares the rows of one file of probes with the references that it has the columns of. A reference of
 * several rows is compared at its rows, the probe interpolated linearly between its own; a constant or a
 * formula at the rows of the probe. */
enum err references_score(const struct references *r, int file, const char *probes_csv,
                          struct score *score, struct diag *d) SPHFSI_CHECKED;

/* An object of the scores by name. */
void references_write(struct json *j, const struct references *r, const struct score *score);

/* One line for the user. */
void reference_line(const struct reference *r, const struct score *score, char *text, size_t size);

#endif
