/* SPDX-License-Identifier: MIT
 * What nearly every file uses: errors, memory, threads, macros. */
#pragma once

#include "base/arena.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/macros.h"
#include "base/threads.h"
