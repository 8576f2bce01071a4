/* SPDX-License-Identifier: MIT
 * A drawing of the scene at the start. */
#ifndef SPHFSI_APP_PREVIEW_H
#define SPHFSI_APP_PREVIEW_H

#include "sphfsi.h"

#include "case/scene.h"

/* Draws the bodies as they are sampled, with names, sizes, clamps, probes and axes, as SVG. */
enum err preview_draw(const struct scene *s, const char *path, struct diag *d) SPHFSI_CHECKED;

#endif
