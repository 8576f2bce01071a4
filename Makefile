# sphfsi: two-dimensional fluid-structure interaction with smoothed particle hydrodynamics
#
#   make                 ./sphfsi, build/release/libsphfsi.a and libsphfsi.so
#   make gate            run cases/gate.cfg and draw it    (DP='0.5 mm' OUT=DIR ARGS='--until 0.1')
#   make test            build and run the tests           (FILTER=cells for some of them)
#   make test-sanitize   the quick tests under ASan and UBSan
#   make test-thread     the same under clang's ThreadSanitizer, with an OpenMP runtime that it knows
#   make memcheck        every shipped case, coarse and short, under valgrind
#   make analyze         cppcheck, clang-tidy and gcc -fanalyzer: no finding without its reason
#   make test-neon       tests of the numerics for AArch64, cross-compiled and run under qemu
#   make faults          the long forms of the fault tests: 50 kills, many sizes of a full disk
#   make absence         an effect that is off costs nothing: each compiled out in turn: docs/absence.md
#   make fuzz            fuzz the readers with clang's libFuzzer (ARGS='SECONDS [TARGET...]')
#   make mutants         put small faults into the sources and count those that tests find: docs/mutants.md
#   make random-cases    1000 random scenes in every build, killed, restarted and forked: the same bits
#   make reliability     run the rehearsals and write docs/reliability.md
#   make stability       run the hard cases in their long form and write docs/stability.md; goes on where
#                        it was interrupted
#   make verify-fluid    rest, waves, impact, openings with both schemes: docs/fluid_verification.md
#   make stability-map   1440 plates over density, thickness and stiffness: docs/stability_map.json, picture
#   make verify-manufactured  orders of convergence against manufactured solutions: docs/manufactured.md
#   make verify-contact  restitution, pressure, friction, stacks, folds, impacts: docs/contact_verification.md
#   make verify-open     a vortex, a weir, a reversal with open boundaries: docs/open_verification.md
#   make gallery         run the small cases, draw the pictures of the README's table
#   make bench           what a step costs by phase: bench/<processor>.csv, and the change against it
#   make performance     the same, longest steps and the gate: docs/performance.md
#   make web             the program as a page for browsers: build/web/index.html
#   make test-web        drive that page in a headless Chromium, compare its hashes with the native ones
#   make examples        build examples/*.c, programs that use the library
#   make accuracy        run what is missing of the accuracy study, write docs/accuracy.md (ARGS=--list)
#   make forecast        what --explain foresees against what the shipped cases take: docs/accuracy.md
#   make validate        run the paper's cases and the verification cases, write docs/validation.md: hours;
#                        QUICK=1 for the coarse selection, ten minutes; goes on where it was interrupted;
#                        KEEP=1 keeps the results of the longer runs in docs/validation/, where they count as
#                        run from then on (ARGS=--again)
#   make debug | sanitize | serial    other builds, as build/<name>/sphfsi
#   make docs            write the reference of keys in docs/cases.md
#   make check | format  style, layers and exported symbols | clang-format in place
#   make install         to PREFIX (/usr/local), below DESTDIR
#   make info | dist | clean | distclean
#
# Variables: CC, CFLAGS, LDFLAGS, ARCH (native, x86-64-v3, x86-64-v4, armv8-a, ...), HDF5_PREFIX,
# UNITY_DIR, PYTHON, WERROR=1, V=1 (show commands), SETUP=no (install nothing that is missing).

VERSION := 0.1.0
CONFIG  ?= release
ARCH    ?= native
PREFIX  ?= /usr/local
OUT     ?= runs/gate$(if $(DP),-dp$(subst $() ,,$(DP)))
B       := build/$(CONFIG)
Q       := $(if $(V),,@)
comma   := ,

# Nothing is built by these goals, so nothing is looked for or installed either.
IDLE  := help info format dist clean distclean
GOALS := $(or $(MAKECMDGOALS),all)
ifneq ($(filter-out $(IDLE),$(GOALS)),)
  NEEDS := $(strip build $(if $(filter test% validate reliability,$(GOALS)),test) \
             $(if $(filter web,$(GOALS)),plot web) \
             $(if $(filter gate accuracy forecast validate verify-% bench performance,$(GOALS)),plot))
  HINTS := CC='$(CC)' HDF5_PREFIX='$(HDF5_PREFIX)' UNITY_DIR='$(UNITY_DIR)' PYTHON='$(PYTHON)' \
           SETUP='$(SETUP)'
  ifneq ($(shell $(HINTS) tools/setup.sh $(NEEDS) >&2 && echo ready),ready)
    $(error tools/setup.sh $(NEEDS) did not succeed; see above)
  endif
