/* SPDX-License-Identifier: MIT
 * From a case to a scene with its particles. */
#pragma once

#include "case/scene.h"

/* scene_read followed by scene_sample. After success scene_free is due. */
enum err scene_load_text(struct scene *scene, const char *text, const char *path, int n_sets,
                         const char *const *sets, struct diag *d) SPHFSI_CHECKED;

/* Samples all shapes into s->points; sets h and the effective domain (geometry/sampling.c). */
enum err scene_sample(struct scene *scene, struct diag *d) SPHFSI_CHECKED;
