/* SPDX-License-Identifier: MIT
 * A run of solids whose contact is looked at. One in each test program. */
#ifndef SPHFSI_TESTS_CONTACT_RIG_H
#define SPHFSI_TESTS_CONTACT_RIG_H

#include "rig.h"
#include "unity.h"

static struct rig rig;
static struct particles *p;
static struct contact *c;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

static void open_case(const char *text)
{
    RIG_OPEN_SOLID(text, NULL);
    c = &rig.sim.contact;
}

#define RUBBER "density = 1000\nyoung = 1e6\npoisson = 0.3\n"

#endif
