# sphfsi: two-dimensional fluid-structure interaction with smoothed particle hydrodynamics
#
#   make                ./sphfsi, build/release/libsphfsi.a and libsphfsi.so
#   make gate           run cases/gate.cfg and draw it    (DP='0.5 mm' OUT=DIR ARGS='--until 0.1')
#   make test           build and run the tests           (FILTER=cells for some of them)
#   make check | format style, layers and exported symbols | clang-format in place
#   make bench          what a step costs by phase, against bench/<processor>.csv
#   make docs           write the reference of keys in docs/cases.md
#   make debug | sanitize | serial    other builds, as build/<name>/sphfsi
#   make examples       build examples/*.c, programs that use the library
#   make install        to PREFIX (/usr/local), below DESTDIR
#   make info | dist | clean | distclean
#   make help-reports   goals that write the reports in docs/
#   make help-checks    tests under sanitizers, valgrind and qemu, static analysis
#   make web | test-web the program as a page for browsers | drive it in a headless Chromium
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
IDLE  := help help-reports help-checks info format dist clean distclean
GOALS := $(or $(MAKECMDGOALS),all)
ifneq ($(filter-out $(IDLE),$(GOALS)),)
  NEEDS := $(strip build $(if $(filter test% validate reliability,$(GOALS)),test) \
             $(if $(filter web,$(GOALS)),plot web) $(if $(filter gate gallery accuracy bench \
               coverage forecast glance performance stability-% turek-hron validate \
               verify-%,$(GOALS)),plot))
  HINTS := CC='$(CC)' HDF5_PREFIX='$(HDF5_PREFIX)' UNITY_DIR='$(UNITY_DIR)' PYTHON='$(PYTHON)' \
           SETUP='$(or $(SETUP),$(if $(filter gate test%,$(GOALS)),yes))'
  ifneq ($(shell $(HINTS) tools/setup.sh $(NEEDS) >&2 && echo ready),ready)
    $(error tools/setup.sh $(NEEDS) did not succeed; see above)
  endif
endif
-include build/hdf5.mk build/unity.mk build/zig.mk
PROJECT_PYTHON := $(or $(shell cat build/python 2>/dev/null),python3)

# --- flags (CMakeLists.txt lists the same ones; tools/dev/check_style.py compares them) ---
# No contraction, no reassociation: the same bits from every compiler and instruction set. gcc 12
# contracts v - a*b beside w + c*d in spite of -ffp-contract=off if it makes a vector of them.
COMMON := -std=gnu11 -pthread -fPIC -ffp-contract=off -fno-math-errno -fno-trapping-math
COMMON += -fvisibility=hidden -fno-tree-slp-vectorize
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
# clang, unlike gcc, minds the float constants INFINITY and NAN in expressions of doubles, loops of
# `omp simd` that it leaves alone without optimisation, and fields that an initialiser leaves out.
WARN += $(if $(findstring clang,$(shell $(CC) --version 2>/dev/null)),-Wno-double-promotion \
          -Wno-pass-failed -Wno-missing-field-initializers)
# -fopenmp-simd keeps `omp simd`, and with it the bits of the threaded build.
OMP := $(if $(filter serial,$(CONFIG)),-fopenmp-simd -Wno-unknown-pragmas,-fopenmp)
# Older clang on AArch64 knows -mcpu=native only.
MARCH := $(or $(shell $(CC) -march=$(ARCH) -E -x c /dev/null >/dev/null 2>&1 && \
                      echo -march=$(ARCH)),-mcpu=$(ARCH))
COMPILE := $(CC) $(COMMON) $(OPT-$(CONFIG)) $(MARCH) $(OMP) $(WARN) -Iinclude -Isrc $(HDF5_CFLAGS) \
           $(CPPFLAGS) $(CFLAGS)
LINK     = $(COMPILE) $(LDFLAGS) -o $@ $(filter %.o %.a,$^) $(HDF5_LIBS) -lm
# Dirty is what the program is made of, not a report that was written anew.
DESCRIBE := $(subst $() -dirty,-dirty,$(shell git describe --always --exclude='*' 2>/dev/null && \
  { test -z "$$(git status --porcelain -- src include cases/templates Makefile CMakeLists.txt)" || \
    echo -dirty; }))
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
EMBEDDED := $(sort $(wildcard cases/templates/*.cfg src/app/data/*))
BENCHES := $(patsubst bench/%.c,$(B)/bench_%,$(wildcard bench/*.c))
SUPPORT := $(patsubst %.c,$(B)/%.o,$(wildcard tests/support/*.c))
TESTS   := $(patsubst %.c,$(B)/%,$(foreach t,$(wildcard tests/*/test_*.c),\
             $(if $(FILTER),$(if $(findstring $(FILTER),$(t)),$(t)),$(t))))