endif
-include build/hdf5.mk build/unity.mk build/zig.mk
PROJECT_PYTHON := $(or $(shell cat build/python 2>/dev/null),python3)

# --- flags (CMakeLists.txt lists the same ones; tools/check_style.py compares them) ---
# No contraction, no reassociation: the same bits from every compiler and instruction set.
COMMON := -std=gnu11 -pthread -fPIC -ffp-contract=off -fno-math-errno -fno-trapping-math -fvisibility=hidden
WARN   := -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -Wno-psabi
OPT-release  := -O3 -DNDEBUG
OPT-serial   := -O3 -DNDEBUG
OPT-debug    := -O0 -g
OPT-memcheck := -O1 -g
OPT-mutant   := -O1 -DNDEBUG
OPT-coverage := -O0 -g --coverage
OPT-thread   := -O1 -g -fno-omit-frame-pointer -fsanitize=thread
OPT-sanitize := -O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined \
                -fno-sanitize-recover=undefined
CONFIGS := release serial debug sanitize thread memcheck mutant coverage
$(if $(OPT-$(CONFIG)),,$(error CONFIG=$(CONFIG) is none of: $(CONFIGS)))
ifneq ($(filter true 1,$(CI) $(WERROR)),)
  WARN += -Werror
endif
# clang, unlike gcc, minds the float constants INFINITY and NAN in expressions of doubles, and loops of
# `omp simd` that it leaves alone without optimisation, and fields that a designated initialiser leaves out.
WARN += $(if $(findstring clang,$(shell $(CC) --version 2>/dev/null)),-Wno-double-promotion -Wno-pass-failed \
          -Wno-missing-field-initializers)
# -fopenmp-simd keeps `omp simd`, and with it the bits of the threaded build.
OMP := $(if $(filter serial,$(CONFIG)),-fopenmp-simd -Wno-unknown-pragmas,-fopenmp)
# Older clang on AArch64 knows -mcpu=native only.
MARCH := $(or $(shell $(CC) -march=$(ARCH) -E -x c /dev/null >/dev/null 2>&1 && \
                      echo -march=$(ARCH)),-mcpu=$(ARCH))
COMPILE := $(CC) $(COMMON) $(OPT-$(CONFIG)) $(MARCH) $(OMP) $(WARN) -Iinclude -Isrc $(HDF5_CFLAGS) \
           $(CPPFLAGS) $(CFLAGS)
LINK     = $(COMPILE) $(LDFLAGS) -o $@ $(filter %.o %.a,$^) $(HDF5_LIBS) -lm
# Dirty is what the program is made of, not a report that was written anew.
DESCRIBE := $(shell git describe --always --exclude='*' 2>/dev/null && \
                    { test -z "$$(git status --porcelain -- src include data cases/templates \
                                    Makefile CMakeLists.txt)" || \
                      echo -dirty; })
DESCRIBE := $(subst $() -dirty,-dirty,$(DESCRIBE))
FULL_VERSION := $(VERSION)$(if $(DESCRIBE),+$(DESCRIBE))

# --- files ---
# What programs link shows sphfsi_... alone; CORE, for tests and benches, shows all between files.
CORE    := $(B)/core.a
LIB     := $(B)/libsphfsi.a
SHARED  := $(B)/libsphfsi.so
ABI     := $(basename $(VERSION))
# One of a build folder of its own (B=...) must not take the place of ./sphfsi.
PROGRAM := $(if $(filter build/release,$(B)),sphfsi,$(B)/sphfsi)
LIB_OBJ := $(patsubst %.c,$(B)/%.o,$(filter-out src/app/main.c,$(wildcard src/*/*.c))) \
           $(B)/src/app/embedded.o
# Texts that the program carries.
EMBEDDED := $(sort $(wildcard cases/templates/*.cfg data/*))
BENCHES := $(patsubst bench/%.c,$(B)/bench_%,$(wildcard bench/*.c))
SUPPORT := $(patsubst %.c,$(B)/%.o,$(wildcard tests/support/*.c))
# Tests of one folder of src/ each, and of the tools.
UNIT_DIRS := base particles case geometry fluid solid time output app tools
TESTS   := $(patsubst %.c,$(B)/%,$(foreach t,$(wildcard tests/*/test_*.c),\
             $(if $(FILTER),$(if $(findstring $(FILTER),$(t)),$(t)),$(t))))

