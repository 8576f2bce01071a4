/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* nftw */
#include "tiny.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

const char tiny_case[] = "title = tiny \"quoted\" \\ scene\n"
                         "dp = 1 cm\n"
                         "end_time = 0.02 s\n"
                         "gravity = 0, -9.81\n"
                         "[fluid water]\n"
                         "shape = box 0, 0, 0.1, 0.1\n"
                         "sound_speed = 20\n"
                         "artificial_viscosity = 0.05\n"
                         "density_diffusion = 0.1\n"
                         "surface = 0.1\n"
                         "[wall tank]\n"
                         "shape = box -0.03, 0, 0, 0.15\n"
                         "shape = box -0.03, -0.03, 0.5, 0\n"
                         "[solid gate]\n"
                         "shape = box 0.1, 0, 0.13, 0.15\n"
                         "clamp = box 0.1, 0.12, 0.13, 0.15\n"
                         "density = 1100\n"
                         "young = 1e6\n"
                         "poisson = 0.4\n"
                         "[output]\n"
                         "probe_interval = 0.1 ms\n"
                         "ledger_interval = 1 ms\n"
                         "snapshot_interval = 5 ms\n"
                         "[probe M1]\n"
                         "body = gate\n"
                         "point = 0.13, 0\n"
                         "[probe V]\n"
                         "quantity = velocity\n"
                         "body = gate\n"
                         "point = 0.11, 0.04\n"
                         "[probe P]\n"
                         "quantity = pressure\n"
                         "point = 0.05, 0.02\n";

static char folder[256];

static int remove_one(const char *path, const struct stat *info, int type, struct FTW *at)
{
    (void)info, (void)type, (void)at;
    return remove(path);
}

void tiny_remove(const char *path) { nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS); }

static void remove_folder(void) { tiny_remove(folder); }

const char *tiny_folder(void)
{
    if (folder[0]) return folder;
    const char *top = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/sphfsi-test-XXXXXX", top && top[0] ? top : "/tmp");
    if (!mkdtemp(folder)) {
        perror(folder);
        exit(1);
    }
    atexit(remove_folder);
    return folder;
}

const char *tiny_path(const char *name)
{
    static char paths[4][512];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", tiny_folder(), name);
    return path;
}