.PHONY: all help debug sanitize serial test gate examples check docs format info install dist \
        clean distclean FORCE
.SECONDARY:
.DELETE_ON_ERROR:

all: $(PROGRAM) $(LIB) $(SHARED)

help:
	@sed -n '/^#/!q; s/^# \{0,1\}//p' Makefile

debug sanitize serial:
	@$(MAKE) --no-print-directory CONFIG=$@ all

# --- rules ---
# Rebuild when compiler or flags change, the files that name the version when that does, and the
# embedded texts when their list does.
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
	$(Q)$(COMPILE) $(LDFLAGS) -shared -o $@ $^ $(HDF5_LIBS) -lm $(if $(DARWIN),, \
	  -Wl$(comma)-soname$(comma)libsphfsi.so.$(ABI) -Wl$(comma)--exclude-libs$(comma)ALL)

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
# (CMakeLists.txt and tests/mutants/mutants.py, too).
$(TESTS): private WRAP = $(addprefix -Wl$(comma)--wrap=,$(shell sed -n 's/^ \* --wrap: //p' \
  $(@:$(B)/%=%).c | tr -d '*/'))

$(BENCHES): $(B)/bench_%: $(B)/bench/%.o $(CORE)
	$(Q)$(LINK)

test: $(PROGRAM) $(SHARED) $(TESTS) $(BENCHES) $(if $(filter release,$(CONFIG)),$(B)/web.so)
	@SPHFSI='$(abspath $(PROGRAM))' PYTHON='$(PROJECT_PYTHON)' FILTER='$(FILTER)' tests/run.sh $(B)

# What a program outside of the source tree would do, with the library where it was built.
EXAMPLES := $(patsubst examples/%.c,$(B)/example_%,$(wildcard examples/*.c))
$(EXAMPLES): $(B)/example_%: $(B)/examples/%.o $(LIB)
	$(Q)$(LINK)
examples: $(EXAMPLES)
	@echo "programs:"; printf '  %s\n' $(EXAMPLES)

# The tools that the README names next need the shared library.
gate: $(PROGRAM) $(SHARED)
	@if grep -qs '"exit_reason": *"finished"' $(OUT)/summary.json; then \
	   echo "$(OUT) holds a finished run, which is only drawn again (remove it to run it anew)"; \
	 else ./$(PROGRAM) cases/gate.cfg --out $(OUT) $(if $(wildcard $(OUT)/*.ckpt),--restart) \
	   $(if $(DP),--set 'dp=$(DP)') $(ARGS); fi
	$(Q)$(PROJECT_PYTHON) tools/plot_m1.py $(OUT) --out $(OUT)/m1.png
	$(Q)$(PROJECT_PYTHON) tools/plot_fields.py $(OUT) --time 0.08 0.16 0.24 0.36 \
	  --window -0.01 0.45 -0.01 0.17
	@echo "pictures:"; ls $(OUT)/*.png | sed 's/^/  /'

check: $(PROGRAM) $(LIB) $(SHARED)
	@$(PROJECT_PYTHON) tools/dev/check_style.py --library $(LIB) --library $(SHARED)
	@$(PROJECT_PYTHON) tools/cases_doc.py ./$(PROGRAM) --check

docs: $(PROGRAM)
	$(Q)$(PROJECT_PYTHON) tools/cases_doc.py ./$(PROGRAM)

format:
	clang-format -i $(wildcard src/*/*.[ch] include/*.h tests/*/*.[ch] bench/*.[ch] \
	                         examples/*.c web/*.c)

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
	@for f in sphfsi.pc:pkgconfig sphfsiConfig.cmake:cmake/sphfsi \
	   sphfsiConfigVersion.cmake:cmake/sphfsi; do \
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

include tests/checks.mk tools/report/report.mk web/web.mk
-include $(wildcard $(B)/*/*.d $(B)/*/*/*.d)
