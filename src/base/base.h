/* SPDX-License-Identifier: MIT
 * What nearly every file uses: errors, memory, threads, macros. */
#ifndef SPHFSI_BASE_BASE_H
#define SPHFSI_BASE_BASE_H

#include "base/arena.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/macros.h"
#include "base/threads.h"

#endif
