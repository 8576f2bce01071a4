# The program as a page for browsers; included by the Makefile.
# What steps a simulation, without the files of runs: no HDF5, one thread. `fused` needs relaxed SIMD;
# `exact` computes multiply-add in software. Both give the native program's bits.
WEB_SRC := $(filter-out src/base/run_dir.c,$(wildcard $(patsubst %,src/%/*.c,base expr particles case \
             geometry fluid solid implicit beam rigid coupling time check))) \
           $(patsubst %,src/output/%.c,probes rows series fluid_sample \
             point_data) src/app/api.c src/app/session.c
WEB_FLAGS := -target wasm32-wasi -msimd128 -D_WASI_EMULATED_SIGNAL -DCLOCK_THREAD_CPUTIME_ID=CLOCK_MONOTONIC \
             $(filter-out -pthread -fPIC,$(COMMON)) \
             $(OPT-release) -fopenmp-simd -Wno-unknown-pragmas -Wno-pass-failed -Iinclude -Isrc
build/web/fused.wasm: RELAXED := -mrelaxed-simd
build/web/%.wasm: web/exports.c $(WEB_SRC) $(wildcard src/*/*.h src/*/*.def include/*.h) Makefile $(B)/version
	@mkdir -p $(@D); echo '  WASM $@'
	$(Q)ZIG_LOCAL_CACHE_DIR=build/web/cache ZIG_GLOBAL_CACHE_DIR=build/web/cache $(ZIG) cc $(WEB_FLAGS) \
	  $(RELAXED) -DSPHFSI_VERSION='"$(FULL_VERSION)"' -mexec-model=reactor -Wl,--gc-sections,--strip-all \
	  -Wl,-z,stack-size=1048576 -o $@ web/exports.c $(WEB_SRC)

# Fails if these sources need one that is not among them; `make test` builds it, without a compiler
# for WebAssembly.
$(B)/web.so: $(WEB_SRC:%.c=$(B)/%.o)
	$(Q)$(COMPILE) $(LDFLAGS) -shared $(if $(DARWIN),,-Wl$(comma)--no-undefined) -o $@ $^ -lm

.PHONY: web test-web
web: $(PROGRAM) build/web/fused.wasm build/web/exact.wasm
	$(Q)$(PROJECT_PYTHON) web/build.py --program '$(PROGRAM)' --fused build/web/fused.wasm \
	  --exact build/web/exact.wasm --out build/web/index.html $(ARGS)

# Without a compiler for WebAssembly there is no page, and the test is skipped.
test-web: $(PROGRAM)
	@$(MAKE) --no-print-directory web || echo "there is no page: the test will be skipped"
	@WEB=1 SPHFSI='$(abspath $(PROGRAM))' PYTHON='$(PROJECT_PYTHON)' FILTER=web/ tests/run.sh $(B)