.PHONY: gallery absence faults fuzz reliability validate docs stability test-neon performance examples
.PHONY: stability-map
.PHONY: test-thread memcheck analyze
.PHONY: all help debug sanitize serial test test-sanitize bench gate check format info install \
        dist clean distclean FORCE
.SECONDARY:
.DELETE_ON_ERROR:

all: $(PROGRAM) $(LIB) $(SHARED)

help:
	@sed -n '/^#/!q; s/^# \{0,1\}//p' Makefile

debug sanitize serial:
	@$(MAKE) --no-print-directory CONFIG=$@ all

# --- rules ---
# Rebuild when compiler or flags change, the files that name the version when that does, and the embedded
# texts when their list does.
STAMP_TEXT-flags   := $(COMPILE) $(LDFLAGS) $(shell $(CC) -dumpversion 2>/dev/null)
STAMP_TEXT-version := $(FULL_VERSION)
STAMP_TEXT-embedded := $(EMBEDDED)
$(B)/flags $(B)/version $(B)/embedded: FORCE
	@mkdir -p $(@D); echo '$(STAMP_TEXT-$(@F))' | cmp -s - $@ || echo '$(STAMP_TEXT-$(@F))' >$@
$(patsubst %.c,$(B)/%.o,$(shell grep -ls SPHFSI_VERSION src/*/*.c)): $(B)/version

$(B)/%.o: %.c $(B)/flags
	@mkdir -p $(@D); $(if $(V),,echo '  CC  $<')
	$(Q)$(COMPILE) $(EXTRA) -DSPHFSI_VERSION='"$(FULL_VERSION)"' -MMD -MP -c -o $@ $<

$(B)/src/app/embedded.c: tools/embed.sh $(EMBEDDED) $(B)/embedded
	@mkdir -p $(@D)
	$(Q)sh tools/embed.sh $@ $(EMBEDDED)

$(B)/src/app/embedded.o: $(B)/src/app/embedded.c $(B)/flags
	$(Q)$(COMPILE) -MMD -MP -c -o $@ $<

$(CORE): $(LIB_OBJ)
	$(Q)rm -f $@ && $(AR) qcs $@ $^

# One object, in which what is hidden is local. Apple's linker does that itself.
DARWIN := $(filter Darwin,$(shell uname))
LD_R   := $(if $(DARWIN),$(CC) -r -nostdlib,$(shell $(CC) -print-prog-name=ld) -r)
LOCAL  := $(if $(DARWIN),true,$(shell $(CC) -print-prog-name=objcopy) --localize-hidden)
$(LIB): $(LIB_OBJ)
	$(Q)$(LD_R) -o $(@:.a=.o) $^ && $(LOCAL) $(@:.a=.o) && rm -f $@ && $(AR) rcs $@ $(@:.a=.o)

$(SHARED): $(LIB_OBJ)
	$(Q)$(COMPILE) $(LDFLAGS) -shared -o $@ $^ \
	  $(if $(DARWIN),,-Wl$(comma)-soname$(comma)libsphfsi.so.$(ABI) -Wl$(comma)--exclude-libs$(comma)ALL) \
	  $(HDF5_LIBS) -lm

$(PROGRAM): $(B)/src/app/main.o $(LIB)
	$(Q)$(LINK) $(WRAP)

# A failed run ends with _exit, which would lose what gcov has counted.
build/coverage/sphfsi: build/coverage/tests/support/coverage/exit.o
build/coverage/sphfsi: private WRAP := -Wl,--wrap=_exit

$(B)/tests/%.o: EXTRA = -Itests/support $(UNITY_CFLAGS)

# Unity writes to stderr, which is not buffered: a crash loses nothing.
$(B)/unity.o: $(UNITY_SRC)/unity.c $(B)/flags
	$(Q)$(COMPILE) $(UNITY_CFLAGS) -w -include stdio.h '-DUNITY_OUTPUT_CHAR(c)=fputc(c, stderr)' \
	  -c -o $@ $<

$(TESTS): %: %.o $(SUPPORT) $(B)/unity.o $(CORE)
	$(Q)$(LINK) $(WRAP)

# A test that puts itself between the program and a library names the functions in lines of its own
# (CMakeLists.txt and tools/mutants.py, too).
$(TESTS): private WRAP = $(addprefix -Wl$(comma)--wrap=,$(shell sed -n 's/^ \* --wrap: //p' \
  $(@:$(B)/%=%).c | tr -d '*/'))

$(BENCHES): $(B)/bench_%: $(B)/bench/%.o $(CORE)
	$(Q)$(LINK)

test: $(PROGRAM) $(SHARED) $(TESTS) $(BENCHES)
	@SPHFSI='$(abspath $(PROGRAM))' PYTHON='$(PROJECT_PYTHON)' FILTER='$(FILTER)' tests/run.sh $(B)

test-neon:
	@bash tests/neon.sh $(UNITY_SRC)

test-sanitize:
	@TEST_DIRS='$(UNIT_DIRS) agree fault' $(MAKE) --no-print-directory CONFIG=sanitize test

# gcc's OpenMP runtime would be reported itself; clang's tells of its barriers (OMPT, libarcher). Tests
# that look at files or at long runs say nothing here and would take hours.
test-thread: export TSAN_OPTIONS := ignore_noninstrumented_modules=1 exitcode=66
test-thread: export OMP_NUM_THREADS := 2
test-thread:
	@$(MAKE) --no-print-directory CONFIG=thread CC=clang all
	@tools/short_runs.sh build/thread/sphfsi
	@TEST_DIRS='$(UNIT_DIRS)' TEST_KINDS=c $(MAKE) --no-print-directory CONFIG=thread CC=clang test

# valgrind knows no AVX-512.
memcheck: export OMP_NUM_THREADS := 1
memcheck:
	@$(MAKE) --no-print-directory CONFIG=memcheck ARCH=x86-64-v3 all
	@tools/short_runs.sh build/memcheck/sphfsi valgrind --quiet --error-exitcode=99 \
	  --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite

analyze:
	@tools/analyze.sh $(ARGS)

faults: $(PROGRAM)
	@set -e; export SPHFSI='$(abspath $(PROGRAM))' PYTHON='$(PROJECT_PYTHON)'; \
	 export KILLS=50 FULL_STEPS=40 INJECT_STRIDE=1; \
	 for t in fault/test_kill fault/test_full fault/test_inject fault/test_fork \
	   agree/test_restart_cases; do bash tests/$$t.sh; done

absence:
	@SETUP=no $(PROJECT_PYTHON) tests/agree/test_absence.py --each

fuzz:
	@tools/fuzz.sh $(ARGS)

.PHONY: mutants
mutants:
	@$(PROJECT_PYTHON) tools/mutants.py $(ARGS)

.PHONY: random-cases
random-cases: $(PROGRAM)
	@$(PROJECT_PYTHON) tools/random_cases.py --all-builds $(ARGS)

verify-fluid: $(PROGRAM)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' $(PROJECT_PYTHON) tools/verify_fluid.py $(ARGS)

verify-contact: $(PROGRAM)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' $(PROJECT_PYTHON) tools/verify_contact.py $(ARGS)

verify-manufactured: $(PROGRAM) $(SHARED)
	$(Q)$(PROJECT_PYTHON) tools/manufactured.py $(ARGS)

verify-open: $(PROGRAM)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' $(PROJECT_PYTHON) tools/verify_open.py $(ARGS)

stability-map: $(PROGRAM)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' OMP_WAIT_POLICY=passive $(PROJECT_PYTHON) tools/stability_map.py $(ARGS)

stability: $(PROGRAM)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' $(PROJECT_PYTHON) tools/stability.py --report --keep $(ARGS)

reliability: $(PROGRAM) $(TESTS)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' $(PROJECT_PYTHON) tools/reliability.py $(ARGS)

bench: $(PROGRAM) $(BENCHES)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' BUILD='$(B)' $(PROJECT_PYTHON) tools/performance.py --bench $(ARGS)

performance: $(PROGRAM) $(BENCHES)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' BUILD='$(B)' $(PROJECT_PYTHON) tools/performance.py $(ARGS)

# What a program outside of the source tree would do, with the library where it was built.
EXAMPLES := $(patsubst examples/%.c,$(B)/example_%,$(wildcard examples/*.c))
$(EXAMPLES): $(B)/example_%: $(B)/examples/%.o $(LIB)
	$(Q)$(LINK)
examples: $(EXAMPLES)
	@echo "programs:"; printf '  %s\n' $(EXAMPLES)

gate: $(PROGRAM)
	@if grep -qs '"exit_reason": *"finished"' $(OUT)/summary.json; then \
	   echo "$(OUT) holds a finished run, which is only drawn again (remove it to run it anew)"; \
	 elif ls $(OUT)/*.ckpt >/dev/null 2>&1; then \
	   ./$(PROGRAM) cases/gate.cfg --out $(OUT) --restart $(if $(DP),--set 'dp=$(DP)') $(ARGS); \
	 else \
	   ./$(PROGRAM) cases/gate.cfg --out $(OUT) $(if $(DP),--set 'dp=$(DP)') $(ARGS); \
	 fi
	$(Q)$(PROJECT_PYTHON) tools/plot_m1.py $(OUT) --out $(OUT)/m1.png
	$(Q)$(PROJECT_PYTHON) tools/plot_fields.py $(OUT) --time 0.08 0.16 0.24 0.36 \
	  --window -0.01 0.45 -0.01 0.17
	@echo "pictures:"; ls $(OUT)/*.png | sed 's/^/  /'

# CASE:TIME:FIELD
GALLERY := channel:1:velocity vortices:0.4:velocity rolling_tank:1.2:pressure \
           beam_on_beam:1.2:pressure two_posts:0.16:pressure \
           rotating_patch:0.6:pressure accelerated_tank:1:pressure \
           ringing_bar:0.01:pressure elastic_valve:0.75:velocity
gallery: $(PROGRAM)
	@set -e; for g in $(GALLERY); do \
	   set -- $$(echo $$g | tr : ' '); [ -e cases/$$1.cfg ] || continue; \
	   [ -e runs/$$1/summary.json ] || ./$(PROGRAM) cases/$$1.cfg --quiet; \
	   $(PROJECT_PYTHON) tools/plot_fields.py runs/$$1 --time $$2 --field $$3 --out docs/img/$$1.png; done

# What steps a simulation, without the files of runs: no HDF5, one thread. `fused` needs relaxed SIMD; `exact`
# computes multiply-add in software. Both give the native program's bits.
WEB_SRC := web/exports.c $(filter-out src/base/run_dir.c,$(wildcard $(patsubst %,src/%/*.c,base \
             particles case geometry fluid solid time))) src/output/probes.c src/output/point_data.c \
             $(patsubst %,src/app/%.c,api call session due)
WEB_FLAGS := -target wasm32-wasi -msimd128 -D_WASI_EMULATED_SIGNAL $(filter-out -pthread -fPIC,$(COMMON)) \
             $(OPT-release) -fopenmp-simd -Wno-unknown-pragmas -Wno-pass-failed -Iinclude -Isrc
build/web/fused.wasm: RELAXED := -mrelaxed-simd
build/web/%.wasm: $(WEB_SRC) $(wildcard src/*/*.h src/*/*.def include/*.h) Makefile $(B)/version
	@mkdir -p $(@D); echo '  WASM $@'
	$(Q)ZIG_LOCAL_CACHE_DIR=build/web/cache ZIG_GLOBAL_CACHE_DIR=build/web/cache $(ZIG) cc $(WEB_FLAGS) \
	  $(RELAXED) -DSPHFSI_VERSION='"$(FULL_VERSION)"' -mexec-model=reactor -Wl,--gc-sections,--strip-all \
	  -Wl,-z,stack-size=1048576 -o $@ $(WEB_SRC)

.PHONY: web test-web
web: $(PROGRAM) build/web/fused.wasm build/web/exact.wasm
	$(Q)$(PROJECT_PYTHON) web/build.py --program '$(PROGRAM)' --fused build/web/fused.wasm \
	  --exact build/web/exact.wasm --out build/web/index.html $(ARGS)

# Without a compiler for WebAssembly there is no page, and the test is skipped.
test-web: $(PROGRAM)
	@$(MAKE) --no-print-directory web || echo "there is no page: the test will be skipped"
	@WEB=1 SPHFSI='$(abspath $(PROGRAM))' PYTHON='$(PROJECT_PYTHON)' FILTER=web/ tests/run.sh $(B)

.PHONY: accuracy forecast verify-contact verify-fluid verify-manufactured verify-open
accuracy: $(PROGRAM)
	$(Q)$(PROJECT_PYTHON) tools/accuracy_cost.py $(ARGS)
	@$(MAKE) --no-print-directory all

forecast: $(PROGRAM)
	$(Q)$(PROJECT_PYTHON) tools/forecast.py $(ARGS)

validate: $(PROGRAM) $(B)/tests/converge/test_solid_patch
	$(Q)BUILD='$(B)' OMP_WAIT_POLICY=passive $(PROJECT_PYTHON) tools/validate.py --program '$(PROGRAM)' \
	  $(if $(QUICK),--quick) $(if $(KEEP),--keep) $(ARGS)

check: $(PROGRAM) $(LIB) $(SHARED)
	@$(PROJECT_PYTHON) tools/check_style.py --library $(LIB) --library $(SHARED)
	@$(PROJECT_PYTHON) tools/cases_doc.py ./$(PROGRAM) --check

docs: $(PROGRAM)
	$(Q)$(PROJECT_PYTHON) tools/cases_doc.py ./$(PROGRAM)

format:
	clang-format -i $(wildcard src/*/*.[ch] include/*.h tests/*/*.[ch] bench/*.[ch] \
	                         examples/*.c)

info:
	@echo "sphfsi   $(FULL_VERSION)"; echo "compile  $(COMPILE)"; echo "link     $(HDF5_LIBS) -lm"; \
	 echo "python   $(PROJECT_PYTHON)"; echo "unity    $(or $(UNITY_SRC),not looked for yet)"

install: $(PROGRAM) $(LIB) $(SHARED)
	install -d $(addprefix $(DESTDIR)$(PREFIX)/,bin lib/pkgconfig lib/cmake/sphfsi include)
	install -m 755 $(PROGRAM) $(DESTDIR)$(PREFIX)/bin/sphfsi
	install -m 644 $(LIB) $(DESTDIR)$(PREFIX)/lib
	install -m 755 $(SHARED) $(DESTDIR)$(PREFIX)/lib/libsphfsi.so.$(VERSION)
	ln -sf libsphfsi.so.$(VERSION) $(DESTDIR)$(PREFIX)/lib/libsphfsi.so.$(ABI)
	ln -sf libsphfsi.so.$(ABI) $(DESTDIR)$(PREFIX)/lib/libsphfsi.so
	install -m 644 include/sphfsi.h $(DESTDIR)$(PREFIX)/include
	@for f in sphfsi.pc:pkgconfig sphfsiConfig.cmake:cmake/sphfsi sphfsiConfigVersion.cmake:cmake/sphfsi; do \
	   sed -e 's|@CMAKE_INSTALL_PREFIX@|$(PREFIX)|' -e 's|@PROJECT_VERSION@|$(VERSION)|' \
	     -e 's|@SPHFSI_LINK@|$(HDF5_LIBS) $(OMP) -pthread -lm|' -e 's|@CMAKE_INSTALL_LIBDIR@|lib|' \
	     -e 's|@SPHFSI_OPENMP@|$(if $(filter serial,$(CONFIG)),OFF,ON)|' -e 's|@SPHFSI_ABI@|$(ABI)|' \
	     tools/$${f%:*}.in >$(DESTDIR)$(PREFIX)/lib/$${f#*:}/$${f%:*}; done

dist:
	@mkdir -p build
	git archive --prefix=sphfsi-$(VERSION)/ -o build/sphfsi-$(VERSION).tar.gz HEAD

clean:
	rm -rf sphfsi build/release build/serial build/debug build/sanitize build/thread build/memcheck

# Runs are results, not build products: they stay.
distclean: clean
	rm -rf build .venv

-include $(wildcard $(B)/*/*.d $(B)/*/*/*.d)
