# Tests and short runs under checkers, and tests that take long. ARGS='...' goes to the tool.
# QUICK=1: one target for five seconds (fuzz), one effect (absence).
#
#   make test-sanitize   tests with gcc's address and undefined-behaviour sanitizers
#   make test-thread     short runs and tests with clang's thread sanitizer
#   make memcheck        short runs under valgrind
#   make analyze         cppcheck, clang-tidy, gcc -fanalyzer (ARGS='FILE...')
#   make test-neon       tests of the numerics for AArch64, cross-compiled and run under qemu
#   make faults          the long forms of the fault tests: 50 kills, many sizes of a full disk
#   make fuzz            fuzz the readers with clang's libFuzzer (ARGS='SECONDS [TARGET...]')
#   make random-cases    1000 random scenes in every build, killed, restarted and forked: same bits
#   make mutants         put small faults into the sources, count those that tests find:
#                        docs/results/mutants.md
#   make absence         an effect that is off costs nothing: each compiled out: docs/results/absence.md

# Tests of one folder of src/ each, and of the tools.
UNIT_DIRS := $(patsubst src/%/,%,$(wildcard src/*/)) tools

.PHONY: help-checks test-sanitize test-thread memcheck analyze test-neon faults fuzz random-cases \
        mutants absence
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
	@tests/short_runs.sh build/thread/sphfsi
	@TEST_DIRS='$(UNIT_DIRS)' TEST_KINDS=c $(MAKE) --no-print-directory CONFIG=thread CC=clang test

# valgrind knows no AVX-512.
memcheck: export OMP_NUM_THREADS := 1
memcheck:
	@$(MAKE) --no-print-directory CONFIG=memcheck ARCH=x86-64-v3 all
	@tests/short_runs.sh build/memcheck/sphfsi valgrind --quiet --error-exitcode=99 \
	  --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite

analyze:
	@tools/dev/analyze.sh $(ARGS)

test-neon:
	@bash tests/neon.sh $(UNITY_SRC)

faults: $(PROGRAM)
	@set -e; export SPHFSI='$(abspath $(PROGRAM))' PYTHON='$(PROJECT_PYTHON)'; \
	 export KILLS=50 FULL_STEPS=40 INJECT_STRIDE=1; \
	 for t in fault/test_kill fault/test_full fault/test_inject fault/test_fork \
	   agree/test_restart_cases; do bash tests/$$t.sh; done

absence:
	@SETUP=no $(PROJECT_PYTHON) tests/agree/test_absence.py --each $(if $(QUICK),TENSILE)

random-cases: $(PROGRAM)
	@$(PROJECT_PYTHON) tests/fault/random_cases.py --all-builds $(ARGS)

fuzz:
	@tests/fuzz/fuzz.sh $(or $(ARGS),$(if $(QUICK),5 expr))

mutants:
	@$(PROJECT_PYTHON) tests/mutants/mutants.py $(ARGS)
