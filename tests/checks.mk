# Tests and short runs under checkers; included by the Makefile.
#
#   make test-sanitize   tests with gcc's address and undefined-behaviour sanitizers
#   make test-thread     short runs and tests with clang's thread sanitizer
#   make memcheck        short runs under valgrind
#   make analyze         cppcheck, clang-tidy, gcc -fanalyzer (ARGS='FILE...')
#   make test-neon       tests of the numerics for AArch64, cross-compiled and run under qemu

# Tests of one folder of src/ each, and of the tools.
UNIT_DIRS := $(patsubst src/%/,%,$(wildcard src/*/)) tools

.PHONY: help-checks test-sanitize test-thread memcheck analyze test-neon
help-checks:
	@sed -n '/^#/!q; s/^# \{0,1\}//p' tests/checks.mk

test-sanitize:
	@TEST_DIRS='$(UNIT_DIRS) agree fault' $(MAKE) --no-print-directory CONFIG=sanitize test

# gcc's OpenMP runtime would be reported itself; clang's tells of its barriers (OMPT, libarcher).
# Tests that look at files or at long runs say nothing here and would take hours.
test-thread: export TSAN_OPTIONS := ignore_noninstrumented_modules=1 exitcode=66
test-thread: export OMP_NUM_THREADS := 2
test-thread:
	@$(MAKE) --no-print-directory CONFIG=thread CC=clang all
	@tools/dev/short_runs.sh build/thread/sphfsi
	@TEST_DIRS='$(UNIT_DIRS)' TEST_KINDS=c $(MAKE) --no-print-directory CONFIG=thread CC=clang test

# valgrind knows no AVX-512.
memcheck: export OMP_NUM_THREADS := 1
memcheck:
	@$(MAKE) --no-print-directory CONFIG=memcheck ARCH=x86-64-v3 all
	@tools/dev/short_runs.sh build/memcheck/sphfsi valgrind --quiet --error-exitcode=99 \
	  --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite

analyze:
	@tools/dev/analyze.sh $(ARGS)

test-neon:
	@bash tests/neon.sh $(UNITY_SRC)
