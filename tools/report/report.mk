# The goals that write reports. ARGS='...' goes to the tool below tools/report/ or tools/dev/.
#
#   make validate        run the paper's cases and the verification cases, write docs/validation.md: hours;
#                        QUICK=1 for the coarse selection, ten minutes; goes on where it was interrupted;
#                        KEEP=1 keeps the results of the longer runs in docs/validation/, where they count
#                        as run from then on (ARGS=--again)
#   make accuracy        run what is missing of the accuracy study, write docs/accuracy.md (ARGS=--list)
#   make forecast        what --explain foresees against what the shipped cases take: docs/accuracy.md
#   make stability       run the hard cases in their long form and write docs/stability.md; goes on where
#                        it was interrupted
#   make stability-map   1440 plates over density, thickness and stiffness: docs/stability_map.json, picture
#   make stability-substeps   sub-steps of the solid against a single rate: docs/stability_substeps.json
#   make verify-fluid    rest, waves, impact, openings with both schemes: docs/fluid_verification.md
#   make verify-contact  restitution, pressure, friction, stacks, folds: docs/contact_verification.md
#   make verify-open     a vortex, a weir, a reversal with open boundaries: docs/open_verification.md
#   make verify-manufactured  orders of convergence against manufactured solutions: docs/manufactured.md
#   make turek-hron      docs/turek_hron.md from the kept runs (ARGS='run fsi2 --across 10' runs a case)
#   make energy-account  what the account of energy finds: docs/energy_account.md
#   make performance     the bench, longest steps and the gate: docs/performance.md
#   make glance          the charts of the README from the results of the reports
#   make gallery         run the elastic valve, draw the picture of it in the README
#   make reliability     run the fault tests and write docs/reliability.md
#   make faults          the long forms of the fault tests: 50 kills, many sizes of a full disk
#   make fuzz            fuzz the readers with clang's libFuzzer (ARGS='SECONDS [TARGET...]')
#   make random-cases    1000 random scenes in every build, killed, restarted and forked: the same bits
#   make mutants         put small faults into the sources and count those that tests find: docs/mutants.md
#   make absence         an effect that is off costs nothing: each compiled out in turn: docs/absence.md

# goal: the tool and its options. Each is run on the built program by the project's Python.
validate_TOOL            := report/validation.py $(if $(QUICK),--quick) $(if $(KEEP),--keep)
accuracy_TOOL            := report/accuracy.py
forecast_TOOL            := report/forecast.py
stability_TOOL           := report/stability.py --report --keep
stability-map_TOOL       := report/stability_map.py
stability-substeps_TOOL  := report/stability_substeps.py
verify-fluid_TOOL        := report/verify_fluid.py
verify-contact_TOOL      := report/verify_contact.py
verify-open_TOOL         := report/verify_open.py
verify-manufactured_TOOL := report/manufactured.py
turek-hron_TOOL          := report/turek_hron.py
energy-account_TOOL      := report/energy_account.py
performance_TOOL         := report/performance.py
bench_TOOL               := report/performance.py --bench
glance_TOOL              := report/glance.py
reliability_TOOL         := dev/reliability.py
random-cases_TOOL        := dev/random_cases.py --all-builds
REPORTS := $(patsubst %_TOOL,%,$(filter %_TOOL,$(.VARIABLES)))

.PHONY: $(REPORTS) help-reports gallery faults absence fuzz mutants
$(REPORTS): $(PROGRAM)
	$(Q)SPHFSI='$(abspath $(PROGRAM))' BUILD='$(B)' $(PROJECT_PYTHON) tools/$($@_TOOL) $(ARGS)
	$(if $(filter accuracy,$@),@$(MAKE) --no-print-directory all)

# What a report runs beside the program. Several runs at a time must not spin while they wait.
validate stability-map: export OMP_WAIT_POLICY := passive
validate: $(B)/tests/converge/test_solid_patch
verify-manufactured: $(SHARED)
bench performance: $(BENCHES)
reliability: $(TESTS)

help-reports:
	@sed -n '/^#/!q; s/^# \{0,1\}//p' tools/report/report.mk

# Those that the documents show.
gallery: $(PROGRAM)
	@[ -e runs/elastic_valve/summary.json ] || ./$(PROGRAM) cases/elastic_valve.cfg --quiet
	@$(PROJECT_PYTHON) tools/plot_fields.py runs/elastic_valve --time 0.75 --field velocity \
	  --out docs/img/elastic_valve.png

faults: $(PROGRAM)
	@set -e; export SPHFSI='$(abspath $(PROGRAM))' PYTHON='$(PROJECT_PYTHON)'; \
	 export KILLS=50 FULL_STEPS=40 INJECT_STRIDE=1; \
	 for t in fault/test_kill fault/test_full fault/test_inject fault/test_fork \
	   agree/test_restart_cases; do bash tests/$$t.sh; done

absence:
	@SETUP=no $(PROJECT_PYTHON) tests/agree/test_absence.py --each

fuzz:
	@tools/dev/fuzz.sh $(ARGS)

mutants:
	@$(PROJECT_PYTHON) tools/dev/mutants.py $(ARGS)
